#![no_main]

use std::path::Path;

use zeroset::model::Solid;
use zeroset_io::{Footprint, Operands, SolidError, parse_solid};

/// A solid for every file, without files.
struct Pretended;

impl Operands for Pretended {
    fn file(&mut self, _: &Path, _: usize) -> Result<Solid, SolidError> {
        Ok(Solid::Ball { center: [0.0; 3], radius: 1.0 })
    }

    fn footprints(&mut self, _: &Path) -> Result<Vec<Footprint>, SolidError> {
        Ok(vec![vec![vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]]])
    }
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match parse_solid(text, &mut Pretended, 0) {
        Ok(solid) => drop(solid.field([0.0; 3])),
        Err(error) => {
            assert_eq!(error.to_string().lines().count(), 1);
            let SolidError::Expression { character, .. } = error else { panic!("{error}") };
            assert!((1..=text.chars().count() + 1).contains(&character));
        }
    }
});
