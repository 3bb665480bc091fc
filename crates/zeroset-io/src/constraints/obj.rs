//! Lines and faces of a Wavefront OBJ.

use super::{Gathered, Item};
use crate::IoError;
use crate::mesh::joined_lines;
use crate::mesh::text::{integer, lines, number, tokens};

/// An element that names its vertices by numbers from 0.
struct Element {
    item: Item,
    vertices: Vec<i64>,
}

pub(super) fn read(gathered: &mut Gathered<'_>, bytes: &[u8]) -> Result<(), IoError> {
    let path = gathered.path;
    let wrong =
        || IoError::WrongMagic { path: path.to_path_buf(), expected: "OBJ", looks: crate::format::sniff(bytes) };
    if bytes.iter().take(4096).any(|b| *b == 0) {
        return Err(wrong());
    }
    let text = joined_lines(bytes);
    let (mut vertices, mut elements) = (Vec::<[f64; 3]>::new(), Vec::new());
    for (at, line) in lines(&text) {
        let mut words = tokens(line);
        match words.next() {
            Some(b"v") => {
                let mut position = [0.0; 3];
                for coordinate in &mut position {
                    *coordinate = number(path, at, words.next())?;
                }
                vertices.push(position);
            }
            Some(word @ (b"l" | b"f")) => {
                let named = words.map(|word| {
                    let index = integer(path, at, word.split(|b| *b == b'/').next())?;
                    // Negative numbers count back from the newest vertex.
                    Ok(if index < 0 { index.saturating_add(vertices.len() as i64) } else { index.saturating_sub(1) })
                });
                let item = if word == b"l" { "the line element of line" } else { "the face of line" };
                elements.push(Element { item: (item, at), vertices: named.collect::<Result<_, IoError>>()? });
            }
            Some(b"p") => gathered.pass_over(),
            Some(b"#") => {
                let rest = String::from_utf8_lossy(&line[1..]);
                let stated = rest.trim_start().strip_prefix("crs ").map(str::to_string);
                gathered.file.crs = gathered.file.crs.take().or(stated);
            }
            _ => {}
        }
    }
    if vertices.is_empty() {
        return Err(wrong());
    }
    for Element { item, vertices: named } in elements {
        let position = |&vertex: &i64| {
            usize::try_from(vertex).ok().and_then(|v| vertices.get(v)).copied().ok_or_else(|| {
                let what =
                    format!("{} {} names vertex {} of {}", item.0, item.1, vertex.saturating_add(1), vertices.len());
                IoError::malformed(path, what, "repair or export it again")
            })
        };
        let positions = named.iter().map(position).collect::<Result<Vec<_>, _>>()?;
        if item.0.starts_with("the line") {
            gathered.line(item, &positions)?
        } else {
            gathered.polygon(item, &[positions])?
        }
    }
    Ok(())
}
