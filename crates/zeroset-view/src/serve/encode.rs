//! Layers as bytes, for the page.
//!
//! | | nodes of points | triangles and lines |
//! |---|---|---|
//! | four letters | `ZSN1` | `ZSM1` |
//! | u32 | points | vertices, then triangles or lines |
//! | positions | u16 x 3: the lowest corner, and 65,535ths of the side | f32 x 3, local |
//! | corners | | u32 x 3, or u32 x 2 |
//! | channels | in order, but for heights | the same |
//!
//! A channel is u16 for numbers (65,534ths of the way from the least to the largest, 65,535 for none), u8 for classes, u8 x 3 for colours, u32 for planes (2^32 - 1 for none). Each array begins
//! at a multiple of four bytes.

use super::channel::{Channel, Data};
use super::octree::Node;

/// Steps along the side of a node.
const STEPS: f64 = 65_535.0;
/// Steps from the least to the largest number.
const VALUE_STEPS: f64 = 65_534.0;

fn pad(out: &mut Vec<u8>) {
    out.resize(out.len().next_multiple_of(4), 0);
}

/// The points of a node.
pub(super) fn node(node: &Node, positions: &[[f64; 3]], channels: &[Channel]) -> Vec<u8> {
    let mut out = b"ZSN1".to_vec();
    out.extend((node.points.len() as u32).to_le_bytes());
    for &i in &node.points {
        for (c, low) in positions[i as usize].into_iter().zip(node.low) {
            let step = (STEPS * (c - low) / node.side).round();
            out.extend((step.clamp(0.0, STEPS) as u16).to_le_bytes());
        }
    }
    pad(&mut out);
    for channel in channels {
        append(&mut out, channel, node.points.iter().map(|i| *i as usize));
    }
    out
}

/// Vertices with what joins them.
pub(super) fn mesh<const N: usize>(
    positions: &[[f64; 3]],
    step: [f64; 3],
    items: &[[u32; N]],
    channels: &[Channel],
) -> Vec<u8> {
    let mut out = b"ZSM1".to_vec();
    out.extend((positions.len() as u32).to_le_bytes());
    out.extend((items.len() as u32).to_le_bytes());
    for p in positions {
        for a in 0..3 {
            out.extend(((p[a] + step[a]) as f32).to_le_bytes());
        }
    }
    out.extend(items.iter().flatten().flat_map(|corner| corner.to_le_bytes()));
    for channel in channels {
        append(&mut out, channel, 0..positions.len());
    }
    out
}

fn append(out: &mut Vec<u8>, channel: &Channel, places: impl Iterator<Item = usize>) {
    match &channel.data {
        Data::Height { .. } => return,
        Data::Values { values, reach: [low, high], .. } => {
            for i in places {
                let step =
                    values[i].map_or(u16::MAX, |v| (VALUE_STEPS * (f64::from(v) - low) / (high - low)).round() as u16);
                out.extend(step.to_le_bytes());
            }
        }
        Data::Classes { values, .. } => out.extend(places.map(|i| values[i])),
        Data::Colors(values) => out.extend(places.flat_map(|i| values[i])),
        Data::Planes(values) => out.extend(places.flat_map(|i| values[i].unwrap_or(u32::MAX).to_le_bytes())),
    }
    pad(out);
}
