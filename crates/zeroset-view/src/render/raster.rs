//! Which thing each sample of the picture shows.

use rayon::prelude::*;

use super::camera::{Camera, Placed};
use super::{RenderError, View};
use crate::scene::{Layer, Scene, Shape};

/// Samples along a side of the squares that are drawn at a time.
const SQUARE: usize = 64;
/// Things that are sorted into squares at a time.
const CHUNK: usize = 1 << 14;
/// A box is this much wider, in samples, so that rounding loses nothing.
const SLACK: f32 = 0.01;
/// Points of a cloud that covers the picture evenly lie so many of their diameters apart.
const COVER: f64 = 1.3;
/// Least and most pixels across the points of a cloud.
const DIAMETERS: [f64; 2] = [1.2, 9.0];

/// What each sample shows.
pub(super) struct Frame<'a> {
    /// Samples across and down.
    pub(super) size: [usize; 2],
    /// How near it is.
    pub(super) nearness: Vec<f32>,
    /// The thing that it shows, counted over all layers from 1; 0 for none.
    pub(super) things: Vec<u32>,
    /// The layers as they lie on the picture.
    pub(super) layers: Vec<OnPicture<'a>>,
}

/// A layer as it lies on the picture.
pub(super) struct OnPicture<'a> {
    pub(super) layer: &'a Layer,
    /// The number of its first thing.
    pub(super) first: u32,
    placed: Vec<Placed>,
    /// Half the width of discs and lines, in samples.
    radius: f32,
}

/// Samples that something may cover: from and to, across and down.
type Extent = [[i64; 2]; 2];

/// A square that is being drawn.
struct Square {
    corner: [usize; 2],
    size: [usize; 2],
    nearness: Vec<f32>,
    things: Vec<u32>,
}

impl<'a> Frame<'a> {
    pub(super) fn draw(scene: &'a Scene, camera: &Camera, view: &View) -> Result<Self, RenderError> {
        let size = view.size.map(|side| (side * view.antialias) as usize);
        let mut layers: Vec<OnPicture<'_>> = Vec::new();
        let mut count = 0;
        for layer in &scene.layers {
            layers.push(OnPicture::new(layer, count as u32, camera, view));
            count += layer.count();
            if count >= u32::MAX as usize {
                return Err(RenderError::TooMany(count));
            }
        }
        let across = size[0].div_ceil(SQUARE);
        let lists = Lists::new(&layers, camera, size, across);
        let mut frame = Self {
            size,
            nearness: vec![camera.farthest(); size[0] * size[1]],
            things: vec![0; size[0] * size[1]],
            layers: Vec::new(),
        };
        let rows = SQUARE * size[0];
        let bands = frame.nearness.par_chunks_mut(rows).zip(frame.things.par_chunks_mut(rows)).enumerate();
        bands.for_each(|(band, (nearness, things))| {
            for column in 0..across {
                let corner = [column * SQUARE, band * SQUARE];
                let extent: [usize; 2] = std::array::from_fn(|a| SQUARE.min(size[a] - corner[a]));
                let mut square = Square {
                    corner,
                    size: extent,
                    nearness: vec![camera.farthest(); extent[0] * extent[1]],
                    things: vec![0; extent[0] * extent[1]],
                };
                let mut layer = 0;
                for thing in lists.of(band * across + column) {
                    while layers.get(layer + 1).is_some_and(|next| next.first <= thing) {
                        layer += 1;
                    }
                    layers[layer].draw(thing, camera, &mut square);
                }
                for row in 0..extent[1] {
                    let (from, to) = (row * extent[0], row * size[0] + corner[0]);
                    nearness[to..to + extent[0]].copy_from_slice(&square.nearness[from..from + extent[0]]);
                    things[to..to + extent[0]].copy_from_slice(&square.things[from..from + extent[0]]);
                }
            }
        });
        frame.layers = layers;
        Ok(frame)
    }
}

/// For each square what may show in it, in order.
struct Lists {
    /// For runs of things: square and thing, sorted.
    runs: Vec<Vec<(u32, u32)>>,
}

impl Lists {
    fn new(layers: &[OnPicture<'_>], camera: &Camera, size: [usize; 2], across: usize) -> Self {
        let runs = layers.iter().flat_map(|on| {
            let (first, end) = (on.first as usize, on.first as usize + on.layer.count());
            (first..end).step_by(CHUNK).map(move |start| (on, start..end.min(start + CHUNK)))
        });
        let sorted = |(on, things): (&OnPicture<'_>, std::ops::Range<usize>)| {
            let mut found = Vec::new();
            for thing in things {
                let Some([low, high]) = on.extent(thing as u32, camera, size) else { continue };
                let squares = [low, high].map(|corner| corner.map(|c| c as usize / SQUARE));
                for row in squares[0][1]..=squares[1][1] {
                    let columns = squares[0][0]..=squares[1][0];
                    found.extend(columns.map(|column| ((row * across + column) as u32, thing as u32)));
                }
            }
            found.sort_unstable();
            found
        };
        Self { runs: runs.collect::<Vec<_>>().into_par_iter().map(sorted).collect() }
    }

    fn of(&self, square: usize) -> impl Iterator<Item = u32> + '_ {
        self.runs.iter().flat_map(move |run| {
            let from = run.partition_point(|entry| (entry.0 as usize) < square);
            run[from..].iter().take_while(move |entry| entry.0 as usize == square).map(|entry| entry.1)
        })
    }
}

impl<'a> OnPicture<'a> {
    fn new(layer: &'a Layer, first: u32, camera: &Camera, view: &View) -> Self {
        let placed = layer.positions.par_iter().map(|&p| camera.place(layer, p)).collect();
        let samples = f64::from(view.antialias);
        let radius = match layer.shape {
            Shape::Points { diameter: Some(diameter) } | Shape::Lines { width: diameter, .. } => {
                0.5 * samples * f64::from(diameter)
            }
            Shape::Points { diameter: None } => {
                let pixels = f64::from(view.size[0]) * f64::from(view.size[1]) / 2.0;
                let apart = view.zoom * (pixels / layer.positions.len().max(1) as f64).sqrt();
                0.5 * samples * (COVER * apart).clamp(DIAMETERS[0], DIAMETERS[1])
            }
            Shape::Surface { .. } => 0.0,
        };
        // A disc always covers the middle of a sample.
        Self { layer, first, placed, radius: radius.max(0.71) as f32 }
    }

    /// The corners of a triangle.
    fn corners(&self, triangle: [u32; 3]) -> [Placed; 3] {
        triangle.map(|v| self.placed[v as usize])
    }

    /// The triangle that a thing is, as it lies on the picture.
    pub(super) fn face(&self, thing: u32) -> Option<([u32; 3], Face)> {
        let Shape::Surface { triangles } = &self.layer.shape else { return None };
        let triangle = triangles[(thing - self.first) as usize];
        Some((triangle, Face::new(self.corners(triangle))?))
    }

    /// The position that a thing that is no triangle is drawn at first.
    pub(super) fn position_of(&self, thing: u32) -> usize {
        let i = (thing - self.first) as usize;
        match &self.layer.shape {
            Shape::Lines { segments, .. } => segments[i][0] as usize,
            Shape::Points { .. } | Shape::Surface { .. } => i,
        }
    }

    /// A line between its ends, x, y and nearness, as far as it lies before the camera.
    fn line(&self, segment: [u32; 2], camera: &Camera) -> Option<[[f32; 3]; 2]> {
        let mut ends = segment.map(|v| self.placed[v as usize]);
        let before = ends.map(|end| camera.is_before(end[2]));
        if before == [false, false] {
            return None;
        }
        if before != [true, true] {
            let (seen, hidden) = if before[0] { (0, 1) } else { (1, 0) };
            let least = 1.001 / camera.nearest();
            let t = (ends[seen][2] - least) / (ends[seen][2] - ends[hidden][2]);
            ends[hidden] = std::array::from_fn(|c| ends[seen][c] + t * (ends[hidden][c] - ends[seen][c]));
        }
        Some(ends.map(|[x, y, w, n]| [x / w, y / w, n / w]))
    }

    fn extent(&self, thing: u32, camera: &Camera, size: [usize; 2]) -> Option<Extent> {
        let i = (thing - self.first) as usize;
        let mut low = [f32::INFINITY; 2];
        let mut high = [f32::NEG_INFINITY; 2];
        let mut include = |x: f32, y: f32| {
            low = [low[0].min(x), low[1].min(y)];
            high = [high[0].max(x), high[1].max(y)];
        };
        match &self.layer.shape {
            Shape::Points { .. } => {
                let [x, y, w, _] = self.placed[i];
                if !camera.is_before(w) {
                    return None;
                }
                include(x / w, y / w);
            }
            Shape::Lines { segments, .. } => {
                for [x, y, _] in self.line(segments[i], camera)? {
                    include(x, y);
                }
            }
            Shape::Surface { triangles } => {
                let corners = self.corners(triangles[i]);
                let before = corners.iter().filter(|corner| camera.is_before(corner[2])).count();
                match before {
                    0 => return None,
                    3 => corners.iter().for_each(|[x, y, w, _]| include(x / w, y / w)),
                    // It reaches behind the camera, so it may show anywhere.
                    _ => return Some([[0; 2], size.map(|side| side as i64 - 1)]),
                }
            }
        }
        let around = if matches!(self.layer.shape, Shape::Surface { .. }) { SLACK } else { self.radius + SLACK };
        // Samples lie in the middle between whole numbers.
        let from: [i64; 2] = std::array::from_fn(|a| ((low[a] - around - 0.5).ceil() as i64).max(0));
        let to: [i64; 2] = std::array::from_fn(|a| ((high[a] + around - 0.5).floor() as i64).min(size[a] as i64 - 1));
        (low[0] <= high[0] && from[0] <= to[0] && from[1] <= to[1]).then_some([from, to])
    }

    fn draw(&self, thing: u32, camera: &Camera, square: &mut Square) {
        let whole = [square.corner[0] + square.size[0], square.corner[1] + square.size[1]];
        let Some([low, high]) = self.extent(thing, camera, whole) else { return };
        let from: [usize; 2] = std::array::from_fn(|a| (low[a] as usize).max(square.corner[a]));
        let to = high.map(|c| c as usize);
        let i = (thing - self.first) as usize;
        match &self.layer.shape {
            Shape::Points { .. } => {
                let [x, y, w, n] = self.placed[i];
                let (x, y, near) = (x / w, y / w, n / w);
                let most = self.radius * self.radius;
                square.fill(from, to, thing, |px, py| {
                    let (dx, dy) = (px - x, py - y);
                    (dx * dx + dy * dy <= most).then_some(near)
                });
            }
            Shape::Lines { segments, .. } => {
                let Some([a, b]) = self.line(segments[i], camera) else { return };
                let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
                let squared = dx * dx + dy * dy;
                let most = self.radius * self.radius;
                square.fill(from, to, thing, |px, py| {
                    let along = ((px - a[0]) * dx + (py - a[1]) * dy) / squared;
                    let t = if squared > 0.0 { along.clamp(0.0, 1.0) } else { 0.0 };
                    let (ox, oy) = (px - a[0] - t * dx, py - a[1] - t * dy);
                    (ox * ox + oy * oy <= most).then_some(a[2] + t * (b[2] - a[2]))
                });
            }
            Shape::Surface { triangles } => {
                let Some(face) = Face::new(self.corners(triangles[i])) else { return };
                let nearest = camera.nearest();
                square.fill_face(from, to, thing, &face, nearest);
            }
        }
    }
}

impl Square {
    /// Keeps what is nearer than all before, of the samples from and to.
    fn fill(&mut self, from: [usize; 2], to: [usize; 2], thing: u32, near: impl Fn(f32, f32) -> Option<f32>) {
        for y in from[1]..=to[1] {
            let row = (y - self.corner[1]) * self.size[0];
            for x in from[0]..=to[0] {
                let place = row + x - self.corner[0];
                if let Some(near) = near(x as f32 + 0.5, y as f32 + 0.5).filter(|&near| near > self.nearness[place]) {
                    (self.nearness[place], self.things[place]) = (near, thing + 1);
                }
            }
        }
    }

    fn fill_face(&mut self, from: [usize; 2], to: [usize; 2], thing: u32, face: &Face, nearest: f32) {
        for y in from[1]..=to[1] {
            let row = (y - self.corner[1]) * self.size[0];
            let sides = face.sides.map(|side| side[1] * (y as f64 + 0.5) + side[2]);
            let deep = face.nearness[1] * (y as f64 + 0.5) + face.nearness[2];
            for x in from[0]..=to[0] {
                let px = x as f64 + 0.5;
                if (0..3).all(|k| face.sides[k][0] * px + sides[k] >= 0.0) {
                    let near = (face.nearness[0] * px + deep) as f32;
                    let place = row + x - self.corner[0];
                    if near > self.nearness[place] && near <= nearest {
                        (self.nearness[place], self.things[place]) = (near, thing + 1);
                    }
                }
            }
        }
    }
}

/// A triangle on the picture: linear functions of a position, as factors of x, y and 1.
pub(super) struct Face {
    /// Not negative within, one for each side. Of two triangles with a common side one has the other's with its sign changed, to the last bit. What they give is the share of
    /// the opposite corner, over its depth, but for a common factor.
    sides: [[f64; 3]; 3],
    nearness: [f64; 3],
    /// Whether the outside is seen.
    pub(super) is_front: bool,
}

impl Face {
    /// `None` if it is seen from its edge.
    fn new(corners: [Placed; 3]) -> Option<Self> {
        let [a, b, c] = corners.map(|corner| [0, 1, 2].map(|i| f64::from(corner[i])));
        let sides = [[b, c], [c, a], [a, b]].map(|[p, q]| crate::vector::cross(p, q));
        let determinant = crate::vector::dot(a, sides[0]);
        if !(determinant.abs() > 0.0 && determinant.is_finite()) {
            return None;
        }
        let nearness =
            std::array::from_fn(|i| (0..3).map(|k| f64::from(corners[k][3]) * sides[k][i]).sum::<f64>() / determinant);
        let sign = determinant.signum();
        // Down is positive on the picture, so what runs against the clock has a negative area.
        Some(Self { sides: sides.map(|side| side.map(|c| sign * c)), nearness, is_front: determinant < 0.0 })
    }

    /// How much of each corner there is at a position; the sum is 1.
    pub(super) fn shares(&self, x: f64, y: f64) -> [f32; 3] {
        let parts = self.sides.map(|side| (side[0] * x + side[1] * y + side[2]).max(0.0));
        let sum: f64 = parts.iter().sum();
        if sum > 0.0 { parts.map(|part| (part / sum) as f32) } else { [1.0 / 3.0; 3] }
    }
}
