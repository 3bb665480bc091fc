//! A quadratic on a triangle: how its zero set joins the crossings of the edges, and how an arc of it is flattened.
//!
//! Of the two sides of a conic one is a union of convex sets: the inside of an ellipse or a parabola, the two insides of the
//! branches of a hyperbola. What a convex set and the triangle have in common is convex, and the arcs are what of its outline lies inside
//! the triangle. So arcs are found by going around the triangle, with no search and no equation but a quadratic in one variable.

/// A quadratic below this many roundings of its largest value counts as linear in the direction concerned.
const ROUNDINGS: f64 = 16.0;

/// Lines that cross count as a hyperbola, or the other one, if F at the centre is more than this many times negligible.
const OPEN_ROUNDINGS: f64 = 64.0;

/// Most halvings of an arc: a corner of a degenerate hyperbola is closed in on by one bit each.
const MOST_HALVINGS: u32 = 48;

/// A position, with its coordinates along the sides 01 and 02 of the triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Point {
    pub(super) reference: [f64; 2],
    pub(super) position: [f64; 2],
}

/// The map between the coordinates along two sides of a triangle and positions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) origin: [f64; 2],
    pub(super) sides: [[f64; 2]; 2],
    /// The gradients of the two coordinates.
    pub(super) gradients: [[f64; 2]; 2],
}

impl Frame {
    pub(super) fn point(&self, reference: [f64; 2]) -> Point {
        let [u, v] = self.sides;
        let position = std::array::from_fn(|a| self.origin[a] + reference[0] * u[a] + reference[1] * v[a]);
        Point { reference, position }
    }
}

/// Which sets of a plane cut by a conic are convex.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Convex {
    /// One set, bounded.
    Ellipse { centre: [f64; 2], axes: [[f64; 2]; 2], half_lengths_squared: [f64; 2] },
    /// One set, not bounded: a parabola, a strip, or a half-plane.
    One,
    /// Two sets, on the two sides of a line through the centre. If they are `open`, they are wedges to rounding, and so is what is
    /// left of the plane.
    Two { centre: [f64; 2], axis: [f64; 2], open: bool },
}

/// A part of the outline of the triangle, from one crossing to the next, that lies in a convex set.
struct Part {
    start: usize,
    end: usize,
    second_set: bool,
}

/// A quadratic polynomial in the coordinates of a [`Frame`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Conic {
    constant: f64,
    linear: [f64; 2],
    /// Coefficients of x^2, xy and y^2.
    square: [f64; 3],
    convex: Convex,
    /// The sign of the quadratic on its convex sets.
    sign: f64,
}

impl Conic {
    /// The quadratic with the given values at the corners 0, 1, 2 and in the middle of the edges 01, 02, 12.
    pub(super) fn new(corners: [f64; 3], middles: [f64; 3]) -> Self {
        let control = |edge: usize, i: usize, j: usize| 2.0 * middles[edge] - 0.5 * (corners[i] + corners[j]);
        let (c01, c02, c12) = (control(0, 0, 1), control(1, 0, 2), control(2, 1, 2));
        let [c00, c11, c22] = corners;
        let largest = corners.iter().chain(&middles).fold(0.0_f64, |m, v| m.max(v.abs()));
        let mut conic = Self {
            constant: c00,
            linear: [2.0 * (c01 - c00), 2.0 * (c02 - c00)],
            square: [c00 - 2.0 * c01 + c11, 2.0 * (c00 - c01 - c02 + c12), c00 - 2.0 * c02 + c22],
            convex: Convex::One,
            sign: -1.0,
        };
        conic.classify(ROUNDINGS * f64::EPSILON * largest);
        conic
    }

    /// Finds the convex sets and their sign.
    fn classify(&mut self, negligible: f64) {
        let [xx, xy, yy] = [self.square[0], 0.5 * self.square[1], self.square[2]];
        let mean = 0.5 * (xx + yy);
        let radius = (0.5 * (xx - yy)).hypot(xy);
        let large = if mean < 0.0 { mean - radius } else { mean + radius };
        let determinant = xx * yy - xy * xy;
        let small = determinant / large;
        if large != 0.0 {
            self.sign = -large.signum();
        }
        if small.is_nan() || small.abs() <= negligible {
            return;
        }
        let [gx, gy] = self.linear;
        let centre = [-0.5 * (yy * gx - xy * gy) / determinant, -0.5 * (xx * gy - xy * gx) / determinant];
        let at_centre = self.constant + 0.5 * (gx * centre[0] + gy * centre[1]);
        let axis = |eigenvalue: f64| {
            let (u, v) = ([eigenvalue - yy, xy], [xy, eigenvalue - xx]);
            let [x, y] = if u[0].hypot(u[1]) >= v[0].hypot(v[1]) { u } else { v };
            let length = x.hypot(y);
            if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] }
        };
        let first = axis(large);
        let second = [-first[1], first[0]];
        if determinant > 0.0 {
            let half_lengths_squared = [-at_centre / large, -at_centre / small];
            self.convex = Convex::Ellipse { centre, axes: [first, second], half_lengths_squared };
        } else {
            self.sign = if at_centre < 0.0 { 1.0 } else { -1.0 };
            let axis = if large * self.sign > 0.0 { first } else { second };
            let open = at_centre.abs() <= OPEN_ROUNDINGS * negligible;
            self.convex = Convex::Two { centre, axis, open };
        }
    }

    /// The sign of the quadratic on its convex sets.
    pub(super) fn convex_sign(&self) -> f64 {
        self.sign
    }

    /// On which side of the line between the convex sets a point lies, and how far; 0 if there are not two.
    fn side_of(&self, [x, y]: [f64; 2]) -> f64 {
        match self.convex {
            Convex::Ellipse { .. } | Convex::One => 0.0,
            Convex::Two { centre, axis, .. } => axis[0] * (x - centre[0]) + axis[1] * (y - centre[1]),
        }
    }

    /// Of two lines that cross, takes the pair of wedges that agrees with the crossings: where the centre lies on an edge, an edge that
    /// only touches a wedge has no crossing to part it from the other one.
    pub(super) fn settle(&mut self, crossings: &[f64], first_sign: f64) {
        let Convex::Two { centre, axis: [x, y], open: true } = self.convex else { return };
        let other = Self { sign: -self.sign, convex: Convex::Two { centre, axis: [-y, x], open: true }, ..*self };
        if other.discord(crossings, first_sign) < self.discord(crossings, first_sign) {
            *self = other;
        }
    }

    /// How far parts of the outline that should lie in one convex set reach into the other.
    fn discord(&self, crossings: &[f64], first_sign: f64) -> f64 {
        let ends = |part: &Part| [part.start, part.end].map(|c| self.side_of(on_outline(crossings[c])));
        let into_other = |part: &Part| {
            let into = ends(part).map(|side| if part.second_set { -side } else { side });
            into[0].max(into[1])
        };
        self.parts(crossings, first_sign).iter().map(into_other).fold(0.0, f64::max)
    }

    fn value(&self, [x, y]: [f64; 2]) -> f64 {
        let [xx, xy, yy] = self.square;
        self.constant + x * (self.linear[0] + xx * x + xy * y) + y * (self.linear[1] + yy * y)
    }

    fn slopes(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [xx, xy, yy] = self.square;
        [self.linear[0] + 2.0 * xx * x + xy * y, self.linear[1] + xy * x + 2.0 * yy * y]
    }

    /// The points at the ends of the axes of an ellipse whose centre lies in the triangle, counter-clockwise.
    pub(super) fn ellipse(&self, frame: &Frame) -> Option<[Point; 4]> {
        let Convex::Ellipse { centre, axes: [u, v], half_lengths_squared: [a, b] } = self.convex else { return None };
        let holds_centre = centre[0] >= 0.0 && centre[1] >= 0.0 && centre[0] + centre[1] <= 1.0;
        if !(holds_centre && a > 0.0 && b > 0.0) {
            return None;
        }
        let end =
            |axis: [f64; 2], length: f64| frame.point([centre[0] + length * axis[0], centre[1] + length * axis[1]]);
        let (a, b) = (a.sqrt(), b.sqrt());
        Some([end(u, a), end(v, b), end(u, -a), end(v, -b)])
    }

    /// Pairs of crossings that arcs join: an arc leads from the first to the second, with a convex set on its left.
    ///
    /// `crossings` are places along the outline of the triangle, in 0..3 and ascending; `first_sign` is the sign of the
    /// quadratic before the first of them.
    pub(super) fn arcs(&self, crossings: &[f64], first_sign: f64) -> Vec<[usize; 2]> {
        let parts = self.parts(crossings, first_sign);
        let next = |k: usize| {
            let mut after = (1..=parts.len()).map(|step| &parts[(k + step) % parts.len()]);
            after.find(|other| other.second_set == parts[k].second_set).map(|other| other.start)
        };
        (0..parts.len()).filter_map(|k| Some([parts[k].end, next(k)?])).collect()
    }

    /// The parts of the outline of the triangle that lie in convex sets.
    fn parts(&self, crossings: &[f64], first_sign: f64) -> Vec<Part> {
        let count = crossings.len();
        let sign_after = |i: usize| if i.is_multiple_of(2) { -first_sign } else { first_sign };
        let part = |start: usize| {
            let end = (start + 1) % count;
            let unrolled = crossings[end] + if end <= start { 3.0 } else { 0.0 };
            let middle = on_outline(0.5 * (crossings[start] + unrolled));
            Part { start, end, second_set: self.side_of(middle) > 0.0 }
        };
        (0..count).filter(|&i| sign_after(i) == self.sign).map(part).collect()
    }

    /// The points of an arc between its ends, which are left out. The convex set is on its left. `across` is the direction to use where
    /// the ends coincide.
    pub(super) fn flatten(
        &self,
        frame: &Frame,
        ends: [Point; 2],
        across: Option<[f64; 2]>,
        tolerance: f64,
    ) -> Vec<[f64; 2]> {
        let mut points = Vec::new();
        let flattening = Flattening { conic: self, frame, tolerance };
        flattening.halve(ends, across, MOST_HALVINGS, &mut points);
        points
    }
}

/// The coordinates of a place on the outline of a triangle: 0..1 from corner 0 to 1, 1..2 from 1 to 2, 2..3 from 2 to 0.
fn on_outline(place: f64) -> [f64; 2] {
    let place = place % 3.0;
    let along = place.fract();
    match place as usize {
        0 => [along, 0.0],
        1 => [1.0 - along, along],
        _ => [0.0, 1.0 - along],
    }
}

struct Flattening<'a> {
    conic: &'a Conic,
    frame: &'a Frame,
    tolerance: f64,
}

impl Flattening<'_> {
    fn halve(&self, ends: [Point; 2], across: Option<[f64; 2]>, halvings: u32, points: &mut Vec<[f64; 2]>) {
        let [a, b] = ends;
        let mut chord = [b.position[0] - a.position[0], b.position[1] - a.position[1]];
        if chord == [0.0; 2] {
            let Some(across) = across else { return };
            chord = across;
        }
        let length = chord[0].hypot(chord[1]);
        let along = chord.map(|c| c / length);
        let Some((summit, height)) = self.summit(ends, [along[1], -along[0]]) else { return };
        // An arc that bends back under its chord is longer than its height tells.
        let bends_back = ends.iter().any(|end| self.runs_against(end, along));
        if halvings == 0 || (height <= 0.5 * self.tolerance && !bends_back) {
            return;
        }
        self.halve([a, summit], None, halvings - 1, points);
        points.push(summit.position);
        self.halve([summit, b], None, halvings - 1, points);
    }

    /// Where the normal in the middle of a chord leaves the convex set, and how far from the chord.
    fn summit(&self, [a, b]: [Point; 2], normal: [f64; 2]) -> Option<(Point, f64)> {
        let Conic { square: [xx, xy, yy], sign, .. } = *self.conic;
        let middle = [0, 1].map(|k| 0.5 * (a.reference[k] + b.reference[k]));
        let step = self.frame.gradients.map(|g| g[0] * normal[0] + g[1] * normal[1]);
        let slopes = self.conic.slopes(middle);
        let value = sign * self.conic.value(middle);
        let slope = sign * (slopes[0] * step[0] + slopes[1] * step[1]);
        let square = sign * (xx * step[0] * step[0] + xy * step[0] * step[1] + yy * step[1] * step[1]);
        // Right under a corner of the set the roots are one, and rounding can take it away.
        let root = (slope * slope - 4.0 * square * value).max(0.0).sqrt();
        // The form without cancellation; with a falling slope it is the smaller root, otherwise the only positive one.
        let height = if slope < 0.0 { 2.0 * value / (root - slope) } else { -0.5 * (slope + root) / square };
        // The arc lies in the triangle; what leads out of it is rounding.
        let weights = [1.0 - middle[0] - middle[1], middle[0], middle[1]];
        let rates = [-step[0] - step[1], step[0], step[1]];
        let leaves = (0..3).filter(|&k| rates[k] < 0.0).map(|k| weights[k] / -rates[k]).fold(f64::INFINITY, f64::min);
        let height = height.min(leaves);
        let reference = [0, 1].map(|k| middle[k] + height * step[k]);
        (height > 0.0 && root.is_finite()).then(|| (self.frame.point(reference), height))
    }

    /// Whether the arc runs backwards at a point, seen along a direction.
    fn runs_against(&self, point: &Point, along: [f64; 2]) -> bool {
        let slopes = self.conic.slopes(point.reference);
        let [g, h] = self.frame.gradients;
        let uphill = [0, 1].map(|a| self.conic.sign * (slopes[0] * g[a] + slopes[1] * h[a]));
        // The convex set lies uphill and on the left.
        let (forward, size) = (uphill[1] * along[0] - uphill[0] * along[1], uphill[0].hypot(uphill[1]));
        forward < -1e-9 * size
    }
}
