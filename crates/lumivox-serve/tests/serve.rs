//! Tests of the running server over HTTP.

#![allow(clippy::unwrap_used, reason = "in a test a panic is the message")]

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

struct Server {
    program: Child,
    port: u16,
}

impl Server {
    fn start(folder: &Path) -> Self {
        let mut program = Command::new(env!("CARGO_BIN_EXE_lumivox-serve"))
            .arg(folder)
            .args(["--port", "0"])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut address = String::new();
        BufReader::new(program.stdout.take().unwrap()).read_line(&mut address).unwrap();
        let port = address.trim().trim_start_matches("http://localhost:").trim_end_matches('/');
        Self { port: port.parse().unwrap(), program }
    }

    fn ask(&self, line: &str) -> String {
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).unwrap();
        write!(stream, "{line} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n").unwrap();
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        text
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

#[test]
fn only_files_in_the_folder_are_served() {
    let outer = tempfile::tempdir().unwrap();
    std::fs::write(outer.path().join("secret"), "secret").unwrap();
    let root = outer.path().join("page");
    std::fs::create_dir_all(root.join("a b")).unwrap();
    std::fs::write(root.join("index.html"), "<p>").unwrap();
    std::fs::write(root.join("a b/x.wasm"), "wasm").unwrap();
    let server = Server::start(&root);

    let page = server.ask("GET /?query");
    assert!(page.starts_with("HTTP/1.1 200") && page.ends_with("<p>"), "{page}");
    assert!(page.contains("content-type: text/html") && page.contains("no-cache"), "{page}");
    let wasm = server.ask("GET /a%20b/x.wasm");
    assert!(wasm.contains("application/wasm") && wasm.ends_with("wasm"), "{wasm}");
    for line in ["GET /none", "GET /../secret", "GET /%2e%2e/secret", "GET /a b", "GET //secret"] {
        let refused = server.ask(line);
        assert!(!refused.contains("secret") && !refused.starts_with("HTTP/1.1 200"), "{refused}");
    }
    assert!(server.ask("POST /").starts_with("HTTP/1.1 405"));
    // It does not listen on other addresses, so other machines cannot connect.
    let other = (Ipv4Addr::new(127, 0, 0, 2), server.port).into();
    TcpStream::connect_timeout(&other, Duration::from_secs(1)).unwrap_err();
}

#[test]
fn open_connections_do_not_block_other_clients() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("index.html"), "<p>").unwrap();
    let server = Server::start(folder.path());
    let mut kept: Vec<TcpStream> =
        (0..40).map(|_| TcpStream::connect((Ipv4Addr::LOCALHOST, server.port)).unwrap()).collect();
    for stream in &mut kept {
        write!(stream, "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
        let mut start = [0; 12];
        stream.read_exact(&mut start).unwrap();
        assert_eq!(&start, b"HTTP/1.1 200");
    }
    assert!(server.ask("GET /").ends_with("<p>"));
}

#[test]
fn a_port_in_use_is_reported_with_a_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(folder.path());
    let port = server.port.to_string();
    let output = Command::new(env!("CARGO_BIN_EXE_lumivox-serve"))
        .arg(folder.path())
        .args(["--port", &port])
        .output()
        .unwrap();
    assert!(!output.status.success());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains(&port) && said.contains("--port"), "{said}");
}

#[test]
fn a_missing_folder_is_reported() {
    let output =
        Command::new(env!("CARGO_BIN_EXE_lumivox-serve")).arg("no such folder").output().unwrap();
    assert!(!output.status.success());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("no such folder: cannot be read"), "{said}");
}
