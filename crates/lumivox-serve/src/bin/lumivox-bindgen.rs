//! Makes a module for browsers of the compiled `lumivox-web`: what `wasm-bindgen --target web` does, without the servers
//! and clients of its test runner, which take minutes to compile.

use std::path::PathBuf;

use clap::Parser;
use wasm_bindgen_cli_support::Bindgen;

#[derive(Debug, Parser)]
#[command(about, version)]
struct Arguments {
    /// The WebAssembly as Cargo leaves it
    input: PathBuf,
    /// The folder for the module, its declarations and its WebAssembly
    folder: PathBuf,
    /// What the module is called
    #[arg(long, default_value = "lumivox")]
    name: String,
}

fn main() -> anyhow::Result<()> {
    let Arguments { input, folder, name } = Arguments::parse();
    Bindgen::new()
        .web(true)?
        .input_path(input)
        .out_name(&name)
        .typescript(true)
        // The module finds its WebAssembly beside itself.
        .omit_default_module_path(false)
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate(folder)
}
