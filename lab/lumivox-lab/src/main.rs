//! The `lumivox-lab` program; all of it is in the library [`lumivox_lab`].

fn main() -> std::process::ExitCode {
    lumivox_app::main(lumivox_lab::run)
}
