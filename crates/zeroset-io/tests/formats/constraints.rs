//! Lines and polygons of the user: what every format gives, what is refused, and that no content makes a reader panic.

use std::path::Path;

use crate::common::{GEOREFERENCED, folder};
use proptest::prelude::*;
use zeroset::feature::{Edge, FeatureKind, Features, Plane};
use zeroset_io::{
    ConstraintFile, ConstraintFormat, FeatureOutput, IoError, WriteOptions, read_constraints, read_constraints_bytes,
    read_footprints_bytes, write_features,
};

fn read(suffix: &str, text: &str) -> Result<ConstraintFile, IoError> {
    let name = format!("known.{suffix}");
    let path = Path::new(&name);
    read_constraints_bytes(path, ConstraintFormat::from_path(path)?, text.as_bytes())
}

/// Lines, polygons and what was passed over.
fn counts(file: &ConstraintFile) -> (usize, usize, usize) {
    (file.constraints.lines(), file.constraints.polygons(), file.passed_over)
}

/// One line that names the file and has a remedy.
#[track_caller]
fn refused(suffix: &str, text: &str, part: &str) {
    let said = read(suffix, text).expect_err("it is refused").to_string();
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.starts_with(&format!("known.{suffix}: ")) && said.contains("; "), "{said}");
    assert!(said.contains(part), "{said} does not say {part}");
}

const OBJ: &str = "# crs EPSG:28992\nv 0 0 0\nv 4 0 0\nv 4 3 0 1 0 0\nv 2 4 0\nv 0 3 0\nv 9 9 9\n\
    f 1/1/1 2//2 3 \\\n4 5\nl 1 2 -1\np 6\nf 1 1 2\n";

#[test]
fn obj() {
    let file = read("obj", OBJ).unwrap();
    assert_eq!(counts(&file), (1, 1, 2));
    assert_eq!(file.constraints.bounds(), Some([[0.0; 3], [9.0; 3]]));
    assert_eq!((file.crs.as_deref(), file.epsg()), (Some("EPSG:28992"), Some(28992)));
    refused("obj", "v 0 0 0\nv 1 0 0\nl 1 7\n", "vertex 7 of 2");
    refused("obj", "v 0 0 0\nv 1 0 0\nl 1 x\n", "not a number");
    refused("obj", "v 0 0\nv 1 0\nl 1 2\n", "ends before its last value");
    refused("obj", "v 0 0 nan\nv 1 0 0\nl 1 2\n", "not finite");
    refused("obj", "v 0 0 1e30\nv 1 0 0\nl 1 2\n", "too large");
    refused("obj", "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 1 2 3 4\n", "not plane");
    refused("obj", "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n", "cross");
    refused("obj", "v 0 0 0\np 1\n", "no lines or polygons in it, only 1");
    refused("obj", "{}", "not a OBJ file");
}

/// Numbers of rings of the footprints of closed lines, each given by its lowest and highest corner.
fn footprints(boxes: &[[f64; 4]]) -> Vec<usize> {
    let ring = |[a, b, c, d]: &[f64; 4]| format!("[[{a},{b}],[{c},{b}],[{c},{d}],[{a},{d}],[{a},{b}]]");
    let lines = boxes.iter().map(ring).collect::<Vec<_>>().join(",");
    let text = format!(r#"{{"type":"MultiLineString","coordinates":[{lines}]}}"#);
    let found = read_footprints_bytes(Path::new("plan.geojson"), ConstraintFormat::GeoJson, text.as_bytes()).unwrap();
    assert!(found.iter().flatten().all(|ring| ring.len() == 4));
    found.iter().map(Vec::len).collect()
}

#[test]
fn closed_lines_in_others_are_holes() {
    let house = [84_800.0, 447_400.0, 84_810.0, 447_410.0];
    let court = [84_802.0, 447_402.0, 84_808.0, 447_408.0];
    let shed = [84_803.0, 447_403.0, 84_804.0, 447_404.0];
    let neighbor = [84_810.0, 447_400.0, 84_815.0, 447_410.0];
    assert_eq!(footprints(&[house]), [1]);
    assert_eq!(footprints(&[court, shed, house, neighbor]), [1, 2, 1]);
    // A hole that touches its outline from within, and one house drawn twice.
    assert_eq!(footprints(&[house, [84_800.0, 447_402.0, 84_803.0, 447_403.0]]), [2]);
    assert_eq!(footprints(&[house, house]), [1, 1]);
}

#[test]
fn geojson() {
    let text = r#"{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::28992"}},
        "features":[
        {"type":"Feature","properties":null,"geometry":{"type":"MultiLineString","coordinates":[[[0,0,1],[1,0,1]],[[2,0,1],[3,0,1]]]}},
        {"type":"Feature","properties":{"a":1},"geometry":{"type":"GeometryCollection","geometries":[
            {"type":"LineString","coordinates":[[0,0,1],[1,0,1],[1,1,2,77]]},{"type":"Point","coordinates":[1,2]}]}},
        {"type":"Feature","properties":null,"geometry":null},
        {"type":"Feature","properties":null,"geometry":{"type":"MultiPolygon","coordinates":[
            [[[0,0,5],[9,0,5],[9,9,5],[0,9,5],[0,0,5]],[[3,3,5],[6,3,5],[6,6,5],[3,3,5]]]]}}]}"#;
    for suffix in ["geojson", "json"] {
        let file = read(suffix, text).unwrap();
        assert_eq!(counts(&file), (3, 1, 2), "{suffix}");
        assert_eq!(file.epsg(), Some(28992));
        let all = file.constraints.within([[0.0; 3], [9.0; 3]]);
        assert!((all.area - (81.0 - 4.5)).abs() < 1e-9 && all.length > 4.0, "{all:?}");
    }
    let line = |positions: &str| format!(r#"{{"type":"LineString","coordinates":{positions}}}"#);
    assert_eq!(counts(&read("geojson", &line("[[0,0,1],[1,0,1]]")).unwrap()), (1, 0, 0));
    refused("geojson", &line("[[0,0],[1,0]]"), "without heights");
    refused("geojson", &line("[[0,0,1],[1,0,1e40]]"), "too large");
    refused("geojson", &line("[[0,0,1]]"), "no lines or polygons");
    refused("geojson", &line("[[0,0,NaN],[1,0,1]]"), "not JSON");
    refused("geojson", &line("[[0,0,1],[1,0,1]"), "known.geojson");
    refused("geojson", r#"{"type":"Polygon","coordinates":[[[0,0,0],[1,0,0],[1,1,1],[0,1,0],[0,0,0]]]}"#, "not plane");
    refused("geojson", r#"{"type":"FeatureCollection","features":[]}"#, "no lines or polygons");
    refused("geojson", "[1,2]", "not a GeoJSON file");
    refused("json", r#"{"a":1}"#, "schema_version");
}

/// A drawing of these entities, as pairs of lines between bars.
fn drawing(entities: &str) -> String {
    let release = "0|SECTION|2|HEADER|9|$ACADVER|1|AC1015|0|ENDSEC|";
    format!("{release}0|SECTION|2|ENTITIES|{entities}0|ENDSEC|0|EOF|").replace('|', "\n")
}

#[test]
fn dxf() {
    let line = "0|LINE|8|0|10|1.0|20|2.0|30|3.0|11|4.0|21|2.0|31|3.0|";
    let light = "0|LWPOLYLINE|8|0|90|2|70|1|38|7.5|10|0.0|20|0.0|42|1.0|10|2.0|20|0.0|42|1.0|";
    let face = "0|3DFACE|8|0|10|0.0|20|0.0|30|1.0|11|1.0|21|0.0|31|1.0|12|1.0|22|1.0|32|1.0|13|1.0|23|1.0|33|1.0|";
    let point = "0|POINT|8|0|10|0.0|20|0.0|30|1.0|";
    let file = read("dxf", &drawing(&[line, light, face, point].concat())).unwrap();
    assert_eq!(counts(&file), (2, 1, 1));
    // Two half circles of radius 1, at their height.
    let circle = read("dxf", &drawing(light)).unwrap();
    let [low, high] = circle.constraints.bounds().unwrap();
    assert_eq!((low[2], high[2]), (7.5, 7.5));
    for (found, expected) in low.into_iter().chain(high).zip([0.0, -1.0, 7.5, 2.0, 1.0, 7.5]) {
        assert!((found - expected).abs() < 1e-12, "{low:?} {high:?}");
    }
    let length = circle.constraints.within([[-9.0; 3], [9.0; 3]]).length;
    assert!((length - std::f64::consts::TAU).abs() < 0.01, "{length}");
    // Extruded along -y: x stays, y points up.
    let upright = "0|LWPOLYLINE|8|0|90|2|70|0|38|5.0|10|1.0|20|2.0|10|3.0|20|4.0|210|0.0|220|-1.0|230|0.0|";
    let bounds = read("dxf", &drawing(upright)).unwrap().constraints.bounds();
    assert_eq!(bounds, Some([[1.0, -5.0, 2.0], [3.0, -5.0, 4.0]]));
    let vertex = |flags: u32, rest: &str| format!("0|VERTEX|8|0|{rest}70|{flags}|");
    let at = |x: &str, y: &str| format!("10|{x}|20|{y}|30|2.0|");
    let polyface = [
        "0|POLYLINE|8|0|66|1|70|64|10|0.0|20|0.0|30|0.0|71|3|72|1|".to_owned(),
        vertex(192, &at("0.0", "0.0")),
        vertex(192, &at("1.0", "0.0")),
        vertex(192, &at("0.0", "1.0")),
        vertex(128, "10|0.0|20|0.0|30|0.0|71|1|72|-2|73|3|"),
        "0|SEQEND|8|0|".to_owned(),
    ];
    let faces = read("dxf", &drawing(&polyface.concat())).unwrap();
    assert_eq!((counts(&faces), faces.constraints.bounds()), ((0, 1, 0), Some([[0.0, 0.0, 2.0], [1.0, 1.0, 2.0]])));
    refused("dxf", &drawing(&polyface.concat()).replace("73\n3\n", "73\n9\n"), "vertex 9 of 3");
    refused("dxf", &drawing(&line.replace("31|3.0", "31|nan")), "known.dxf");
    refused("dxf", &drawing(&line.replace("31|3.0", "31|1e20")), "too large");
    refused("dxf", &drawing(&face.replace("33|1.0", "33|2.0").replace("13|1.0", "13|0.0")), "not plane");
    refused("dxf", &drawing(point), "only 1 other items");
    refused("dxf", "{\"type\":1}", "not a DXF file");
    refused("dxf", "0\nSECTION\n2\nENTITIES\n0\nLINE\n10\nabc\n", "known.dxf");
}

#[test]
fn suffixes_and_empty_files() {
    assert!(read("shp", "x").unwrap_err().to_string().contains("obj, geojson, json, dxf"));
    for (suffix, _) in ConstraintFormat::KNOWN {
        refused(suffix, "", "empty");
    }
}

#[test]
fn features_that_were_written_come_back() {
    let at = GEOREFERENCED[0];
    let square = |a: f64, b: f64| vec![[a, a, 3.0], [b, a, 3.0], [b, b, 3.0], [a, b, 3.0]];
    let mut hole = square(1.0, 2.0);
    hole.reverse();
    let roof = Plane {
        normal: [0.0, 0.0, 1.0],
        offset: 3.0,
        area: 15.0,
        rings: vec![square(0.0, 4.0), hole],
        ..Plane::default()
    };
    let wall = Plane {
        normal: [0.0, -1.0, 0.0],
        area: 12.0,
        rings: vec![vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 3.0], [0.0, 0.0, 3.0]]],
        ..Plane::default()
    };
    let edge = |polyline: &[[f64; 3]]| Edge {
        kind: FeatureKind::Convex,
        planes: vec![0],
        polyline: polyline.to_vec(),
        angle: 1.5,
    };
    let [a, b, c] = [[1.0, 1.0, 3.0], [2.0, 1.0, 3.0], [2.0, 2.0, 3.0]];
    let features = Features {
        world_from_local: at,
        crs: Some("EPSG:28992".into()),
        planes: vec![roof, wall],
        edges: vec![edge(&[a, b]), edge(&[a, b, c, a])],
        ..Features::default()
    };
    let options = WriteOptions::default();
    let parameters = serde_json::Value::Null;
    let output = FeatureOutput { features: &features, cloud: None, parameters: &parameters, options: &options };
    let folder = folder();
    // Upright planes are lines in GeoJSON, and rings are lines in DXF.
    for (suffix, expected, area) in
        [("json", (2, 2), 27.0), ("obj", (2, 9), 27.0), ("geojson", (3, 1), 15.0), ("dxf", (5, 0), 0.0)]
    {
        let path = folder.path().join(format!("features.{suffix}"));
        write_features(&path, output).unwrap();
        let file = read_constraints(&path).unwrap();
        assert_eq!((file.constraints.lines(), file.constraints.polygons()), expected, "{suffix}");
        assert_eq!(file.epsg(), Some(28992), "{suffix}");
        let bounds = [at, [at[0] + 4.0, at[1] + 4.0, at[2] + 3.0]];
        let found = file.constraints.bounds().unwrap();
        for (found, expected) in found.into_iter().flatten().zip(bounds.into_iter().flatten()) {
            let low = if suffix == "dxf" || suffix == "json" || suffix == "obj" { 1e-3 } else { 1.6 };
            assert!((found - expected).abs() < low, "{suffix} {found} {expected}");
        }
        assert!((file.constraints.within(bounds).area - area).abs() < 1e-3, "{suffix}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn no_content_makes_a_reader_panic(at in 0_usize..400, byte: u8, cut in 0_usize..400) {
        let geojson = r#"{"type":"Polygon","coordinates":[[[0,0,1],[4,0,1],[4,4,1],[0,0,1]]],"crs":{"properties":{"name":3}}}"#;
        let light = "0|LWPOLYLINE|8|0|90|2|70|1|38|7.5|10|0.0|20|0.0|42|1.0|10|2.0|20|0.0|42|1.0|";
        for (suffix, text) in [("obj", OBJ.to_owned()), ("geojson", geojson.to_owned()), ("json", geojson.to_owned()), ("dxf", drawing(light))] {
            let name = format!("known.{suffix}");
            let format = ConstraintFormat::from_path(Path::new(&name)).unwrap();
            let mut bytes = text.into_bytes();
            let place = at % bytes.len();
            bytes[place] = byte;
            for bytes in [&bytes[..], &bytes[..cut.min(bytes.len())]] {
                if let Err(error) = read_constraints_bytes(Path::new(&name), format, bytes) {
                    prop_assert_eq!(error.to_string().lines().count(), 1);
                }
            }
        }
    }
}
