//! Polygons drawn out along z.

use super::planar::Region;
use crate::field::{Field, FieldError, Metric, finite};
use crate::vec3;

/// A polygon with holes between two heights: a building from its footprint, say.
#[derive(Debug, Clone, PartialEq)]
pub struct Prism {
    region: Region,
    heights: [f64; 2],
}

/// Where a position is: beyond the region, and beyond the heights.
struct Place {
    nearest: super::planar::Nearest,
    above: f64,
}

impl Prism {
    /// The region that an odd number of rings surrounds, so holes are rings within rings, between two heights in any order. Rings are
    /// closed by themselves; their direction does not matter. They must not cross.
    ///
    /// # Errors
    /// If a number is not finite, the heights are equal, or no ring has an area.
    pub fn new(rings: &[Vec<[f64; 2]>], heights: [f64; 2]) -> Result<Self, FieldError> {
        rings.iter().flatten().try_for_each(|p| finite("a coordinate", p))?;
        finite("a height", &heights)?;
        if heights[0] == heights[1] {
            return Err(FieldError::Empty("an extruded polygon has no height: its two heights must differ"));
        }
        let region = Region::new(rings)
            .ok_or(FieldError::Empty("a polygon has no area: give a ring of three corners or more"))?;
        Ok(Self { region, heights: [heights[0].min(heights[1]), heights[0].max(heights[1])] })
    }

    fn place(&self, p: [f64; 3]) -> Place {
        let nearest = self.region.nearest([p[0], p[1]]);
        Place { nearest, above: (self.heights[0] - p[2]).max(p[2] - self.heights[1]) }
    }

    fn is_upper(&self, z: f64) -> bool {
        z - self.heights[1] >= self.heights[0] - z
    }
}

impl Field for Prism {
    fn value(&self, p: [f64; 3]) -> f64 {
        let Place { nearest, above } = self.place(p);
        let beside = nearest.distance;
        beside.max(0.0).hypot(above.max(0.0)) + beside.max(above).min(0.0)
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let Place { nearest, above } = self.place(p);
        let up = if self.is_upper(p[2]) { 1.0 } else { -1.0 };
        let beside = nearest.distance;
        let step = [p[0] - nearest.place[0], p[1] - nearest.place[1]];
        let outward = if beside == 0.0 { self.region.sides()[nearest.side].outward } else { step.map(|c| c / beside) };
        if beside > 0.0 && above > 0.0 {
            let length = beside.hypot(above);
            return [outward[0] * beside / length, outward[1] * beside / length, up * above / length];
        }
        if beside > above { [outward[0], outward[1], 0.0] } else { [0.0, 0.0, up] }
    }

    fn metric(&self) -> Metric {
        Metric::Distance
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        let corners = || self.region.sides().iter().map(|side| [side.from[0], side.from[1], self.heights[0]]);
        let low = corners().fold([f64::INFINITY; 3], vec3::min);
        let high = corners().fold([f64::NEG_INFINITY; 3], vec3::max);
        Some([low, [high[0], high[1], self.heights[1]]])
    }

    fn sheets(&self) -> u32 {
        2 + self.region.sides().len() as u32
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        let Place { nearest, above } = self.place(p);
        // Beyond a corner the line of the side counts, not the corner.
        let beside = self.region.sides()[nearest.side].offset([p[0], p[1]]);
        if beside > above { 2 + nearest.side as u32 } else { u32::from(self.is_upper(p[2])) }
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        match sheet {
            0 => (self.heights[0] - p[2], [0.0, 0.0, -1.0]),
            1 => (p[2] - self.heights[1], [0.0, 0.0, 1.0]),
            _ => {
                let side = &self.region.sides()[sheet as usize - 2];
                (side.offset([p[0], p[1]]), [side.outward[0], side.outward[1], 0.0])
            }
        }
    }

    fn is_flat(&self, _: u32) -> bool {
        true
    }
}
