//! The program itself.

use crate::console::{Console, Effect, Reply};

/// `quit`
pub fn quit(_: &mut Console, _: &[&str]) -> anyhow::Result<Reply> {
    Ok(Reply::ask(Effect::Quit))
}
