//! From positions to places in the picture.

use super::super::{Section, plane_frame};
use super::axis::Axis;
use crate::LinearUnit;
use crate::mesh::world;
use crate::number::{decimals_for, trimmed};

/// Pixels along the longer side.
const SIZE: f64 = 800.0;
/// Room between the curves and the frame, relative to the longer side.
const MARGIN_REL: f64 = 0.04;
/// The shorter side is at least this long, relative to the longer one.
const LEAST_REL: f64 = 0.12;
/// Rounding moves a curve by no more than this, in pixels.
const ROUNDING: f64 = 1e-3;
/// About the width of a letter.
const LETTER: f64 = 6.7;
/// Room above, to the right of and below the frame.
const TOP: f64 = 16.0;
const RIGHT: f64 = 32.0;
const BOTTOM: f64 = 96.0;
/// About how far apart marks are, to the right and up, and about how many there are at least: side by side they need more
/// room than above one another.
const MARKS: [f64; 2] = [150.0, 110.0];
const LEAST_MARKS: [f64; 2] = [1.0, 2.0];

/// How the plane lies in the picture.
pub(super) struct Canvas {
    /// The plane's point, in local coordinates.
    point: [f64; 3],
    directions: [[f64; 3]; 2],
    /// To the right, and up.
    pub(super) axes: [Axis; 2],
    /// From where the coordinates of curves count.
    zero: [f64; 2],
    /// Pixels for each unit of length.
    scale: f64,
    left: f64,
    /// Digits of the coordinates of curves.
    pub(super) decimals: u32,
    pub(super) unit: Option<LinearUnit>,
}

impl Canvas {
    pub(super) fn new(section: &Section, unit: Option<LinearUnit>) -> Self {
        let plane = section.levels.first().map(|level| level.plane);
        let point = plane.map_or([0.0; 3], |plane| plane.point);
        let directions = plane_frame(plane.map_or([0.0, 0.0, 1.0], |plane| plane.normal));
        let ranges = ranges(section, point, directions);
        let longer = ranges.map(|[low, high]| high - low).into_iter().fold(0.0, f64::max);
        let scale = SIZE / longer;
        let axes = [0, 1].map(|i| {
            let axis = Axis::new(directions[i], world(point, section.world_from_local), ranges[i]);
            let about = scale * axis.length() / MARKS[i];
            axis.with_marks(about.max(LEAST_MARKS[i]))
        });
        let zero = [0, 1].map(|i: usize| axes[i].marks.first().map_or(axes[i].range[0], |(place, _)| *place));
        let longest = axes[1].marks.iter().map(|(_, text)| text.len()).max().unwrap_or(0);
        let left = 42.0 + LETTER * longest as f64;
        let decimals = decimals_for(ROUNDING / scale);
        Self { point, directions, axes, zero, scale, left, decimals, unit }
    }

    /// A position in the plane, to the right and up from the plane's point.
    pub(super) fn place(&self, position: [f64; 3]) -> [f64; 2] {
        in_plane(position, self.point, self.directions)
    }

    /// The same, from where the coordinates of curves count.
    pub(super) fn beyond_zero(&self, position: [f64; 3]) -> [f64; 2] {
        let place = self.place(position);
        [place[0] - self.zero[0], place[1] - self.zero[1]]
    }

    /// A place in pixels, down from the upper left.
    pub(super) fn pixel(&self, [right, up]: [f64; 2]) -> [f64; 2] {
        let [across, upward] = &self.axes;
        [self.left + self.scale * (right - across.range[0]), TOP + self.scale * (upward.range[1] - up)]
    }

    /// Upper left and lower right corner of the frame, in pixels.
    pub(super) fn frame(&self) -> [[f64; 2]; 2] {
        let [across, upward] = &self.axes;
        [[across.range[0], upward.range[1]], [across.range[1], upward.range[0]]].map(|place| self.pixel(place))
    }

    /// What takes the coordinates of curves to pixels.
    pub(super) fn transform(&self) -> String {
        let [x, y] = self.pixel(self.zero);
        format!("matrix({0} 0 0 -{0} {x:.4} {y:.4})", self.scale)
    }

    /// A length in pixels, in the unit of curves.
    pub(super) fn length(&self, pixels: f64) -> String {
        format!("{:.3e}", pixels / self.scale)
    }

    /// Pixels of a length.
    pub(super) fn pixels(&self, length: f64) -> f64 {
        self.scale * length
    }

    /// A sentence about where the coordinates of curves count from.
    pub(super) fn zero(&self) -> String {
        let [right, up] = [0, 1].map(|i: usize| {
            let axis = &self.axes[i];
            let figure =
                axis.marks.first().map_or_else(|| trimmed(axis.figure(axis.range[0]), 6), |(_, text)| text.clone());
            format!("{} {figure}", axis.name)
        });
        let unit = self.unit.map_or_else(String::new, |unit| format!(" in {},", unit.name()));
        format!("Coordinates of curves count{unit} to the right and up from {right}, {up}")
    }

    /// Width and height of the picture.
    pub(super) fn size(&self) -> (f64, f64) {
        let [_, [right, bottom]] = self.frame();
        ((right + RIGHT).ceil(), (bottom + BOTTOM).ceil())
    }
}

fn in_plane(position: [f64; 3], point: [f64; 3], directions: [[f64; 3]; 2]) -> [f64; 2] {
    directions.map(|direction| (0..3).map(|a| direction[a] * (position[a] - point[a])).sum())
}

/// What is shown of both axes: the box around all curves, and some room.
fn ranges(section: &Section, point: [f64; 3], directions: [[f64; 3]; 2]) -> [[f64; 2]; 2] {
    let positions = section.levels.iter().flat_map(|level| &level.lines).flat_map(|line| &line.positions);
    let empty = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    let around = positions
        .map(|p| in_plane(*p, point, directions))
        .fold(empty, |ranges, place| [0, 1].map(|i: usize| [ranges[i][0].min(place[i]), ranges[i][1].max(place[i])]));
    let around = if around[0][0] <= around[0][1] { around } else { [[0.0; 2]; 2] };
    let longer = around.map(|[low, high]| high - low).into_iter().fold(0.0, f64::max);
    let longer = if longer > 0.0 { longer } else { 1.0 };
    around.map(|[low, high]| {
        let side = (high - low + 2.0 * MARGIN_REL * longer).max(LEAST_REL * longer);
        let middle = 0.5 * (low + high);
        [middle - 0.5 * side, middle + 0.5 * side]
    })
}
