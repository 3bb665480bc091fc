#![no_main]

use std::path::Path;

use zeroset_io::read_features_bytes;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    if let Err(error) = read_features_bytes(Path::new("fuzz.json"), bytes) {
        assert_eq!(error.to_string().lines().count(), 1);
    }
});
