//! A diverging scale of colours: blue inside, white on the zero set, red outside.

/// ColorBrewer RdBu (C. Brewer, colorbrewer2.org), from white outwards. Its darkest ends are left out: cells and data must show on them.
const INSIDE: [[f64; 3]; 5] =
    [[247.0, 247.0, 247.0], [209.0, 229.0, 240.0], [146.0, 197.0, 222.0], [67.0, 147.0, 195.0], [33.0, 102.0, 172.0]];
const OUTSIDE: [[f64; 3]; 5] =
    [[247.0, 247.0, 247.0], [253.0, 219.0, 199.0], [244.0, 165.0, 130.0], [214.0, 96.0, 77.0], [178.0, 24.0, 43.0]];

/// The smallest values are coloured by this share, so that both sides of the zero set can be told apart.
const FAINTEST: f64 = 0.1;

/// The colour of a value from -1 to 1.
pub(super) fn shade(value: f64) -> String {
    let scale = if value < 0.0 { INSIDE } else { OUTSIDE };
    let share = FAINTEST + (1.0 - FAINTEST) * value.abs().clamp(0.0, 1.0);
    let at = share * (scale.len() - 1) as f64;
    let below = (at as usize).min(scale.len() - 2);
    let t = at - below as f64;
    let channel = |c: usize| (scale[below][c] + t * (scale[below + 1][c] - scale[below][c])).round() as u8;
    format!("#{:02x}{:02x}{:02x}", channel(0), channel(1), channel(2))
}

#[cfg(test)]
mod tests {
    use super::shade;

    #[test]
    fn signs_have_their_colours() {
        assert_ne!(shade(0.01), shade(-0.01));
        assert_eq!(shade(-1.0), "#2166ac");
        assert_eq!(shade(2.0), "#b2182b");
    }
}
