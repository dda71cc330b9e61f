//! The `lumivox` program; all of it is in the library [`lumivox_app`].

use std::process::ExitCode;

use lumivox_app::{Host, guard, run};

fn main() -> ExitCode {
    guard(|| run(std::env::args_os(), &Host::of_process())).into()
}
