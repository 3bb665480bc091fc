#![no_main]

use std::path::Path;

use zeroset_io::{ConstraintFormat, read_constraints_bytes};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(error) = read_constraints_bytes(Path::new("fuzz.geojson"), ConstraintFormat::GeoJson, bytes) {
        assert_eq!(error.to_string().lines().count(), 1);
    }
});
