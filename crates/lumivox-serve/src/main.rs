//! Serves a folder of static files to browsers on this machine: WebGPU and modules do not work from
//! `file://`.
//!
//! The server only listens on localhost. Browsers must revalidate each file (`no-cache`), so that a
//! page is never older than its build.

use std::io::Write as _;
use std::net::Ipv4Addr;
use std::path::PathBuf;

use anyhow::Context as _;
use axum::Router;
use axum::http::HeaderValue;
use axum::http::header::CACHE_CONTROL;
use clap::Parser;
use tokio::net::TcpListener;
use tower_http::services::ServeDir;
use tower_http::set_header::SetResponseHeaderLayer;

#[derive(Debug, Parser)]
#[command(about, version)]
struct Arguments {
    /// The folder
    folder: PathBuf,
    /// The port, 0 to 65535; 0 takes any free one
    #[arg(long, default_value_t = 8080)]
    port: u16,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { folder, port } = Arguments::parse();
    std::fs::read_dir(&folder).with_context(|| format!("{}: cannot be read", folder.display()))?;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).await.with_context(|| {
        format!("port {port} of this machine cannot be used; choose another with --port, or 0 for any free one")
    })?;
    // The only line on stdout, for the program that started the server.
    writeln!(std::io::stdout(), "http://localhost:{}/", listener.local_addr()?.port())
        .context("the address cannot be printed")?;
    let no_cache = HeaderValue::from_static("no-cache");
    let files = Router::new()
        .fallback_service(ServeDir::new(folder))
        .layer(SetResponseHeaderLayer::overriding(CACHE_CONTROL, no_cache));
    Ok(axum::serve(listener, files).await?)
}
