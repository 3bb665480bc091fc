//! Planes, edges and corners: what every format holds, what is refused, and that no content makes the reader panic.

use std::path::Path;

use crate::common::{GEOREFERENCED, SWISS, cloud, folder};
use proptest::prelude::*;
use serde_json::{Value, json};
use zeroset::cloud::Cloud;
use zeroset::feature::{Corner, Edge, FeatureClass, FeatureKind, Features, Plane, PointFeature};
use zeroset_io::{
    FeatureFile, FeatureFormat, FeatureOutput, IoError, LinearUnit, WriteOptions, read_features, read_features_bytes,
    read_mesh, write_features,
};

/// A level roof with a chimney's hole, a wall below its southern eave, the eave and one of its corners.
fn features(at: [f64; 3]) -> Features {
    let square = |a: f64, b: f64| vec![[a, a, 3.0], [b, a, 3.0], [b, b, 3.0], [a, b, 3.0]];
    let mut hole = square(1.0, 2.0);
    hole.reverse();
    let roof = Plane {
        normal: [0.0, 0.0, 1.0],
        offset: 3.0,
        oriented: true,
        points: 3,
        rms: Some(0.0125),
        area: 15.0,
        rings: vec![square(0.0, 4.0), hole],
    };
    let wall = Plane {
        normal: [0.0, -1.0, 0.0],
        offset: 0.0,
        oriented: false,
        points: 0,
        rms: None,
        area: 12.0,
        rings: vec![vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 3.0], [0.0, 0.0, 3.0]]],
    };
    let edge = |kind, polyline: &[[f64; 3]]| Edge { kind, planes: vec![0, 1], polyline: polyline.to_vec(), angle: 1.5 };
    let eave = edge(FeatureKind::Convex, &[[0.0, 0.0, 3.0], [4.0, 0.0, 3.0]]);
    let [a, b, c] = [[1.0, 1.0, 3.0], [2.0, 1.0, 3.0], [2.0, 2.0, 3.0]];
    let rim = edge(FeatureKind::Concave, &[a, b, c, a]);
    let bent = edge(FeatureKind::Unknown, &[a, b, c]);
    let corner = Corner { kind: FeatureKind::Mixed, position: [0.0, 0.0, 3.0], planes: vec![0, 1], edges: vec![0] };
    let point = |plane, class| PointFeature { plane, class };
    Features {
        world_from_local: at,
        crs: Some("EPSG:28992+5709".into()),
        planes: vec![roof, wall],
        edges: vec![eave, rim, bent],
        corners: vec![corner],
        points: vec![
            point(Some(0), FeatureClass::Flat),
            point(Some(1), FeatureClass::Edge),
            point(None, FeatureClass::Unstructured),
            point(Some(0), FeatureClass::Corner),
        ],
    }
}

fn parameters() -> Value {
    json!({ "min_area": 0.5, "scene": "terrain" })
}

/// Writes and returns the content.
fn written(name: &str, features: &Features, cloud: Option<&Cloud>) -> Result<Vec<u8>, IoError> {
    let folder = folder();
    let path = folder.path().join(name);
    let options = WriteOptions { unit: Some(LinearUnit::Metre), ..WriteOptions::default() };
    let report =
        write_features(&path, FeatureOutput { features, cloud, parameters: &parameters(), options: &options })?;
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(report.bytes, bytes.len() as u64);
    Ok(bytes)
}

fn read(text: impl AsRef<[u8]>) -> Result<FeatureFile, IoError> {
    read_features_bytes(Path::new("in.json"), text.as_ref())
}

#[test]
fn json_comes_back_as_it_was() {
    let features = features([0.0; 3]);
    let file = read(written("out.json", &features, None).unwrap()).unwrap();
    assert_eq!((file.unit, &file.parameters), (Some(LinearUnit::Metre), &parameters()));
    let mut back = file.features;
    back.points = features.points.clone();
    for (edge, original) in back.edges.iter_mut().zip(&features.edges) {
        // Degrees there and back.
        assert!((edge.angle - original.angle).abs() < 1e-15);
        edge.angle = original.angle;
    }
    assert_eq!(back, features);
}

#[test]
fn json_holds_world_coordinates_with_all_digits() {
    let far = features([84_810.123_456_7, 447_412.8, -1.5]);
    let bytes = written("out.json", &far, None).unwrap();
    let json: Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(
        (&json["schema_version"], &json["crs"], &json["unit"]),
        (&1.into(), &"EPSG:28992+5709".into(), &"metre".into())
    );
    assert_eq!(json["planes"][0]["polygon"][0][2], json!([84_814.123_456_7, 447_416.8, 1.5]));
    assert_eq!((&json["planes"][0]["offset"], &json["planes"][1]["offset"]), (&1.5.into(), &(-447_412.8).into()));
    assert_eq!((&json["edges"][0]["length"], &json["edges"][2]["length"]), (&4.0.into(), &2.0.into()));
    assert_eq!((&json["edges"][1]["kind"], &json["corners"][0]["kind"]), (&"concave".into(), &"mixed".into()));
    let back = read(&bytes).unwrap().features;
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} is not {b}");
    for (i, plane) in back.planes.iter().enumerate() {
        near(back.world_offset(i), far.world_offset(i));
        for p in plane.rings.iter().flatten() {
            near((0..3).map(|a| plane.normal[a] * p[a]).sum(), plane.offset);
        }
    }
    assert!(back.world_from_local[1] > 4e5, "what is read is local again: {:?}", back.world_from_local);
}

#[test]
fn nothing_found_is_a_file_too() {
    for (suffix, _) in FeatureFormat::KNOWN {
        let cloud = Cloud::default();
        let bytes = written(&format!("out.{suffix}"), &Features::default(), Some(&cloud)).unwrap();
        assert!(!bytes.is_empty(), "{suffix}");
        if *suffix == "json" {
            assert_eq!(read(bytes).unwrap().features, Features::default());
        }
    }
}

#[test]
fn geojson_has_polygons_traces_lines_and_points() {
    let bytes = written("out.geojson", &features([100.0, 200.0, 10.0]), None).unwrap();
    let json: Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(json["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::28992");
    let list = json["features"].as_array().unwrap();
    let kinds: Vec<&str> = list.iter().map(|f| f["geometry"]["type"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["Polygon", "LineString", "LineString", "LineString", "LineString", "Point"]);
    let roof = &list[0]["geometry"]["coordinates"];
    assert_eq!(
        roof[0],
        json!([
            [100.0, 200.0, 13.0],
            [104.0, 200.0, 13.0],
            [104.0, 204.0, 13.0],
            [100.0, 204.0, 13.0],
            [100.0, 200.0, 13.0]
        ])
    );
    assert_eq!((roof.as_array().unwrap().len(), roof[1].as_array().unwrap().len()), (2, 5));
    assert_eq!((&list[0]["properties"]["slope_deg"], &list[0]["properties"]["area"]), (&0.0.into(), &15.0.into()));
    // The wall's trace runs with the wall's outside on its right, at half its height.
    assert_eq!(list[1]["geometry"]["coordinates"], json!([[100.0, 200.0, 11.5], [104.0, 200.0, 11.5]]));
    assert_eq!((&list[1]["properties"]["z_min"], &list[1]["properties"]["z_max"]), (&10.0.into(), &13.0.into()));
    assert_eq!(list[5]["geometry"]["coordinates"], json!([100.0, 200.0, 13.0]));
}

#[test]
fn geojson_keeps_the_right_hand_rule_and_gives_holes_to_their_polygon() {
    let mut found = features([0.0; 3]);
    found.crs = Some("a local grid".into());
    let square = |x: f64, low: f64, high: f64| {
        vec![[x + low, low, 0.0], [x + high, low, 0.0], [x + high, high, 0.0], [x + low, high, 0.0]]
    };
    // Counter-clockwise seen from below, as the normal points down; the second one has the hole.
    let rings = vec![square(0.0, 0.0, 4.0), square(10.0, 0.0, 4.0), square(10.0, 1.0, 2.0)];
    found.planes[0].rings = rings
        .into_iter()
        .enumerate()
        .map(|(i, mut ring)| {
            if i < 2 {
                ring.reverse();
            }
            ring
        })
        .collect();
    found.planes[0].normal = [0.0, 0.0, -1.0];
    let json: Value = serde_json::from_slice(&written("out.geojson", &found, None).unwrap()).unwrap();
    assert_eq!((&json["crs_text"], &json["crs"]), (&"a local grid".into(), &Value::Null));
    let geometry = &json["features"][0]["geometry"];
    assert_eq!(geometry["type"], "MultiPolygon");
    let polygons: Vec<Vec<Vec<[f64; 3]>>> = serde_json::from_value(geometry["coordinates"].clone()).unwrap();
    assert_eq!(polygons.iter().map(Vec::len).collect::<Vec<_>>(), [1, 2]);
    let twice_area = |ring: &[[f64; 3]]| ring.windows(2).map(|s| s[0][0] * s[1][1] - s[1][0] * s[0][1]).sum::<f64>();
    assert_eq!(polygons.concat().iter().map(|ring| twice_area(ring)).collect::<Vec<_>>(), [32.0, 32.0, -2.0]);
}

#[test]
fn obj_has_the_areas_of_the_planes_and_named_groups() {
    let folder = folder();
    let bytes = written("out.obj", &features(SWISS[0]), None).unwrap();
    let path = folder.path().join("again.obj");
    std::fs::write(&path, &bytes).unwrap();
    let mesh = read_mesh(&path).unwrap();
    let area: f64 = mesh
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
            let (u, v): ([f64; 3], [f64; 3]) =
                (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
            let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            0.5 * n.iter().map(|c| c * c).sum::<f64>().sqrt()
        })
        .sum();
    // The roof without its hole, and the wall.
    assert!((area - 27.0).abs() < 0.01, "{area}");
    let text = String::from_utf8(bytes).unwrap();
    let starting = |word: &str| text.lines().filter(|line| line.starts_with(word)).count();
    assert_eq!((starting("f "), starting("l "), starting("p "), starting("v ")), (9, 3, 1, 8 + 4 + 2 + 4 + 3 + 1));
    for group in ["plane_0", "plane_1", "edges_convex", "edges_concave", "edges_unknown", "corners"] {
        assert!(text.lines().any(|line| line == format!("g {group}")), "{group}");
    }
    assert!(text.contains("\nv 2600000.123000 1200000.456000 503.001000\n"), "{text}");
    assert_eq!(mesh.crs.as_deref(), Some("EPSG:28992+5709"));
}

#[test]
fn ply_has_a_plane_and_a_class_at_each_point() {
    let mut source = cloud(GEOREFERENCED);
    let found = features(source.world_from_local);
    let bytes = written("out.ply", &found, Some(&source)).unwrap();
    let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
    assert!(
        head.contains("property uchar classification\nproperty int plane\nproperty uchar feature\nend_header"),
        "{head}"
    );
    let rows: Vec<(i32, u8)> = bytes[end..]
        .chunks((bytes.len() - end) / 4)
        .map(|row| {
            let tail = &row[row.len() - 5..];
            (i32::from_le_bytes(tail[..4].try_into().unwrap()), tail[4])
        })
        .collect();
    assert_eq!(rows, [(0, 1), (1, 2), (-1, 0), (0, 3)]);
    // It is a cloud as before for every program, this one too.
    let back = zeroset_io::read_cloud_bytes(Path::new("a.ply"), zeroset_io::CloudFormat::Ply, bytes).unwrap().cloud;
    assert_eq!(back.attributes, source.attributes);
    // Without colours, those of the planes show.
    source.attributes.colors = None;
    let bytes = written("out.ply", &found, Some(&source)).unwrap();
    let back = zeroset_io::read_cloud_bytes(Path::new("a.ply"), zeroset_io::CloudFormat::Ply, bytes).unwrap().cloud;
    let colors = back.attributes.colors.unwrap();
    assert!(colors[0] == colors[3] && colors[0] != colors[1] && colors[2] == [150; 3], "{colors:?}");
}

#[test]
fn ply_asks_for_the_points_that_belong_to_the_features() {
    let source = cloud(GEOREFERENCED);
    let mut found = features(source.world_from_local);
    let said = written("out.ply", &found, None).unwrap_err().to_string();
    assert!(said.contains("write json, geojson, obj or dxf"), "{said}");
    found.points.pop();
    let said = written("out.ply", &found, Some(&source)).unwrap_err().to_string();
    assert!(said.contains("3 features for 4 points"), "{said}");
}

#[test]
fn dxf_is_what_another_program_reads() {
    use dxf::entities::EntityType;
    let bytes = written("out.dxf", &features(SWISS[0]), None).unwrap();
    let drawing = dxf::Drawing::load(&mut &bytes[..]).unwrap();
    assert_eq!(drawing.header.version, dxf::enums::AcadVersion::R12);
    let layers: Vec<&str> = drawing.layers().map(|layer| layer.name.as_str()).collect();
    for layer in ["PLANES", "EDGES_CONVEX", "EDGES_CONCAVE", "CORNERS"] {
        assert!(layers.contains(&layer), "{layers:?}");
    }
    let mut seen = Vec::new();
    for entity in drawing.entities() {
        let layer = entity.common.layer.clone();
        seen.push(match &entity.specific {
            EntityType::Polyline(line) => {
                assert!(line.is_3d_polyline());
                (layer, line.is_closed(), line.vertices().count())
            }
            EntityType::Line(line) => {
                assert_eq!((line.p1.x, line.p2.x, line.p1.z), (2_600_000.123, 2_600_004.123, 503.001));
                (layer, false, 2)
            }
            EntityType::ModelPoint(point) => {
                assert_eq!((point.location.x, point.location.y), (2_600_000.123, 1_200_000.456));
                (layer, false, 1)
            }
            other => panic!("{other:?}"),
        });
    }
    let seen: Vec<_> = seen.iter().map(|(layer, closed, count)| (layer.as_str(), *closed, *count)).collect();
    assert_eq!(
        seen,
        [
            ("PLANES", true, 4),
            ("PLANES", true, 4),
            ("PLANES", true, 4),
            ("EDGES_CONVEX", false, 2),
            ("EDGES_CONCAVE", true, 3),
            ("EDGES_UNKNOWN", false, 3),
            ("CORNERS", false, 1),
        ]
    );
}

#[test]
fn equal_features_give_equal_bytes() {
    let source = cloud(GEOREFERENCED);
    let found = features(source.world_from_local);
    for (suffix, _) in FeatureFormat::KNOWN {
        let name = format!("out.{suffix}");
        assert_eq!(written(&name, &found, Some(&source)).unwrap(), written(&name, &found, Some(&source)).unwrap());
    }
}

/// Makes sound features unsound.
type Spoil = fn(&mut Features);

#[test]
fn what_is_not_finite_is_not_written() {
    let sound = features([0.0; 3]);
    let spoil: [(&str, Spoil); 12] = [
        ("plane 0 has a normal of length", |f| f.planes[0].normal[2] = f64::NAN),
        ("plane 1 has a normal of length 0", |f| f.planes[1].normal = [0.0; 3]),
        ("plane 0 has the offset", |f| f.planes[0].offset = f64::INFINITY),
        ("plane 1 has the area", |f| f.planes[1].area = f64::NAN),
        ("plane 0 has the rms", |f| f.planes[0].rms = Some(-1.0)),
        ("plane 0 has the coordinate", |f| f.planes[0].rings[1][2][0] = f64::NAN),
        ("plane 0 has a ring of 2 positions", |f| f.planes[0].rings[1].truncate(2)),
        ("edge 1 has the angle", |f| f.edges[1].angle = f64::NAN),
        ("edge 2 has 1 positions", |f| f.edges[2].polyline.truncate(1)),
        ("edge 0 names plane 2 of 2", |f| f.edges[0].planes.push(2)),
        ("corner 0 has the coordinate 1e12", |f| f.corners[0].position[1] = 1e12),
        ("corner 0 names edge 7 of 3", |f| f.corners[0].edges.push(7)),
    ];
    for (expected, spoil) in spoil {
        let mut spoiled = sound.clone();
        spoil(&mut spoiled);
        for (suffix, _) in FeatureFormat::KNOWN {
            let said = written(&format!("out.{suffix}"), &spoiled, None).unwrap_err().to_string();
            assert!(said.contains(expected) && said.lines().count() == 1, "{said}");
        }
    }
}

#[test]
fn bad_json_is_one_line_with_a_remedy() {
    let sound = String::from_utf8(written("out.json", &features([0.0; 3]), None).unwrap()).unwrap();
    let replaced = |from: &str, to: &str| {
        assert!(sound.contains(from), "{from}");
        sound.replacen(from, to, 1)
    };
    for (text, expected) in [
        (String::new(), "the file is empty"),
        ("[1]".into(), "not a JSON file"),
        ("# .PCD v0.7".into(), "it looks like PCD"),
        (r#"{"points": [[1, 2]]}"#.into(), "no `schema_version`"),
        (replaced("\"schema_version\":1", "\"schema_version\":2"), "schema_version 2 of features is not supported"),
        (replaced("\"schema_version\":1", "\"schema_version\":\"1\""), "invalid type"),
        (replaced("\"oriented\":true,", ""), "missing field `oriented`"),
        (replaced("\"rms\":0.0125", "\"rms\":NaN"), "not JSON"),
        (replaced("\"rms\":0.0125", "\"rms\":1e999"), "number out of range"),
        (replaced("\"rms\":0.0125", "\"rms\":-1"), "plane 0 has the rms -1"),
        (replaced("\"normal\":[0.0,0.0,1.0]", "\"normal\":[0,0,2]"), "plane 0 has a normal of length 2"),
        (replaced("\"normal\":[0.0,0.0,1.0]", "\"normal\":[0,1]"), "invalid length 2"),
        (replaced("\"id\":1", "\"id\":4"), "plane 1 of the list has the id 4"),
        (replaced("\"kind\":\"concave\"", "\"kind\":\"round\""), "unknown variant `round`"),
        (replaced("\"planes\":[0,1]", "\"planes\":[0,-1]"), "invalid value"),
        (replaced("\"planes\":[0,1]", "\"planes\":[0,9]"), "edge 0 names plane 9 of 2"),
        (sound[..sound.len() / 2].to_string(), "cut short"),
    ] {
        let said = read(&text).unwrap_err().to_string();
        assert!(said.contains(expected), "{said} does not say {expected}");
        assert!(said.starts_with("in.json: ") && said.contains("; ") && said.lines().count() == 1, "{said}");
    }
    assert!(read(replaced("\"unit\":\"metre\"", "\"unit\":null,\"more\":{}")).is_ok_and(|file| file.unit.is_none()));
    assert!(read(format!("\u{feff}{sound}")).is_ok());
}

#[test]
fn other_formats_are_not_read_and_unknown_ones_are_listed() {
    let said = read_features(Path::new("a.dxf")).unwrap_err().to_string();
    assert!(said.contains("DXF") && said.contains("json"), "{said}");
    let said = read_features(Path::new("a.shp")).unwrap_err().to_string();
    assert!(said.contains("json, geojson, obj, ply, dxf"), "{said}");
    assert!(matches!(read_features(Path::new("/no/such.json")), Err(IoError::NotFound { .. })));
}

proptest! {
    #[test]
    fn no_content_makes_the_reader_panic(cut in 0_usize..4000, patch in "[\\[\\]{},:\"0-9.eE+\\- \na-z]{0,40}") {
        let sound = String::from_utf8(written("out.json", &features([0.0; 3]), None).unwrap()).unwrap();
        let cut = cut % sound.len();
        let rest = &sound[(cut + patch.len()).min(sound.len())..];
        if let Err(error) = read(format!("{}{patch}{rest}", &sound[..cut])) {
            prop_assert_eq!(error.to_string().lines().count(), 1);
        }
    }
}
