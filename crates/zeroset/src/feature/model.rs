//! What detection finds.

use serde::{Deserialize, Serialize};

/// The flat and sharp parts of a cloud.
///
/// Coordinates are local to the cloud: the world position is the local one plus `world_from_local`. Lists name one another by
/// index.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Features {
    /// What to add to a local position to get the world position, in the unit of the cloud.
    pub world_from_local: [f64; 3],
    /// The coordinate reference system as the input stated it.
    pub crs: Option<String>,
    /// Flat regions, by falling area.
    pub planes: Vec<Plane>,
    /// Sharp edges.
    pub edges: Vec<Edge>,
    /// Corners, where edges meet.
    pub corners: Vec<Corner>,
    /// What each point of the cloud is, in the order of the cloud.
    pub points: Vec<PointFeature>,
}

/// A flat region.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plane {
    /// Unit normal. It points outward where [`oriented`](Self::oriented), else up rather than down.
    pub normal: [f64; 3],
    /// `normal . x` of its points x, in local coordinates.
    pub offset: f64,
    /// Whether inside and outside are known.
    pub oriented: bool,
    /// Number of points on it; points at equal positions count once.
    pub points: usize,
    /// Root of the mean square of the points' distances from it; `None` for a plane without points of its own.
    pub rms: Option<f64>,
    /// Area of the polygon.
    pub area: f64,
    /// Its outline: closed rings in the plane, the first position not repeated. Rings are counter-clockwise seen from the tip of
    /// the normal where the region lies inside, clockwise around holes.
    pub rings: Vec<Vec<[f64; 3]>>,
}

/// Which way the surface bends at an edge or a corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FeatureKind {
    /// Like an edge or the outside corner of a box.
    Convex,
    /// Like an edge or a corner of a room, seen from within.
    Concave,
    /// A corner where edges of both kinds meet: a notch, a saddle.
    Mixed,
    /// Which side is inside is not known.
    Unknown,
}

/// A sharp edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// Which way the surface bends.
    pub kind: FeatureKind,
    /// The planes that meet in it; fewer than two where curved surfaces meet.
    pub planes: Vec<usize>,
    /// Its course. Two positions for a straight edge; the first is repeated at the end of a closed one.
    pub polyline: Vec<[f64; 3]>,
    /// The angle, in radians, by which the surface turns there; the mean along a curved edge.
    pub angle: f64,
}

/// A point where edges meet.
#[derive(Debug, Clone, PartialEq)]
pub struct Corner {
    /// Which way the surface bends.
    pub kind: FeatureKind,
    /// Where it is.
    pub position: [f64; 3],
    /// The planes that meet in it.
    pub planes: Vec<usize>,
    /// The edges that end in it.
    pub edges: Vec<usize>,
}

/// What kind of place a point lies at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FeatureClass {
    /// On no flat region: smooth, vegetation, clutter.
    #[default]
    Unstructured,
    /// On a plane.
    Flat,
    /// Near an edge.
    Edge,
    /// Near a corner.
    Corner,
}

/// What a point of the cloud is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PointFeature {
    /// The plane that it lies on.
    pub plane: Option<u32>,
    /// The kind of place.
    pub class: FeatureClass,
}

impl Features {
    /// `normal . x` of the positions x of plane `i` in world coordinates.
    #[must_use]
    pub fn world_offset(&self, i: usize) -> f64 {
        let plane = &self.planes[i];
        plane.offset + crate::vec3::dot(plane.normal, self.world_from_local)
    }
}

impl Edge {
    /// Length along the polyline.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.polyline.windows(2).map(|ends| crate::vec3::distance(ends[0], ends[1])).sum()
    }
}
