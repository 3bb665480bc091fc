//! LZF decompression.
//!
//! The stream is a row of instructions. A first byte below 32 says how many plain bytes follow, less one. Any other
//! holds in its upper three bits the length of a copy, less two (7: a further byte is added), and in the rest, with the
//! byte after it, how far back the copy starts, less one.

/// The most that a byte can stand for: a copy of 264 bytes takes three.
const MOST_RATIO: usize = 264 / 3;

/// Decompresses to exactly `length` bytes; `None` if the data is damaged or the length a lie.
pub(super) fn decompress(data: &[u8], length: usize) -> Option<Vec<u8>> {
    if length > data.len().saturating_mul(MOST_RATIO) {
        return None;
    }
    let mut out = Vec::with_capacity(length);
    let mut rest = data;
    while let Some((&control, after)) = rest.split_first() {
        rest = after;
        if control < 32 {
            let (plain, after) = rest.split_at_checked(usize::from(control) + 1)?;
            out.extend_from_slice(plain);
            rest = after;
        } else {
            let mut count = usize::from(control >> 5) + 2;
            if count == 9 {
                let (&more, after) = rest.split_first()?;
                count += usize::from(more);
                rest = after;
            }
            let (&low, after) = rest.split_first()?;
            rest = after;
            let back = (usize::from(control & 31) << 8 | usize::from(low)) + 1;
            let start = out.len().checked_sub(back)?;
            if out.len() + count > length {
                return None;
            }
            // Source and target may overlap: a copy can repeat what it just wrote.
            for i in start..start + count {
                out.push(out[i]);
            }
        }
        if out.len() > length {
            return None;
        }
    }
    (out.len() == length).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_bytes_and_overlapping_copies() {
        assert_eq!(decompress(&[2, b'a', b'b', b'c'], 3).as_deref(), Some(&b"abc"[..]));
        // "a", then five bytes from one back.
        assert_eq!(decompress(&[0, b'a', 3 << 5, 0], 6).as_deref(), Some(&b"aaaaaa"[..]));
        // A long copy: 9 and 3 more from two back.
        assert_eq!(decompress(&[1, b'a', b'b', 7 << 5, 3, 1], 14).as_deref(), Some(&b"ababababababab"[..]));
    }

    #[test]
    fn damaged_streams_are_refused() {
        for (data, length) in [
            (&[5, b'a'][..], 6),
            (&[0, b'a', 3 << 5], 6),
            (&[0, b'a', 3 << 5, 9], 6),
            (&[0, b'a', 3 << 5, 0], 5),
            (&[0, b'a', 3 << 5, 0], 7),
            (&[0, b'a'], usize::MAX),
        ] {
            assert_eq!(decompress(data, length), None, "{data:?}");
        }
    }
}
