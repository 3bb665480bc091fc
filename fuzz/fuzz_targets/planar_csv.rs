#![no_main]

use std::path::Path;

use zeroset_io::{PlanarFormat, read_planar_bytes};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(error) = read_planar_bytes(Path::new("fuzz.csv"), PlanarFormat::Csv, bytes) {
        assert_eq!(error.to_string().lines().count(), 1);
    }
});
