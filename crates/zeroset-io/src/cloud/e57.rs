//! E57 scans, decoded by the `e57` crate.
//!
//! All scans of a file become one cloud: spherical coordinates are made Cartesian, the pose of each scan is applied,
//! and points that the scanner marked as invalid are left out and counted.

use std::io::Cursor;
use std::path::Path;

use e57::{E57Reader, PointCloud, Record, RecordDataType, RecordName, RecordValue};

use super::Columns;
use super::report::{LinearUnit, NO_COLOR, NO_INTENSITY};
use crate::IoError;
use crate::format::sniff;
use crate::guard::without_panic;
use crate::input::Fields;

/// More fields than any scanner writes; each costs memory for each point while it is unpacked.
const MOST_FIELDS: usize = 64;

pub(crate) fn read(path: &Path, bytes: &[u8]) -> Result<Columns, IoError> {
    const MAGIC: &[u8] = b"ASTM-E57";
    const HEADER: usize = 48;
    if !bytes.starts_with(MAGIC) && !MAGIC.starts_with(bytes) {
        return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "E57", looks: sniff(bytes) });
    }
    let mut fields = Fields::at(bytes, 16);
    let mut read = || Some((fields.u64()?, fields.u64()?, fields.u64()?, fields.u64()?));
    let Some((stated, _, xml_length, _)) = read() else {
        return Err(IoError::truncated(path, "header", HEADER as u64, bytes.len() as u64));
    };
    let length = bytes.len() as u64;
    if stated > length || xml_length > length {
        return Err(IoError::truncated(path, "body", stated.max(xml_length), length));
    }
    let failed = |message: String| IoError::Decode { path: path.to_path_buf(), format: "E57", message };
    without_panic(|| read_scans(path, bytes)).map_err(failed)?
}

fn read_scans(path: &Path, bytes: &[u8]) -> Result<Columns, IoError> {
    let failed = |e: e57::Error| IoError::Decode { path: path.to_path_buf(), format: "E57", message: e.to_string() };
    let mut reader = E57Reader::new(Cursor::new(bytes)).map_err(failed)?;
    let scans = reader.pointclouds();
    let declared = scans.iter().fold(0_u64, |sum, scan| sum.saturating_add(scan.records));
    // Coordinates of scanners take several bytes a point. Scans that share their data could otherwise multiply it.
    if declared > bytes.len() as u64 {
        return Err(IoError::CountMismatch {
            path: path.to_path_buf(),
            items: "points",
            declared,
            found: bytes.len() as u64,
        });
    }
    let mut columns = Columns {
        declared: Some(declared),
        crs: reader.coordinate_metadata().map(str::trim).filter(|crs| !crs.is_empty()).map(str::to_string),
        // The standard has no other unit.
        unit: Some(LinearUnit::Metre),
        ..Columns::default()
    };
    let used = || scans.iter().filter(|scan| scan.records > 0);
    let share = |wanted: &dyn Fn(&Fieldset) -> bool| {
        let with = used().filter(|scan| wanted(&Fieldset::of(&scan.prototype))).count();
        (with > 0).then_some(with < used().count())
    };
    let (some_colors, some_intensities) = (share(&|set| set.color.is_some()), share(&|set| set.intensity.is_some()));
    let (mut colors, mut intensities) = (some_colors.map(|_| Vec::new()), some_intensities.map(|_| Vec::new()));
    if some_colors == Some(true) {
        columns.notes.push("not every scan has colours; points of the others are white".into());
    }
    if some_intensities == Some(true) {
        columns.notes.push("not every scan has intensities; points of the others get 0".into());
    }

    for scan in used() {
        let set = Fieldset::of(&scan.prototype);
        check(path, scan, &set)?;
        let pose = Pose::of(scan);
        let ranges = set.color.map(|color| color_ranges(scan, color));
        for point in reader.pointcloud_raw(scan).map_err(failed)? {
            let point = point.map_err(failed)?;
            let value = |at: usize| point[at].to_f64(&scan.prototype[at].data_type).unwrap_or(f64::NAN);
            let Some(local) = set.position(&value) else {
                columns.invalid += 1;
                continue;
            };
            columns.points.push(pose.apply(local));
            if let Some(colors) = &mut colors {
                let valid = set.color_state.is_none_or(|at| value(at) == 0.0);
                colors.push(match (set.color, &ranges) {
                    (Some(color), Some(ranges)) if valid => std::array::from_fn(|c| {
                        let (low, high) = ranges[c];
                        (255.0 * (value(color[c]) - low) / (high - low)).round() as u8
                    }),
                    _ => NO_COLOR,
                });
            }
            if let Some(intensities) = &mut intensities {
                let valid = set.intensity_state.is_none_or(|at| value(at) == 0.0);
                intensities.push(set.intensity.filter(|_| valid).map_or(NO_INTENSITY, |at| value(at) as f32));
            }
        }
    }
    columns.attributes.colors = colors;
    columns.attributes.intensities = intensities;
    columns.facts.push(("scans", scans.len().to_string()));
    let sensor = scans.iter().find_map(|scan| {
        let parts = [scan.sensor_vendor.as_deref(), scan.sensor_model.as_deref()];
        let text = parts.into_iter().flatten().collect::<Vec<_>>().join(" ");
        (!text.trim().is_empty()).then(|| crate::error::clean(&text))
    });
    columns.facts.extend(sensor.map(|sensor| ("scanner", sensor)));
    Ok(columns)
}

/// Index of the field of each value.
struct Fieldset {
    cartesian: Option<[usize; 3]>,
    cartesian_state: Option<usize>,
    spherical: Option<[usize; 3]>,
    spherical_state: Option<usize>,
    color: Option<[usize; 3]>,
    color_state: Option<usize>,
    intensity: Option<usize>,
    intensity_state: Option<usize>,
}

impl Fieldset {
    fn of(prototype: &[Record]) -> Self {
        let find = |name: RecordName| prototype.iter().position(|record| record.name == name);
        let three = |a, b, c| Some([find(a)?, find(b)?, find(c)?]);
        Self {
            cartesian: three(RecordName::CartesianX, RecordName::CartesianY, RecordName::CartesianZ),
            cartesian_state: find(RecordName::CartesianInvalidState),
            spherical: three(RecordName::SphericalRange, RecordName::SphericalAzimuth, RecordName::SphericalElevation),
            spherical_state: find(RecordName::SphericalInvalidState),
            color: three(RecordName::ColorRed, RecordName::ColorGreen, RecordName::ColorBlue),
            color_state: find(RecordName::IsColorInvalid),
            intensity: find(RecordName::Intensity),
            intensity_state: find(RecordName::IsIntensityInvalid),
        }
    }

    /// Cartesian position before the pose, unless the point is marked as invalid: state 1 keeps only a direction.
    fn position(&self, value: &dyn Fn(usize) -> f64) -> Option<[f64; 3]> {
        let valid = |state: Option<usize>| state.is_none_or(|at| value(at) == 0.0);
        if let Some(at) = self.cartesian.filter(|_| valid(self.cartesian_state)) {
            return Some(at.map(value));
        }
        let [range, azimuth, elevation] = self.spherical.filter(|_| valid(self.spherical_state))?.map(value);
        let horizontal = range * elevation.cos();
        Some([horizontal * azimuth.cos(), horizontal * azimuth.sin(), range * elevation.sin()])
    }
}

/// Refuses scans that the crate would take too much memory for, or that hold no positions.
fn check(path: &Path, scan: &PointCloud, set: &Fieldset) -> Result<(), IoError> {
    let bad = |what: &str| Err(IoError::damaged(path, format!("an E57 scan {what}")));
    if set.cartesian.is_none() && set.spherical.is_none() {
        return bad("has neither Cartesian nor spherical coordinates");
    }
    if scan.prototype.len() > MOST_FIELDS {
        return bad("has more fields than any scanner writes");
    }
    // Fields of a single possible value take no bits. If all did, any number of points would fit into nothing.
    let takes_bits = |record: &Record| match record.data_type {
        RecordDataType::Integer { min, max } | RecordDataType::ScaledInteger { min, max, .. } => min < max,
        _ => true,
    };
    if !scan.prototype.iter().any(takes_bits) {
        return bad("has only constant fields");
    }
    Ok(())
}

/// Rotation and translation of a scan.
struct Pose {
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
}

impl Pose {
    fn of(scan: &PointCloud) -> Self {
        let pose = scan.transform.clone().unwrap_or_default();
        let q = pose.rotation;
        let norm = (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z).sqrt();
        // A quaternion of zeros stands for "no rotation" in some files.
        let [w, x, y, z] = if norm > 0.0 { [q.w, q.x, q.y, q.z].map(|c| c / norm) } else { [1.0, 0.0, 0.0, 0.0] };
        Self {
            rotation: [
                [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
                [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
                [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
            ],
            translation: [pose.translation.x, pose.translation.y, pose.translation.z],
        }
    }

    fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| {
            let row = self.rotation[i];
            row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + self.translation[i]
        })
    }
}

/// The values that stand for no and for full brightness, for each channel.
fn color_ranges(scan: &PointCloud, color: [usize; 3]) -> [(f64, f64); 3] {
    let limits = scan.color_limits.as_ref();
    let stated = [
        limits.map(|l| (&l.red_min, &l.red_max)),
        limits.map(|l| (&l.green_min, &l.green_max)),
        limits.map(|l| (&l.blue_min, &l.blue_max)),
    ];
    std::array::from_fn(|c| {
        let kind = &scan.prototype[color[c]].data_type;
        let number = |value: &Option<RecordValue>| value.as_ref().and_then(|v| v.to_f64(kind).ok());
        let range = stated[c].and_then(|(low, high)| Some((number(low)?, number(high)?)));
        let range = range.or(match kind {
            RecordDataType::Integer { min, max } => Some((*min as f64, *max as f64)),
            RecordDataType::Single { min: Some(min), max: Some(max) } => Some((f64::from(*min), f64::from(*max))),
            RecordDataType::Double { min: Some(min), max: Some(max) } => Some((*min, *max)),
            _ => None,
        });
        range.filter(|(low, high)| high > low).unwrap_or((0.0, 255.0))
    })
}
