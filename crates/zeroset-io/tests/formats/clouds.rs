//! Clouds: each format read as its specification says, and written so that it reads back.

use std::path::Path;

use crate::common::{GEOREFERENCED, SWISS, assert_near, attributes, cloud, folder, world};
use zeroset::cloud::Attributes;
use zeroset_io::{
    CloudFile, CloudFormat, IoError, LinearUnit, NO_CLASS, NO_COLOR, NO_INTENSITY, WriteOptions, read_cloud,
    read_cloud_bytes, read_clouds, write_cloud,
};

fn read(name: &str, content: impl AsRef<[u8]>) -> Result<CloudFile, IoError> {
    let path = Path::new(name);
    read_cloud_bytes(path, CloudFormat::from_path(path)?, content.as_ref().to_vec())
}

#[track_caller]
fn points(name: &str, content: impl AsRef<[u8]>) -> Vec<[f64; 3]> {
    let cloud = read(name, content).unwrap().cloud;
    world(cloud.world_from_local, &cloud.points)
}

const THREE: [[f64; 3]; 3] = [[1.0, 2.0, 3.0], [4.5, -5.0, 6.25], [7.0, 8.0, 9.0]];

#[test]
fn every_writer_round_trips() {
    let folder = folder();
    for sample in [GEOREFERENCED, SWISS] {
        for suffix in ["ply", "xyz", "csv", "pts", "las", "laz"] {
            let path = folder.path().join(format!("cloud.{suffix}"));
            let sent = cloud(sample);
            let report = write_cloud(&path, &sent, &WriteOptions::default()).unwrap();
            assert_eq!(report.bytes, std::fs::metadata(&path).unwrap().len());
            let back = read_cloud(&path).unwrap();
            assert_near(&world(back.cloud.world_from_local, &back.cloud.points), &sample, 0.000_501);
            let (found, expected) = (&back.cloud.attributes, attributes());
            assert_eq!(found.colors, expected.colors, "{suffix}");
            assert_eq!(found.intensities, expected.intensities, "{suffix}");
            if suffix == "pts" {
                assert_eq!(report.attributes_left_out, ["classes"]);
                assert_eq!(back.report.points_declared, Some(4));
            } else {
                assert_eq!(found.classes, expected.classes, "{suffix}");
                // A comment would keep other programs from finding the names in the first line of CSV.
                let crs = (suffix != "csv").then_some("EPSG:28992");
                assert_eq!(back.cloud.crs.as_deref(), crs, "{suffix}");
            }
        }
    }
}

#[test]
fn a_finer_resolution_writes_more_digits() {
    let folder = folder();
    let sent = zeroset::cloud::Cloud { points: vec![[0.123_456_78, 0.0, 1.0], [0.2, 0.3, 0.4]], ..Default::default() };
    let options = WriteOptions { resolution: Some(1e-3), ..WriteOptions::default() };
    for suffix in ["ply", "xyz", "las", "laz"] {
        let path = folder.path().join(format!("cloud.{suffix}"));
        write_cloud(&path, &sent, &options).unwrap();
        let back = read_cloud(&path).unwrap().cloud;
        assert_near(&world(back.world_from_local, &back.points), &sent.points, 1.01e-7);
    }
}

#[test]
fn las_keeps_wkt_and_its_unit() {
    let folder = folder();
    let path = folder.path().join("cloud.laz");
    let wkt =
        r#"PROJCS["a",GEOGCS["b",UNIT["degree",0.017453292519943295]],UNIT["US survey foot",0.3048006096012192]]"#;
    let sent = zeroset::cloud::Cloud { crs: Some(wkt.into()), ..cloud(GEOREFERENCED) };
    write_cloud(&path, &sent, &WriteOptions::default()).unwrap();
    let back = read_cloud(&path).unwrap();
    assert_eq!(back.cloud.crs.as_deref(), Some(wkt));
    assert_eq!(back.report.unit, Some(LinearUnit::UsSurveyFoot));
    assert_eq!(back.report.points_declared, Some(4));
}

#[test]
fn las_of_wide_extent_takes_a_coarser_step() {
    let folder = folder();
    let path = folder.path().join("wide.las");
    let sent = zeroset::cloud::Cloud { points: vec![[-4e7, 0.0, 0.0], [4e7, 1.0, 0.0]], ..Default::default() };
    write_cloud(&path, &sent, &WriteOptions::default()).unwrap();
    let back = read_cloud(&path).unwrap().cloud;
    assert_near(&world(back.world_from_local, &back.points), &sent.points, 0.051);
}

/// The `las` crate as an independent writer: every point format, and LAZ of the formats that it compresses.
#[test]
fn las_of_every_point_format() {
    let folder = folder();
    for format in 0..=10_u8 {
        for suffix in ["las", "laz"] {
            let path = folder.path().join(format!("f{format}.{suffix}"));
            let mut builder = las::Builder::from((1, 4));
            builder.point_format = las::point::Format::new(format).unwrap();
            builder.point_format.extra_bytes = 3;
            let axis = |offset| las::Transform { scale: 0.001, offset };
            builder.transforms = las::Vector { x: axis(84_800.0), y: axis(447_400.0), z: axis(0.0) };
            let kind = builder.point_format;
            let mut writer = las::Writer::from_path(&path, builder.into_header().unwrap()).unwrap();
            let expected = attributes();
            for (i, [x, y, z]) in GEOREFERENCED.into_iter().enumerate() {
                let [red, green, blue] = expected.colors.as_ref().unwrap()[i].map(|c| u16::from(c) * 257);
                writer
                    .write_point(las::Point {
                        x,
                        y,
                        z,
                        intensity: expected.intensities.as_ref().unwrap()[i] as u16,
                        classification: las::point::Classification::new(expected.classes.as_ref().unwrap()[i]).unwrap(),
                        return_number: 1,
                        number_of_returns: 1,
                        gps_time: kind.has_gps_time.then_some(1.5),
                        color: kind.has_color.then_some(las::Color { red, green, blue }),
                        nir: kind.has_nir.then_some(7),
                        waveform: kind.has_waveform.then(Default::default),
                        extra_bytes: vec![1, 2, 3],
                        is_withheld: i == 2,
                        ..las::Point::default()
                    })
                    .unwrap();
            }
            writer.close().unwrap();
            let back = read_cloud(&path).unwrap_or_else(|e| panic!("{e}"));
            // The third is withheld.
            let kept = |i: &usize| *i != 2;
            let sent: Vec<_> = (0..4).filter(kept).map(|i| GEOREFERENCED[i]).collect();
            assert_near(&world(back.cloud.world_from_local, &back.cloud.points), &sent, 1e-9);
            assert_eq!(back.report.withheld, 1);
            assert_eq!(back.report.points_declared, Some(4));
            assert_eq!(back.cloud.attributes.classes, Some(vec![2, 6, 1]));
            assert_eq!(back.cloud.attributes.intensities, Some(vec![1.0, 2.0, 65535.0]));
            let colors = kind.has_color.then(|| vec![[255, 0, 128], [1, 2, 3], [10, 200, 255]]);
            assert_eq!(back.cloud.attributes.colors, colors, "format {format} {suffix}");
        }
    }
}

/// The `las` crate as an independent reader of what is written here.
#[test]
fn las_is_read_by_others() {
    let folder = folder();
    for crs in [None, Some("EPSG:28992"), Some(r#"LOCAL_CS["a",UNIT["metre",1]]"#)] {
        for suffix in ["las", "laz"] {
            let path = folder.path().join(format!("cloud.{suffix}"));
            let sent = zeroset::cloud::Cloud { crs: crs.map(str::to_string), ..cloud(GEOREFERENCED) };
            write_cloud(&path, &sent, &WriteOptions::default()).unwrap();
            let mut reader = las::Reader::from_path(&path).unwrap();
            let bounds = reader.header().bounds();
            assert!((bounds.min.x - 84_810.3).abs() < 1e-6 && (bounds.max.y - 447_499.999).abs() < 1e-6);
            let all = reader.read_all().unwrap();
            let found: Vec<_> = all.points().map(|p| p.unwrap()).collect();
            let position: Vec<_> = found.iter().map(|p| [p.x, p.y, p.z]).collect();
            assert_near(&position, &GEOREFERENCED, 1e-6);
            assert_eq!(u8::from(found[1].classification), 6);
            assert_eq!(found[0].color, Some(las::Color { red: 65535, green: 0, blue: 128 * 257 }));
            assert_eq!((found[0].return_number, found[0].number_of_returns), (1, 1));
        }
    }
}

/// Chunks of different sizes, as cloud-optimised files have them.
#[test]
fn laz_with_chunks_of_any_size() {
    use laz::{LasZipCompressor, LazItemRecordBuilder, LazVlr, LazVlrBuilder};
    let count = 1000_u32;
    let sent = zeroset::cloud::Cloud {
        points: (0..count).map(|i| [f64::from(i), f64::from(i * i % 97), 0.5 * f64::from(i)]).collect(),
        ..Default::default()
    };
    let folder = folder();
    let path = folder.path().join("plain.las");
    write_cloud(&path, &sent, &WriteOptions::default()).unwrap();
    let plain = std::fs::read(&path).unwrap();
    let (head, records) = plain.split_at(375);

    let items = LazItemRecordBuilder::default_for_point_format_id(6, 0).unwrap();
    let settings: LazVlr = LazVlrBuilder::new(items).with_variable_chunk_size().build();
    let mut data = Vec::new();
    settings.write_to(&mut data).unwrap();
    let mut file = head.to_vec();
    file[104] |= 0x80;
    file[100..104].copy_from_slice(&1_u32.to_le_bytes());
    file[96..100].copy_from_slice(&(375 + 54 + data.len() as u32).to_le_bytes());
    file.extend([0; 2]);
    file.extend(b"laszip encoded\0\0");
    file.extend(22204_u16.to_le_bytes());
    file.extend((data.len() as u16).to_le_bytes());
    file.extend([0; 32]);
    file.extend(&data);
    let start = file.len() as u64;
    let mut cursor = std::io::Cursor::new(file);
    cursor.set_position(start);
    let mut compressor = LasZipCompressor::new(cursor, settings).unwrap();
    let mut at = 0;
    for size in [1, 7, 400, 3, 589] {
        compressor.compress_many(&records[30 * at..30 * (at + size)]).unwrap();
        compressor.finish_current_chunk().unwrap();
        at += size;
    }
    compressor.done().unwrap();
    let file = compressor.into_inner().into_inner();
    assert_near(&points("tile.copc.laz", &file), &sent.points, 1e-9);
}

#[test]
fn ply_of_any_property_order_and_type() {
    let head = "ply\nformat ascii 1.0\ncomment crs EPSG:7415\ncomment unit foot\nelement camera 1\nproperty float fov\n\
        property list uchar int ids\nelement vertex 2\nproperty uchar blue\nproperty double z\nproperty list uchar int seen\n\
        property short x\nproperty float y\nproperty uchar green\nproperty uchar red\nproperty float scalar_Intensity\n\
        property int scalar_Classification\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let text = format!("{head}0.5 2 8 9\n30 3.25 2 5 6 1 2 20 10 0.75 6\n33 9 0 4 5.5 22 11 0.5 2\n3 0 1 0\n");
    let file = read("a.ply", text).unwrap();
    assert_eq!(file.cloud.points, [[1.0, 2.0, 3.25], [4.0, 5.5, 9.0]]);
    assert_eq!(file.cloud.attributes.colors, Some(vec![[10, 20, 30], [11, 22, 33]]));
    assert_eq!(file.cloud.attributes.intensities, Some(vec![0.75, 0.5]));
    assert_eq!(file.cloud.attributes.classes, Some(vec![6, 2]));
    assert_eq!(file.cloud.crs.as_deref(), Some("EPSG:7415"));
    assert_eq!(file.report.unit, Some(LinearUnit::Foot));
}

#[test]
fn ply_of_both_byte_orders() {
    for (name, big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
        let mut file = format!(
            "ply\r\nformat {name} 1.0\r\nelement other 2\r\nproperty list ushort double v\r\nelement vertex 3\r\n\
             property double x\r\nproperty ushort red\r\nproperty ushort green\r\nproperty ushort blue\r\n\
             property float y\r\nproperty int z\r\nend_header\r\n"
        )
        .into_bytes();
        let mut put = |bytes: &[u8]| {
            let mut bytes = bytes.to_vec();
            if big {
                bytes.reverse();
            }
            file.extend(bytes);
        };
        put(&1_u16.to_le_bytes());
        put(&7.0_f64.to_le_bytes());
        put(&0_u16.to_le_bytes());
        for i in 0..3_i32 {
            put(&(2_600_000.123 + f64::from(i)).to_le_bytes());
            for channel in [0, 32_896, 65_535_u16] {
                put(&channel.to_le_bytes());
            }
            put(&(1.5 * i as f32).to_le_bytes());
            put(&(-i).to_le_bytes());
        }
        let expected = [[2_600_000.123, 0.0, 0.0], [2_600_001.123, 1.5, -1.0], [2_600_002.123, 3.0, -2.0]];
        assert_near(&points("a.ply", &file), &expected, 1e-9);
        assert_eq!(read("a.ply", &file).unwrap().cloud.attributes.colors, Some(vec![[0, 128, 255]; 3]));
    }
}

#[test]
fn text_of_any_separator() {
    for text in [
        "1 2 3\n4.5 -5 6.25\n7 8 9\n",
        "1,2,3\n4.5,-5,6.25\n7,8,9",
        "1;2;3\r\n4.5;-5;6.25\r\n7;8;9\r\n",
        "1\t2\t3\r4.5\t-5\t6.25\r7\t8\t9\r",
        "\u{feff}1, 2, 3\n\n# note\n// note\n4.5 , -5 , 6.25\n   7 8;9   \n\n",
        "x y z\n1 2 3\n4.5 -5 6.25\n7 8 9\n",
        "A title\nof two lines\n1 2 3\n4.5 -5 6.25\n7 8 9\n",
        "1e0 +2 3.0E0\n45e-1 -5 6.25\n7 8 9 ",
        "3\n1 2 3\n4.5 -5 6.25\n7 8 9\n",
        "\"x\",\"y\",\"z\"\n\"1\",\"2\",\"3\"\n4.5,-5,6.25\n7,8,9\n",
    ] {
        assert_eq!(points("a.xyz", text), THREE, "{text:?}");
    }
}

#[test]
fn text_columns_by_name() {
    let expected = ([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], vec![[10, 20, 30], [40, 50, 255]], vec![7.0, 8.5], vec![2, 6]);
    for text in [
        "X,Y,Z,Red,Green,Blue,Intensity,Classification\n1,2,3,10,20,30,7,2\n4,5,6,40,50,255,8.5,6\n",
        "//X Y Z R G B Scalar_Intensity Scalar_Classification\n2\n1 2 3 10 20 30 7 2\n4 5 6 40 50 255 8.5 6\n",
        "# class intensity b g r z y x extra\n2 7 30 20 10 3 2 1 99\n6 8.5 255 50 40 6 5 4 98\n",
        "easting;northing;height;r;g;b;i;class\n1;2;3;10;20;30;7;2\n4;5;6;40;50;255;8.5;6\n",
        "\"x(m)\",\"y[m]\",z,red,green,blue,intensity,class\n1,2,3,10,20,30,7,2\n4,5,6,40,50,255,8.5,6\n",
    ] {
        let file = read("a.csv", text).unwrap();
        assert_eq!(file.cloud.points, expected.0, "{text}");
        assert_eq!(file.cloud.attributes.colors.as_ref(), Some(&expected.1), "{text}");
        assert_eq!(file.cloud.attributes.intensities.as_ref(), Some(&expected.2), "{text}");
        assert_eq!(file.cloud.attributes.classes.as_ref(), Some(&expected.3), "{text}");
    }
}

#[test]
fn text_columns_are_where_the_header_says() {
    for text in [
        // A name with a space; the index column of a table without a name; a number of something beside northing.
        "GPS time,X,Y,Z,red\n7,1,2,3,9\n8,4.5,-5,6.25,9\n9,7,8,9,9\n",
        ",x,y,z\n0,1,2,3\n1,4.5,-5,6.25\n2,7,8,9\n",
        "n,x,y,z,height\n5,1,2,3,0\n6,4.5,-5,6.25,0\n7,7,8,9,0\n",
        "\"height above ground\";\"x\";\"y\";\"z\"\n5;1;2;3\n6;4.5;-5;6.25\n7;7;8;9\n",
        // Words, dates, nothing and quoted separators in columns before.
        "name,date,x,y,z\nNew York,2020-01-01 12:00,1,2,3\n,,4.5,-5,6.25\n\"a, b\",x,7,8,9\n",
        "tag\tfirst name\tx\ty\tz\n1\t\t1\t2\t3\n\tb c\t4.5\t-5\t6.25\n3\td\t7\t8\t9\n",
        // Names between commas, values between spaces.
        "# x,y,z\n1 2 3\n4.5 -5 6.25\n7 8 9\n",
        "x (m),y (m),z (m)\r\n1,2,3\r\n4.5,-5,6.25\r\n7,8,9\r\n",
        "+1 +2 +3\n+4.5 -5 +6.25\n7 8 9\n",
    ] {
        assert_eq!(points("a.csv", text), THREE, "{text}");
    }
    let file = read("a.csv", "x,y,z,time,intensity\n1,2,3,2020-01-01 12:00:00,17\n4,5,6,,18\n").unwrap();
    assert_eq!(file.cloud.attributes.intensities, Some(vec![17.0, 18.0]));
    let file = read("a.csv", "\tx\ty\tz\tred\tgreen\tblue\n0\t1\t2\t3\t1\t2\t3\n1\t4\t5\t6\t\t\t\n").unwrap();
    assert_eq!(file.cloud.attributes.colors, Some(vec![[1, 2, 3], [0; 3]]));
    let file = read("a.csv", "id,lon,lat,alt\n7,1,2,3\n").unwrap();
    assert!(file.report.notes[0].starts_with("line 1 names no x, y and z"), "{:?}", file.report.notes);
}

#[test]
fn unnamed_text_columns_are_mentioned_and_left_alone() {
    let file = read("a.xyz", "1 2 3 0.1 0.2 0.3\n4 5 6 0.1 0.2 0.3\n").unwrap();
    assert_eq!(file.cloud.attributes, Default::default());
    assert!(file.report.notes.iter().any(|note| note.contains("3 columns")), "{:?}", file.report.notes);
}

#[test]
fn pts_has_its_own_convention() {
    let file = read("a.pts", "2\r\n1 2 3 -1000 10 20 30\r\n4 5 6 2047 40 50 255\r\n").unwrap();
    assert_eq!(file.cloud.attributes.intensities, Some(vec![-1000.0, 2047.0]));
    assert_eq!(file.cloud.attributes.colors, Some(vec![[10, 20, 30], [40, 50, 255]]));
    let scans = read("a.pts", "1\n1 2 3 5\n2\n4 5 6 5\n7 8 9 6\n").unwrap();
    assert_eq!((scans.cloud.len(), scans.report.points_declared), (3, Some(3)));
    assert_eq!(read("a.pts", "1 2 3 10 20 30\n").unwrap().cloud.attributes.colors, Some(vec![[10, 20, 30]]));
}

#[test]
fn pcd_of_all_three_encodings() {
    for bytes in [crate::common::pcd_ascii(), crate::common::pcd_binary(), crate::common::pcd_compressed()] {
        let cloud = read("a.pcd", &bytes).unwrap().cloud;
        assert_near(&world(cloud.world_from_local, &cloud.points), &GEOREFERENCED, 1e-9);
        let expected = attributes();
        assert_eq!(cloud.attributes.colors, expected.colors);
        assert_eq!(cloud.attributes.intensities, expected.intensities);
    }
}

#[test]
fn pcd_intensity_is_not_the_index() {
    let text = "FIELDS i x y z intensity\nSIZE 4 4 4 4 4\nTYPE U F F F F\nCOUNT 1 1 1 1 1\nPOINTS 1\nDATA ascii\n5 1 2 3 0.5\n";
    assert_eq!(read("a.pcd", text).unwrap().cloud.attributes.intensities, Some(vec![0.5]));
}

#[test]
fn pcd_without_a_count_of_points_takes_the_grid() {
    let text = "FIELDS _ x y z\nSIZE 1 4 4 4\nTYPE U F F F\nCOUNT 3 1 1 1\nWIDTH 2\nHEIGHT 1\nDATA ascii\n\
        0 0 0 1 2 3\n0 0 0 nan nan nan\n";
    let file = read("a.pcd", text).unwrap();
    assert_eq!((file.cloud.points, file.report.non_finite), (vec![[1.0, 2.0, 3.0]], 1));
}

#[test]
fn e57_applies_the_pose() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let pose = e57::Transform {
        rotation: e57::Quaternion { w: half, x: 0.0, y: 0.0, z: half },
        translation: e57::Translation { x: 1000.0, y: -5.0, z: 2.0 },
    };
    // A quarter turn to the left.
    let expected: Vec<_> = GEOREFERENCED.iter().map(|p| [1000.0 - p[1], p[0] - 5.0, p[2] + 2.0]).collect();
    let file = read("a.e57", crate::common::e57(Some(pose))).unwrap();
    assert_near(&world(file.cloud.world_from_local, &file.cloud.points), &expected, 1e-8);
    assert_eq!(file.cloud.attributes.colors, attributes().colors);
    assert_eq!(file.cloud.attributes.intensities, Some(vec![0.5; 4]));
    assert_eq!(file.report.unit, Some(LinearUnit::Metre));
    assert!(file.report.facts.contains(&("scans", "1".into())));
}

#[test]
fn e57_joins_scans_and_understands_spherical_points() {
    use e57::{Record, RecordDataType, RecordName, RecordValue};
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = e57::E57Writer::new(&mut file, "a file").unwrap();
    let cartesian = vec![
        Record::CARTESIAN_X_F32,
        Record::CARTESIAN_Y_F32,
        Record::CARTESIAN_Z_F32,
        Record { name: RecordName::CartesianInvalidState, data_type: RecordDataType::Integer { min: 0, max: 2 } },
    ];
    let mut scan = writer.add_pointcloud("first", cartesian).unwrap();
    for state in [0, 1, 2] {
        let mut values: Vec<_> = [1.0, 2.0, 3.0].map(RecordValue::Single).into();
        values.push(RecordValue::Integer(state));
        scan.add_point(values).unwrap();
    }
    scan.finalize().unwrap();
    let angle = |name| Record { name, data_type: RecordDataType::F64 };
    let spherical = vec![
        angle(RecordName::SphericalRange),
        angle(RecordName::SphericalAzimuth),
        angle(RecordName::SphericalElevation),
    ];
    let mut scan = writer.add_pointcloud("second", spherical).unwrap();
    let quarter = std::f64::consts::FRAC_PI_2;
    scan.add_point([2.0, quarter, 0.0].map(RecordValue::Double).into()).unwrap();
    scan.add_point([2.0, 0.0, quarter].map(RecordValue::Double).into()).unwrap();
    scan.finalize().unwrap();
    writer.finalize().unwrap();
    drop(writer);
    let back = read("a.e57", file.into_inner()).unwrap();
    assert_near(&back.cloud.points, &[[1.0, 2.0, 3.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]], 1e-12);
    assert_eq!((back.report.points_declared, back.report.points_read, back.report.non_finite), (Some(5), 3, 2));
}

#[test]
fn e57_keeps_the_colours_of_the_scans_that_have_them() {
    use e57::{Record, RecordValue};
    let mut file = std::io::Cursor::new(Vec::new());
    let mut writer = e57::E57Writer::new(&mut file, "a file").unwrap();
    let bare = vec![Record::CARTESIAN_X_F32, Record::CARTESIAN_Y_F32, Record::CARTESIAN_Z_F32];
    let mut colored = bare.clone();
    colored.extend([Record::COLOR_RED_U8, Record::COLOR_GREEN_U8, Record::COLOR_BLUE_U8]);
    let place = [1.0, 2.0, 3.0].map(RecordValue::Single);
    for (name, fields) in [("first", bare), ("second", colored)] {
        let with_color = fields.len() > 3;
        let mut scan = writer.add_pointcloud(name, fields).unwrap();
        let mut values: Vec<_> = place.clone().into();
        if with_color {
            values.extend([10, 20, 30].map(RecordValue::Integer));
        }
        scan.add_point(values).unwrap();
        scan.finalize().unwrap();
    }
    writer.finalize().unwrap();
    drop(writer);
    let back = read("a.e57", file.into_inner()).unwrap();
    assert_eq!(back.cloud.attributes.colors, Some(vec![NO_COLOR, [10, 20, 30]]));
    assert_eq!(back.report.notes, ["not every scan has colours; points of the others are white"]);
}

#[test]
fn points_without_finite_coordinates_are_dropped_with_their_attributes() {
    let file = read("a.xyz", "x y z class\n1 2 3 1\nnan 2 3 2\n4 inf 6 3\n7 8 9 4\n").unwrap();
    assert_eq!(file.cloud.points, [[1.0, 2.0, 3.0], [7.0, 8.0, 9.0]]);
    assert_eq!(file.cloud.attributes.classes, Some(vec![1, 4]));
    assert_eq!((file.report.non_finite, file.report.points_read), (2, 2));
}

#[test]
fn several_files_become_one_cloud() {
    let folder = folder();
    let (first, second, third) =
        (folder.path().join("a.laz"), folder.path().join("b.xyz"), folder.path().join("c.ply"));
    write_cloud(&first, &cloud(GEOREFERENCED), &WriteOptions::default()).unwrap();
    std::fs::write(&second, "# crs EPSG:2056\n84000.5 447000.25 1 9\n").unwrap();
    write_cloud(&third, &cloud(GEOREFERENCED), &WriteOptions::default()).unwrap();
    let all = read_clouds(&[first.clone(), second.clone(), third.clone()]).unwrap();
    let mut expected = GEOREFERENCED.to_vec();
    expected.push([84_000.5, 447_000.25, 1.0]);
    expected.extend(GEOREFERENCED);
    assert_near(&world(all.cloud.world_from_local, &all.cloud.points), &expected, 0.000_501);
    assert_eq!(all.cloud.attributes.classes, Some(vec![2, 6, 9, 1, 0, 2, 6, 9, 1]));
    assert_eq!((all.report.sources.len(), all.report.points_read, all.report.points_declared), (3, 9, None));
    let counts: Vec<u64> = all.report.sources.iter().map(|source| source.points).collect();
    assert_eq!(counts.iter().sum::<u64>(), all.report.points_read, "{counts:?}");
    assert!(all.report.notes.iter().any(|n| n.contains("another reference system")), "{:?}", all.report.notes);
    assert_eq!(all.cloud.crs.as_deref(), Some("EPSG:28992"));

    let both = read_clouds(&[first, third]).unwrap();
    assert!(both.report.notes.is_empty(), "{:?}", both.report);
    assert_eq!(both.cloud.attributes.classes, Some(vec![2, 6, 9, 1, 2, 6, 9, 1]));
    assert_eq!(both.report.points_declared, Some(8));
    assert!(matches!(read_clouds(&[]), Err(IoError::NoInput)));
}

#[test]
fn points_of_files_without_an_attribute_get_none() {
    let folder = folder();
    let (bare, full) = (folder.path().join("a.xyz"), folder.path().join("b.ply"));
    std::fs::write(&bare, "1 2 3\n").unwrap();
    let given = cloud(GEOREFERENCED);
    write_cloud(&full, &given, &WriteOptions::default()).unwrap();
    for order in [[&bare, &full, &full], [&full, &bare, &full], [&full, &full, &bare]] {
        let all = read_clouds(&order.map(Clone::clone)).unwrap();
        let (mut colors, mut intensities, mut classes) = (Vec::new(), Vec::new(), Vec::new());
        for path in order {
            if *path == bare {
                colors.push(NO_COLOR);
                intensities.push(NO_INTENSITY);
                classes.push(NO_CLASS);
            } else {
                colors.extend(given.attributes.colors.iter().flatten());
                intensities.extend(given.attributes.intensities.iter().flatten());
                classes.extend(given.attributes.classes.iter().flatten());
            }
        }
        let expected = Attributes { colors: Some(colors), intensities: Some(intensities), classes: Some(classes) };
        assert_eq!(all.cloud.attributes, expected);
        let notes: Vec<&String> = all.report.notes.iter().filter(|note| note.contains("has no")).collect();
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(notes[0].contains("a.xyz has no colors, no intensities, no classes"), "{notes:?}");
        for (source, path) in all.report.sources.iter().zip(order) {
            assert_eq!(source.has("classes"), *path == full);
        }
    }
    let bare_only = read_clouds(&[bare.clone(), bare]).unwrap();
    assert_eq!(bare_only.cloud.attributes, Attributes::default());
    assert!(bare_only.report.notes.is_empty(), "{:?}", bare_only.report.notes);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let folder = folder();
    let points = (0..200_000_u32).map(|i| {
        let t = f64::from(i);
        [84_810.3 + (0.01 * t).sin() * 100.0, 447_412.8 + (0.017 * t).cos() * 100.0, 0.001 * t]
    });
    let sent = zeroset::cloud::Cloud::from_world(points.collect());
    for suffix in ["ply", "xyz", "las", "laz"] {
        let path = folder.path().join(format!("many.{suffix}"));
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                write_cloud(&path, &sent, &WriteOptions::default()).unwrap();
                (std::fs::read(&path).unwrap(), read_cloud(&path).unwrap())
            })
        };
        let ((one, one_back), (four, four_back)) = (on(1), on(4));
        assert!(one == four, "{suffix}: the files differ");
        assert!(one_back.cloud == four_back.cloud, "{suffix}: the clouds differ");
        assert_near(
            &world(one_back.cloud.world_from_local, &one_back.cloud.points),
            &world(sent.world_from_local, &sent.points),
            0.000_501,
        );
    }
}
