//! Cylinders and cones.

use crate::field::{Field, FieldError, Metric, finite};
use crate::vec3::{self, Vec3};

/// A cylinder, a cone, or a cone without its tip: what is swept by a disc that goes from one end of an axis to the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frustum {
    foot: Vec3,
    axis: Vec3,
    length: f64,
    radii: [f64; 2],
}

/// The profile at one position: the distance from the axis, that from the plane of the foot, and the unit vector away from the axis.
struct Profile {
    radius: f64,
    height: f64,
    away: Vec3,
}

const FOOT: usize = 0;
const SIDE: usize = 1;
const HEAD: usize = 2;

impl Frustum {
    /// The solid between discs around the ends of an axis. A radius of 0 makes a cone.
    ///
    /// # Errors
    /// If a number is not finite, a radius is negative, both are zero, or the ends are at one place.
    pub fn new(ends: [[f64; 3]; 2], radii: [f64; 2]) -> Result<Self, FieldError> {
        ends.iter().try_for_each(|end| finite("a coordinate", end))?;
        finite("a radius", &radii)?;
        if let Some(&value) = radii.iter().find(|r| **r < 0.0) {
            return Err(FieldError::NotPositive { what: "a radius", value });
        }
        if radii == [0.0; 2] {
            return Err(FieldError::NotPositive { what: "a radius", value: 0.0 });
        }
        let step = vec3::sub(ends[1], ends[0]);
        let axis = vec3::normalized(step)
            .ok_or(FieldError::Empty("a cylinder has no length: the ends of its axis must differ"))?;
        Ok(Self { foot: ends[0], axis, length: vec3::norm(step), radii })
    }

    /// The cylinder around an axis.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn cylinder(ends: [[f64; 3]; 2], radius: f64) -> Result<Self, FieldError> {
        Self::new(ends, [radius; 2])
    }

    fn profile(&self, p: Vec3) -> Profile {
        let step = vec3::sub(p, self.foot);
        let height = vec3::dot(step, self.axis);
        let across = vec3::add_scaled(step, self.axis, -height);
        let away = vec3::normalized(across).unwrap_or(vec3::axes_across(self.axis)[0]);
        Profile { radius: vec3::norm(across), height, away }
    }

    /// The normal of the side in the profile, away from the axis and along it.
    fn side_normal(&self) -> [f64; 2] {
        let [a, b] = self.radii;
        let slant = self.length.hypot(a - b);
        [self.length / slant, (a - b) / slant]
    }

    /// Distances from the planes of foot and head and from the side, each carried on.
    fn parts(&self, profile: &Profile) -> [f64; 3] {
        let [out, up] = self.side_normal();
        let side = (profile.radius - self.radii[0]) * out + profile.height * up;
        [-profile.height, side, profile.height - self.length]
    }

    fn normal(&self, part: usize, away: Vec3) -> Vec3 {
        match part {
            FOOT => vec3::scale(self.axis, -1.0),
            SIDE => {
                let [out, up] = self.side_normal();
                vec3::add_scaled(vec3::scale(away, out), self.axis, up)
            }
            _ => self.axis,
        }
    }

    fn largest(parts: [f64; 3]) -> usize {
        // The side first, as caps may have no area.
        [FOOT, HEAD].into_iter().fold(SIDE, |best, i| if parts[i] > parts[best] { i } else { best })
    }

    /// The nearest place of the rim of the profile, for a position outside.
    fn nearest(&self, profile: &Profile) -> [f64; 2] {
        let q = [profile.radius, profile.height];
        let [a, b] = self.radii;
        let ends = [[[0.0, 0.0], [a, 0.0]], [[a, 0.0], [b, self.length]], [[b, self.length], [0.0, self.length]]];
        let distance = |p: &[f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
        let places = ends.map(|[from, to]| super::planar::nearest_on_segment(from, to, q));
        places.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(q)
    }
}

impl Field for Frustum {
    fn value(&self, p: [f64; 3]) -> f64 {
        let profile = self.profile(p);
        let parts = self.parts(&profile);
        let most = parts[Self::largest(parts)];
        if most <= 0.0 {
            return most;
        }
        let [radius, height] = self.nearest(&profile);
        (radius - profile.radius).hypot(height - profile.height)
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let profile = self.profile(p);
        let parts = self.parts(&profile);
        let most = Self::largest(parts);
        let [radius, height] = self.nearest(&profile);
        let step = [profile.radius - radius, profile.height - height];
        let length = step[0].hypot(step[1]);
        if parts[most] <= 0.0 || length == 0.0 {
            return self.normal(most, profile.away);
        }
        vec3::add_scaled(vec3::scale(profile.away, step[0] / length), self.axis, step[1] / length)
    }

    fn metric(&self) -> Metric {
        Metric::Distance
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        let head = vec3::add_scaled(self.foot, self.axis, self.length);
        let reach = self.axis.map(|c| (1.0 - c * c).max(0.0).sqrt());
        let [a, b] = [(self.foot, self.radii[0]), (head, self.radii[1])].map(|(end, radius)| {
            let reach = vec3::scale(reach, radius);
            [vec3::sub(end, reach), vec3::add(end, reach)]
        });
        Some([vec3::min(a[0], b[0]), vec3::max(a[1], b[1])])
    }

    fn sheets(&self) -> u32 {
        3
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        Self::largest(self.parts(&self.profile(p))) as u32
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (profile, part) = (self.profile(p), sheet as usize);
        (self.parts(&profile)[part], self.normal(part, profile.away))
    }

    fn is_flat(&self, sheet: u32) -> bool {
        sheet as usize != SIDE
    }
}
