#![no_main]

use std::path::Path;

use zeroset_io::{CloudFormat, read_cloud_bytes};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(error) = read_cloud_bytes(Path::new("fuzz.pts"), CloudFormat::Pts, bytes.to_vec()) {
        assert_eq!(error.to_string().lines().count(), 1);
    }
});
