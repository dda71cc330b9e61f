//! The arguments of `run`.

use std::path::PathBuf;

use clap::Args;

use super::ExploreArgs;

pub const EXAMPLES: &str = "\
Examples:
  lumivox run evening.txt --scene builtin:cornell
  lumivox run -c 'load builtin:atrium; sky 20,100' -c 'screenshot atrium.png'
  lumivox run                  (on a terminal: a prompt with history and completion)
  generate | lumivox run -
docs/generated/console.md lists all commands, and so does `lumivox run -c help`.";

/// A script, and its initial state.
#[derive(Args, Debug)]
pub struct RunArgs {
    /// File of commands, or - for stdin [default: a prompt on a terminal, else stdin]
    ///
    /// One or more commands a line, with ; between them; # begins a comment. UTF-8. Relative paths
    /// in commands start at the working folder.
    #[arg(value_name = "SCRIPT", conflicts_with = "commands")]
    pub script: Option<PathBuf>,

    /// Commands by name, with ; between them, instead of a script; may be repeated [default: none]
    #[arg(short, long = "command", value_name = "COMMANDS", allow_hyphen_values = true)]
    pub commands: Vec<String>,

    /// Continue after errors, report them all, and end with the exit code of the first [default:
    /// stop at the first]
    #[arg(long)]
    pub keep_going: bool,

    /// The initial state.
    #[command(flatten)]
    pub explore: ExploreArgs,
}

/// The arguments of `commands`.
#[derive(Args, Debug)]
pub struct CommandsArgs {
    /// Print the page of the docs, docs/generated/console.md [default: a line on each command]
    #[arg(long)]
    pub markdown: bool,
}
