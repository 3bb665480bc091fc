//! Between 8 bit sRGB and 16 bit linear colours (IEC 61966-2-1).

/// Share of full brightness of an sRGB share.
fn linear_from_srgb(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

fn srgb_from_linear(value: f64) -> f64 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

/// Linear 16 bits for each 8 bit sRGB value.
pub(super) fn linear_table() -> Vec<u16> {
    (0..=255_u8).map(|v| (65535.0 * linear_from_srgb(f64::from(v) / 255.0)).round() as u16).collect()
}

/// 8 bit sRGB of a linear share of full brightness.
pub(super) fn srgb_byte(linear: f64) -> u8 {
    (255.0 * srgb_from_linear(linear.clamp(0.0, 1.0))).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives() {
        for (byte, linear) in linear_table().into_iter().enumerate() {
            assert_eq!(usize::from(srgb_byte(f64::from(linear) / 65535.0)), byte);
        }
    }
}
