//! Where a tileset stands.

use zeroset::mesh::Mesh;
use zeroset::reconstruct::Up;
use zeroset::tile::{Node, TilePlan};
use zeroset_io::{Frame, Globe, GlobeError};

use crate::{Sorted, TilesError};

/// Where a tileset stands: on the globe, or in coordinates of its own.
#[derive(Debug, Clone)]
pub(crate) enum Placement {
    /// The local coordinates of the plan.
    Local,
    /// East, north and up in the middle of the tiles.
    Globe {
        globe: Box<Globe>,
        frame: Frame,
        /// The longest that a unit of the points is, in metres.
        metres: f64,
    },
}

/// A turned square reaches so much farther than one along the axes, and a bit.
const TURNED: f64 = 1.5;

impl Placement {
    /// On the globe, if that can be.
    pub(crate) fn of(sorted: &Sorted, plan: &TilePlan) -> Self {
        Self::on_globe(sorted, plan).unwrap_or(Self::Local)
    }

    /// On the globe, or why not.
    pub(crate) fn on_globe(sorted: &Sorted, plan: &TilePlan) -> Result<Self, GlobeError> {
        let globe = Globe::of(sorted.crs.as_deref().unwrap_or_default())?;
        if plan.report.up != Up::Z {
            return Err(GlobeError::Axes { code: globe.code() });
        }
        let offset = plan.world_from_local;
        let [low, high] = plan.bounds.map(|corner| -> [f64; 3] { std::array::from_fn(|a| corner[a] + offset[a]) });
        let middle: [f64; 3] = std::array::from_fn(|a| 0.5 * (low[a] + high[a]));
        let corners = (0..8).map(|i| std::array::from_fn(|a| if i >> a & 1 == 0 { low[a] } else { high[a] }));
        // What lies between places that can be shown can be shown, too.
        let mut metres = 0.0_f64;
        for place in corners.chain([middle]) {
            let at = globe.geocentric(place)?;
            for axis in 0..3 {
                let mut beside = place;
                beside[axis] += 0.5 * plan.side;
                let to = globe.geocentric(beside)?;
                let length = (0..3).map(|a| (to[a] - at[a]).powi(2)).sum::<f64>().sqrt();
                metres = metres.max(length / (0.5 * plan.side));
            }
        }
        let frame = globe.frame([middle[0], middle[1], 0.0])?;
        Ok(Self::Globe { globe: Box::new(globe), frame, metres })
    }

    /// The longest that a unit of the points is in coordinates of the tileset.
    pub(crate) fn unit(&self) -> f64 {
        match self {
            Self::Local => 1.0,
            Self::Globe { metres, .. } => *metres,
        }
    }

    /// From coordinates of the tileset to the world, column by column.
    pub(crate) fn transform(&self, plan: &TilePlan) -> [f64; 16] {
        match self {
            Self::Local => {
                let [x, y, z] = plan.world_from_local;
                [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
            }
            Self::Globe { frame, .. } => frame.transform(),
        }
    }

    /// A surface whose box in local coordinates is given, in coordinates of the tileset about a middle, which is its offset. Vertices at one place come to
    /// one place, bit for bit, whatever surface of a level they are of.
    pub(crate) fn place(
        &self,
        plan: &TilePlan,
        node: &Node,
        mut mesh: Mesh,
        bounds: [[f64; 3]; 2],
    ) -> Result<Mesh, TilesError> {
        let middle = match self {
            Self::Local => plan.middle(node, bounds),
            Self::Globe { globe, frame, metres } => {
                let offset = plan.world_from_local;
                mesh.vertices.iter_mut().for_each(|v| *v = std::array::from_fn(|a| v[a] + offset[a]));
                globe.geocentric_all(&mut mesh.vertices)?;
                mesh.vertices.iter_mut().for_each(|v| *v = frame.local(*v));
                let (level, unit) = (node.id.level, TURNED * metres);
                plan.put_on_raster(level, unit, &mut mesh.vertices);
                let [low, high] = box_of(&mesh);
                // What is told of the reference system is not true of these coordinates.
                mesh.crs = None;
                plan.on_raster(level, unit, std::array::from_fn(|a| 0.5 * (low[a] + high[a])))
            }
        };
        mesh.vertices.iter_mut().for_each(|v| *v = std::array::from_fn(|a| v[a] - middle[a]));
        Ok(Mesh { world_from_local: middle, ..mesh })
    }
}

/// Lowest and highest coordinates of the vertices.
pub(crate) fn box_of(mesh: &Mesh) -> [[f64; 3]; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for v in &mesh.vertices {
        for a in 0..3 {
            bounds[0][a] = bounds[0][a].min(v[a]);
            bounds[1][a] = bounds[1][a].max(v[a]);
        }
    }
    bounds
}
