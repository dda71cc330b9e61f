//! Serves a folder of static files on this machine, for browsers on this machine: WebGPU and modules need a server, and
//! `file://` is none.
//!
//! Only what is in the folder is handed out, links that leave it are not followed, and nobody else on the network is
//! answered. Browsers are told to ask again each time, so that a page is never older than its build.

use std::fs::File;
use std::io;
use std::net::Ipv4Addr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context as _;
use clap::Parser;
use tiny_http::{Header, Method, Request, Response, Server, StatusCode};

/// Answers at a time: a browser fetches about six files at once.
const THREADS: usize = 6;

#[derive(Debug, Parser)]
#[command(about, version)]
struct Arguments {
    /// The folder
    folder: PathBuf,
    /// The port, 0 to 65535; 0 takes any free one
    #[arg(long, default_value_t = 8080)]
    port: u16,
}

fn main() -> anyhow::Result<()> {
    let Arguments { folder, port } = Arguments::parse();
    let root =
        folder.canonicalize().with_context(|| format!("{}: cannot be read", folder.display()))?;
    let server = listen(port)?;
    let address = server.server_addr().to_ip().context("the server has no address")?;
    // The one line on stdout: whoever started this reads it.
    println!("http://localhost:{}/", address.port());
    let server = Arc::new(server);
    let workers: Vec<_> = (0..THREADS)
        .map(|_| {
            let (server, root) = (server.clone(), root.clone());
            std::thread::spawn(move || serve(&server, &root))
        })
        .collect();
    for worker in workers {
        // A worker that panicked has said so; the others go on.
        let _ = worker.join();
    }
    Ok(())
}

fn listen(port: u16) -> anyhow::Result<Server> {
    Server::http((Ipv4Addr::LOCALHOST, port)).map_err(|error| {
        anyhow::anyhow!(
            "port {port} of this machine cannot be used: {error}; choose another with --port, or 0 for any free one"
        )
    })
}

fn serve(server: &Server, root: &Path) {
    while let Ok(request) = server.recv() {
        // Browsers hang up when they like.
        let _ = answer(request, root);
    }
}

fn answer(request: Request, root: &Path) -> io::Result<()> {
    if !matches!(request.method(), Method::Get | Method::Head) {
        return refuse(request, 405, "Files can be read here, and that is all.\n");
    }
    let Some(path) = find(root, request.url()) else {
        return refuse(request, 404, "There is no such file.\n");
    };
    match File::open(&path) {
        Ok(file) => {
            let kind = mime_guess::from_path(&path).first_or_octet_stream();
            let kind = match kind.type_() {
                mime_guess::mime::TEXT => format!("{kind}; charset=utf-8"),
                _ => kind.to_string(),
            };
            let response = Response::from_file(file)
                .with_header(header("Content-Type", &kind))
                .with_header(header("Cache-Control", "no-cache"));
            request.respond(response)
        }
        Err(_) => refuse(request, 404, "The file cannot be read.\n"),
    }
}

fn refuse(request: Request, code: u16, words: &str) -> io::Result<()> {
    request.respond(Response::from_string(words).with_status_code(StatusCode(code)))
}

fn header(name: &str, value: &str) -> Header {
    Header::from_bytes(name, value).unwrap_or_else(|()| unreachable!("{name}: {value} is ASCII"))
}

/// The file at an address, if it is in the folder; of a folder its `index.html`.
fn find(root: &Path, url: &str) -> Option<PathBuf> {
    let path = url.split(['?', '#']).next().unwrap_or_default();
    let path = percent_encoding::percent_decode_str(path).decode_utf8().ok()?;
    let mut file = root.join(path.trim_start_matches('/'));
    if file.is_dir() {
        file.push("index.html");
    }
    // With all links and dots followed, it must still be below.
    let file = file.canonicalize().ok()?;
    (file.starts_with(root) && file.is_file()).then_some(file)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "in a test a panic is the message")]

    use super::*;

    fn folder() -> tempfile::TempDir {
        let outer = tempfile::tempdir().unwrap();
        std::fs::write(outer.path().join("secret"), "secret").unwrap();
        let root = outer.path().join("page");
        std::fs::create_dir(&root).unwrap();
        std::fs::create_dir(root.join("a b")).unwrap();
        for (name, text) in [("index.html", "<p>"), ("a b/x.wasm", "wasm"), ("s.js", "js")] {
            std::fs::write(root.join(name), text).unwrap();
        }
        outer
    }

    #[cfg(unix)]
    #[test]
    fn links_that_leave_the_folder_are_not_followed() {
        let outer = folder();
        let root = outer.path().join("page").canonicalize().unwrap();
        std::os::unix::fs::symlink(outer.path().join("secret"), root.join("link")).unwrap();
        std::os::unix::fs::symlink(root.join("s.js"), root.join("inside")).unwrap();
        assert_eq!(find(&root, "/link"), None);
        assert_eq!(find(&root, "/inside"), Some(root.join("s.js")));
    }

    #[test]
    fn a_port_that_is_taken_is_told_with_a_remedy() {
        let taken = listen(0).unwrap();
        let port = taken.server_addr().to_ip().unwrap().port();
        let error = listen(port).err().unwrap().to_string();
        assert!(error.contains(&port.to_string()) && error.contains("--port"), "{error}");
    }
}
