//! Solids from expressions. The page of [`solid`](super) gives the grammar.

use std::path::Path;

use zeroset::model::Solid;

use super::cursor::{Cursor, Failure, Parsed};
use super::{DEEPEST, Fault, Operands, SolidError, make, suffixes};
use crate::MeshFormat;

const CALLS: &str = "box, sphere, cylinder, cone, halfspace, extrude, mesh, union, intersect, subtract, smooth_union";
const STEPS: &str = "rotate, at, scale, offset, shell, complement";

/// Reads an expression that has `depth` levels around it.
pub(super) fn parse(text: &str, operands: &mut dyn Operands, depth: usize) -> Result<Solid, SolidError> {
    let mut parser = Parser { cursor: Cursor::new(text), operands };
    parser.whole(depth).map_err(|Failure { at, fault }| SolidError::Expression {
        expression: text.into(),
        character: 1 + text[..at].chars().count(),
        fault,
    })
}

struct Parser<'a> {
    cursor: Cursor<'a>,
    operands: &'a mut dyn Operands,
}

impl Parser<'_> {
    fn whole(&mut self, depth: usize) -> Parsed<Solid> {
        let solid = self.operand(depth)?;
        match self.cursor.peek() {
            None => Ok(solid),
            Some(_) => Err(self.cursor.expected(format!("the end or one of {STEPS}"))),
        }
    }

    /// A shape, a file or an operation, and what is done to it.
    fn operand(&mut self, depth: usize) -> Parsed<Solid> {
        let at = self.cursor.place();
        if depth >= DEEPEST {
            return Err(Failure { at, fault: Fault::TooDeep });
        }
        let mut solid = match self.cursor.call() {
            Some(name) => self.called(at, name, depth)?,
            None => self.named(depth)?,
        };
        while self.cursor.peek().is_some_and(|c| c.is_ascii_alphabetic() || c == '_') {
            solid = self.step(solid)?;
        }
        Ok(solid)
    }

    /// What a call makes. Its name and `(` are past.
    fn called(&mut self, at: usize, name: &str, depth: usize) -> Parsed<Solid> {
        let solid = match name {
            "union" => self.list(depth).map(Solid::Union),
            "intersect" => self.list(depth).map(Solid::Intersection),
            "subtract" => self.list(depth).map(make::difference),
            "smooth_union" => self.smooth_union(at, depth),
            "mesh" => self.mesh(depth),
            "extrude" => self.extrude(at),
            _ => self.primitive(at, name),
        }?;
        self.cursor.expect(')', "")?;
        make::shallow(solid).map_err(|fault| Failure { at, fault })
    }

    fn primitive(&mut self, at: usize, name: &str) -> Parsed<Solid> {
        let cursor = &mut self.cursor;
        let solid = match name {
            "box" => {
                let first = cursor.position()?;
                cursor.expect(';', "the opposite corner")?;
                Solid::Cuboid { corners: [first, cursor.position()?] }
            }
            "sphere" => {
                let center = cursor.position()?;
                cursor.expect(';', "a radius")?;
                Solid::Ball { center, radius: cursor.number("a radius")? }
            }
            "cylinder" | "cone" => {
                let first = cursor.position()?;
                cursor.expect(';', "the other end")?;
                let ends = [first, cursor.position()?];
                cursor.expect(';', "a radius")?;
                let radius = cursor.number("a radius")?;
                let mut radii = [radius; 2];
                if name == "cone" {
                    cursor.expect(';', "the radius at the other end")?;
                    radii[1] = cursor.number("the radius at the other end")?;
                }
                Solid::Frustum { ends, radii }
            }
            "halfspace" => {
                let point = cursor.position()?;
                cursor.expect(';', "a normal")?;
                Solid::HalfSpace { point, normal: cursor.position()? }
            }
            _ => {
                let fault = Fault::Unknown {
                    what: "shape or operation",
                    name: name.chars().take(40).collect(),
                    known: CALLS.into(),
                };
                return Err(Failure { at, fault });
            }
        };
        make::primitive(solid).map_err(|fault| Failure { at, fault })
    }

    fn extrude(&mut self, at: usize) -> Parsed<Solid> {
        let place = self.cursor.place();
        let file = self.cursor.file()?;
        let footprints = self.operands.footprints(&file);
        let footprints = footprints.map_err(|error| Failure { at: place, fault: error.into() })?;
        self.cursor.expect(';', "a height")?;
        let low = self.cursor.number("a height")?;
        self.cursor.expect(';', "a second height")?;
        let high = self.cursor.number("a second height")?;
        make::extruded(footprints, [low, high]).map_err(|fault| Failure { at, fault })
    }

    fn mesh(&mut self, depth: usize) -> Parsed<Solid> {
        let at = self.cursor.place();
        let file = self.cursor.file()?;
        let mesh = MeshFormat::from_path(&file).map_err(SolidError::from);
        mesh.and_then(|_| self.operands.file(&file, depth + 1)).map_err(|error| Failure { at, fault: error.into() })
    }

    /// A file that stands for itself.
    fn named(&mut self, depth: usize) -> Parsed<Solid> {
        let at = self.cursor.place();
        if self.cursor.peek().is_none_or(|c| matches!(c, '(' | ')' | ';' | ',')) {
            return Err(self.cursor.expected("a shape, an operation or a file"));
        }
        let file = self.cursor.file()?;
        if !is_operand(&file) {
            let name = file.to_string_lossy().chars().take(80).collect();
            return Err(Failure { at, fault: Fault::NoOperand { name, known: suffixes() } });
        }
        let solid = self.operands.file(&file, depth + 1).map_err(Fault::from).and_then(make::shallow);
        solid.map_err(|fault| Failure { at, fault })
    }

    /// Two operands or more.
    fn list(&mut self, depth: usize) -> Parsed<Vec<Solid>> {
        let mut all = vec![self.operand(depth + 1)?];
        self.cursor.expect(';', "another solid")?;
        loop {
            all.push(self.operand(depth + 1)?);
            if !self.cursor.take(';') {
                return Ok(all);
            }
        }
    }

    fn smooth_union(&mut self, at: usize, depth: usize) -> Parsed<Solid> {
        let first = self.operand(depth + 1)?;
        self.cursor.expect(';', "another solid")?;
        let second = self.operand(depth + 1)?;
        self.cursor.expect(';', "a radius")?;
        let radius = self.cursor.number("a radius")?;
        make::smooth_union(first, second, radius).map_err(|fault| Failure { at, fault })
    }

    /// What is done to an operand.
    fn step(&mut self, solid: Solid) -> Parsed<Solid> {
        let at = self.cursor.place();
        let name = self.cursor.name();
        if !STEPS.split(", ").any(|known| known == name) {
            let name = name.chars().take(40).collect();
            return Err(Failure { at, fault: Fault::Unknown { what: "transform", name, known: STEPS.into() } });
        }
        let cursor = &mut self.cursor;
        cursor.expect('(', "")?;
        let made = match name {
            "rotate" => {
                let axis = axis(cursor)?;
                let angle = cursor.angle()?;
                let about = center(cursor)?;
                make::placed(solid, |placement| placement.turned(axis, angle, about))
            }
            "at" => {
                let by = cursor.position()?;
                make::placed(solid, |placement| placement.moved(by))
            }
            "scale" => {
                let factor = cursor.number("a factor")?;
                let about = center(cursor)?;
                make::placed(solid, |placement| placement.scaled(factor, about))
            }
            "offset" => Ok(make::offset(solid, cursor.number("a distance")?)),
            "shell" => make::shell(solid, cursor.number("a thickness")?),
            _ => Ok(make::complement(solid)),
        };
        cursor.expect(')', "")?;
        made.and_then(make::shallow).map_err(|fault| Failure { at, fault })
    }
}

/// The axis of a rotation, and what separates it from the angle.
fn axis(cursor: &mut Cursor<'_>) -> Parsed<[f64; 3]> {
    let start = *cursor;
    let axis = match cursor.name() {
        "x" => [1.0, 0.0, 0.0],
        "y" => [0.0, 1.0, 0.0],
        "z" => [0.0, 0.0, 1.0],
        "" => {
            let axis = cursor.position()?;
            cursor.expect(';', "an angle")?;
            return Ok(axis);
        }
        _ => {
            *cursor = start;
            return Err(cursor.expected("an axis: x, y, z or three numbers"));
        }
    };
    cursor.expect(',', "an angle")?;
    Ok(axis)
}

/// The position that stays where it is: the origin, if none is given.
fn center(cursor: &mut Cursor<'_>) -> Parsed<[f64; 3]> {
    if cursor.take(';') { cursor.position() } else { Ok([0.0; 3]) }
}

/// Whether a file can stand for itself.
fn is_operand(file: &Path) -> bool {
    let suffix = file.extension().map(|suffix| suffix.to_string_lossy().to_ascii_lowercase());
    suffix.is_some_and(|suffix| suffixes().split(", ").any(|known| known == suffix))
}
