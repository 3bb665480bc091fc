//! Sections and contour lines as SVG, DXF and GeoJSON.

use std::path::Path;

use crate::common::folder;
use serde_json::{Value, json};
use zeroset_io::{
    IoError, LinearUnit, Section, SectionFormat, SectionLevel, SectionLine, SectionPlane, WriteOptions,
    read_constraints, write_section,
};

const ORIGIN: [f64; 3] = [84_800.0, 447_400.0, 2.0];

fn ring(positions: &[[f64; 3]]) -> SectionLine {
    SectionLine { positions: positions.to_vec(), closed: true }
}

/// An upright cut through a wall with a window, looking north, and the ground beside it.
fn cut() -> Section {
    let at = |x: f64, z: f64| [x, 5.0, z];
    let wall = ring(&[at(0.0, 0.0), at(8.0, 0.0), at(8.0, 3.0), at(4.0, 5.0), at(0.0, 3.0)]);
    let window = ring(&[at(1.0, 1.0), at(1.0, 2.0), at(2.0, 2.0), at(2.0, 1.0)]);
    let ground = SectionLine { positions: vec![at(-3.0, 0.25), at(-1.0, 0.0), at(0.0, 0.0)], closed: false };
    let plane = SectionPlane { point: [0.0, 5.0, 0.0], normal: [0.0, -1.0, 0.0] };
    let levels = vec![SectionLevel { plane, height: None, lines: vec![wall, window, ground] }];
    Section { world_from_local: ORIGIN, crs: Some("EPSG:28992+5709".into()), levels }
}

/// Contour lines of a cone.
fn contours() -> Section {
    let level = |i: u32| {
        let (z, radius) = (0.5 * f64::from(i), 10.0 - 0.5 * f64::from(i));
        let angle = |j: u32| std::f64::consts::TAU * f64::from(j) / 60.0;
        let positions = (0..60).map(|j| [radius * angle(j).cos(), radius * angle(j).sin(), z]).collect();
        let plane = SectionPlane { point: [0.0, 0.0, z], normal: [0.0, 0.0, 1.0] };
        SectionLevel { plane, height: Some(ORIGIN[2] + z), lines: vec![SectionLine { positions, closed: true }] }
    };
    Section { levels: (0..18).map(level).collect(), ..cut() }
}

fn written(name: &str, section: &Section) -> Result<String, IoError> {
    let folder = folder();
    let path = folder.path().join(name);
    let options = WriteOptions { unit: Some(LinearUnit::Metre), ..WriteOptions::default() };
    let report = write_section(&path, section, &options)?;
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(report.bytes, text.len() as u64);
    Ok(text)
}

#[test]
fn geojson_has_lines_in_world_coordinates() {
    let json: Value = serde_json::from_str(&written("a.geojson", &cut()).unwrap()).unwrap();
    assert_eq!(json["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::28992");
    let lines = json["features"].as_array().unwrap();
    assert_eq!(lines.len(), 3);
    assert_eq!(lines[0]["properties"], json!({ "level": 1, "closed": true }));
    assert_eq!(lines[2]["properties"]["closed"], false);
    let window = &lines[1]["geometry"];
    assert_eq!(window["type"], "LineString");
    let corner = json!([84_801.0, 447_405.0, 3.0]);
    assert_eq!((window["coordinates"].as_array().unwrap().len(), &window["coordinates"][0]), (5, &corner));
    assert_eq!(window["coordinates"][4], corner);
    let json: Value = serde_json::from_str(&written("a.geojson", &contours()).unwrap()).unwrap();
    assert_eq!(json["features"][3]["properties"], json!({ "level": 4, "closed": true, "height": 3.5 }));
    let lost = Section { crs: Some("a local grid".into()), ..cut() };
    let json: Value = serde_json::from_str(&written("a.geojson", &lost).unwrap()).unwrap();
    assert_eq!((json.get("crs"), &json["crs_text"]), (None, &"a local grid".into()));
}

#[test]
fn dxf_has_polylines_on_layers() {
    let text = written("a.dxf", &contours()).unwrap();
    let drawing = dxf::Drawing::load(&mut text.as_bytes()).unwrap();
    let layers: Vec<&str> = drawing.layers().map(|layer| layer.name.as_str()).collect();
    assert!(layers.contains(&"CONTOUR_2") && layers.contains(&"CONTOUR_2_5"), "{layers:?}");
    let polylines: Vec<_> = drawing
        .entities()
        .filter_map(|entity| match &entity.specific {
            dxf::entities::EntityType::Polyline(line) => Some((entity.common.layer.clone(), line)),
            _ => None,
        })
        .collect();
    assert_eq!(polylines.len(), 18);
    let (layer, line) = &polylines[1];
    assert!(layer == "CONTOUR_2_5" && line.is_closed() && line.is_3d_polyline());
    let first = &line.vertices().next().unwrap().location;
    assert_eq!([first.x, first.y, first.z], [84_809.5, 447_400.0, 2.5]);
    let text = written("a.dxf", &cut()).unwrap();
    assert!(text.contains("\nSECTION_1\n") && text.contains("999\ncrs EPSG:28992+5709\n"));
}

#[test]
fn what_is_written_is_read_as_constraints() {
    let folder = folder();
    for (name, section) in [("a.dxf", cut()), ("a.geojson", cut()), ("b.dxf", contours())] {
        let path = folder.path().join(name);
        write_section(&path, &section, &WriteOptions::default()).unwrap();
        assert_eq!(read_constraints(&path).unwrap().passed_over, 0, "{name}");
    }
}

#[test]
fn svg_is_to_scale_with_round_figures() {
    let text = written("a.svg", &cut()).unwrap();
    // 11 units and 4 % on either side make 800 pixels.
    assert!(text.contains("matrix(67.34006734006732 0 0 -67.34"), "{text}");
    assert!(
        text.contains("Coordinates of curves count in metre, to the right and up from x 84798, height 2"),
        "{text}"
    );
    for expected in [
        "\n84800\n",
        "\nx (m)\n",
        "\nheight (m)\n",
        "\n2 m\n",
        "M2 0L10 0L10 3L6 5L2 3Z",
        "evenodd",
        "crs EPSG:28992+5709",
    ] {
        assert!(text.contains(expected), "{expected} is not in {text}");
    }
    // The open line is no part of the solid: the paths of a level are two.
    assert_eq!((text.matches("<path").count(), text.matches('Z').count()), (2, 2));
}

#[test]
fn svg_of_contour_lines_is_a_map() {
    let text = written("a.svg", &contours()).unwrap();
    assert!(text.contains("\ny (m)\n") && text.contains("\n447400\n") && !text.contains("evenodd"));
    // Of 18 heights from 2 to 10.5 those of whole multiples of 2 are labelled.
    let labels: Vec<&str> =
        text.split("id=\"heights\"").nth(1).unwrap().split("</g>").next().unwrap().lines().collect();
    let found = |height: &str| labels.contains(&height);
    assert!(found("4") && found("10") && !found("2.5") && !found("3"), "{labels:?}");
}

#[test]
fn nothing_is_a_picture_too() {
    for name in ["a.svg", "a.dxf", "a.geojson"] {
        let text = written(name, &Section::default()).unwrap();
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        let mut empty = cut();
        empty.levels[0].lines.clear();
        let text = written(name, &empty).unwrap();
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
}

#[test]
fn equal_sections_are_equal_files() {
    for name in ["a.svg", "a.dxf", "a.geojson"] {
        assert_eq!(written(name, &contours()).unwrap(), written(name, &contours()).unwrap());
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let level = |change: &dyn Fn(&mut SectionLevel)| {
        let mut section = cut();
        change(&mut section.levels[0]);
        section
    };
    let mut turned = cut();
    turned.levels.extend(contours().levels);
    let cases = [
        (level(&|level| level.lines[0].positions[1][2] = f64::NAN), "position"),
        (level(&|level| level.lines[0].positions[1][0] = 1e12), "position"),
        (level(&|level| level.lines[0].positions.truncate(2)), "2 positions, fewer than 3"),
        (level(&|level| level.lines[2].positions.truncate(1)), "1 positions, fewer than 2"),
        (level(&|level| level.plane.normal = [0.0, 0.0, 2.0]), "normal of length 2"),
        (level(&|level| level.plane.point[0] = f64::INFINITY), "finite place"),
        (level(&|level| level.height = Some(f64::NAN)), "finite place"),
        (Section { world_from_local: [f64::NAN; 3], ..cut() }, "finite place"),
        (turned.clone(), "planes 1 and 2 are not parallel"),
    ];
    for (section, expected) in cases {
        let text = written("a.svg", &section).unwrap_err().to_string();
        assert!(text.contains(expected) && text.lines().count() == 1, "{text}");
    }
    assert!(written("a.dxf", &turned).is_ok());
    assert!(matches!(SectionFormat::from_path(Path::new("a.png")), Err(IoError::UnknownSuffix { .. })));
}
