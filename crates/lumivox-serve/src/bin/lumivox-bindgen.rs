//! Makes a browser module from compiled WebAssembly, as `wasm-bindgen --target web` does. That
//! program also contains a test runner, which takes minutes to compile.

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
    /// Leave out that the module looks for its WebAssembly beside itself: whoever starts it hands it over
    #[arg(long)]
    no_default_path: bool,
}

fn main() -> anyhow::Result<()> {
    let Arguments { input, folder, name, no_default_path } = Arguments::parse();
    Bindgen::new()
        .web(true)?
        .input_path(input)
        .out_name(&name)
        .typescript(true)
        .omit_default_module_path(no_default_path)
        .remove_name_section(true)
        .remove_producers_section(true)
        .generate(folder)
}
