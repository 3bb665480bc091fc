//! `view`.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Outcome, folder, line, torus, write, zeroset};

/// Ends the command with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// What lies at an address, if it is given.
fn get(port: u16, path: &str) -> (u16, String) {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    (head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
}

#[test]
fn the_page_is_served_at_the_printed_address_or_the_command_says_how_to_build_it() {
    let folder = folder();
    write(&folder.path().join("a.xyz"), &torus(3_000, [84_810.0, 447_412.0, 0.0]).points);
    std::fs::write(folder.path().join("bad.ply"), "ply\nelement face 3\nend_header\n").unwrap();
    let mut command = zeroset(folder.path());
    command.args(["view", "a.xyz", "bad.ply", "--no-open", "--quiet"]).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut running = Running(command.spawn().unwrap());
    let mut address = String::new();
    BufReader::new(running.0.stdout.take().unwrap()).read_line(&mut address).unwrap();
    if address.is_empty() {
        let mut stderr = String::new();
        running.0.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
        let code = running.0.wait().unwrap().code();
        let said = Outcome { code, stdout: String::new(), stderr }.failed("zeroset");
        assert!(said.contains("cargo xtask web"), "{said}");
        return;
    }
    let rest = address.trim().strip_prefix("http://127.0.0.1:").unwrap();
    let (port, token) = rest.split_once('/').unwrap();
    let (port, token) = (port.parse().unwrap(), token.trim_end_matches('/'));
    assert_eq!(token.len(), 32);
    assert_eq!(get(port, "/").0, 403);
    let (status, page) = get(port, &format!("/{token}/"));
    assert!(status == 200 && page.contains("<html"), "{status}: {page}");
    let start = Instant::now();
    let scene = loop {
        let (status, body) = get(port, &format!("/{token}/scene.json"));
        assert_eq!(status, 200);
        let scene: serde_json::Value = serde_json::from_str(&body).unwrap();
        if !scene["problems"].as_array().unwrap().is_empty() {
            break scene;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "{scene}");
        std::thread::sleep(Duration::from_millis(50));
    };
    assert_eq!((&scene["layers"][0]["name"], &scene["layers"][0]["count"]), (&"a.xyz".into(), &3_000.into()));
    assert!(scene["problems"][0].as_str().unwrap().starts_with("bad.ply: "), "{scene}");
    #[cfg(unix)]
    {
        let id = running.0.id().to_string();
        std::process::Command::new("kill").args(["-INT", &id]).status().unwrap();
        assert_eq!(running.0.wait().unwrap().code(), Some(0));
    }
}

#[test]
fn what_cannot_be_shown_is_refused_before_anything_is_served() {
    let folder = folder();
    write(&folder.path().join("a.xyz"), &torus(10, [0.0; 3]).points);
    for name in ["missing.laz", "a.docx", "."] {
        std::fs::write(folder.path().join("a.docx"), "x").unwrap();
        line(folder.path(), &format!("view a.xyz {name} --no-open")).failed(name);
    }
    assert_eq!(line(folder.path(), "view a.xyz --port 70000 --no-open").code, Some(2));
    assert_eq!(line(folder.path(), "view - --no-open").code, Some(2));
}
