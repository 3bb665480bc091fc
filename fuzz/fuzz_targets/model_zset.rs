#![no_main]

use std::path::Path;

use serde_json::{Value, json};
use zeroset::field::Field;
use zeroset::model::Solid;
use zeroset_io::read_model_bytes;

/// A file of a header and data, with a zero between them: its checksums are sound, and its arrays are all there.
fn with_checksums(bytes: &[u8]) -> Option<Vec<u8>> {
    let end = bytes.iter().position(|&byte| byte == 0)?;
    let mut header: Value = serde_json::from_slice(&bytes[..end]).ok()?;
    let mut data = bytes[end + 1..].to_vec();
    let mut last = 0;
    for entry in header.get_mut("arrays").and_then(Value::as_object_mut).into_iter().flat_map(|all| all.values_mut()) {
        let item: usize = entry["dtype"].as_str()?.get(2..)?.parse().ok()?;
        let shape = entry["shape"].as_array()?.iter();
        let size = shape.map(Value::as_u64).try_fold(item, |all, n| all.checked_mul(n? as usize))?;
        let first = entry["offset"].as_u64()? as usize;
        let end = first.checked_add(size).filter(|&end| end < 1 << 20)?;
        data.resize(data.len().max(end), 0);
        entry["crc32"] = json!(crc32fast::hash(&data[first..end]));
        last = last.max(end);
    }
    data.resize(last.next_multiple_of(64), 0);
    let mut text = serde_json::to_vec(&header).ok()?;
    text.resize((24 + text.len()).next_multiple_of(64) - 24, b' ');
    let (sum, length) = (crc32fast::hash(&text).to_le_bytes(), (text.len() as u64).to_le_bytes());
    Some([b"\x89ZSET\r\n\x1a", &1_u32.to_le_bytes()[..], &sum, &length, &text, &data].concat())
}

/// Where the operands are.
fn places(solid: &Solid) -> Vec<[f64; 3]> {
    match solid {
        Solid::Fitted(fitted) => {
            let parts = fitted.parts();
            let world = |p: [f64; 3]| std::array::from_fn(|a| p[a] + parts.world_from_local[a]);
            parts.points.iter().take(4).map(|p| world(p.map(f64::from))).chain(parts.bounds.map(world)).collect()
        }
        Solid::HalfSpace { point, .. } => vec![*point],
        Solid::Cuboid { corners: ends } | Solid::Frustum { ends, .. } => ends.to_vec(),
        Solid::Ball { center, .. } => vec![*center],
        Solid::Union(of) | Solid::Intersection(of) => of.iter().take(4).flat_map(places).collect(),
        Solid::Difference(of) | Solid::SmoothUnion { of, .. } => of.iter().flat_map(places).collect(),
        Solid::Complement(of) | Solid::Offset { of, .. } | Solid::Shell { of, .. } => places(of),
        Solid::Placed { .. } | Solid::Mesh(_) | Solid::Prism { .. } | Solid::HeightField { .. } => Vec::new(),
    }
}

/// Asks a field for all that it knows at some places.
fn ask(field: &dyn Field, mut places: Vec<[f64; 3]>) {
    places.truncate(16);
    places.extend([[0.0; 3], [0.3, -0.2, 0.7], [84_811.0, 447_412.0, 1.0], [1e12; 3], [f64::MAX, f64::MIN, 0.0]]);
    let _ = (field.extent(), field.metric(), field.lipschitz());
    for pair in places.windows(2) {
        let p = pair[0];
        let _ = (field.value(p), field.gradient(p));
        let sheet = field.sheet(p);
        let _ = (field.on_sheet(sheet, p), field.is_flat(sheet), field.operand(sheet));
        let low = std::array::from_fn(|a| p[a].min(pair[1][a]));
        let high = std::array::from_fn(|a| p[a].max(pair[1][a]));
        let bounds = field.bounds(low, high);
        let _ = bounds.contains(0.0);
        let _ = field.bounds(p, p);
    }
}

fn check(bytes: &[u8]) {
    match read_model_bytes(Path::new("fuzz.zset"), bytes) {
        Ok(model) => {
            if let Ok(field) = model.solid.field([0.0; 3]) {
                ask(&*field, places(&model.solid));
            }
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.lines().count() == 1 && text.contains("fuzz.zset"), "{text}");
        }
    }
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    check(bytes);
    if let Some(bytes) = with_checksums(bytes) {
        check(&bytes);
    }
});
