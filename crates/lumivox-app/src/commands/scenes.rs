//! `lumivox scenes`: the built-in scenes.

use lumivox_scene::builtin;

use crate::host::Host;

/// Lists the built-in scenes, one in a line.
///
/// # Errors
/// When stdout cannot be written.
pub fn run(host: &Host) -> anyhow::Result<()> {
    host.print(&text())
}

fn text() -> String {
    let width = builtin::names().iter().map(|name| name.len()).max().unwrap_or(0);
    let mut text = String::from(
        "Built-in scenes, to be named as builtin:NAME, or builtin:NAME-glossy with a gloss of roughness 0.5:\n\n",
    );
    for name in builtin::names() {
        text += &format!("  {name:<width$}  {}\n", builtin::about(name).unwrap_or_default());
    }
    text
}
