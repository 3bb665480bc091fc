//! Volumes of solids, and of what differs between two.

use rayon::prelude::*;
use serde::Serialize;

use super::columns::{Column, STEPS, TILE, spans};
use super::domain::{Local, checked, is_finite};
use super::keep::Keep;
use super::{ModelError, Solid};
use crate::monitor::{Monitor, Steps};
use crate::vec3::{self, Vec3};

/// Of what the volume is taken.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VolumeParams {
    /// Only what lies in this box of world coordinates; `None`: all.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Only what lies beyond this plane, on the side that the normal points to: a position and a normal of any length, in world coordinates.
    pub above: Option<[[f64; 3]; 2]>,
    /// The distance between the lines along which the solid is measured; `None`: half a cell.
    pub step: Option<f64>,
}

/// A volume, in cubic units of the input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Volume {
    /// The volume.
    pub volume: f64,
    /// How far it may be off, for there are gaps between the lines: twice the standard error, from the differences of neighbouring lines. What F itself is off is
    /// not part of it.
    pub error: f64,
}

/// What changed from one solid to another, in cubic units of the input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CutAndFill {
    /// What is only in the first.
    pub cut: Volume,
    /// What is only in the second.
    pub fill: Volume,
    /// The second less the first.
    pub net: Volume,
}

/// Lines to a cell.
const LINES: f64 = 2.0;
/// No more lines than this along one side.
const MOST_LINES: f64 = 2e5;

/// The volume of a solid, by upright lines.
///
/// # Errors
/// If an operand cannot be, the solid has no end that is known and no bounds are given, or the monitor stops.
///
/// ```
/// use zeroset::model::{Solid, VolumeParams, volume};
/// let ball = Solid::Ball { center: [84810.0, 447412.0, 2.0], radius: 3.0 };
/// let found = volume(&ball, &VolumeParams::default(), &())?;
/// let exact = 36.0 * std::f64::consts::PI;
/// assert!((found.volume - exact).abs() < 0.001 * exact && found.error < 0.002 * exact);
/// # Ok::<(), zeroset::model::ModelError>(())
/// ```
pub fn volume(solid: &Solid, params: &VolumeParams, monitor: &dyn Monitor) -> Result<Volume, ModelError> {
    let local = Local::new(solid)?;
    let region = Region::new(&local, &local, params, Some(&local))?;
    let [sum] = region.sum(monitor, |tile| {
        let spans = spans(&*local.field, tile, region.step);
        let field = &local.field;
        move |line, ends| {
            let column = Column::trace(&**field, line, ends, &spans, region.step);
            [column.inside(ends).map(|[low, high]| high - low).sum()]
        }
    })?;
    Ok(sum)
}

/// What is only in the one of two solids, and only in the other, by upright lines.
///
/// Where both are open ground, only what both have points around is looked at.
///
/// # Errors
/// As for [`volume`].
pub fn cut_and_fill(
    before: &Solid,
    after: &Solid,
    params: &VolumeParams,
    monitor: &dyn Monitor,
) -> Result<CutAndFill, ModelError> {
    let first = Local::new(before)?;
    let second = Local::at(after, first.origin)?;
    let region = Region::new(&first, &second, params, None)?;
    let (first, other) = (&*first.field, &*second.field);
    let [cut, fill, net] = region.sum(monitor, |tile| {
        let found = [first, other].map(|field| spans(field, tile, region.step));
        move |line, ends| {
            let trace = |field, spans| Column::trace(field, line, ends, spans, region.step);
            let (a, b) = (trace(first, &found[0]), trace(other, &found[1]));
            let length = |column: &Column| column.inside(ends).map(|[low, high]| high - low).sum::<f64>();
            let common = overlap(&a, &b, ends);
            [length(&a) - common, length(&b) - common, length(&b) - length(&a)]
        }
    })?;
    Ok(CutAndFill { cut, fill, net })
}

/// Whether something of a solid lies under the box of its surface.
fn is_open_below(local: &Local, [low, high]: [Vec3; 2]) -> bool {
    let z = low[2] - local.cell([low, high]);
    let at = |a: usize, i: u32| low[a] + (high[a] - low[a]) * (f64::from(i) + 0.5) / f64::from(LOOKS);
    let mut places = (0..LOOKS).flat_map(|i| (0..LOOKS).map(move |j| (i, j)));
    places.any(|(i, j)| local.field.value([at(0, i), at(1, j), z]) < 0.0)
}

/// Places along either side at which is looked under a solid.
const LOOKS: u32 = 32;

/// The length that two lines have in common.
fn overlap(a: &Column, b: &Column, ends: [f64; 2]) -> f64 {
    let others: Vec<[f64; 2]> = b.inside(ends).collect();
    let with = |[low, high]: [f64; 2]| -> f64 {
        others.iter().map(|other| (high.min(other[1]) - low.max(other[0])).max(0.0)).sum()
    };
    a.inside(ends).map(with).sum()
}

/// Where lines are drawn, in the local coordinates of both solids.
struct Region<'a> {
    /// Ground that must be known where a line is.
    grounds: Vec<(&'a Local, Option<Keep>)>,
    low: Vec3,
    high: Vec3,
    /// Lines along x and y.
    lines: [usize; 2],
    spacing: [f64; 2],
    /// Step along a line.
    step: f64,
    /// What lies on the far side of a plane counts: `normal . x > offset`.
    above: Option<(Vec3, f64)>,
}

impl<'a> Region<'a> {
    /// Both are about the same origin. `alone` is the solid if it must end by itself.
    fn new(
        first: &'a Local,
        second: &'a Local,
        params: &VolumeParams,
        alone: Option<&Local>,
    ) -> Result<Self, ModelError> {
        let given = checked(params.bounds)?.map(|bounds| bounds.map(|corner| vec3::sub(corner, first.origin)));
        let [low, high] = match given.filter(is_finite) {
            Some(given) => given,
            None => {
                let (a, b) = (first.local_box()?, second.local_box()?);
                let (mut low, mut high) = (vec3::min(a[0], b[0]), vec3::max(a[1], b[1]));
                // Ground that one of them knows nothing of has not changed.
                for (local, [own_low, own_high]) in [(first, a), (second, b)] {
                    if local.ground().is_some() {
                        (0..2).for_each(|i| (low[i], high[i]) = (low[i].max(own_low[i]), high[i].min(own_high[i])));
                    }
                }
                given.map_or([low, high], |given| [vec3::max(low, given[0]), vec3::min(high, given[1])])
            }
        };
        let above = match params.above {
            None => None,
            Some([point, normal]) => {
                let normal = vec3::normalized(normal).filter(|_| vec3::is_finite(point));
                let normal = normal.ok_or(ModelError::Parameter("the plane needs a finite position and a normal"))?;
                Some((normal, vec3::dot(normal, vec3::sub(point, first.origin))))
            }
        };
        // Ground goes on below without end.
        let is_limited = given.is_some_and(|given| given[0][2].is_finite()) || above.is_some_and(|(n, _)| n[2] > 0.0);
        if !is_limited && alone.is_some_and(|local| is_open_below(local, [low, high])) {
            return Err(ModelError::Parameter(
                "the solid goes on below without end; give --above a plane, such as a height, or --bounds",
            ));
        }
        let (low, high) = match above {
            // The plane may lie under all of the surface.
            Some((normal, offset)) if normal[2] > 0.0 && given.is_none_or(|given| given[0][2].is_infinite()) => {
                let under = |x: f64, y: f64| (offset - normal[0] * x - normal[1] * y) / normal[2];
                let corners = [(low[0], low[1]), (low[0], high[1]), (high[0], low[1]), (high[0], high[1])];
                let lowest = corners.map(|(x, y)| under(x, y)).into_iter().fold(low[2], f64::min);
                ([low[0], low[1], lowest], high)
            }
            _ => (low, high),
        };
        let cell = first.cell([low, high]).min(second.cell([low, high]));
        let wanted = params.step.unwrap_or(cell / LINES);
        let lines = [0, 1].map(|a| ((high[a] - low[a]) / wanted).ceil().clamp(1.0, MOST_LINES) as usize);
        let spacing = [0, 1].map(|a| (high[a] - low[a]) / lines[a] as f64);
        // Of two equal ones the first is enough.
        let both = if std::ptr::eq(first, second) { vec![first] } else { vec![first, second] };
        let grounds = both.into_iter().filter(|local| local.ground().is_some());
        let grounds = grounds.map(|local| (local, local.keep())).collect();
        Ok(Self { grounds, low, high, lines, spacing, step: cell / STEPS, above })
    }

    /// The sums over all lines of some lengths, as volumes. `measure` prepares for the lines in a box.
    fn sum<const N: usize, M: Fn([f64; 2], [f64; 2]) -> [f64; N]>(
        &self,
        monitor: &dyn Monitor,
        measure: impl Fn([Vec3; 2]) -> M + Sync,
    ) -> Result<[Volume; N], ModelError> {
        monitor.stage("measuring along lines");
        let tiles = self.lines.map(|lines| lines.div_ceil(TILE));
        let steps = Steps::new(monitor, 0.0..1.0, tiles[0] * tiles[1]);
        let sums: Vec<[[f64; 2]; N]> = (0..tiles[0] * tiles[1])
            .into_par_iter()
            .map(|tile| {
                steps.advance(1)?;
                let first = [tile % tiles[0] * TILE, tile / tiles[0] * TILE];
                let last = [0, 1].map(|a| (first[a] + TILE).min(self.lines[a]));
                Ok(self.sum_of_tile(first, last, &measure))
            })
            .collect::<Result<_, ModelError>>()?;
        let area = self.spacing[0] * self.spacing[1];
        Ok(std::array::from_fn(|n| {
            let [sum, squares] = sums.iter().fold([0.0; 2], |[s, q], tile| [s + tile[n][0], q + tile[n][1]]);
            // Where lengths jump from a line to the next, any place between them is as likely.
            Volume { volume: area * sum, error: 2.0 * area * (squares / 12.0).sqrt() }
        }))
    }

    /// The sums of lengths and of squared differences along x.
    fn sum_of_tile<const N: usize, M: Fn([f64; 2], [f64; 2]) -> [f64; N]>(
        &self,
        first: [usize; 2],
        last: [usize; 2],
        measure: impl Fn([Vec3; 2]) -> M,
    ) -> [[f64; 2]; N] {
        let at = |a: usize, i: usize| self.low[a] + (i as f64 + 0.5) * self.spacing[a];
        let corner = |place: [usize; 2], z: f64| [at(0, place[0]), at(1, place[1]), z];
        let measure = measure([corner(first, self.low[2]), corner([last[0] - 1, last[1] - 1], self.high[2])]);
        let mut sums = [[0.0; 2]; N];
        for j in first[1]..last[1] {
            let mut before = None::<[f64; N]>;
            for i in first[0]..last[0] {
                let line = [at(0, i), at(1, j)];
                let ends = self.ends(line).filter(|_| self.is_known(line));
                let lengths = ends.map_or([0.0; N], |ends| measure(line, ends));
                for (n, [sum, squares]) in sums.iter_mut().enumerate() {
                    *sum += lengths[n];
                    *squares += before.map_or(0.0, |before| (lengths[n] - before[n]).powi(2));
                }
                before = Some(lengths);
            }
        }
        sums
    }

    /// Whether ground is known where a line is.
    fn is_known(&self, [x, y]: [f64; 2]) -> bool {
        self.grounds
            .iter()
            .all(|(local, keep)| keep.as_ref().is_none_or(|keep| keep.contains(local.enter([x, y, 0.0]))))
    }

    /// The part of a line that counts.
    fn ends(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let (mut low, mut high) = (self.low[2], self.high[2]);
        if let Some((normal, offset)) = self.above {
            let rest = offset - normal[0] * x - normal[1] * y;
            if normal[2] > 0.0 {
                low = low.max(rest / normal[2]);
            } else if normal[2] < 0.0 {
                high = high.min(rest / normal[2]);
            } else if rest > 0.0 {
                return None;
            }
        }
        (low < high).then_some([low, high])
    }
}
