//! The `lumivox` program; all of it is in the library [`lumivox_app`].

fn main() -> std::process::ExitCode {
    lumivox_app::main(lumivox_app::run)
}
