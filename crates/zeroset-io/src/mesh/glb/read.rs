//! Reading GLB: the triangles of the scene.

use std::path::Path;

use serde_json::Value;
use zeroset::cloud::Attributes;
use zeroset::mesh::Mesh;

use super::color::srgb_byte;
use super::nodes::{Affine, placed_meshes};
use super::{BIN, JSON, MAGIC, component};
use crate::IoError;
use crate::cloud::class_from_value;
use crate::input::Fields;

/// Reads in world coordinates with z up.
pub(in crate::mesh) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, IoError> {
    let (root, binary) = chunks(path, bytes)?;
    check_extensions(path, &root)?;
    let damaged = |what: &str| IoError::damaged(path, what.to_string());
    let placed = placed_meshes(&root).ok_or_else(|| damaged("the GLB scene is not a tree of valid nodes"))?;
    let mut scene =
        Scene { path, root: &root, binary, most: bytes.len(), values: 0, mesh: Mesh::default(), parts: Vec::new() };
    for (mesh, transform) in placed {
        let primitives = root.get("meshes").and_then(|meshes| meshes.get(mesh)?.get("primitives")?.as_array());
        for primitive in primitives.ok_or_else(|| damaged("a GLB node names a mesh that does not exist"))? {
            scene.add(primitive, &transform)?;
        }
    }
    let crs = root.get("asset").and_then(|asset| asset.get("extras")?.get("crs")?.as_str()).map(str::to_string);
    let attributes = scene.attributes();
    Ok(Mesh { attributes, crs, ..scene.mesh })
}

fn chunks<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Value, &'a [u8]), IoError> {
    let found = bytes.len() as u64;
    if !bytes.starts_with(MAGIC) {
        return Err(if MAGIC.starts_with(bytes) {
            IoError::truncated(path, "header", 20, found)
        } else {
            IoError::WrongMagic { path: path.to_path_buf(), expected: "GLB", looks: crate::format::sniff(bytes) }
        });
    }
    let mut fields = Fields::at(bytes, 4);
    let mut head = || Some((fields.u32()?, fields.u32()?, fields.u32()?, fields.u32()?));
    let (version, length, json_length, json_kind) =
        head().ok_or_else(|| IoError::truncated(path, "header", 20, found))?;
    if version != 2 {
        let feature = format!("glTF version {version}");
        return Err(IoError::Unsupported { path: path.to_path_buf(), feature, remedy: "export as glTF 2.0" });
    }
    if u64::from(length) > found {
        return Err(IoError::truncated(path, "body", u64::from(length), found));
    }
    if json_kind != JSON {
        return Err(IoError::damaged(path, "the first GLB chunk is not JSON"));
    }
    let cut = |needed: u32| IoError::truncated(path, "body", u64::from(needed), found);
    let json = fields.take(json_length as usize).ok_or_else(|| cut(json_length))?;
    let root = serde_json::from_slice(json).map_err(|e| IoError::Decode {
        path: path.to_path_buf(),
        format: "GLB",
        message: e.to_string(),
    })?;
    // The binary chunk is optional, and whatever follows it is none of ours.
    let mut binary: &[u8] = &[];
    if let (Some(length), Some(kind)) = (fields.u32(), fields.u32())
        && kind == BIN
    {
        binary = fields.take(length as usize).ok_or_else(|| cut(length))?;
    }
    Ok((root, binary))
}

/// Extensions that a file cannot be understood without.
fn check_extensions(path: &Path, root: &Value) -> Result<(), IoError> {
    let required = root.get("extensionsRequired").and_then(Value::as_array).into_iter().flatten();
    let mut names = required.filter_map(Value::as_str);
    // How a surface looks does not matter here.
    match names.find(|name| !name.starts_with("KHR_materials_") && !name.starts_with("KHR_texture_")) {
        Some(name) => Err(IoError::Unsupported {
            path: path.to_path_buf(),
            feature: format!("the glTF extension {name}"),
            remedy: "export without compression",
        }),
        None => Ok(()),
    }
}

/// Attributes of a primitive, as far as it has them.
struct Part {
    colors: Option<Vec<[u8; 3]>>,
    intensities: Option<Vec<f32>>,
    classes: Option<Vec<u8>>,
}

struct Scene<'a> {
    path: &'a Path,
    root: &'a Value,
    binary: &'a [u8],
    /// How many values may be read in all: meshes that share their data could otherwise multiply a small file.
    most: usize,
    values: usize,
    mesh: Mesh,
    parts: Vec<Part>,
}

impl<'a> Scene<'a> {
    fn add(&mut self, primitive: &Value, transform: &Affine) -> Result<(), IoError> {
        match primitive.get("mode").map_or(Some(4), Value::as_u64) {
            Some(4) => {}
            // Points and lines are no surface.
            Some(0..=3) => return Ok(()),
            _ => {
                let feature = "a glTF triangle strip or fan".into();
                let path = self.path.to_path_buf();
                return Err(IoError::Unsupported { path, feature, remedy: "export plain triangles" });
            }
        }
        let attribute = |name: &str| primitive.get("attributes").and_then(|a| a.get(name)).and_then(Value::as_u64);
        let Some(position) = attribute("POSITION") else { return Ok(()) };
        let first = self.mesh.vertices.len();
        let positions = self.accessor(position)?;
        if positions.width != 3 {
            return Err(self.damaged("POSITION has not three components"));
        }
        let count = positions.count;
        for i in 0..count {
            let [x, y, z] = transform.apply([positions.value(i, 0), positions.value(i, 1), positions.value(i, 2)]);
            // y up becomes z up.
            self.mesh.vertices.push([x, -z, y]);
        }
        let corners: Vec<u64> = match primitive.get("indices").and_then(Value::as_u64) {
            Some(indices) => {
                let indices = self.accessor(indices)?;
                (0..indices.count).map(|i| indices.value(i, 0) as u64).collect()
            }
            None => (0..count as u64).collect(),
        };
        for corners in corners.chunks_exact(3) {
            if let Some(bad) = corners.iter().find(|v| **v >= count as u64) {
                let (path, face) = (self.path.to_path_buf(), self.mesh.triangles.len() as u64);
                return Err(IoError::BadIndex { path, face, vertex: *bad as i64, vertices: count as u64 });
            }
            let [a, b, c] = [corners[0], corners[1], corners[2]].map(|v| v as u32 + first as u32);
            self.mesh.triangles.push(if transform.mirrors() { [a, c, b] } else { [a, b, c] });
        }
        let part = Part {
            colors: self.column(attribute("COLOR_0"), count, 3, |values, i| {
                [0, 1, 2].map(|channel| srgb_byte(values.value(i, channel)))
            })?,
            intensities: self.column(attribute("_INTENSITY"), count, 1, |values, i| values.value(i, 0) as f32)?,
            classes: self
                .column(attribute("_CLASSIFICATION"), count, 1, |values, i| class_from_value(values.value(i, 0)))?,
        };
        self.parts.push(part);
        Ok(())
    }

    fn column<T>(
        &mut self,
        accessor: Option<u64>,
        count: usize,
        width: usize,
        value: impl Fn(&Accessor<'_>, usize) -> T,
    ) -> Result<Option<Vec<T>>, IoError> {
        let Some(accessor) = accessor else { return Ok(None) };
        let accessor = self.accessor(accessor)?;
        if accessor.count != count || accessor.width < width {
            return Err(self.damaged("an attribute does not match its POSITION"));
        }
        Ok(Some((0..count).map(|i| value(&accessor, i)).collect()))
    }

    fn accessor(&mut self, index: u64) -> Result<Accessor<'a>, IoError> {
        let (root, binary) = (self.root, self.binary);
        let item = |list: &str, index: u64| root.get(list)?.get(usize::try_from(index).ok()?);
        let accessor = item("accessors", index).ok_or_else(|| self.damaged("an accessor does not exist"))?;
        if accessor.get("sparse").is_some() {
            let (path, feature) = (self.path.to_path_buf(), "a sparse glTF accessor".into());
            return Err(IoError::Unsupported { path, feature, remedy: "export without morphs" });
        }
        let accessor = Accessor::of(accessor, |view| item("bufferViews", view), binary);
        let accessor =
            accessor.ok_or_else(|| self.damaged("an accessor reaches beyond the data or is inconsistent"))?;
        self.values = self.values.saturating_add(accessor.count);
        if self.values > self.most {
            let (path, feature) = (self.path.to_path_buf(), "a glTF scene of many copies of a mesh".into());
            return Err(IoError::Unsupported { path, feature, remedy: "export each mesh once" });
        }
        Ok(accessor)
    }

    /// Attributes that every primitive has.
    fn attributes(&mut self) -> Attributes {
        fn joined<T>(parts: Vec<Option<Vec<T>>>) -> Option<Vec<T>> {
            let parts = parts.into_iter().collect::<Option<Vec<_>>>()?;
            (!parts.is_empty()).then(|| parts.into_iter().flatten().collect())
        }
        let parts = &mut self.parts;
        Attributes {
            colors: joined(parts.iter_mut().map(|part| part.colors.take()).collect()),
            intensities: joined(parts.iter_mut().map(|part| part.intensities.take()).collect()),
            classes: joined(parts.iter_mut().map(|part| part.classes.take()).collect()),
        }
    }

    fn damaged(&self, what: &str) -> IoError {
        IoError::damaged(self.path, format!("in the GLB scene {what}"))
    }
}

/// Values in the binary chunk; every one of them is known to be inside.
struct Accessor<'a> {
    bytes: &'a [u8],
    count: usize,
    /// Components of each item.
    width: usize,
    stride: usize,
    component: u64,
    normalized: bool,
}

impl<'a> Accessor<'a> {
    fn of<'v>(accessor: &Value, view: impl Fn(u64) -> Option<&'v Value>, binary: &'a [u8]) -> Option<Self> {
        let number = |value: &Value, key: &str, default: u64| {
            let number = value.get(key).map_or(Some(default), Value::as_u64)?;
            usize::try_from(number).ok()
        };
        let component = accessor.get("componentType")?.as_u64()?;
        let size = match component {
            component::U8 => 1,
            component::U16 => 2,
            component::U32 | component::F32 => 4,
            _ => return None,
        };
        let width = match accessor.get("type")?.as_str()? {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => return None,
        };
        let view = view(accessor.get("bufferView")?.as_u64()?)?;
        if view.get("buffer")?.as_u64()? != 0 {
            return None;
        }
        let start = number(view, "byteOffset", 0)?;
        let length = number(view, "byteLength", 0)?;
        let bytes = binary.get(start..start.checked_add(length)?)?.get(number(accessor, "byteOffset", 0)?..)?;
        let stride = match number(view, "byteStride", 0)? {
            0 => size * width,
            // The standard's own limits; a stride of zero would make a count cost nothing.
            stride if (size * width..=252).contains(&stride) => stride,
            _ => return None,
        };
        let count = number(accessor, "count", 0)?;
        let needed = match count {
            0 => 0,
            _ => (count - 1).checked_mul(stride)?.checked_add(size * width)?,
        };
        let normalized = accessor.get("normalized").and_then(Value::as_bool).unwrap_or(false);
        (needed <= bytes.len()).then_some(Self { bytes, count, width, stride, component, normalized })
    }

    fn value(&self, item: usize, channel: usize) -> f64 {
        let mut fields = Fields::at(self.bytes, item * self.stride);
        let (value, full) = match self.component {
            component::U8 => (fields.take(channel).and_then(|_| fields.u8()).map(f64::from), 255.0),
            component::U16 => (fields.take(2 * channel).and_then(|_| fields.u16()).map(f64::from), 65535.0),
            component::U32 => (fields.take(4 * channel).and_then(|_| fields.u32()).map(f64::from), 1.0),
            _ => (fields.take(4 * channel).and_then(|_| fields.f32()).map(f64::from), 1.0),
        };
        let value = value.unwrap_or(0.0);
        if self.normalized { value / full } else { value }
    }
}
