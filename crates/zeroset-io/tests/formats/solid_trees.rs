//! Solids from TOML trees: every key, names of files, and what is refused.

use std::path::Path;

use crate::common::folder;
use proptest::prelude::*;
use tempfile::TempDir;
use zeroset::model::Solid;
use zeroset_io::{SolidError, SolidFiles, parse_solid_tree};

fn parse(text: &str) -> Result<Solid, SolidError> {
    parse_solid_tree(Path::new("tree.toml"), text, &mut SolidFiles::default(), 0)
}

/// F at positions, of the keys of one table.
#[track_caller]
fn expect(keys: &str, values: &[([f64; 3], f64)]) {
    let solid = parse(&format!("[solid]\n{keys}\n")).unwrap_or_else(|error| panic!("{error}"));
    let field = solid.field([0.0; 3]).unwrap();
    for (p, value) in values {
        let found = field.value(*p);
        assert!((found - value).abs() < 1e-9, "{keys} at {p:?}: {found}, not {value}");
    }
}

const BALL: &str = r#"{ expr = "sphere(0,0,0; 2)" }"#;
const OTHER: &str = r#"{ expr = "sphere(3,0,0; 2)" }"#;

#[test]
fn every_operation() {
    let both = format!("of = [{BALL}, {OTHER}]");
    let [left, middle, right] = [[-1.0, 0.0, 0.0], [1.5, 0.0, 0.0], [4.0, 0.0, 0.0]];
    expect(&format!("op = 'union'\n{both}"), &[(left, -1.0), (middle, -0.5), (right, -1.0)]);
    expect(&format!("op = 'intersect'\n{both}"), &[(left, 2.0), (middle, -0.5), (right, 2.0)]);
    expect(&format!("op = 'subtract'\n{both}"), &[(left, -1.0), (middle, 0.5), (right, 2.0)]);
    expect(&format!("op = 'smooth_union'\nradius = 2\n{both}"), &[(middle, -1.0)]);
    expect(&format!("op = 'complement'\nof = [{BALL}]"), &[([0.0; 3], 2.0)]);
    expect(&format!("op = 'offset'\ndistance = -0.5\nof = [{BALL}]"), &[([0.0; 3], -1.5)]);
    expect(&format!("op = 'shell'\nthickness = 1.0\nof = [{BALL}]"), &[([2.0, 0.0, 0.0], -0.5)]);
    let three = format!("of = [{BALL}, {OTHER}, {{ op = 'complement', of = [{OTHER}] }}]");
    expect(&format!("op = 'subtract'\n{three}"), &[(left, 2.0)]);
}

#[test]
fn placements() {
    let ball = "expr = 'sphere(2,0,0; 1)'";
    expect(&format!("{ball}\nat = [1, 2.5, -3e0]"), &[([3.0, 2.5, -3.0], -1.0)]);
    expect(&format!("{ball}\nscale = 2"), &[([4.0, 0.0, 0.0], -2.0)]);
    expect(&format!("{ball}\nrotate = {{ axis = 'z', degrees = 90 }}"), &[([0.0, 2.0, 0.0], -1.0)]);
    expect(&format!("{ball}\nrotate = {{ axis = 'x', degrees = 90 }}"), &[([2.0, 0.0, 0.0], -1.0)]);
    expect(&format!("{ball}\nrotate = {{ axis = 'y', degrees = -90 }}"), &[([0.0, 0.0, 2.0], -1.0)]);
    expect(&format!("{ball}\nrotate = {{ axis = [0, 0, 2], degrees = 90.0 }}"), &[([0.0, 2.0, 0.0], -1.0)]);
    expect(&format!("{ball}\nrotate = {{ axis = 'z', degrees = 180, about = [1, 0, 0] }}"), &[([0.0; 3], -1.0)]);
    // Scaled, then turned, then moved, in whatever order they are written.
    expect(
        &format!("at = [1, 0, 0]\nrotate = {{ axis = 'z', degrees = 90 }}\nscale = 2\n{ball}"),
        &[([1.0, 4.0, 0.0], -2.0)],
    );
    expect("rotate.axis = 'z'\nrotate.degrees = 90\nexpr = 'sphere(2,0,0; 1)'", &[([0.0, 2.0, 0.0], -1.0)]);
}

/// Trees that are refused, the line that the message names, and a part of what it says.
const BAD: &[(&str, usize, &str)] = &[
    ("", 1, "expected the key solid, a table, found none"),
    ("solid = 3", 1, "expected a table such as"),
    ("[solid]\n", 1, "expected one of op, expr and file, found none of them"),
    ("\n[solid]\nexpr = 'a.ply'\nfile = 'a.ply'", 2, "found 2 of them"),
    ("[solid]\nexpr = 'sphere(0,0,0; 1)'\n[other]", 3, "no key \"other\"; possible here: solid"),
    ("[solid]\nexpr = 'sphere(0,0,0; 1)'\nradius = 1", 3, "no key \"radius\"; possible here: expr, scale, rotate, at"),
    ("[solid]\nop = 'union'\nradius = 1\nof = []", 3, "possible here: op, of, scale, rotate, at"),
    ("[solid]\nop = 'join'", 2, "no op \"join\"; possible here: union, intersect"),
    ("[solid]\nop = 3", 2, "in quotation marks, found a value of type integer"),
    ("[solid]\nop = 'union'", 1, "expected the key of, a list of two solids or more, found none"),
    ("[solid]\nop = 'union'\nof = [{ expr = 'sphere(0,0,0;1)' }]", 3, "two solids or more, found a list of 1"),
    ("[solid]\nop = 'union'\nof = 'a'", 3, "two solids or more, found a value of type string"),
    ("[solid]\nop = 'union'\nof = [1,\n 2]", 3, "expected a table such as { expr"),
    ("[solid]\nop = 'complement'\nof = [{}, {}]", 3, "expected a list of one solid, found a list of 2"),
    (
        "[solid]\nop = 'smooth_union'\nof = [{ expr = 'sphere(0,0,0;1)' }, { expr = 'sphere(0,0,0;1)' }]",
        1,
        "the key radius, a number",
    ),
    (
        "[solid]\nop = 'shell'\nthickness = 'thin'\nof = [{ expr = 'sphere(0,0,0;1)' }]",
        3,
        "expected a number, found a value of type string",
    ),
    ("[solid]\nop = 'shell'\nthickness = 0\nof = [{ expr = 'sphere(0,0,0;1)' }]", 2, "the thickness of a shell of 0"),
    (
        "[solid]\nop = 'offset'\ndistance = nan\nof = [{ expr = 'sphere(0,0,0;1)' }]",
        3,
        "nan is too large or not finite",
    ),
    ("[solid]\nop = 'offset'\ndistance = 1e12\nof = [{ expr = 'sphere(0,0,0;1)' }]", 3, "1e12 is too large"),
    ("[solid]\nop = 'offset'\ndistance = 99999999999999999999999\nof = [{ expr = 'sphere(0,0,0;1)' }]", 3, "too large"),
    ("[solid]\nexpr = 'sphere(0,0,0;1)'\nat = [1, 2]", 3, "a list of three numbers, found a list of 2"),
    ("[solid]\nexpr = 'sphere(0,0,0;1)'\nat = [1, 2,\n'3']", 4, "expected a number"),
    ("[solid]\nexpr = 'sphere(0,0,0;1)'\nscale = -1", 3, "a scale of -1"),
    ("[solid]\nexpr = 'sphere(0,0,0;1)'\nrotate = { axis = 'w', degrees = 3 }", 3, "found \"w\""),
    ("[solid]\nexpr = 'sphere(0,0,0;1)'\nrotate = { axis = [0,0,0], degrees = 3 }", 3, "axis of a rotation is zero"),
    (
        "[solid]\nexpr = 'sphere(0,0,0;1)'\nrotate = { axis = 'z', angle = 3 }",
        3,
        "no key \"angle\"; possible here: axis, degrees",
    ),
    ("[solid]\nexpr = 'sphere(0,0,0;1)'\nrotate = 30", 3, "expected a table such as { axis = \"z\", degrees = 30 }"),
    ("[solid]\nexpr = 'sphere(0,0;1)'", 2, "line 2: sphere(0,0;1): character 11: expected \",\""),
    ("[solid]\nfile = 'none.ply'", 2, "line 2: none.ply: no such file"),
    ("[solid]\nfile = 'none.las'", 2, "unknown solid format `.las`; use one of: ply"),
    ("[solid]\nexpr = 'a", 2, "this is no TOML: "),
    ("[solid]\nexpr = 'a.ply'\nexpr = 'a.ply'", 3, "this is no TOML: "),
];

#[test]
fn bad_trees_and_where() {
    for (text, expected, part) in BAD {
        let error = parse(text).expect_err(text);
        let said = error.to_string();
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.starts_with("tree.toml: line ") && said.contains(part), "{text}: {said} does not say {part}");
        let SolidError::Tree { line, .. } = error else { panic!("{said}") };
        assert_eq!(line, *expected, "{said}");
    }
}

fn write(folder: &TempDir, name: &str, text: &str) {
    let path = folder.path().join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

fn read(folder: &TempDir, name: &str) -> Result<Solid, SolidError> {
    SolidFiles::default().read(&folder.path().join(name))
}

#[test]
fn names_are_relative_to_the_tree() {
    let folder = folder();
    let mesh = "v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    write(&folder, "parts/body.obj", mesh);
    write(
        &folder,
        "parts/tree.toml",
        "[solid]\nop = 'union'\nof = [{ file = 'body.obj' }, { expr = 'body.obj at(9,0,0)' }]",
    );
    write(
        &folder,
        "top.toml",
        "\u{feff}[solid]\nop = 'union'\nof = [{ file = 'parts/tree.toml', at = [0,9,0] }, { expr = 'parts/body.obj' }]",
    );
    let field = read(&folder, "top.toml").unwrap().field([0.0; 3]).unwrap();
    for p in [[0.5; 3], [0.5, 9.5, 0.5], [9.5, 9.5, 0.5]] {
        assert!(field.value(p) < 0.0);
    }
    assert!(field.value([9.5, 0.5, 0.5]) > 0.0);
}

#[test]
fn cycles_are_named() {
    let folder = folder();
    write(&folder, "self.toml", "[solid]\nfile = 'self.toml'");
    write(&folder, "a.toml", "[solid]\nfile = 'b/b.toml'");
    write(&folder, "b/b.toml", "[solid]\n\nexpr = '../b/c.toml offset(1)'");
    write(&folder, "b/c.toml", "[solid]\nfile = 'b.toml'");
    let said = read(&folder, "self.toml").unwrap_err().to_string();
    assert_eq!(said.lines().count(), 1);
    assert!(said.contains("self.toml: a tree must not name itself; take one of these names out"), "{said}");
    let said = read(&folder, "a.toml").unwrap_err().to_string();
    let names: Vec<_> = said.split(" -> ").map(|part| part.split(": a tree").next().unwrap_or(part)).collect();
    assert!(names.len() == 3 && names[1].ends_with("c.toml") && names[2].ends_with("b.toml"), "{said}");
}

#[test]
fn hostile_trees_are_refused() {
    let deep = |open: &str, close: &str| format!("[solid]\nof = {}{}", open.repeat(100_000), close.repeat(100_000));
    for text in [
        deep("[", "]"),
        deep("{of=[", "]}"),
        format!("[solid]\n{}x = 1", "of.".repeat(100_000)),
        format!("[{}x]", "solid.".repeat(100_000)),
    ] {
        assert!(parse(&text).unwrap_err().to_string().len() < 1000);
    }
    // Trees that name the next: one each, and twice each.
    let folder = folder();
    for i in 0..200 {
        write(&folder, &format!("chain{i}.toml"), &format!("[solid]\nfile = 'chain{}.toml'", i + 1));
        let next = format!("{{ file = 'twice{}.toml' }}", i + 1);
        write(&folder, &format!("twice{i}.toml"), &format!("[solid]\nop = 'union'\nof = [{next}, {next}]"));
    }
    write(&folder, "chain200.toml", "[solid]\nexpr = 'sphere(0,0,0; 1)'");
    write(&folder, "twice30.toml", "[solid]\nexpr = 'sphere(0,0,0; 1)'");
    let said = read(&folder, "chain0.toml").unwrap_err().to_string();
    assert!(said.contains("more than 100 solids are within one another"), "{said}");
    assert!(read(&folder, "chain150.toml").is_ok());
    let said = read(&folder, "twice0.toml").unwrap_err().to_string();
    assert!(said.contains("files are named more than 10000 times"), "{said}");
    write(&folder, "bytes.toml", "[solid]\nexpr = ''");
    std::fs::write(folder.path().join("bytes.toml"), b"\xff\xfe").unwrap();
    assert!(read(&folder, "bytes.toml").unwrap_err().to_string().ends_with("save it as UTF-8"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn no_text_makes_it_panic(text in ".*", keys in proptest::collection::vec(proptest::sample::select(vec![
        "[solid]\n", "op = 'union'\n", "of = [", "]\n", "{ expr = 'sphere(0,0,0;1)' }", ", ", "expr = 'box(0'\n", "at = [1,2,3]\n", "scale = 2\n",
        "rotate = { axis = 'z', degrees = 3 }\n", "file = 'none.toml'\n", "solid.", "é", "# c\n",
    ]), 0..12)) {
        for text in [text, keys.concat()] {
            if let Err(error) = parse(&text) {
                let one_line = error.to_string().lines().count() == 1;
                let SolidError::Tree { line, .. } = error else { panic!("{error}") };
                prop_assert!(one_line && line <= 1 + text.matches('\n').count());
            }
        }
    }
}
