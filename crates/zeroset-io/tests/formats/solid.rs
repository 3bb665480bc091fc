//! Solids from expressions: what every shape and transform is, where errors point, and that no text makes the reader panic.

use std::path::Path;

use crate::common::folder;
use proptest::prelude::*;
use zeroset::model::Solid;
use zeroset_io::solid::Fault;
use zeroset_io::{Footprint, IoError, Operands, SolidError, SolidFiles, parse_solid};

/// A solid for every file, without files: a unit ball, and a square with a hole.
struct Pretended;

impl Operands for Pretended {
    fn file(&mut self, path: &Path, _: usize) -> Result<Solid, SolidError> {
        match path.to_str() {
            Some("missing.ply") => Err(IoError::NotFound { path: path.into() }.into()),
            _ => Ok(Solid::Ball { center: [0.0; 3], radius: 1.0 }),
        }
    }

    fn footprints(&mut self, _: &Path) -> Result<Vec<Footprint>, SolidError> {
        let square = |half: f64| vec![[-half, -half], [half, -half], [half, half], [-half, half]];
        Ok(vec![vec![square(2.0), square(1.0)]])
    }
}

fn parse(text: &str) -> Result<Solid, SolidError> {
    parse_solid(text, &mut Pretended, 0)
}

/// F at positions.
#[track_caller]
fn expect(text: &str, values: &[([f64; 3], f64)]) {
    let field = parse(text).unwrap_or_else(|error| panic!("{error}")).field([0.0; 3]).unwrap();
    for (p, value) in values {
        let found = field.value(*p);
        assert!((found - value).abs() < 1e-9, "{text} at {p:?}: {found}, not {value}");
    }
}

#[test]
fn shapes() {
    expect("box(0,0,0; 2,4,6)", &[([1.0, 2.0, 3.0], -1.0), ([5.0, 2.0, 3.0], 3.0), ([0.0; 3], 0.0)]);
    expect("box(2,4,6; 0,0,0)", &[([1.0, 2.0, 3.0], -1.0)]);
    expect("sphere(1,2,3; 2)", &[([1.0, 2.0, 3.0], -2.0), ([1.0, 2.0, 8.0], 3.0)]);
    expect("cylinder(0,0,0; 0,0,10; 2)", &[([0.0, 0.0, 5.0], -2.0), ([5.0, 0.0, 5.0], 3.0), ([0.0, 0.0, 12.0], 2.0)]);
    expect("cone(0,0,0; 0,0,4; 3; 0)", &[([0.0, 0.0, 4.0], 0.0), ([3.0, 0.0, 0.0], 0.0), ([0.0, 0.0, -2.0], 2.0)]);
    expect("halfspace(0,0,5; 0,0,2)", &[([7.0, 7.0, 1.0], -4.0), ([0.0, 0.0, 6.0], 1.0)]);
    expect("extrude(plan.geojson; 0; 9)", &[([1.5, 0.0, 4.0], -0.5), ([0.0, 0.0, 4.0], 1.0), ([1.5, 0.0, 11.0], 2.0)]);
    expect("mesh(ball.ply)", &[([0.0; 3], -1.0)]);
}

#[test]
fn operations() {
    let boxes = "box(0,0,0; 4,4,4); box(2,0,0; 8,4,4)";
    expect(&format!("union({boxes})"), &[([1.0, 2.0, 2.0], -1.0), ([7.0, 2.0, 2.0], -1.0)]);
    expect(&format!("intersect({boxes})"), &[([3.0, 2.0, 2.0], -1.0), ([1.0, 2.0, 2.0], 1.0)]);
    expect(&format!("subtract({boxes})"), &[([1.0, 2.0, 2.0], -1.0), ([3.0, 2.0, 2.0], 1.0)]);
    expect(
        "subtract(sphere(0,0,0;9); sphere(5,0,0;1); sphere(-5,0,0;1))",
        &[([5.0, 0.0, 0.0], 1.0), ([-5.0, 0.0, 0.0], 1.0)],
    );
    // min - r / 4 where both are equal.
    expect("smooth_union(halfspace(0,0,0;0,0,1); halfspace(0,0,0;1,0,0); 2)", &[([0.0; 3], -0.5)]);
}

#[test]
fn transforms() {
    expect("sphere(0,0,0;1) at(1,2,3)", &[([1.0, 2.0, 3.0], -1.0)]);
    expect("sphere(2,0,0;1) rotate(z,90deg)", &[([0.0, 2.0, 0.0], -1.0)]);
    expect("sphere(0,2,0;1)rotate(x,90deg)", &[([0.0, 0.0, 2.0], -1.0)]);
    expect("sphere(0,0,2;1) rotate(y, 90deg)", &[([2.0, 0.0, 0.0], -1.0)]);
    expect("sphere(2,0,0;1) rotate(0,0,-3; -90deg)", &[([0.0, 2.0, 0.0], -1.0)]);
    expect("sphere(2,0,0;1) rotate(z, 1.5707963267948966rad; 1,0,0)", &[([1.0, 1.0, 0.0], -1.0)]);
    expect("sphere(2,0,0;1) rotate(0,0,1; 180deg; 1,0,0)", &[([0.0; 3], -1.0)]);
    expect("sphere(2,0,0;1) scale(3)", &[([6.0, 0.0, 0.0], -3.0)]);
    expect("sphere(2,0,0;1) scale(3; 2,0,0)", &[([2.0, 0.0, 0.0], -3.0)]);
    expect("sphere(0,0,0;1) offset(2)", &[([0.0; 3], -3.0)]);
    expect("sphere(0,0,0;3) offset(-2)", &[([0.0; 3], -1.0)]);
    expect("sphere(0,0,0;3) shell(1)", &[([3.0, 0.0, 0.0], -0.5), ([0.0; 3], 2.5)]);
    expect("sphere(0,0,0;3) complement()", &[([0.0; 3], 3.0)]);
    // From left to right.
    expect("sphere(0,0,0;1) at(2,0,0) rotate(z,90deg) scale(2)", &[([0.0, 4.0, 0.0], -2.0)]);
    expect("sphere(0,0,0;1) scale(2) rotate(z,90deg) at(2,0,0)", &[([2.0, 0.0, 0.0], -2.0)]);
    expect("sphere(0,0,0;1) offset(1) scale(2)", &[([0.0; 3], -4.0)]);
    expect("sphere(0,0,0;1) scale(2) offset(1)", &[([0.0; 3], -3.0)]);
    expect(
        "union(sphere(0,0,0;1) at(9,0,0); ball.ply) at(1,0,0)",
        &[([10.0, 0.0, 0.0], -1.0), ([1.0, 0.0, 0.0], -1.0)],
    );
}

#[test]
fn how_things_may_be_written() {
    expect("  box ( 0 , 0,0 ;\n\t2,4,6 )  ", &[([1.0, 2.0, 3.0], -1.0)]);
    expect("sphere(+1e0,-.5,0.0E-3;2.)", &[([1.0, -0.5, 0.0], -2.0)]);
    for file in ["a.ply", "../b-2,3.STL", "c.toml", "d.zset", "\"e (1); f.obj\"", "0.off", "-.glb"] {
        assert!(parse(&format!("union({file}; {file}) at(1,0,0)")).is_ok(), "{file}");
    }
    expect("ball.ply", &[([0.0; 3], -1.0)]);
    expect("ball.ply offset(1)", &[([0.0; 3], -2.0)]);
    expect("mesh(\"a ball.ply\")offset(1)", &[([0.0; 3], -2.0)]);
}

/// Expressions that are refused, the character that the message points at, and a part of what it says.
const BAD: &[(&str, usize, &str)] = &[
    ("", 1, "empty expression: character 1: expected a shape, an operation or a file, found the end"),
    ("   ", 4, "found the end"),
    ("box(0,0;1,1,1)", 8, "box(0,0;1,1,1): character 8: expected \",\" and a third coordinate, found \";\""),
    ("box(0,0,0,1,1,1)", 10, "expected \";\" and the opposite corner, found \",\""),
    ("box(0,0,0; 1,1,a)", 16, "expected a third coordinate, found \"a\""),
    ("box(0,0,0; 1,1,1", 17, "expected \")\", found the end"),
    ("box(0,0,0; 1,1,1))", 18, "expected the end or one of rotate, at"),
    ("box", 1, "\"box\" is no shape, no operation, and no file that ends in ply, obj, stl, off, glb, zset, toml"),
    ("bax(0,0,0; 1,1,1)", 1, "no shape or operation \"bax\"; possible here: box, sphere, cylinder"),
    ("union(box(0,0,0;1,1,1); bax(1))", 25, "no shape or operation \"bax\""),
    ("union(box(0,0,0;1,1,1))", 23, "expected \";\" and another solid"),
    ("union(box(0,0,0;1,1,1);)", 24, "expected a shape, an operation or a file, found \")\""),
    ("box(0,0,0;1,1,1) turn(z,30deg)", 18, "no transform \"turn\"; possible here: rotate, at, scale"),
    ("box(0,0,0;1,1,1) rotate(z,30)", 27, "the angle 30 has no unit; write 30deg or 30rad"),
    ("box(0,0,0;1,1,1) rotate(w,30deg)", 25, "an axis: x, y, z or three numbers, found \"w\""),
    ("box(0,0,0;1,1,1) rotate(z,30grad)", 27, "expected an angle such as 30deg"),
    ("box(0,0,0;1,1,1) rotate(1,0,0,30deg)", 30, "expected \";\" and an angle"),
    ("box(0,0,0;1,1,1) rotate(0,0,0;30deg)", 18, "axis of a rotation is zero"),
    ("box(0,0,0;1,1,1) rotate(z,1e200deg)", 27, "too large or not finite"),
    ("box(0,0,0;1,1,1) scale(0)", 18, "a scale of 0 is not possible"),
    ("box(0,0,0;1,1,1) scale(-1)", 18, "a scale of -1"),
    ("box(0,0,0;1,1,1) shell(0)", 18, "the thickness of a shell of 0"),
    ("box(0,0,0;1,1,1) complement(1)", 29, "expected \")\", found \"1\""),
    ("box(0,0,0;1,1,1) at 1,2,3", 21, "expected \"(\", found \"1\""),
    ("sphere(0,0,0; 0)", 1, "a radius of 0"),
    ("at(1,2,3)", 1, "no shape or operation \"at\""),
    ("union(sphere(0,0,0;1); sphere(0,0,0; -2))", 24, "a radius of -2"),
    ("sphere(0,0,nan; 1)", 12, "nan is too large or not finite"),
    ("sphere(0,0,inf; 1)", 12, "inf is too large or not finite"),
    ("sphere(0,0,1e12; 1)", 12, "1e12 is too large"),
    ("sphere(0,0,1e999; 1)", 12, "1e999 is too large"),
    ("sphere(0,0,0; 5m)", 15, "expected a radius, found \"5m\""),
    ("sphere(0,0,0; 1 2)", 17, "expected \")\", found \"2\""),
    ("box(0,0,0; 0,1,1)", 1, "a box has no volume"),
    ("cylinder(0,0,0; 0,0,0; 1)", 1, "a cylinder has no length"),
    ("cone(0,0,0; 0,0,1; 1)", 21, "expected \";\" and the radius at the other end"),
    ("halfspace(0,0,0; 0,0,0)", 1, "the normal of a half-space is zero"),
    ("smooth_union(a.ply; b.ply)", 26, "expected \";\" and a radius"),
    ("smooth_union(a.ply; b.ply; 0)", 1, "the radius of a smooth union of 0"),
    ("extrude(a.dxf; 3; 3)", 1, "two heights must differ"),
    ("extrude(; 3; 4)", 9, "expected the name of a file, found \";\""),
    ("\"a b.ply", 1, "no partner"),
    ("\"\"", 1, "expected the name of a file"),
    ("a b.ply", 1, "\"a\" is no shape"),
    ("a.las at(1,2,3)", 1, "\"a.las\" is no shape"),
    ("mesh(a.zset)", 6, "a.zset: unknown mesh format `.zset`; use one of: ply"),
    ("union(a.ply; missing.ply)", 14, "character 14: missing.ply: no such file; check the path"),
    ("(a.ply)", 1, "found \"(\""),
    ("tile-(1).ply", 1, "\"tile-\" is no shape"),
    ("a.ply b.ply", 7, "no transform \"b\""),
    ("ünïon(a.ply; b.ply)", 1, "is no shape"),
    ("union(\"ünï.ply\"; é)", 18, "\"é\" is no shape"),
    ("sphere(0,0,0;\u{1}1)", 14, "expected a radius"),
];

#[test]
fn bad_expressions_and_where() {
    for (text, expected, part) in BAD {
        let error = parse(text).expect_err(text);
        let said = error.to_string();
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.contains(part), "{text}: {said} does not say {part}");
        let SolidError::Expression { character, .. } = error else { panic!("{said}") };
        assert_eq!(character, *expected, "{said}");
    }
}

#[test]
fn long_expressions_are_shown_in_part() {
    let text = format!("union({}; oops(); {})", ["sphere(0,0,0; 1)"; 40].join("; "), ["a.ply"; 99].join(";"));
    let said = parse(&text).unwrap_err().to_string();
    assert!(said.len() < 400 && said.starts_with("...") && said.contains("oops(); a.ply"), "{said}");
}

#[test]
fn absurd_nesting_is_refused() {
    let nested = |levels: usize| format!("{}a.ply{}", "union(a.ply; ".repeat(levels), ")".repeat(levels));
    assert!(parse(&nested(50)).unwrap().field([0.0; 3]).is_ok());
    let chains = ["offset(1)", "shell(1)", "complement()", "scale(2) offset(1)"];
    let texts = [nested(101), nested(100_000), "union(".repeat(100_000)];
    let texts = texts.into_iter().chain(chains.map(|step| format!("a.ply{}", format!(" {step}").repeat(100_000))));
    for text in texts {
        let error = parse(&text).unwrap_err();
        assert!(matches!(error, SolidError::Expression { fault: Fault::TooDeep, .. }), "{error}");
    }
    // Placements become one.
    expect(&format!("a.ply{}", " at(1,0,0)".repeat(1000)), &[([1000.0, 0.0, 0.0], -1.0)]);
    assert!(parse(&format!("a.ply{}", " scale(1e9)".repeat(1000))).is_err());
}

#[test]
fn files_of_an_expression() {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let at = |name: &str| format!("\"{}\"", folder.path().join(name).display());
    let tetrahedron = "v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    write("solid.obj", tetrahedron);
    write("open.obj", tetrahedron.trim_end_matches("f 3 1 4\n"));
    let square = |x: f64, half: f64| {
        format!("[[{0},{1}],[{2},{1}],[{2},{3}],[{0},{3}],[{0},{1}]]", x - half, -half, x + half, half)
    };
    let plan = format!(
        r#"{{"type":"GeometryCollection","geometries":[
        {{"type":"Polygon","coordinates":[{},{}]}},
        {{"type":"Polygon","coordinates":[{}]}},
        {{"type":"LineString","coordinates":{}}},
        {{"type":"LineString","coordinates":{}}},
        {{"type":"LineString","coordinates":[[0,0],[50,50]]}},
        {{"type":"Point","coordinates":[0,0]}}]}}"#,
        square(0.0, 4.0),
        square(0.0, 2.0),
        square(8.0, 4.0),
        square(20.0, 2.0),
        square(20.0, 4.0),
    );
    write("plan.geojson", &plan);
    write("open.geojson", r#"{"type":"LineString","coordinates":[[0,0],[1,0],[1,1]]}"#);
    write("crossed.geojson", r#"{"type":"LineString","coordinates":[[0,0],[2,2],[2,0],[0,2],[0,0]]}"#);
    let mut files = SolidFiles::new(|path| {
        assert!(path.ends_with("model.zset"));
        Ok(Solid::Ball { center: [0.0; 3], radius: 7.0 })
    });

    let value = |solid: Solid, p: [f64; 3]| solid.field([0.0; 3]).unwrap().value(p);
    assert!(value(files.expression(&at("solid.obj")).unwrap(), [0.5; 3]) < 0.0);
    assert_eq!(value(files.expression(&at("model.zset")).unwrap(), [0.0; 3]), -7.0);
    let extruded = files.expression(&format!("extrude({}; 0; 10)", at("plan.geojson"))).unwrap();
    // A hole, the wall beside it, a neighbour, a closed line, and one in it.
    for (x, is_solid) in [(0.0, false), (3.0, true), (8.0, true), (17.0, true), (20.0, false), (30.0, false)] {
        assert_eq!(value(extruded.clone(), [x, 0.0, 5.0]) < 0.0, is_solid, "at {x}");
    }

    let mut said = |text: String| files.expression(&text).unwrap_err().to_string();
    assert!(said(at("open.obj")).contains("open.obj: the mesh is not closed: 3 of its edges"));
    assert!(said(at("none.ply")).contains("none.ply: no such file"));
    let open = said(format!("extrude({}; 0; 1)", at("open.geojson")));
    assert!(open.contains("open.geojson: there are no polygons or closed lines in it, only 1 other"), "{open}");
    assert!(said(format!("extrude({}; 0; 1)", at("crossed.geojson"))).contains("cross"));
    assert!(said(format!("extrude({}; 0; 1)", at("plan.shp"))).contains("unknown polygon format"));
    let missing = SolidFiles::default().expression("a.zset").unwrap_err().to_string();
    assert!(missing.ends_with("a.zset: no such file; check the path"), "{missing}");
}

/// An error that points into its text.
fn is_sound(text: &str) -> bool {
    match parse(text) {
        Ok(_) => true,
        Err(error) => {
            let one_line = error.to_string().lines().count() == 1;
            let SolidError::Expression { character, expression, .. } = error else { return false };
            one_line && expression == text && (1..=text.chars().count() + 1).contains(&character)
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn no_text_makes_it_panic(text in ".*") {
        prop_assert!(is_sound(&text));
    }

    #[test]
    fn nor_do_pieces_of_sound_ones(pieces in proptest::collection::vec(proptest::sample::select(vec![
        "box(", "sphere(", "cone(", "extrude(", "union(", "subtract(", "smooth_union(", "at(", "rotate(", "z", "scale(", "shell(",
        "complement()", "offset(", "(", ")", ";", ",", "0,0,0", "1,2,3", "1", "-1e3", "1e99", "30deg", "a.ply", "\"", " ", "é", "\n",
        "box(0,0,0;1,1,1)", "sphere(0,0,0;1)",
    ]), 0..30)) {
        prop_assert!(is_sound(&pieces.concat()));
    }

    #[test]
    fn numbers_come_through(p in proptest::array::uniform3(-1e11_f64..1e11), radius in 1e-3_f64..1e11) {
        let solid = parse(&format!("sphere({},{},{:e}; {radius})", p[0], p[1], p[2])).unwrap();
        let Solid::Ball { center, radius: found } = solid else { panic!("no ball") };
        prop_assert_eq!((center, found), (p, radius));
    }
}
