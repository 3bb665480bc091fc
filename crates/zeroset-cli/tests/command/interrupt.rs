//! Ctrl-C leaves nothing behind.

#![cfg(unix)]

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};

use crate::common::{entries, folder, torus, write, zeroset};

fn interrupt(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill is there");
    assert!(sent.success());
}

/// Waits for the end and returns the exit code and what standard error still held.
fn end(mut child: Child, mut stderr: impl Read) -> (Option<i32>, String) {
    let mut rest = String::new();
    stderr.read_to_string(&mut rest).expect("text");
    (child.wait().expect("it ends").code(), rest)
}

#[test]
fn during_the_fit() {
    let folder = folder();
    write(&folder.path().join("in.xyz"), &torus(100_000, [0.0; 3]).points);
    std::fs::write(folder.path().join("out.ply"), "old").unwrap();
    let before = entries(folder.path());
    let mut command = zeroset(folder.path());
    command.args(["reconstruct", "in.xyz", "-o", "out.ply", "--resolution", "0.0025", "--report", "report.json", "-v"]);
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    // With -v the scene is announced when the plan is made; the fit follows, and takes seconds.
    stderr.read_line(&mut line).unwrap();
    assert!(line.starts_with("points: "), "{line}");
    line.clear();
    stderr.read_line(&mut line).unwrap();
    assert!(line.starts_with("scene: "), "{line}");
    interrupt(&child);
    let (code, rest) = end(child, stderr);
    assert_eq!(code, Some(130), "{rest}");
    assert_eq!(rest.lines().count(), 1, "{rest}");
    assert_eq!(entries(folder.path()), before);
    assert_eq!(std::fs::read(folder.path().join("out.ply")).unwrap(), b"old");
}

#[test]
fn while_reading() {
    let folder = folder();
    let mut command = zeroset(folder.path());
    // Standard input stays open, so reading does not end.
    command.args(["reconstruct", "-", "-o", "out.ply"]).stdin(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let stderr = child.stderr.take().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(500));
    interrupt(&child);
    let (code, rest) = end(child, stderr);
    assert_eq!(code, Some(130), "{rest}");
    assert!(entries(folder.path()).is_empty());
}
