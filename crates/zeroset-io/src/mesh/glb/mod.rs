//! glTF 2.0 in one binary file.
//!
//! # Axes and offset
//! glTF has y up, clouds have z up, and f32 cannot hold georeferenced coordinates. The writer turns and moves nothing in
//! the data: positions are local and z is up. Instead the scene has two nodes. The outer one, `z_up`, has the rotation
//! by -90 degrees about x that makes viewers show z upright; the inner one, `mesh`, has the offset as its translation.
//! World coordinates with z up are therefore translation + position, in f64, as JSON numbers are.
//!
//! The reader applies the transforms of all nodes and then turns y up into z up, which for files of the writer gives
//! back the world coordinates.
//!
//! # Colours
//! `COLOR_0` is linear in glTF while 8 bit colours are sRGB. The writer stores 16 bit linear values, from which the
//! reader gets the same 8 bits back. Intensity and class go to the application's own attributes `_INTENSITY` and
//! `_CLASSIFICATION`.

mod color;
mod nodes;
mod read;
mod write;

pub(super) use read::read;
pub(super) use write::{check, write};

const MAGIC: &[u8; 4] = b"glTF";
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// Numbers that stand for types of values.
mod component {
    pub(super) const U8: u64 = 5121;
    pub(super) const U16: u64 = 5123;
    pub(super) const U32: u64 = 5125;
    pub(super) const F32: u64 = 5126;
}
