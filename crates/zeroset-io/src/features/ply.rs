//! The points of a cloud with what they are, as PLY.

use std::io::Result;

use zeroset::cloud::Cloud;
use zeroset::feature::{FeatureClass, PointFeature};
use zeroset::mesh::Mesh;

use super::FeatureOutput;
use crate::mesh::{Column, WriteOptions, write_ply_points};
use crate::output::Sink;

/// Points of no plane.
const GREY: [u8; 3] = [150, 150, 150];

pub(super) fn write(sink: &mut dyn Sink, cloud: &Cloud, output: FeatureOutput<'_>) -> Result<()> {
    let points = &output.features.points;
    let mut attributes = cloud.attributes.clone();
    attributes.colors.get_or_insert_with(|| points.iter().map(color).collect());
    let mesh = Mesh {
        world_from_local: cloud.world_from_local,
        vertices: cloud.points.clone(),
        attributes,
        crs: cloud.crs.clone(),
        ..Mesh::default()
    };
    let planes: Vec<i32> =
        points.iter().map(|p| p.plane.and_then(|plane| i32::try_from(plane).ok()).unwrap_or(-1)).collect();
    let classes: Vec<u8> = points.iter().map(|p| class(p.class)).collect();
    let mut comments = output.options.comments.clone();
    comments.push("plane: number of the plane, -1 for none".to_owned());
    comments.push("feature: 0 unstructured, 1 flat, 2 edge, 3 corner".to_owned());
    let options = WriteOptions { comments, ..output.options.clone() };
    write_ply_points(sink, &mesh, &options, &[Column::Int("plane", &planes), Column::Byte("feature", &classes)])
}

fn class(class: FeatureClass) -> u8 {
    match class {
        FeatureClass::Unstructured => 0,
        FeatureClass::Flat => 1,
        FeatureClass::Edge => 2,
        FeatureClass::Corner => 3,
    }
}

/// A colour of the plane's own. Hues a golden section apart keep planes of near numbers apart; three shades help where
/// hues come close.
fn color(point: &PointFeature) -> [u8; 3] {
    const GOLDEN_SECTION: f64 = 0.618_033_988_749_894_9;
    let Some(plane) = point.plane else { return GREY };
    let hue = (f64::from(plane) * GOLDEN_SECTION).fract();
    let value = [0.95, 0.75, 0.85][plane as usize % 3];
    let channel = |shift: f64| {
        // A ramp up, a plateau, a ramp down and a floor over the circle of hues.
        let x = ((hue + shift).fract() * 6.0 - 3.0).abs() - 1.0;
        let saturation = 0.7;
        (255.0 * value * (1.0 - saturation * (1.0 - x.clamp(0.0, 1.0)))).round() as u8
    };
    [channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_planes_have_colours_that_differ() {
        let of = |plane| color(&PointFeature { plane, class: FeatureClass::Flat });
        assert_eq!(of(None), GREY);
        for a in 0..40 {
            for b in (0..a).rev().take(5) {
                let differ: i32 = (0..3).map(|c| (i32::from(of(Some(a))[c]) - i32::from(of(Some(b))[c])).abs()).sum();
                assert!(differ > 40, "{a} and {b}: {differ}");
            }
        }
        assert_eq!(of(Some(0)), [242, 73, 73]);
    }
}
