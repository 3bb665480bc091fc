#![no_main]

use std::path::Path;

use zeroset_io::{PositionFormat, read_positions_bytes};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(error) = read_positions_bytes(Path::new("fuzz.npy"), PositionFormat::Npy, bytes.to_vec()) {
        assert_eq!(error.to_string().lines().count(), 1);
    }
});
