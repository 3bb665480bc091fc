//! Memory stays in proportion to a file's true size, whatever counts and lengths it states.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

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
}
