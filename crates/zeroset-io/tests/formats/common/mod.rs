//! What the tests share: a folder that cleans up, and a small sound file of every format.

#![allow(dead_code, unreachable_pub, unused_imports, reason = "the tests of memory take a part of this")]

use zeroset::cloud::{Attributes, Cloud};
use zeroset::mesh::Mesh;
use zeroset_io::{CloudFormat, MeshFormat, WriteOptions, write_cloud, write_mesh};

mod models;
mod shared_data;

pub use models::*;
pub use shared_data::shared_data;

/// A folder of the test's own.
pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("the system has a folder for temporary files")
}

/// Points of Dutch and Swiss grids, to the millimetre.
pub const GEOREFERENCED: [[f64; 3]; 4] = [
    [84_810.3, 447_412.8, 1.125],
    [84_811.301, 447_412.802, 2.5],
    [84_810.303, 447_499.999, -3.75],
    [84_899.9, 447_450.0, 0.0],
];
pub const SWISS: [[f64; 3]; 4] = [
    [2_600_000.123, 1_200_000.456, 500.001],
    [2_600_010.5, 1_200_000.456, 501.0],
    [2_600_000.123, 1_200_020.789, 502.002],
    [2_600_005.0, 1_200_005.0, 510.5],
];

pub fn attributes() -> Attributes {
    Attributes {
        colors: Some(vec![[255, 0, 128], [1, 2, 3], [0, 0, 0], [10, 200, 255]]),
        intensities: Some(vec![1.0, 2.0, 300.0, 65535.0]),
        classes: Some(vec![2, 6, 9, 1]),
    }
}

/// Four points with every attribute.
pub fn cloud(world: [[f64; 3]; 4]) -> Cloud {
    Cloud { attributes: attributes(), crs: Some("EPSG:28992".into()), ..Cloud::from_world(world.to_vec()) }
}

/// A tetrahedron with every attribute.
pub fn mesh(world: [[f64; 3]; 4]) -> Mesh {
    let cloud = cloud(world);
    Mesh {
        world_from_local: cloud.world_from_local,
        vertices: cloud.points,
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        attributes: cloud.attributes,
        crs: cloud.crs,
    }
}

pub fn world(offset: [f64; 3], points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    points.iter().map(|p| [p[0] + offset[0], p[1] + offset[1], p[2] + offset[2]]).collect()
}

/// Asserts that two lists of positions agree to a tolerance.
#[track_caller]
pub fn assert_near(found: &[[f64; 3]], expected: &[[f64; 3]], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        let distance = (0..3).map(|a| (f[a] - e[a]).abs()).fold(0.0, f64::max);
        assert!(distance <= tolerance, "{f:?} and {e:?} differ by {distance}");
    }
}

/// The bytes of a small sound file of each cloud format.
pub fn sound_cloud(format: CloudFormat) -> Vec<u8> {
    match format {
        CloudFormat::Pcd => pcd_binary(),
        CloudFormat::E57 => e57(None),
        _ => {
            let suffix = CloudFormat::KNOWN.iter().find(|(_, f)| *f == format).expect("every format has a suffix").0;
            let folder = folder();
            let path = folder.path().join(format!("sound.{suffix}"));
            write_cloud(&path, &cloud(GEOREFERENCED), &WriteOptions::default()).expect("a sound cloud can be written");
            std::fs::read(path).expect("what was written can be read")
        }
    }
}

/// The bytes of a small sound file of each mesh format.
pub fn sound_mesh(format: MeshFormat) -> Vec<u8> {
    let suffix = MeshFormat::KNOWN.iter().find(|(_, f)| *f == format).expect("every format has a suffix").0;
    let folder = folder();
    let path = folder.path().join(format!("sound.{suffix}"));
    write_mesh(&path, &mesh(GEOREFERENCED), &WriteOptions::default()).expect("a sound mesh can be written");
    std::fs::read(path).expect("what was written can be read")
}

pub const PCD_HEAD: &str = "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb intensity\nSIZE 8 8 8 4 4\nTYPE F F F F F\n\
    COUNT 1 1 1 1 1\nWIDTH 4\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\n";

fn pcd_values() -> Vec<([f64; 3], u32, f32)> {
    let packed = |[r, g, b]: [u8; 3]| u32::from_be_bytes([0, r, g, b]);
    let a = attributes();
    let (colors, intensities) = (a.colors.unwrap_or_default(), a.intensities.unwrap_or_default());
    (0..4).map(|i| (GEOREFERENCED[i], packed(colors[i]), intensities[i])).collect()
}

pub fn pcd_binary() -> Vec<u8> {
    let mut out = format!("{PCD_HEAD}DATA binary\n").into_bytes();
    for (position, color, intensity) in pcd_values() {
        out.extend(position.iter().flat_map(|c| c.to_le_bytes()));
        out.extend(color.to_le_bytes());
        out.extend(intensity.to_le_bytes());
    }
    out
}

pub fn pcd_ascii() -> Vec<u8> {
    let mut out = format!("{PCD_HEAD}DATA ascii\n");
    for ([x, y, z], color, intensity) in pcd_values() {
        let color = f32::from_bits(color);
        out.push_str(&format!("{x} {y} {z} {color:e} {intensity}\n"));
    }
    out.into_bytes()
}

/// Compressed with plain runs only, which is valid LZF.
pub fn pcd_compressed() -> Vec<u8> {
    let mut plain = Vec::new();
    for axis in 0..3 {
        plain.extend(pcd_values().iter().flat_map(|(p, _, _)| p[axis].to_le_bytes()));
    }
    plain.extend(pcd_values().iter().flat_map(|(_, color, _)| color.to_le_bytes()));
    plain.extend(pcd_values().iter().flat_map(|(_, _, intensity)| intensity.to_le_bytes()));
    let mut packed = Vec::new();
    for run in plain.chunks(32) {
        packed.push(run.len() as u8 - 1);
        packed.extend_from_slice(run);
    }
    let mut out = format!("{PCD_HEAD}DATA binary_compressed\n").into_bytes();
    out.extend((packed.len() as u32).to_le_bytes());
    out.extend((plain.len() as u32).to_le_bytes());
    out.extend(packed);
    out
}

/// Two scans of the four points: Cartesian with colours and intensity, and with the given pose.
pub fn e57(pose: Option<e57::Transform>) -> Vec<u8> {
    use e57::{Record, RecordValue};
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = e57::E57Writer::new(&mut file, "a file").expect("E57 can be written");
    let prototype = vec![
        Record::CARTESIAN_X_F64,
        Record::CARTESIAN_Y_F64,
        Record::CARTESIAN_Z_F64,
        Record::COLOR_RED_U8,
        Record::COLOR_GREEN_U8,
        Record::COLOR_BLUE_U8,
        Record::INTENSITY_UNIT_F32,
    ];
    let colors = attributes().colors.unwrap_or_default();
    let mut scan = writer.add_pointcloud("a scan", prototype).expect("E57 can be written");
    scan.set_transform(pose);
    for (p, color) in GEOREFERENCED.iter().zip(colors) {
        let mut values: Vec<RecordValue> = p.iter().map(|c| RecordValue::Double(*c)).collect();
        values.extend(color.iter().map(|c| RecordValue::Integer(i64::from(*c))));
        values.push(RecordValue::Single(0.5));
        scan.add_point(values).expect("the point matches the prototype");
    }
    scan.finalize().expect("E57 can be written");
    writer.finalize().expect("E57 can be written");
    drop(writer);
    file.into_inner()
}
