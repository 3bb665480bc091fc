//! Morton (Z-order) codes of three 21-bit coordinates.

/// Spreads the low 21 bits of `v` so that two zero bits follow each.
#[inline]
fn spread(v: u32) -> u64 {
    let mut x = u64::from(v) & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[inline]
fn compact(v: u64) -> u32 {
    let mut x = v & 0x1249_2492_4924_9249;
    x = (x | x >> 2) & 0x10c3_0c30_c30c_30c3;
    x = (x | x >> 4) & 0x100f_00f0_0f00_f00f;
    x = (x | x >> 8) & 0x001f_0000_ff00_00ff;
    x = (x | x >> 16) & 0x001f_0000_0000_ffff;
    ((x | x >> 32) & 0x1f_ffff) as u32
}

/// Code of three coordinates below 2^21; x is the fastest.
#[inline]
pub(crate) fn encode(c: [u32; 3]) -> u64 {
    spread(c[0]) | spread(c[1]) << 1 | spread(c[2]) << 2
}

/// The coordinates of a code.
#[inline]
pub(crate) fn decode(code: u64) -> [u32; 3] {
    [compact(code), compact(code >> 1), compact(code >> 2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_round_trip_and_nest() {
        for c in [[0, 0, 0], [1, 2, 3], [0x1f_ffff, 0, 0x15_5555], [0x1f_ffff; 3]] {
            assert_eq!(decode(encode(c)), c);
            assert_eq!(encode(c) >> 3, encode(c.map(|v| v >> 1)));
        }
    }
}
