//! Lines, polylines and faces of a drawing.
//!
//! Blocks are not expanded, and sheets of paper are passed over.

use dxf::entities::{EntityType, LwPolyline, Polyline};
use dxf::{Drawing, Point, Vector};

use super::{Gathered, Item};
use crate::IoError;
use crate::guard::without_panic;

/// Arcs are cut into parts that turn by this at most: 10 degrees.
const ARC: f64 = 0.175;

pub(super) fn read(gathered: &mut Gathered<'_>, bytes: &[u8]) -> Result<(), IoError> {
    let path = gathered.path;
    // A drawing begins with a code, 0 or 999, or says what it is.
    let first = bytes.split(|b| *b == b'\n').next().unwrap_or_default().trim_ascii();
    if !(first == b"0" || first == b"999" || first.starts_with(b"AutoCAD")) {
        let looks = crate::format::sniff(bytes);
        return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "DXF", looks });
    }
    let failed = |message| IoError::Decode { path: path.to_path_buf(), format: "DXF", message };
    let drawing = without_panic(|| Drawing::load(&mut &bytes[..])).map_err(failed)?;
    let drawing = drawing.map_err(|error| failed(error.to_string()))?;
    gathered.file.crs = crs(bytes);
    for (i, entity) in (0..).zip(drawing.entities()) {
        if entity.common.is_in_paper_space {
            gathered.pass_over();
            continue;
        }
        match &entity.specific {
            EntityType::Line(line) => gathered.line(("LINE, entity", i), &[at(&line.p1), at(&line.p2)])?,
            EntityType::LwPolyline(line) => {
                gathered.line(("LWPOLYLINE, entity", i), &light(line, entity.common.elevation))?;
            }
            EntityType::Polyline(line) => polyline(gathered, i, line)?,
            EntityType::Face3D(face) => {
                let corners = [&face.first_corner, &face.second_corner, &face.third_corner, &face.fourth_corner];
                gathered.polygon(("3DFACE, entity", i), &[corners.map(at).to_vec()])?;
            }
            _ => gathered.pass_over(),
        }
    }
    Ok(())
}

fn at(p: &Point) -> [f64; 3] {
    [p.x, p.y, p.z]
}

/// The comment in which `zeroset` states the reference system.
fn crs(bytes: &[u8]) -> Option<String> {
    let mut lines = bytes.split(|b| *b == b'\n').map(<[u8]>::trim_ascii);
    while lines.next()? == b"999" {
        if let Some(text) = lines.next()?.strip_prefix(b"crs ") {
            return Some(String::from_utf8_lossy(text).into_owned());
        }
    }
    None
}

fn polyline(gathered: &mut Gathered<'_>, i: u64, line: &Polyline) -> Result<(), IoError> {
    let item = ("POLYLINE, entity", i);
    if line.is_polyface_mesh() {
        return faces(gathered, item, line);
    }
    if line.is_3d_polygon_mesh() {
        gathered.pass_over();
        return Ok(());
    }
    let course = line.vertices().filter(|vertex| !vertex.is_spline_frame_control_point());
    let positions = if line.is_3d_polyline() {
        let mut positions: Vec<[f64; 3]> = course.map(|vertex| at(&vertex.location)).collect();
        if line.is_closed() {
            positions.extend(positions.first().copied());
        }
        positions
    } else {
        let vertices: Vec<[f64; 3]> =
            course.map(|vertex| [vertex.location.x, vertex.location.y, vertex.bulge]).collect();
        in_space(&with_arcs(&vertices, line.is_closed()), line.location.z, &line.normal)
    };
    gathered.line(item, &positions)
}

/// The faces of a polyface mesh: vertices first, then records that name them from 1; a negative number marks an invisible side.
fn faces(gathered: &mut Gathered<'_>, item: Item, line: &Polyline) -> Result<(), IoError> {
    let positions: Vec<[f64; 3]> =
        line.vertices().filter(|v| v.is_3d_polygon_mesh()).map(|vertex| at(&vertex.location)).collect();
    for record in line.vertices().filter(|v| !v.is_3d_polygon_mesh()) {
        let named = [
            record.polyface_mesh_vertex_index1,
            record.polyface_mesh_vertex_index2,
            record.polyface_mesh_vertex_index3,
            record.polyface_mesh_vertex_index4,
        ];
        let corners = named.iter().filter(|named| **named != 0).map(|named| {
            let place = named.unsigned_abs() as usize - 1;
            positions.get(place).copied().ok_or_else(|| {
                let what = format!("{} {} names vertex {} of {}", item.0, item.1, place + 1, positions.len());
                IoError::malformed(gathered.path, what, "repair or export it again")
            })
        });
        let corners = corners.collect::<Result<Vec<_>, _>>()?;
        gathered.polygon(item, &[corners])?;
    }
    Ok(())
}

fn light(line: &LwPolyline, elevation: f64) -> Vec<[f64; 3]> {
    let vertices: Vec<[f64; 3]> = line.vertices.iter().map(|vertex| [vertex.x, vertex.y, vertex.bulge]).collect();
    in_space(&with_arcs(&vertices, line.is_closed()), elevation, &line.extrusion_direction)
}

/// The course of a flat polyline from its positions, each with the bulge of the part that follows: the tangent of a quarter of its angle.
fn with_arcs(vertices: &[[f64; 3]], closed: bool) -> Vec<[f64; 2]> {
    let Some(&[x, y, _]) = vertices.first() else { return Vec::new() };
    let mut course = vec![[x, y]];
    for (i, &[x, y, bulge]) in vertices.iter().enumerate() {
        let next = match vertices.get(i + 1) {
            Some(next) => next,
            None if closed => &vertices[0],
            None => break,
        };
        let chord = [next[0] - x, next[1] - y];
        let half = 2.0 * bulge.atan();
        let parts = (2.0 * half.abs() / ARC).ceil().max(1.0) as usize;
        for part in 1..parts {
            // The chord of a part of the arc, turned and shortened against that of the whole.
            let share = part as f64 / parts as f64;
            let (sin, cos) = ((share - 1.0) * half).sin_cos();
            let length = (share * half).sin() / half.sin();
            let [u, v] = [cos * chord[0] - sin * chord[1], sin * chord[0] + cos * chord[1]];
            course.push([x + length * u, y + length * v]);
        }
        course.push([next[0], next[1]]);
    }
    course
}

/// Positions of a flat polyline in world coordinates: its plane is told by its normal, and its axes by the rule that the format calls the
/// arbitrary axis algorithm.
fn in_space(course: &[[f64; 2]], elevation: f64, normal: &Vector) -> Vec<[f64; 3]> {
    let length = (normal.x * normal.x + normal.y * normal.y + normal.z * normal.z).sqrt();
    let [nx, ny, nz] = if length > 0.0 { [normal.x, normal.y, normal.z].map(|c| c / length) } else { [0.0, 0.0, 1.0] };
    const STEEP: f64 = 1.0 / 64.0;
    // y x n where the normal is nearly upright, else z x n.
    let [x, y, z] = if nx.abs() < STEEP && ny.abs() < STEEP { [nz, 0.0, -nx] } else { [-ny, nx, 0.0] };
    let long = (x * x + y * y + z * z).sqrt();
    let [x, y, z] = [x / long, y / long, z / long];
    let across = [ny * z - nz * y, nz * x - nx * z, nx * y - ny * x];
    let place = |&[u, v]: &[f64; 2]| {
        [
            u * x + v * across[0] + elevation * nx,
            u * y + v * across[1] + elevation * ny,
            u * z + v * across[2] + elevation * nz,
        ]
    };
    course.iter().map(place).collect()
}
