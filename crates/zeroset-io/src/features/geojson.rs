//! Features as GeoJSON (RFC 7946), in the reference system of the input.

use serde_json::{Map, Value, json};
use zeroset::feature::{Features, Plane};

use super::FeatureOutput;
use crate::collection::{Collection, feature};
use crate::mesh::world;

/// The vertical part of the normal of a plane within a degree of upright is at most the sine of that.
const UPRIGHT: f64 = 0.017_452_406_437_283_51;

type Ring = Vec<[f64; 3]>;

/// The content of a file, with a line end.
pub(super) fn text(output: FeatureOutput<'_>) -> String {
    let features = output.features;
    let planes = features.planes.iter().enumerate().filter_map(|(id, plane)| {
        let (geometry, more) = plane_geometry(features, plane)?;
        let mut properties = json!({
            "feature": "plane",
            "id": id,
            "normal": plane.normal,
            "offset": features.world_offset(id),
            "oriented": plane.oriented,
            "slope_deg": plane.normal[2].abs().min(1.0).acos().to_degrees(),
            "area": plane.area,
            "points": plane.points,
            "rms": plane.rms,
        });
        if let Some(properties) = properties.as_object_mut() {
            properties.extend(more);
        }
        Some(feature(geometry, properties))
    });
    let edges = features.edges.iter().enumerate().map(|(id, edge)| {
        let line: Ring = edge.polyline.iter().map(|p| world(*p, features.world_from_local)).collect();
        let properties = json!({
            "feature": "edge",
            "id": id,
            "kind": edge.kind,
            "planes": edge.planes,
            "angle_deg": edge.angle.to_degrees(),
            "length": edge.length(),
        });
        feature(json!({ "type": "LineString", "coordinates": line }), properties)
    });
    let corners = features.corners.iter().enumerate().map(|(id, corner)| {
        let position = world(corner.position, features.world_from_local);
        let properties = json!({
            "feature": "corner",
            "id": id,
            "kind": corner.kind,
            "planes": corner.planes,
            "edges": corner.edges,
        });
        feature(json!({ "type": "Point", "coordinates": position }), properties)
    });
    let all = planes.chain(edges).chain(corners).collect();
    Collection::new(features.crs.as_deref(), output.options, all).text()
}

/// The geometry, and what else is to be said about it; `None` for a plane without a polygon.
fn plane_geometry(features: &Features, plane: &Plane) -> Option<(Value, Map<String, Value>)> {
    let mut more = Map::new();
    if plane.rings.is_empty() {
        return None;
    }
    if plane.normal[2].abs() <= UPRIGHT {
        let (line, [low, high]) = trace(plane)?;
        let line = line.map(|p| world(p, features.world_from_local));
        more.insert("z_min".into(), (low + features.world_from_local[2]).into());
        more.insert("z_max".into(), (high + features.world_from_local[2]).into());
        return Some((json!({ "type": "LineString", "coordinates": line }), more));
    }
    let at = |ring: &Ring| -> Ring { ring.iter().map(|p| world(*p, features.world_from_local)).collect() };
    let polygons: Vec<Vec<Ring>> =
        polygons(plane).iter().map(|rings| rings.iter().map(|ring| closed(at(ring))).collect()).collect();
    let geometry = match &polygons[..] {
        [] => return None,
        [polygon] => json!({ "type": "Polygon", "coordinates": polygon }),
        _ => json!({ "type": "MultiPolygon", "coordinates": polygons }),
    };
    Some((geometry, more))
}

fn closed(mut ring: Ring) -> Ring {
    ring.extend(ring.first().copied());
    ring
}

/// The ends of an upright plane in plan, at half its height, and its lowest and highest position.
fn trace(plane: &Plane) -> Option<([[f64; 3]; 2], [f64; 2])> {
    let positions = || plane.rings.iter().flatten();
    let [x, y, z] = plane.normal;
    let horizontal = x.hypot(y);
    let along = [-y / horizontal, x / horizontal];
    let reach = |value: &dyn Fn(&[f64; 3]) -> f64| {
        positions().map(value).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let ends = reach(&|p| along[0] * p[0] + along[1] * p[1]);
    let heights = reach(&|p| p[2]);
    let middle = 0.5 * (heights[0] + heights[1]);
    // Where the plane is at half height: across . p = (offset - n_z z) / |(n_x, n_y)|.
    let across = (plane.offset - z * middle) / horizontal;
    let at = |end: f64| [x / horizontal * across + along[0] * end, y / horizontal * across + along[1] * end, middle];
    positions().next().map(|_| (ends.map(at), heights))
}

/// Outer rings, counter-clockwise in plan, each followed by its holes, clockwise.
fn polygons(plane: &Plane) -> Vec<Vec<Ring>> {
    let upward = |ring: &Ring| -> Ring {
        // Rings are counter-clockwise seen from the tip of the normal.
        if plane.normal[2] < 0.0 { ring.iter().rev().copied().collect() } else { ring.clone() }
    };
    let rings: Vec<Ring> = plane.rings.iter().map(upward).collect();
    let (outer, holes): (Vec<Ring>, Vec<Ring>) = rings.into_iter().partition(|ring| area_in_plan(ring) >= 0.0);
    if outer.is_empty() {
        return holes.into_iter().map(|ring| vec![ring.into_iter().rev().collect()]).collect();
    }
    let mut polygons: Vec<Vec<Ring>> = outer.into_iter().map(|ring| vec![ring]).collect();
    for hole in holes {
        // The smallest one around it; a hole that lies in none goes to the first.
        let around = (0..polygons.len()).filter(|i| contains(&polygons[*i][0], hole[0]));
        let area = |i: &usize| area_in_plan(&polygons[*i][0]);
        let owner = around.min_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or(0);
        polygons[owner].push(hole);
    }
    polygons
}

fn sides(ring: &Ring) -> impl Iterator<Item = [[f64; 3]; 2]> + '_ {
    (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]])
}

/// Area in plan, positive for a counter-clockwise ring.
fn area_in_plan(ring: &Ring) -> f64 {
    let Some(o) = ring.first() else { return 0.0 };
    0.5 * sides(ring).map(|[a, b]| (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1])).sum::<f64>()
}

/// Whether a position lies within a ring in plan.
fn contains(ring: &Ring, [x, y, _]: [f64; 3]) -> bool {
    let crossed =
        |[a, b]: &[[f64; 3]; 2]| (a[1] > y) != (b[1] > y) && a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > x;
    sides(ring).filter(crossed).count() % 2 == 1
}
