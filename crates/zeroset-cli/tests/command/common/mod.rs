//! What the tests share: the built command, a folder that cleans up, and a small file of every format.

#![allow(unreachable_pub, reason = "one file is shared with the tests of zeroset-io")]

use std::ffi::OsStr;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use zeroset::cloud::Cloud;
use zeroset::sample::{Scene, SceneKind};
use zeroset_io::{WriteOptions, write_cloud};

#[path = "../../../../zeroset-io/tests/formats/common/shared_data.rs"]
mod shared_data;

pub use shared_data::shared_data;

/// Suffixes of clouds, one for each format.
pub const CLOUDS: [&str; 8] = ["las", "laz", "ply", "xyz", "csv", "pts", "pcd", "e57"];
/// Suffixes of meshes.
pub const MESHES: [&str; 5] = ["ply", "obj", "stl", "off", "glb"];

/// The built command in a folder.
pub fn zeroset(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_zeroset"));
    command.current_dir(folder).stdin(Stdio::null());
    command
}

/// What a run of the command ended with.
#[derive(Debug)]
pub struct Outcome {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Outcome {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

pub fn run(folder: &Path, words: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Outcome {
    zeroset(folder).args(words).output().expect("the command starts").into()
}

/// Runs words without spaces in them.
pub fn line(folder: &Path, words: &str) -> Outcome {
    run(folder, words.split_whitespace())
}

/// Runs with a text on standard input.
pub fn with_input(folder: &Path, words: &str, input: &[u8]) -> Outcome {
    let mut command = zeroset(folder);
    command.args(words.split_whitespace()).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command starts");
    // A command that fails early closes its end.
    let _ = child.stdin.take().expect("standard input is a pipe").write_all(input);
    child.wait_with_output().expect("the command ends").into()
}

impl Outcome {
    #[track_caller]
    pub fn ok(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    /// Exit 1, nothing on standard output, and one line that names the file and the remedy. Returns the line.
    #[track_caller]
    pub fn failed(self, name: &str) -> String {
        assert_eq!(self.code, Some(1), "{self:?}");
        assert_eq!(self.stdout, "");
        let lines: Vec<&str> = self.stderr.lines().collect();
        let [line] = lines[..] else { panic!("not one line:\n{}", self.stderr) };
        assert!(line.starts_with("error: "), "{line}");
        assert!(line.contains(name), "{line} does not name {name}");
        let remedy = line.rsplit_once("; ").map_or("", |(_, remedy)| remedy);
        assert!(remedy.len() >= 8, "{line} has no remedy");
        line.to_owned()
    }
}

pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("the system has a folder for temporary files")
}

/// Names in a folder, hidden ones too.
pub fn entries(folder: &Path) -> Vec<String> {
    let read = std::fs::read_dir(folder).expect("the folder is there");
    let mut names: Vec<String> =
        read.map(|entry| entry.expect("the folder can be read").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// A small torus around a place in the world.
pub fn torus(points: usize, at: [f64; 3]) -> Cloud {
    let local = Scene::new(SceneKind::Torus, 1).points(points, 0.001, 1);
    Cloud::from_world(local.points.iter().map(|p| std::array::from_fn(|a| p[a] + at[a])).collect())
}

/// Writes points in any format.
pub fn write(path: &Path, points: &[[f64; 3]]) {
    match path.extension().and_then(OsStr::to_str) {
        Some("pcd") => std::fs::write(path, pcd(points)).expect("the folder can be written to"),
        Some("e57") => std::fs::write(path, e57(points)).expect("the folder can be written to"),
        _ => {
            let cloud = Cloud::from_world(points.to_vec());
            write_cloud(path, &cloud, &WriteOptions::default()).expect("a sound cloud can be written");
        }
    }
}

/// The content of a sound file of 60 points.
pub fn sound(suffix: &str) -> Vec<u8> {
    let folder = folder();
    let path = folder.path().join(format!("sound.{suffix}"));
    write(&path, &torus(60, [0.0; 3]).points);
    std::fs::read(path).expect("what was written can be read")
}

fn pcd(points: &[[f64; 3]]) -> Vec<u8> {
    let n = points.len();
    let mut out = format!(
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {n}\nHEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {n}\nDATA binary\n"
    )
    .into_bytes();
    out.extend(points.iter().flatten().flat_map(|c| c.to_le_bytes()));
    out
}

fn e57(points: &[[f64; 3]]) -> Vec<u8> {
    use e57::{Record, RecordValue};
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = e57::E57Writer::new(&mut file, "a file").expect("E57 can be written");
    let prototype = vec![Record::CARTESIAN_X_F64, Record::CARTESIAN_Y_F64, Record::CARTESIAN_Z_F64];
    let mut scan = writer.add_pointcloud("a scan", prototype).expect("E57 can be written");
    for point in points {
        scan.add_point(point.iter().map(|c| RecordValue::Double(*c)).collect()).expect("the point fits");
    }
    scan.finalize().expect("E57 can be written");
    writer.finalize().expect("E57 can be written");
    drop(writer);
    file.into_inner()
}
