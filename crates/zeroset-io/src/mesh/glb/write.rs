//! Writing GLB.

use std::path::Path;

use serde_json::{Value, json};
use zeroset::mesh::Mesh;

use super::color::linear_table;
use super::{BIN, JSON, MAGIC, component};
use crate::IoError;
use crate::mesh::options::WriteOptions;
use crate::output::Sink;

const ARRAY_BUFFER: u64 = 34962;
const ELEMENT_ARRAY_BUFFER: u64 = 34963;
const MATERIAL: u64 = 0;

/// A stretch of the binary chunk, with the accessor that describes it.
struct Stretch {
    name: Option<&'static str>,
    length: u64,
    accessor: Value,
}

/// The stretches in the order in which they are written; every item takes a multiple of 4 bytes.
fn plan(mesh: &Mesh) -> Vec<Stretch> {
    let vertices = mesh.vertices.len() as u64;
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for vertex in &mesh.vertices {
        for axis in 0..3 {
            low[axis] = low[axis].min(vertex[axis] as f32);
            high[axis] = high[axis].max(vertex[axis] as f32);
        }
    }
    let mut stretches = vec![Stretch {
        name: Some("POSITION"),
        length: 12 * vertices,
        accessor: json!({
            "componentType": component::F32, "type": "VEC3", "count": vertices,
            "min": low.map(f64::from), "max": high.map(f64::from),
        }),
    }];
    if mesh.attributes.colors.is_some() {
        stretches.push(Stretch {
            name: Some("COLOR_0"),
            length: 8 * vertices,
            accessor: json!({ "componentType": component::U16, "type": "VEC4", "count": vertices, "normalized": true }),
        });
    }
    let scalars =
        [("_INTENSITY", mesh.attributes.intensities.is_some()), ("_CLASSIFICATION", mesh.attributes.classes.is_some())];
    for (name, _) in scalars.into_iter().filter(|(_, present)| *present) {
        stretches.push(Stretch {
            name: Some(name),
            length: 4 * vertices,
            accessor: json!({ "componentType": component::F32, "type": "SCALAR", "count": vertices }),
        });
    }
    let corners = 3 * mesh.triangles.len() as u64;
    if corners > 0 {
        stretches.push(Stretch {
            name: None,
            length: 4 * corners,
            accessor: json!({ "componentType": component::U32, "type": "SCALAR", "count": corners }),
        });
    }
    stretches
}

fn json_text(mesh: &Mesh, options: &WriteOptions) -> (Vec<u8>, u64) {
    let stretches = plan(mesh);
    let (mut views, mut accessors, mut attributes) = (Vec::new(), Vec::new(), serde_json::Map::new());
    let (mut offset, mut indices) = (0, None);
    for (index, stretch) in stretches.into_iter().enumerate() {
        let target = if stretch.name.is_some() { ARRAY_BUFFER } else { ELEMENT_ARRAY_BUFFER };
        views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": stretch.length, "target": target }));
        let mut accessor = stretch.accessor;
        accessor["bufferView"] = json!(index);
        accessors.push(accessor);
        match stretch.name {
            Some(name) => drop(attributes.insert(name.to_string(), json!(index))),
            None => indices = Some(index),
        }
        offset += stretch.length;
    }
    let mut primitive = json!({ "attributes": attributes, "mode": 4, "material": MATERIAL });
    match indices {
        Some(indices) => primitive["indices"] = json!(indices),
        // Without triangles there are only points to show.
        None => primitive["mode"] = json!(0),
    }
    let mut extras = serde_json::Map::new();
    if let Some(crs) = &mesh.crs {
        extras.insert("crs".into(), json!(crs));
    }
    if let Some(unit) = options.unit {
        extras.insert("unit".into(), json!(unit.name()));
    }
    if !options.comments.is_empty() {
        extras.insert("comments".into(), json!(options.comments));
    }
    let mut asset = json!({ "version": "2.0", "generator": options.generator });
    if !extras.is_empty() {
        asset["extras"] = Value::Object(extras);
    }
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mut root = json!({
        "asset": asset,
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "name": "z_up", "rotation": [-half, 0.0, 0.0, half], "children": [1] },
            { "name": "mesh", "translation": mesh.world_from_local, "mesh": 0 },
        ],
        "meshes": [{ "primitives": [primitive] }],
        "materials": [{
            "doubleSided": true,
            "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 1.0 },
        }],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": offset }],
    });
    if mesh.vertices.is_empty() {
        // Empty accessors and meshes are not allowed.
        for key in ["meshes", "materials", "accessors", "bufferViews", "buffers"] {
            root.as_object_mut().map(|root| root.remove(key));
        }
        root["nodes"][1].as_object_mut().map(|node| node.remove("mesh"));
    }
    let mut text = root.to_string().into_bytes();
    // Chunks are multiples of 4 bytes; JSON is filled up with spaces.
    text.resize(text.len().next_multiple_of(4), b' ');
    (text, if mesh.vertices.is_empty() { 0 } else { offset })
}

/// Refuses meshes whose file would be larger than its own 32 bit length can say.
pub(in crate::mesh) fn check(path: &Path, mesh: &Mesh) -> Result<(), IoError> {
    let length = plan(mesh).iter().map(|stretch| stretch.length).sum::<u64>();
    // Room for the JSON, which has a few hundred bytes and the texts of the caller.
    if length > u64::from(u32::MAX) - (1 << 24) {
        let what = format!("the mesh takes {length} bytes, more than a GLB file can hold");
        return Err(IoError::malformed(path, what, "write PLY"));
    }
    Ok(())
}

/// Writes local coordinates; the offset is the translation of the node `mesh`.
pub(in crate::mesh) fn write(sink: &mut dyn Sink, mesh: &Mesh, options: &WriteOptions) -> std::io::Result<()> {
    const RUN: usize = 1 << 12;
    let (json, binary) = json_text(mesh, options);
    let chunk = if binary > 0 { 8 + binary } else { 0 };
    let total = u32::try_from(12 + 8 + json.len() as u64 + chunk).map_err(|_| std::io::ErrorKind::FileTooLarge)?;
    sink.write_all(MAGIC)?;
    for value in [2, total, json.len() as u32, JSON] {
        sink.write_all(&value.to_le_bytes())?;
    }
    sink.write_all(&json)?;
    if binary == 0 {
        return Ok(());
    }
    sink.write_all(&(binary as u32).to_le_bytes())?;
    sink.write_all(&BIN.to_le_bytes())?;

    let mut run = Vec::with_capacity(12 * RUN);
    for vertices in mesh.vertices.chunks(RUN) {
        run.clear();
        run.extend(vertices.iter().flatten().flat_map(|c| (*c as f32).to_le_bytes()));
        sink.write_all(&run)?;
    }
    let table = linear_table();
    for colors in mesh.attributes.colors.iter().flat_map(|colors| colors.chunks(RUN)) {
        run.clear();
        for color in colors {
            let [r, g, b] = color.map(|channel| table[usize::from(channel)]);
            run.extend([r, g, b, u16::MAX].into_iter().flat_map(u16::to_le_bytes));
        }
        sink.write_all(&run)?;
    }
    for values in mesh.attributes.intensities.iter().flat_map(|values| values.chunks(RUN)) {
        run.clear();
        run.extend(values.iter().flat_map(|v| v.to_le_bytes()));
        sink.write_all(&run)?;
    }
    for values in mesh.attributes.classes.iter().flat_map(|values| values.chunks(RUN)) {
        run.clear();
        run.extend(values.iter().flat_map(|v| f32::from(*v).to_le_bytes()));
        sink.write_all(&run)?;
    }
    for triangles in mesh.triangles.chunks(RUN) {
        run.clear();
        run.extend(triangles.iter().flatten().flat_map(|v| v.to_le_bytes()));
        sink.write_all(&run)?;
    }
    Ok(())
}
