//! Files that are read part by part give what they give as a whole.

use std::path::Path;

use crate::common::{assert_near, folder};
use zeroset::cloud::{Attributes, Cloud};
use zeroset_io::{CloudPart, IoError, ReadReport, WriteOptions, cloud_size, read_cloud, read_cloud_parts, write_cloud};

const MANY: usize = 130_000;

/// A cloud with values on all points.
fn cloud() -> Cloud {
    let points = (0..MANY).map(|i| [84_000.0 + i as f64 * 0.01, 447_000.0 + (i % 977) as f64, (i % 31) as f64]);
    let attributes = Attributes {
        colors: Some((0..MANY).map(|i| [(i % 256) as u8, (i % 7) as u8, 9]).collect()),
        intensities: Some((0..MANY).map(|i| (i % 1000) as f32).collect()),
        classes: Some((0..MANY).map(|i| (i % 20) as u8).collect()),
    };
    Cloud { attributes, crs: Some("EPSG:28992+5709".into()), ..Cloud::from_world(points.collect()) }
}

/// All parts as one cloud in world coordinates; how often reading began; in how many parts it ended; what was reported.
fn joined(path: &Path, points: usize) -> Result<(Cloud, usize, usize, ReadReport), IoError> {
    let (mut all, mut begun, mut parts) = (Cloud::default(), 0, 0);
    let report = read_cloud_parts(path, points, |CloudPart { first, cloud }| {
        if first == 0 {
            (all, parts) = (Cloud::default(), 0);
            begun += 1;
        }
        parts += 1;
        let world = (0..cloud.len()).map(|i| cloud.world(i)).collect();
        all.append(Cloud { points: world, attributes: cloud.attributes, ..Cloud::default() });
        Ok::<(), IoError>(())
    })?;
    Ok((all, begun, parts, report))
}

fn assert_whole(path: &Path, points: usize, times: usize) {
    let whole = read_cloud(path).unwrap();
    let (all, begun, parts, report) = joined(path, points).unwrap();
    assert_eq!(begun, times, "{}", path.display());
    assert!(parts > 1 || points > MANY, "{parts} parts of {}", path.display());
    assert_near(&all.points, &(0..MANY).map(|i| whole.cloud.world(i)).collect::<Vec<_>>(), 1e-9);
    assert_eq!(all.attributes, whole.cloud.attributes);
    assert_eq!(report, whole.report);
}

#[test]
fn las_and_laz_in_parts_of_any_size() {
    let folder = folder();
    for suffix in ["las", "laz"] {
        let path = folder.path().join("many").with_extension(suffix);
        write_cloud(&path, &cloud(), &WriteOptions::default()).unwrap();
        for points in [1000, 60_000, usize::MAX] {
            assert_whole(&path, points, 1);
        }
        let size = cloud_size(&path).unwrap();
        let bounds = read_cloud(&path).unwrap().cloud.bounds().unwrap();
        assert_eq!(size.points, MANY as u64);
        assert_near(&size.bounds, &bounds, 1e-9);
    }
}

#[test]
fn other_formats_are_one_part() {
    let folder = folder();
    let path = folder.path().join("few.xyz");
    std::fs::write(&path, "1 2 3\n4 5 6\n7 8 nan\n").unwrap();
    let (all, begun, parts, report) = joined(&path, 1).unwrap();
    assert_eq!((all.points, begun, parts, report.non_finite), (vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], 1, 1, 1));
    assert_eq!(cloud_size(&path).unwrap().bounds, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
}

/// Colours look like 8 bits, and like none, until a late point tells otherwise.
#[test]
fn reading_begins_anew_where_a_late_point_tells_how_values_are_meant() {
    let folder = folder();
    let path = folder.path().join("late.las");
    write_cloud(&path, &Cloud { crs: None, ..cloud() }, &WriteOptions::default()).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let points_at = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    let length = usize::from(u16::from_le_bytes(bytes[105..107].try_into().unwrap()));
    assert_eq!(length, 36);
    for i in 0..MANY {
        let record = &mut bytes[points_at + i * length..][..length];
        // Without intensity and colour up to the second part, of 8 bits in it, of 16 in the last.
        let color: u16 = if i < 50_000 { 0 } else { [200, 40_000][usize::from(i > MANY - 5)] };
        record[12..14].copy_from_slice(&u16::from(i >= 50_000).to_le_bytes());
        for channel in 0..3 {
            record[30 + 2 * channel..][..2].copy_from_slice(&color.to_le_bytes());
        }
    }
    std::fs::write(&path, bytes).unwrap();
    assert_whole(&path, 40_000, 3);
    assert_whole(&path, usize::MAX, 1);
}

#[test]
fn what_is_wrong_with_a_file_is_told_as_ever() {
    let folder = folder();
    for suffix in ["las", "laz"] {
        let path = folder.path().join("cut").with_extension(suffix);
        write_cloud(&path, &cloud(), &WriteOptions::default()).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        for length in [0, 3, 100, 226, 300, 374, 376, 500, bytes.len() / 2, bytes.len() - 9] {
            std::fs::write(&path, &bytes[..length]).unwrap();
            let whole = read_cloud(&path).unwrap_err().to_string();
            assert_eq!(joined(&path, 1000).unwrap_err().to_string(), whole, "{suffix} of {length} bytes");
        }
    }
    let path = folder.path().join("withheld.las");
    write_cloud(&path, &cloud(), &WriteOptions::default()).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let points_at = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    let length = usize::from(u16::from_le_bytes(bytes[105..107].try_into().unwrap()));
    for i in 0..MANY {
        bytes[points_at + i * length + 15] |= 0b1000_0000;
    }
    std::fs::write(&path, &bytes).unwrap();
    assert_eq!(joined(&path, 1000).unwrap_err().to_string(), read_cloud(&path).unwrap_err().to_string());
    bytes[points_at + 70_000 * length + 15] &= 0b0111_1111;
    std::fs::write(&path, &bytes).unwrap();
    let (all, _, _, report) = joined(&path, 1000).unwrap();
    assert_eq!((all.len(), report.withheld), (1, MANY as u64 - 1));
}
