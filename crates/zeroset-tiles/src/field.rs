//! F on a lattice as a file.

use std::path::Path;

use zeroset::domain::{Lattice, Mask};
use zeroset::field::LatticeField;

use crate::TilesError;
use crate::binary::{In, Out, read};

pub(crate) fn write_field(path: &Path, field: &LatticeField) -> Result<(), TilesError> {
    let mut out = Out::default();
    out.value(field.lattice.origin);
    out.value(field.lattice.spacing);
    out.value(field.lattice.finest);
    out.value(field.lattice.blocks);
    let (inside, packed) = field.packed();
    out.list(&field.blocks.keys);
    out.list(&field.known);
    out.list(&inside);
    out.list(&packed);
    out.write(path)
}

pub(crate) fn read_field(path: &Path) -> Result<LatticeField, TilesError> {
    let bytes = read(path)?;
    parse(&bytes).ok_or_else(|| TilesError::damaged(path))
}

fn parse(bytes: &[u8]) -> Option<LatticeField> {
    let mut rest = In::new(bytes);
    let lattice = Lattice::new(rest.value()?, rest.value()?, rest.value()?, rest.value()?).ok()?;
    let (keys, known, inside) = (rest.list::<u64>()?, rest.list::<Mask>()?, rest.list::<Mask>()?);
    let packed: Vec<f32> = rest.list()?;
    LatticeField::from_packed(lattice, keys, known, &inside, &packed).ok().filter(|_| rest.is_at_end())
}
