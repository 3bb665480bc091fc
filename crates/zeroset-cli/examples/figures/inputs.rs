//! The data of the pictures, as files that anyone can fit again.

use std::f64::consts::TAU;
use std::fmt::Write;

/// The paper's example, as printed.
const THIRTEEN: [[f64; 2]; 13] = [
    [0.44, 0.13],
    [0.24, 0.15],
    [0.22, 0.35],
    [0.31, 0.49],
    [0.35, 0.60],
    [0.43, 0.70],
    [0.51, 0.77],
    [0.57, 0.70],
    [0.70, 0.55],
    [0.85, 0.30],
    [0.88, 0.23],
    [0.80, 0.10],
    [0.60, 0.10],
];

pub(crate) fn write() -> std::io::Result<()> {
    std::fs::write("thirteen.csv", csv(&THIRTEEN, 2))?;
    std::fs::write("mixed.json", mixed())?;
    std::fs::write("corner.csv", csv(&corner(), 4))?;
    std::fs::write("clover.csv", csv(&clover(), 4))?;
    std::fs::write("peanut.csv", csv(&peanut(), 4))
}

fn csv(points: &[[f64; 2]], decimals: usize) -> String {
    points.iter().fold("x,y\n".to_owned(), |mut text, [x, y]| {
        let _ = writeln!(text, "{x:.decimals$},{y:.decimals$}");
        text
    })
}

/// Around a region: points on the left, a chain of segments on the right. A hole in it: a polygon.
fn mixed() -> String {
    let mut chance = Chance::new(4);
    let points: Vec<String> = (0..40)
        .map(|i| TAU * (0.26 + 0.48 * f64::from(i) / 39.0))
        .map(|angle| [0.48 + 0.36 * angle.cos(), 0.5 + 0.36 * angle.sin()].map(|c| c + 0.003 * chance.normal()))
        .map(|[x, y]| format!("[{x:.4}, {y:.4}]"))
        .collect();
    let chain = [[0.52, 0.86], [0.76, 0.82], [0.90, 0.50], [0.76, 0.18], [0.52, 0.14]];
    let segments: Vec<String> = chain.windows(2).map(|ends| format!("{ends:?}")).collect();
    format!(
        "{{\n  \"points\": [{}],\n  \"segments\": [{}],\n  \
         \"polygons\": [[[0.36, 0.36], [0.66, 0.36], [0.66, 0.54], [0.51, 0.68], [0.36, 0.54]]]\n}}\n",
        points.join(", "),
        segments.join(", ")
    )
}

/// An L: the corner lies in the lower of the two triangles of the square, the arms run to the left and upwards.
fn corner() -> Vec<[f64; 2]> {
    const CORNER: [f64; 2] = [0.72, 0.22];
    const TURN: f64 = 0.08;
    let (sin, cos) = TURN.sin_cos();
    let mut chance = Chance::new(8);
    let arms = [[-cos, -sin], [-sin, cos]];
    arms.into_iter()
        .flat_map(|arm| [arm; 200])
        .map(|arm| {
            let t = 0.42 * chance.uniform();
            std::array::from_fn(|a| CORNER[a] + t * arm[a] + 0.005 * chance.normal())
        })
        .collect()
}

/// A clover of four leaves.
fn clover() -> Vec<[f64; 2]> {
    let mut chance = Chance::new(5);
    (0..400)
        .map(|i| {
            let angle = TAU * f64::from(i) / 400.0;
            let radius = 1.0 + 0.3 * (4.0 * angle).cos();
            [radius * angle.cos(), radius * angle.sin()].map(|c| c + 0.02 * chance.normal())
        })
        .collect()
}

/// A peanut, turned a little.
fn peanut() -> Vec<[f64; 2]> {
    const TURN: f64 = 0.35;
    let mut chance = Chance::new(6);
    (0..300)
        .map(|i| {
            let angle = TAU * f64::from(i) / 300.0;
            let radius = 0.72 + 0.28 * (2.0 * angle).cos();
            let turned = angle + TURN;
            [radius * turned.cos(), radius * turned.sin()].map(|c| c + 0.012 * chance.normal())
        })
        .collect()
}

/// Random numbers by SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): the same everywhere and for ever.
struct Chance(u64);

impl Chance {
    fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// At least 0, less than 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Mean 0, deviation 1.
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }
}
