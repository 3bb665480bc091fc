//! Data in the plane: what is read, what is refused, and that no content makes the readers panic.

use std::path::Path;

use proptest::prelude::*;
use zeroset_io::planar::WeightedPoint;
use zeroset_io::{IoError, PlanarData, PlanarFormat, PlanarResult, planar_json, read_planar_bytes};

fn read(suffix: &str, text: impl AsRef<[u8]>) -> Result<PlanarData, IoError> {
    let name = format!("in.{suffix}");
    let path = Path::new(&name);
    read_planar_bytes(path, PlanarFormat::from_path(path)?, text.as_ref())
}

fn point(x: f64, y: f64, weight: f64) -> WeightedPoint {
    WeightedPoint { position: [x, y], weight }
}

#[test]
fn json_holds_all_kinds() {
    let text = r#"{"points": [[1, 2], [3e0, -4.5, 0.25]], "segments": [[[0, 0], [1, 1]]],
        "polygons": [[[0, 0], [1, 0], [0, 1]]], "domain": {"vertices": [[0, 0], [9, 0], [0, 9]], "triangles": [[0, 1, 2]]}}"#;
    let data = read("json", text).unwrap();
    assert_eq!(data.points, [point(1.0, 2.0, 1.0), point(3.0, -4.5, 0.25)]);
    assert_eq!(data.segments, [[[0.0, 0.0], [1.0, 1.0]]]);
    assert_eq!(data.polygons, [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]]);
    assert_eq!(data.domain.unwrap().triangles, [[0, 1, 2]]);
    assert_eq!(data.points.len() + data.segments.len() + data.polygons.len(), 4);
}

#[test]
fn numbers_pass_exactly() {
    let x = 84_810.123_456_789;
    assert_eq!(read("json", format!("{{\"points\": [[{x}, 0.1]]}}")).unwrap().points, [point(x, 0.1, 1.0)]);
    assert_eq!(read("csv", format!("{x},0.1\n")).unwrap().points, [point(x, 0.1, 1.0)]);
}

#[test]
fn text_with_and_without_names() {
    let both = [point(1.0, 2.0, 1.0), point(3.0, 4.0, 1.0)];
    for text in [
        "1,2\n3,4",
        "1 2\n\n# c\n3\t4\n",
        "x,y\n1,2\n3,4",
        "1; 2\r\n3; 4\r\n",
        "1 2\r3 4\r",
        "id,Northing,Easting\n7,2,1\n8,4,3\n",
    ] {
        assert_eq!(read("csv", text).unwrap().points, both, "{text}");
    }
    assert_eq!(read("txt", "1 2 0.5\n").unwrap().points, [point(1.0, 2.0, 0.5)]);
    assert_eq!(read("csv", "weight,x,y\n0.5,1,2\n").unwrap().points, [point(1.0, 2.0, 0.5)]);
}

#[test]
fn a_stream_is_told_by_its_first_character() {
    let stream = |text: &str| read_planar_bytes(Path::new("-"), PlanarFormat::Stream, text.as_bytes()).unwrap();
    assert_eq!(stream("1 2\n"), stream(" {\"points\": [[1, 2]]}"));
}

#[test]
fn a_long_list_takes_no_memory_and_is_named() {
    let text = format!("{{\"points\": [[1, 2], [{}0]]}}", "0,".repeat(1_000_000));
    let said = read("json", text).unwrap_err().to_string();
    assert!(said.contains("point 1 has 1000001 numbers"), "{said}");
}

#[test]
fn results_are_json_with_exact_numbers() {
    let result =
        PlanarResult { rayleigh_quotient: 0.1 + 0.2, contour: vec![vec![[1.0, 2.0]]], ..PlanarResult::default() };
    let text = planar_json(&result);
    assert!(
        text.contains("\"rayleigh_quotient\":0.30000000000000004") && text.contains("\"contour\":[[[1.0,2.0]]]"),
        "{text}"
    );
    assert!(text.contains("\"eigenvalue\":null") && text.ends_with("}\n"));
}

proptest! {
    #[test]
    fn no_content_makes_a_reader_panic(text in "[\\[\\]{},:\"0-9.eE+\\- \na-z#;]{0,80}", keyed in any::<bool>()) {
        let text = if keyed { format!("{{\"points\": [[1, 2], {text}") } else { text };
        for suffix in ["json", "csv"] {
            if let Err(error) = read(suffix, &text) {
                prop_assert_eq!(error.to_string().lines().count(), 1);
            }
        }
    }
}
