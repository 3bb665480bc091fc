//! Solids from TOML. The page of [`solid`](super) gives the format.

use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};
use zeroset::model::Solid;

use super::cursor::{Failure, Parsed, in_range};
use super::{DEEPEST, Fault, Operands, SolidError, expression, make};

const POSITION: &str = "a list of three numbers";
const AXIS: &str = "\"x\", \"y\", \"z\" or a list of three numbers";
const SOLID: &str = "a table such as { expr = \"sphere(0,0,0; 1)\" }";
const ONE: &str = "a list of one solid";
const TWO: &str = "a list of two solids";
const OPERATIONS: &str = "union, intersect, subtract, smooth_union, complement, offset, shell";

fn failed<T>(at: &Range<usize>, fault: impl Into<Fault>) -> Parsed<T> {
    Err(Failure { at: at.start, fault: fault.into() })
}

/// Reads a tree that has `depth` levels around it.
pub(super) fn parse(path: &Path, text: &str, operands: &mut dyn Operands, depth: usize) -> Result<Solid, SolidError> {
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
    document(text, operands, depth).map_err(|Failure { at, fault }| {
        let before = &text.as_bytes()[..at.min(text.len())];
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        SolidError::Tree { path: path.to_path_buf(), line, fault }
    })
}

fn document(text: &str, operands: &mut dyn Operands, depth: usize) -> Parsed<Solid> {
    let document = DeTable::parse(text).map_err(|error| Failure {
        at: error.span().map_or(0, |span| span.start),
        fault: Fault::NoToml { message: error.message().into() },
    })?;
    let top = Node { table: document.get_ref(), span: document.span() };
    top.only("solid")?;
    let solid = top.required("solid", "a table")?;
    Reader { operands }.solid(&Node::of(solid, SOLID)?, depth)
}

/// A table, and its place in the text.
struct Node<'a> {
    table: &'a DeTable<'a>,
    span: Range<usize>,
}

type Value<'a> = Spanned<DeValue<'a>>;

impl<'a> Node<'a> {
    fn of(value: &'a Value<'a>, what: &str) -> Parsed<Self> {
        match value.get_ref() {
            DeValue::Table(table) => Ok(Self { table, span: value.span() }),
            _ => wrong(value, what),
        }
    }

    fn get(&self, key: &str) -> Option<&'a Value<'a>> {
        self.table.get(key)
    }

    fn required(&self, key: &str, what: &str) -> Parsed<&'a Value<'a>> {
        match self.get(key) {
            Some(value) => Ok(value),
            None => {
                let expected = format!("the key {key}, {what}");
                failed(&self.span, Fault::Expected { expected, found: "none".into() })
            }
        }
    }

    /// Refuses keys that are not among the known ones.
    fn only(&self, known: &str) -> Parsed<()> {
        let is_known = |key: &str| known.split(", ").any(|known| known == key);
        let unknown = self.table.keys().filter(|key| !is_known(key.get_ref())).min_by_key(|key| key.span().start);
        match unknown {
            Some(key) => {
                let name = key.get_ref().to_string();
                failed(&key.span(), Fault::Unknown { what: "key", name, known: known.into() })
            }
            None => Ok(()),
        }
    }

    fn number(&self, key: &str) -> Parsed<f64> {
        number(self.required(key, "a number")?)
    }

    /// The list in `of`; `fits` tells whether its length is possible.
    fn list(&self, what: &str, fits: impl Fn(usize) -> bool) -> Parsed<Vec<Node<'a>>> {
        let list = self.required("of", what)?;
        match list.get_ref() {
            DeValue::Array(array) if fits(array.len()) => array.iter().map(|value| Node::of(value, SOLID)).collect(),
            DeValue::Array(array) => {
                let found = format!("a list of {}", array.len());
                failed(&list.span(), Fault::Expected { expected: what.into(), found })
            }
            _ => wrong(list, what),
        }
    }
}

struct Reader<'o> {
    operands: &'o mut dyn Operands,
}

impl Reader<'_> {
    fn solid(&mut self, node: &Node<'_>, depth: usize) -> Parsed<Solid> {
        if depth >= DEEPEST {
            return failed(&node.span, Fault::TooDeep);
        }
        let solid = match (node.get("op"), node.get("expr"), node.get("file")) {
            (Some(op), None, None) => self.operation(node, op, depth)?,
            (None, Some(expr), None) => {
                node.only("expr, scale, rotate, at")?;
                let text = string(expr, "an expression")?;
                expression::parse(text, self.operands, depth + 1).or_else(|error| failed(&expr.span(), error))?
            }
            (None, None, Some(file)) => {
                node.only("file, scale, rotate, at")?;
                let name = Path::new(string(file, "the name of a file")?);
                self.operands.file(name, depth + 1).or_else(|error| failed(&file.span(), error))?
            }
            (op, expr, file) => {
                let count = [op, expr, file].iter().flatten().count();
                let found = if count == 0 { "none of them".into() } else { format!("{count} of them") };
                let expected = "one of op, expr and file".into();
                return failed(&node.span, Fault::Expected { expected, found });
            }
        };
        let solid = placed(node, solid)?;
        make::shallow(solid).or_else(|fault| failed(&node.span, fault))
    }

    fn operation(&mut self, node: &Node<'_>, op: &Value<'_>, depth: usize) -> Parsed<Solid> {
        let only = |own: &str| node.only(&format!("op, of, {own}scale, rotate, at"));
        let made = match string(op, OPERATIONS)? {
            name @ ("union" | "intersect" | "subtract") => {
                only("")?;
                let of = self.several(node, depth)?;
                Ok(match name {
                    "union" => Solid::Union(of),
                    "intersect" => Solid::Intersection(of),
                    _ => make::difference(of),
                })
            }
            "smooth_union" => {
                only("radius, ")?;
                let [a, b] = self.exactly(node, TWO, depth)?;
                make::smooth_union(a, b, node.number("radius")?)
            }
            "complement" => {
                only("")?;
                let [of] = self.exactly(node, ONE, depth)?;
                Ok(make::complement(of))
            }
            "offset" => {
                only("distance, ")?;
                let [of] = self.exactly(node, ONE, depth)?;
                Ok(make::offset(of, node.number("distance")?))
            }
            "shell" => {
                only("thickness, ")?;
                let [of] = self.exactly(node, ONE, depth)?;
                make::shell(of, node.number("thickness")?)
            }
            name => Err(Fault::Unknown { what: "op", name: name.into(), known: OPERATIONS.into() }),
        };
        made.or_else(|fault| failed(&op.span(), fault))
    }

    fn several(&mut self, node: &Node<'_>, depth: usize) -> Parsed<Vec<Solid>> {
        let list = node.list("a list of two solids or more", |count| count >= 2)?;
        list.iter().map(|node| self.solid(node, depth + 1)).collect()
    }

    fn exactly<const N: usize>(&mut self, node: &Node<'_>, what: &str, depth: usize) -> Parsed<[Solid; N]> {
        let list = node.list(what, |count| count == N)?;
        let all = list.iter().map(|node| self.solid(node, depth + 1)).collect::<Parsed<Vec<_>>>()?;
        all.try_into().or_else(|_| wrong(node.required("of", what)?, what))
    }
}

/// Scaled, then turned, then moved.
fn placed(node: &Node<'_>, mut solid: Solid) -> Parsed<Solid> {
    if let Some(value) = node.get("scale") {
        let factor = number(value)?;
        solid = made_at(value, make::placed(solid, |placement| placement.scaled(factor, [0.0; 3])))?;
    }
    if let Some(value) = node.get("rotate") {
        let turn = Node::of(value, "a table such as { axis = \"z\", degrees = 30 }")?;
        turn.only("axis, degrees, about")?;
        let axis = axis(turn.required("axis", AXIS)?)?;
        let angle = turn.number("degrees")?.to_radians();
        let about = turn.get("about").map(position).transpose()?.unwrap_or_default();
        solid = made_at(value, make::placed(solid, |placement| placement.turned(axis, angle, about)))?;
    }
    if let Some(value) = node.get("at") {
        let by = position(value)?;
        solid = made_at(value, make::placed(solid, |placement| placement.moved(by)))?;
    }
    Ok(solid)
}

fn made_at(value: &Value<'_>, made: Result<Solid, Fault>) -> Parsed<Solid> {
    made.or_else(|fault| failed(&value.span(), fault))
}

fn wrong<T>(value: &Value<'_>, expected: &str) -> Parsed<T> {
    let found = format!("a value of type {}", value.get_ref().type_str());
    failed(&value.span(), Fault::Expected { expected: expected.into(), found })
}

fn string<'a>(value: &'a Value<'_>, what: &str) -> Parsed<&'a str> {
    value.get_ref().as_str().map_or_else(|| wrong(value, &format!("{what} in quotation marks")), Ok)
}

fn number(value: &Value<'_>) -> Parsed<f64> {
    let (read, word) = match value.get_ref() {
        // More digits than a whole number of the machine holds are out of range anyway.
        DeValue::Integer(whole) => {
            (i64::from_str_radix(whole.as_str(), whole.radix()).map_or(f64::INFINITY, |n| n as f64), whole.as_str())
        }
        DeValue::Float(float) => (float.as_str().parse().unwrap_or(f64::NAN), float.as_str()),
        _ => return wrong(value, "a number"),
    };
    in_range(read, word).or_else(|fault| failed(&value.span(), fault))
}

fn position(value: &Value<'_>) -> Parsed<[f64; 3]> {
    match value.get_ref().as_array() {
        Some(array) if array.len() == 3 => {
            let mut position = [0.0; 3];
            for (coordinate, value) in position.iter_mut().zip(array.iter()) {
                *coordinate = number(value)?;
            }
            Ok(position)
        }
        Some(array) => {
            let found = format!("a list of {}", array.len());
            failed(&value.span(), Fault::Expected { expected: POSITION.into(), found })
        }
        None => wrong(value, POSITION),
    }
}

fn axis(value: &Value<'_>) -> Parsed<[f64; 3]> {
    match value.get_ref().as_str() {
        Some("x") => Ok([1.0, 0.0, 0.0]),
        Some("y") => Ok([0.0, 1.0, 0.0]),
        Some("z") => Ok([0.0, 0.0, 1.0]),
        Some(other) => failed(&value.span(), Fault::Expected { expected: AXIS.into(), found: format!("\"{other}\"") }),
        None => position(value),
    }
}
