//! Settings by their names.

use anyhow::bail;
use lumivox_render::parameters::{PARAMETERS, Parameter};

use crate::console::{COMMANDS, Console, Reply, suggest};
use crate::exit::Failure;

/// `PARAMETER [VALUE]`: prints or sets it.
pub fn run(console: &mut Console, name: &str, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some(parameter) = Parameter::find(name) else { bail!(unknown(name)) };
    match arguments {
        [] => {
            let value = parameter.get(console.explorer.settings());
            Ok(Reply::say(format!("{name} {value}")))
        }
        [text] => {
            let mut settings = console.explorer.settings().clone();
            let value = parameter.parse(text).map_err(|e| Failure::input(e.to_string()))?;
            parameter.set(&mut settings, value).map_err(|e| Failure::input(e.to_string()))?;
            console.explorer.set_settings(settings)?;
            Ok(Reply::default())
        }
        _ => bail!(Failure::input(format!("{name} takes one value; got {}", arguments.len()))),
    }
}

fn unknown(name: &str) -> Failure {
    let commands =
        COMMANDS.iter().flat_map(|c| [c.name].into_iter().chain(c.aliases.iter().copied()));
    let known = commands.chain(PARAMETERS.iter().map(|parameter| parameter.name));
    Failure::input(match suggest::like(name, known) {
        Some(like) => format!("there is no command \"{name}\"; did you mean \"{like}\"?"),
        None => format!("there is no command \"{name}\"; `help` lists them"),
    })
}
