//! Prints how long writing and reading a grid of a given number of points takes in every format.

use std::time::Instant;

use zeroset::cloud::{Attributes, Cloud};
use zeroset::mesh::Mesh;
use zeroset_io::{WriteOptions, read_cloud, read_mesh, write_cloud, write_mesh};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let points: usize = std::env::args().nth(1).map_or(Ok(1_000_000), |arg| arg.parse())?;
    let folder = std::env::temp_dir().join(format!("zeroset-time-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let side = (points as f64).sqrt() as u32;
    let position = |i: u32| {
        let (x, y) = (f64::from(i % side), f64::from(i / side));
        [
            0.25 * x,
            0.25 * y,
            (0.01 * x).sin() + (0.013 * y).cos() + 0.01 * f64::from(i.wrapping_mul(2_654_435_761) >> 24),
        ]
    };
    let vertices: Vec<[f64; 3]> = (0..side * side).map(position).collect();
    let colors = Some((0..side * side).map(|i| [(i % 251) as u8, (i % 83) as u8, 7]).collect());
    let attributes = Attributes { colors, ..Attributes::default() };
    let cell = |i: u32| {
        let at = (i / (side - 1)) * side + i % (side - 1);
        [[at, at + 1, at + side], [at + 1, at + side + 1, at + side]]
    };
    let triangles: Vec<[u32; 3]> = (0..(side - 1) * (side - 1)).flat_map(cell).collect();
    let offset = [84_900.0, 447_500.0, 0.0];
    let options = WriteOptions::default();

    let cloud = Cloud { world_from_local: offset, points: vertices.clone(), attributes: attributes.clone(), crs: None };
    println!("{} points", cloud.len());
    for suffix in ["ply", "xyz", "las", "laz"] {
        let path = folder.join(format!("cloud.{suffix}"));
        let start = Instant::now();
        let report = write_cloud(&path, &cloud, &options)?;
        let written = start.elapsed();
        let start = Instant::now();
        let file = read_cloud(&path)?;
        assert_eq!(file.cloud.len(), cloud.len());
        let (write, read) = (written.as_secs_f64(), start.elapsed().as_secs_f64());
        println!("cloud {suffix}: write {write:.3} s, read {read:.3} s, {} bytes", report.bytes);
    }
    let mesh = Mesh { world_from_local: offset, vertices, triangles, attributes, crs: None };
    println!("{} triangles", mesh.triangles.len());
    for suffix in ["ply", "obj", "stl", "off", "glb"] {
        let path = folder.join(format!("mesh.{suffix}"));
        let start = Instant::now();
        let report = write_mesh(&path, &mesh, &options)?;
        let written = start.elapsed();
        let start = Instant::now();
        let back = read_mesh(&path)?;
        assert_eq!(back.triangles.len(), mesh.triangles.len());
        let (write, read) = (written.as_secs_f64(), start.elapsed().as_secs_f64());
        println!("mesh {suffix}: write {write:.3} s, read {read:.3} s, {} bytes", report.bytes);
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}
