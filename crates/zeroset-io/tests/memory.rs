//! Memory stays in proportion to a file's true size, whatever counts and lengths it states.

#[path = "formats/common/mod.rs"]
mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use common::{Parts, read_bad, sound_model, wrapped};
use serde_json::json;
use zeroset_io::{CloudFormat, MeshFormat, read_cloud_bytes, read_mesh_bytes};

/// The system's allocator, and the most that was taken at any time.
struct Counting;

static NOW: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

#[expect(unsafe_code, reason = "the trait of allocators is unsafe")]
// SAFETY: every call is handed on unchanged; counting touches no memory of the caller.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let now = NOW.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(now, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        NOW.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the pointer came from `System.alloc` above, with this layout.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Bytes taken at the most while `work` runs, beyond those taken before.
fn peak(work: impl FnOnce()) -> usize {
    let before = NOW.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    work();
    MOST.load(Ordering::Relaxed).saturating_sub(before)
}

/// For files of some hundred bytes.
const SMALL: usize = 1 << 20;
/// A model takes this many times its file: a block without a known node is 136 bytes there, and 2.3 kB in memory. Lists of short texts take as
/// much while they grow.
const MODEL_REL: usize = 26;
/// LAZ may repeat one point at next to no cost, so up to a million points are always believed.
const LAZ: usize = 80 << 20;

fn damaged(sound: &[u8], mut read: impl FnMut(Vec<u8>)) {
    for at in 0..sound.len() {
        for pattern in [&[0xFF][..], &[0x7F], &[0xFF; 4], &[0xFF, 0xFF, 0xFF, 0x7F], &[0xFF; 8], b"9", b"99999999"] {
            let mut bytes = sound.to_vec();
            let length = pattern.len().min(bytes.len() - at);
            bytes[at..at + length].copy_from_slice(&pattern[..length]);
            read(bytes);
        }
    }
}

/// One test, so that no other thread of this program counts.
#[test]
fn damaged_files_take_little_memory() {
    for (suffix, format) in CloudFormat::KNOWN {
        let name = format!("bad.{suffix}");
        let limit = if *format == CloudFormat::Laz { LAZ } else { SMALL };
        // Thread pools and tables are set up before counting.
        let _ = read_cloud_bytes(Path::new(&name), *format, common::sound_cloud(*format));
        let mut samples = vec![common::sound_cloud(*format)];
        if *format == CloudFormat::Pcd {
            samples.extend([common::pcd_ascii(), common::pcd_compressed()]);
        }
        for sound in samples {
            damaged(&sound, |bytes| {
                let found = peak(|| drop(read_cloud_bytes(Path::new(&name), *format, bytes)));
                assert!(found < limit, "{name}: {found} bytes");
            });
        }
    }
    for (suffix, format) in MeshFormat::KNOWN {
        let name = format!("bad.{suffix}");
        damaged(&common::sound_mesh(*format), |bytes| {
            let found = peak(|| drop(read_mesh_bytes(Path::new(&name), *format, &bytes)));
            assert!(found < SMALL, "{name}: {found} bytes");
        });
    }
    for sound in [sound_model(), common::model_bytes(&common::model(common::every_solid()))] {
        damaged(&sound, |bytes| {
            let found = peak(|| drop(read_bad(&bytes)));
            assert!(found < SMALL, "{found} bytes for a model");
        });
    }
    for (name, bytes) in hostile_models() {
        let found = peak(|| drop(read_bad(&bytes)));
        let rel = found as f64 / bytes.len() as f64;
        println!("{name}: {rel:.1} times {} bytes", bytes.len());
        assert!(found < MODEL_REL * bytes.len() + SMALL, "{name}: {rel:.1} times {} bytes", bytes.len());
    }
}

/// Models with sound checksums, of contents that take much more memory than file.
fn hostile_models() -> Vec<(&'static str, Vec<u8>)> {
    // Lists are longest in memory just after they have grown.
    const MANY: usize = (1 << 17) + 1;
    let list = |item: &str| vec![item; MANY].join(",");
    let of = |text: String| wrapped(text.as_bytes(), &[]);
    let rest = r#""solid":[]"#;
    let mut blocks = Parts::of(&sound_model());
    let count = 128_u64.pow(2);
    blocks.header["models"][0]["lattice"]["blocks"] = json!([4, 4, 1]);
    blocks.header["models"][0]["lattice"]["finest"] = json!(5);
    for (name, content) in [
        ("keys", (0..count).flat_map(u64::to_le_bytes).collect()),
        ("known", vec![0; 64 * count as usize]),
        ("inside", vec![0; 64 * count as usize]),
        ("values", Vec::new()),
    ] {
        let name = format!("models/0/{name}");
        let first = if name.ends_with("values") { 0 } else { count };
        blocks.header["arrays"][&name]["shape"][0] = json!(first);
        blocks.arrays.insert(name, content);
    }
    let arrays: Vec<String> =
        (0..MANY).map(|i| format!(r#""{i}":{{"dtype":"|u1","shape":[0],"offset":0,"crc32":0}}"#)).collect();
    vec![
        ("blocks", blocks.bytes()),
        ("numbers in an unknown key", of(format!(r#"{{"a":[{}],{rest}}}"#, list("0")))),
        ("lists in an unknown key", of(format!(r#"{{"a":[{}],{rest}}}"#, list("[]")))),
        ("numbers in an unknown operand", of(format!(r#"{{"solid":[{{"a":[{}]}}]}}"#, list("0")))),
        (
            "numbers in an unknown part of an operand",
            of(format!(r#"{{"solid":[{{"ball":{{"a":[{}]}}}}]}}"#, list("0"))),
        ),
        ("operands", of(format!(r#"{{"solid":[{}]}}"#, list(r#"{"mesh":{"mesh":0}}"#)))),
        ("balls", of(format!(r#"{{"solid":[{}]}}"#, list(r#"{"ball":{"center":[0,0,0],"radius":1}}"#)))),
        ("operands of an operand", of(format!(r#"{{"solid":[{{"union":{{"of":[{}]}}}}]}}"#, list("0")))),
        ("rings", of(format!(r#"{{"solid":[{{"prism":{{"rings":[{}],"heights":[0,1]}}}}]}}"#, list("[]")))),
        ("corners", of(format!(r#"{{"solid":[{{"prism":{{"rings":[[{}]],"heights":[0,1]}}}}]}}"#, list("[0,0]")))),
        ("small rings", of(format!(r#"{{"solid":[{{"prism":{{"rings":[{}],"heights":[0,1]}}}}]}}"#, list("[[0,0]]")))),
        ("meshes", of(format!(r#"{{"meshes":[{}],{rest}}}"#, list(r#"{"world_from_local":[0,0,0]}"#)))),
        ("inputs", of(format!(r#"{{"provenance":{{"zeroset":"","inputs":[{}]}},{rest}}}"#, list("\"\"")))),
        ("arrays", of(format!(r#"{{"arrays":{{{}}},{rest}}}"#, arrays.join(",")))),
    ]
}
