//! `fit2d`: curves through data in the plane.

use std::path::Path;

use crate::common::{Outcome, entries, folder, line, with_input};
use serde_json::{Value, json};

/// The paper's first example.
const THIRTEEN: [[f64; 2]; 13] = [
    [0.44, 0.13],
    [0.24, 0.15],
    [0.22, 0.35],
    [0.31, 0.49],
    [0.35, 0.60],
    [0.43, 0.70],
    [0.51, 0.77],
    [0.57, 0.70],
    [0.70, 0.55],
    [0.85, 0.30],
    [0.88, 0.23],
    [0.80, 0.10],
    [0.60, 0.10],
];

fn csv() -> String {
    THIRTEEN.iter().map(|[x, y]| format!("{x},{y}\n")).collect()
}

fn put(folder: &Path, name: &str, text: impl AsRef<[u8]>) {
    std::fs::write(folder.join(name), text).unwrap();
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

fn figures(outcome: Outcome) -> Value {
    serde_json::from_str(&outcome.ok().stdout).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// Forty points on a circle.
fn circle() -> Vec<[f64; 2]> {
    let point = |i: i32| {
        let angle = f64::from(i) * std::f64::consts::TAU / 40.0;
        [2.0 + angle.cos(), 1.0 + angle.sin()]
    };
    (0..40).map(point).collect()
}

#[track_caller]
fn assert_paper(found: &Value) {
    assert!((found["eigenvalue"].as_f64().unwrap() - 0.043_397_2).abs() < 1e-7, "{found}");
    for (found, expected) in
        numbers(&found["coefficients"]).iter().zip([0.165_637, 0.092_039, 0.352_474, 0.840_197, -0.365_958])
    {
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
    assert_eq!(found["nodes"], json!([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]]));
}

#[test]
fn the_papers_example_in_every_way_in() {
    let folder = folder();
    let here = folder.path();
    put(here, "a.csv", csv());
    put(
        here,
        "b.csv",
        format!("# thirteen\n\"y\";\"x\";\"name\"\n{}", THIRTEEN.map(|[x, y]| format!("{y};{x};p\r\n")).concat()),
    );
    put(here, "c.txt", csv().replace(',', "\t 1e0 ").replace("\t 1e0 ", "\t"));
    put(here, "d.json", json!({ "points": THIRTEEN }).to_string());
    put(here, "e.csv", format!("\u{FEFF}x,y,weight\n{}", THIRTEEN.map(|[x, y]| format!("{x}, {y}, 1\n")).concat()));
    let options = "--domain four --bounds 0,0,1,1 -o - -q";
    for name in ["a.csv", "b.csv", "c.txt", "d.json", "e.csv"] {
        let outcome = line(here, &format!("fit2d {name} {options}")).ok();
        assert_eq!(outcome.stderr, "", "{name}");
        assert_paper(&figures(outcome));
    }
    for input in [csv(), read(here, "d.json")] {
        assert_paper(&figures(with_input(here, &format!("fit2d - {options}"), input.as_bytes())));
    }
    for solver in ["dense", "shift-invert", "lobpcg"] {
        assert_paper(&figures(line(here, &format!("fit2d a.csv {options} --solver {solver}"))));
    }
    let own = json!({ "points": THIRTEEN, "domain": { "vertices": [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0.5]],
        "triangles": [[0, 1, 4], [1, 2, 4], [3, 2, 4], [3, 0, 4]] } });
    put(here, "own.json", own.to_string());
    let found = figures(line(here, "fit2d own.json -o -"));
    assert_paper(&found);
    assert_eq!(found["method"]["domain"], "file");
    let made = figures(line(here, "fit2d own.json --domain lattice --cells 3 -o -"));
    assert_eq!(made["nodes"].as_array().unwrap().len(), 16);
}

#[test]
fn the_contour_closes_on_itself() {
    let folder = folder();
    put(folder.path(), "a.csv", csv());
    let found = figures(line(folder.path(), "fit2d a.csv --domain four --bounds 0,0,1,1 -o -"));
    let contour = found["contour"].as_array().unwrap();
    assert_eq!((contour.len(), &found["closed"]), (1, &json!([true])));
    let points = contour[0].as_array().unwrap();
    assert_eq!((points.len(), points.first()), (5, points.last()));
    assert_eq!(found["residuals"].as_array().unwrap().len(), 13);
    assert!(found["gap"].as_f64().unwrap() > 0.05);
    let rms = found["residual_rms"].as_f64().unwrap();
    assert!((13.0 * rms * rms - found["eigenvalue"].as_f64().unwrap()).abs() < 1e-12);
}

#[test]
fn points_segments_and_polygons_together() {
    let folder = folder();
    let data = json!({ "points": [[0.2, 0.2], [0.3, 0.1, 2.0]], "segments": [[[0.1, 0.5], [0.2, 0.8]]],
        "polygons": [[[0.4, 0.4], [0.8, 0.4], [0.8, 0.8], [0.4, 0.8], [0.4, 0.4]]] });
    put(folder.path(), "mixed.json", data.to_string());
    let words = "fit2d mixed.json --cells 20 --order 2 --normalization squared-gradient --line-weight 10";
    let found = figures(line(folder.path(), &format!("{words} -o -")));
    assert_eq!(found["residuals"].as_array().unwrap().len(), 4);
    assert!(found["distance_rms"].as_f64().unwrap() < 0.01, "{found}");
    assert_eq!(found["method"]["line_weight"], 10.0);
    line(folder.path(), &format!("{words} -o mixed.svg")).ok();
    let picture = read(folder.path(), "mixed.svg");
    assert!(picture.contains("id=\"lines\"") && picture.contains("id=\"points\""));
}

#[test]
fn every_basis_domain_and_normalisation_runs_or_says_why_not() {
    let folder = folder();
    put(folder.path(), "c.json", json!({ "points": circle() }).to_string());
    let bases =
        "p1 p2 gaussian multiquadric inverse-multiquadric thin-plate wendland-c2 wendland-c4".split_whitespace();
    let mut done = 0;
    for basis in bases {
        let radial = if basis.starts_with('p') { "" } else { "--centres 12" };
        for normalization in ["coefficients", "squared-gradient", "mean-gradient"] {
            for order in 0..=2 {
                let words = format!(
                    "fit2d c.json -o - --basis {basis} --normalization {normalization} --order {order} --cells 6 {radial}"
                );
                let outcome = line(folder.path(), &words);
                if outcome.code == Some(0) {
                    let found = figures(outcome);
                    assert_eq!(numbers(&found["coefficients"]).len(), found["nodes"].as_array().unwrap().len());
                    done += 1;
                } else {
                    assert_eq!(order, 0, "{words}: {}", outcome.stderr);
                    outcome.failed("c.json");
                }
            }
        }
    }
    assert!(done > 60, "{done}");
    for domain in ["lattice", "four", "delaunay"] {
        line(folder.path(), &format!("fit2d c.json -o {domain}.svg --domain {domain}")).ok();
    }
}

#[test]
fn smoothness_finds_the_circle() {
    let folder = folder();
    // In the coordinates of a national grid.
    let points: Vec<[f64; 2]> = circle().iter().map(|[x, y]| [84_000.0 + x, 447_000.0 + y]).collect();
    put(folder.path(), "c.json", json!({ "points": points }).to_string());
    for options in
        ["--normalization mean-gradient --order 2", "--normalization squared-gradient --order 2 --basis p2 --cells 8"]
    {
        let found = figures(line(folder.path(), &format!("fit2d c.json -o - {options}")));
        assert_eq!(found["closed"], json!([true]), "{options}");
        for point in found["contour"][0].as_array().unwrap() {
            let p = numbers(point);
            let radius = (p[0] - 84_002.0).hypot(p[1] - 447_001.0);
            assert!((radius - 1.0).abs() < 0.02, "{options}: {radius}");
        }
    }
}

#[test]
fn output_is_equal_from_run_to_run() {
    let folder = folder();
    put(folder.path(), "c.json", json!({ "points": circle() }).to_string());
    for options in ["--order 2 --normalization mean-gradient", "--basis gaussian --centres 10", "--basis p2 --cells 3"]
    {
        for name in ["a.svg", "b.svg", "a.json", "b.json"] {
            line(folder.path(), &format!("fit2d c.json -o {name} {options}")).ok();
        }
        assert_eq!(read(folder.path(), "a.svg"), read(folder.path(), "b.svg"), "{options}");
        assert_eq!(read(folder.path(), "a.json"), read(folder.path(), "b.json"), "{options}");
    }
}

/// Elements, by their names, of a document whose tags all close. The writer puts one tag on a line at most.
#[track_caller]
fn elements(text: &str) -> Vec<String> {
    let (mut open, mut seen) = (Vec::new(), Vec::new());
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        let end = start + rest[start..].find('>').expect("every tag ends");
        let tag = &rest[start + 1..end];
        assert!(!tag.contains('<') && tag.matches('"').count().is_multiple_of(2), "{tag}");
        let name = |tag: &str| tag.split([' ', '\n', '/']).next().unwrap().to_owned();
        match tag.strip_prefix('/') {
            Some(tag) => assert_eq!(open.pop(), Some(name(tag))),
            None => {
                seen.push(name(tag));
                if !tag.ends_with('/') {
                    open.push(name(tag));
                }
            }
        }
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty(), "{open:?}");
    seen
}

#[test]
fn the_picture_has_its_parts() {
    let folder = folder();
    put(folder.path(), "a.csv", csv());
    let draw = |options: &str| {
        let outcome = line(folder.path(), &format!("fit2d a.csv -o a.svg --bounds 0,0,1,1 {options}")).ok();
        assert!(outcome.stdout.is_empty() && outcome.stderr.contains("a.svg: 13 data"), "{}", outcome.stderr);
        let text = read(folder.path(), "a.svg");
        assert!(text.starts_with("<svg ") && elements(&text).contains(&"path".to_owned()));
        assert!(!text.contains("NaN") && !text.contains("inf"), "{options}");
        text
    };
    let text = draw("--domain four");
    for part in ["shading", "cells", "contour", "data", "points", "axes", "bar", "caption"] {
        assert!(text.contains(&format!("id=\"{part}\"")), "{part}");
    }
    assert!(text.contains("eigenvalue 0.0433972") && text.contains("viewBox") && !text.contains("id=\"unknown\""));
    let bare = draw("--domain four --no-cells --no-shading");
    for part in ["shading", "cells", "bar"] {
        assert!(!bare.contains(&format!("id=\"{part}\"")), "{part}");
    }
    assert!(draw("--cells 8").contains("id=\"unknown\""), "cells without data are hatched");
    assert!(draw("--cells 100 --order 2").len() < 2_000_000);
    assert!(draw("--domain four --size 1000").len() < 20_000);
}

#[test]
fn what_may_be_wrong_is_said() {
    let folder = folder();
    put(folder.path(), "a.csv", csv());
    let loud = line(folder.path(), "fit2d a.csv -o a.json --cells 8").ok();
    assert!(loud.stderr.lines().any(|line| line.starts_with("warning: ") && line.contains("touch no data")));
    let quiet = line(folder.path(), "fit2d a.csv -o b.json --cells 8 --quiet").ok();
    assert_eq!(quiet.stderr, "");
    let found: Value = serde_json::from_str(&read(folder.path(), "b.json")).unwrap();
    assert!(
        !found["warnings"].as_array().unwrap().is_empty() && !found["unconstrained"].as_array().unwrap().is_empty()
    );
}

#[test]
fn bad_inputs() {
    let cases = [
        ("json", "", "empty"),
        ("json", "{", "cut short"),
        ("json", r#"{"points": [[1, 2], [3, 4"#, "cut short"),
        ("json", "1 2\n3 4\n", "does not start with"),
        ("json", "[[[1, 2]]]", "does not start with"),
        ("json", "LASF", "looks like LAS"),
        ("json", "{}", "no points, segments or polygons"),
        ("json", r#"{"pionts": [[1, 2]]}"#, "unknown field `pionts`"),
        ("json", r#"{"points": [[1, 2]], "points": []}"#, "duplicate field"),
        ("json", r#"{"points": [[1]]}"#, "point 0 has 1 numbers"),
        ("json", r#"{"points": [[1, 2, 3, 4]]}"#, "point 0 has 4 numbers"),
        ("json", r#"{"points": [[1, "a"]]}"#, "invalid type"),
        ("json", r#"{"points": [[1, NaN]]}"#, "not JSON"),
        ("json", r#"{"points": [[1, 1e999]]}"#, "out of range"),
        ("json", r#"{"points": [[1, 1e12]]}"#, "too large"),
        ("json", r#"{"points": [[1, 2, -1]]}"#, "weight -1"),
        ("json", r#"{"points": [[1, 2]]}"#, "in one place"),
        ("json", r#"{"segments": [[[1, 2], [3, 4], [5, 6]]]}"#, "segment 0 has 3 positions"),
        ("json", r#"{"segments": [[[1, 2], [1, 2]]]}"#, "segment 0"),
        ("json", r#"{"segments": [[[1, 2], [1, 2, 3]]]}"#, "position of 3 numbers"),
        ("json", r#"{"polygons": [[[1, 2], [3, 4]]]}"#, "polygon 0 has 2 positions"),
        ("json", r#"{"polygons": [[[1, 2], [3, 4], [1, 2]]]}"#, "polygon 0"),
        ("json", r#"{"points": [[1, 2]], "domain": {"vertices": [[0, 0]]}}"#, "missing field `triangles`"),
        (
            "json",
            r#"{"points": [[1, 2]], "domain": {"vertices": [[0, 0]], "triangles": [[0, 0, 1]]}}"#,
            "uses vertex 1 of 1",
        ),
        (
            "json",
            r#"{"points": [[1, 2]], "domain": {"vertices": [[0, 0], [1, 0], [2, 0]], "triangles": [[0, 1, 2]]}}"#,
            "degenerate",
        ),
        (
            "json",
            r#"{"points": [[1, 2]], "domain": {"vertices": [[0, 0], [1, 0], [0, 1]], "triangles": [[0, 1, 2]]}}"#,
            "point 0: ",
        ),
        ("json", r#"{"points": [[1, 2]], "domain": {"vertices": [], "triangles": []}}"#, "no cells"),
        ("csv", "", "empty"),
        ("csv", "x,y\n", "no points"),
        ("csv", "# nothing\n\n", "no points"),
        ("csv", "these are words\n", "neither a point nor names"),
        ("csv", "1,2\n3\n", "line 2 has 1 columns"),
        ("csv", "1,2\n3,a\n", "line 2, column 2: `a` is not a number"),
        ("csv", "1,2\n3,nan\n", "NaN or infinite"),
        ("csv", "1,2,0\n", "weight 0"),
        ("csv", "1,2,3,4\n", "4 columns"),
        ("csv", "1,5;2,5\n", "decimal commas"),
        ("csv", "{\"points\": []}\n", "looks like JSON"),
        ("csv", "a\0b", "not a CSV text"),
        ("csv", "\u{FEFF}1,2\n1,2\n", "in one place"),
    ];
    for (suffix, text, part) in cases {
        let folder = folder();
        let name = format!("bad.{suffix}");
        put(folder.path(), &name, text);
        put(folder.path(), "old.svg", "old");
        let before = entries(folder.path());
        let outcome = line(folder.path(), &format!("fit2d {name} -o old.svg"));
        println!("{suffix:4} {}", outcome.stderr.trim());
        let said = outcome.failed(&name);
        assert!(said.contains(part), "{said} does not say {part}");
        assert_eq!(read(folder.path(), "old.svg"), "old");
        assert_eq!(entries(folder.path()), before, "litter");
    }
}

#[test]
fn bad_files_and_options() {
    let folder = folder();
    let here = folder.path();
    put(here, "a.csv", csv());
    put(
        here,
        "own.json",
        json!({ "points": [[0.1, 0.1]], "domain": { "vertices": [[0, 0], [1, 0], [0, 1]], "triangles": [[0, 1, 2]] } })
            .to_string(),
    );
    put(here, "utf16.csv", b"\xFF\xFE1\x00");
    for (words, name, part) in [
        ("a.csv -o out.png", "out.png", "svg, json"),
        ("a.csv -o out", "out", "svg, json"),
        ("a.dwg -o out.svg", "a.dwg", "json, csv"),
        ("missing.csv -o out.svg", "missing.csv", "no such file"),
        ("a.csv -o no/out.svg", "no/out.svg", "create it first"),
        ("own.json -o own.json", "own.json", "named as both"),
        ("own.json -o out.svg --bounds 0,0,1,1", "own.json", "--bounds"),
        ("own.json -o out.svg --cells 4", "own.json", "--cells"),
        ("a.csv -o out.svg --bounds 0,0,0.5,0.5", "a.csv", "leaves the domain"),
        ("utf16.csv -o out.svg", "utf16.csv", "UTF-8"),
        ("- -o out.svg", "standard input", "nothing came in"),
    ] {
        let said = line(here, &format!("fit2d {words}")).failed(name);
        assert!(said.contains(part), "{said}");
    }
    assert_eq!(entries(here), ["a.csv", "own.json", "utf16.csv"]);
    for words in [
        "a.csv",
        "a.csv -o out.svg --smoothness 1",
        "a.csv -o out.svg --order 3",
        "a.csv -o out.svg --order 2 --smoothness -1",
        "a.csv -o out.svg --centres 5",
        "a.csv -o out.svg --width 0.5",
        "a.csv -o out.svg --basis gaussian --width 0",
        "a.csv -o out.svg --sites 5",
        "a.csv -o out.svg --domain four --cells 5",
        "a.csv -o out.svg --cells 0",
        "a.csv -o out.svg --bounds 1,1,0,0",
        "a.csv -o out.svg --size 1",
        "a.csv -o out.svg --line-weight 0",
        "a.csv -o out.svg --basis p3",
    ] {
        let outcome = line(here, &format!("fit2d {words}"));
        assert_eq!(outcome.code, Some(2), "{words}: {}", outcome.stderr);
    }
}
