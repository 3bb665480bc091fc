#![no_main]

use std::path::Path;

use zeroset_io::{MeshFormat, read_mesh_bytes};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(error) = read_mesh_bytes(Path::new("fuzz.off"), MeshFormat::Off, bytes) {
        assert_eq!(error.to_string().lines().count(), 1);
    }
});
