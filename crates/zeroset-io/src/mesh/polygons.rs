//! Faces of any number of corners on the way to triangles.

use std::path::Path;

use crate::IoError;

/// Collects polygons and cuts them into fans of triangles.
#[derive(Debug, Default)]
pub(crate) struct Polygons {
    /// Corners of the polygon at hand.
    corners: Vec<i64>,
    triangles: Vec<[u32; 3]>,
    faces: u64,
    /// The first face with a vertex that no file can have, and that vertex.
    impossible: Option<(u64, i64)>,
    /// The first face with the highest vertex, and that vertex.
    highest: Option<(u64, u32)>,
}

impl Polygons {
    /// Adds a corner to the polygon at hand.
    #[inline]
    pub(crate) fn corner(&mut self, vertex: i64) {
        self.corners.push(vertex);
    }

    /// Ends the polygon; one with fewer than three corners is a point or a line and is passed over.
    ///
    /// Whether the vertices exist is found out at the end: some files have their faces first.
    #[inline]
    pub(crate) fn close(&mut self) {
        if let [first, rest @ ..] = self.corners.as_slice() {
            for vertex in &self.corners {
                match u32::try_from(*vertex) {
                    Ok(vertex) if self.highest.is_none_or(|(_, highest)| vertex > highest) => {
                        self.highest = Some((self.faces, vertex));
                    }
                    Ok(_) => {}
                    Err(_) => self.impossible = self.impossible.or(Some((self.faces, *vertex))),
                }
            }
            // What does not fit was noted, and then none of this is used.
            self.triangles.extend(rest.windows(2).map(|pair| [*first as u32, pair[0] as u32, pair[1] as u32]));
        }
        self.corners.clear();
        self.faces += 1;
    }

    /// All triangles, if every vertex is one of `vertices`.
    pub(crate) fn into_triangles(self, path: &Path, vertices: usize) -> Result<Vec<[u32; 3]>, IoError> {
        let vertices = vertices as u64;
        let beyond = self.highest.filter(|(_, vertex)| u64::from(*vertex) >= vertices);
        let bad = self.impossible.or(beyond.map(|(face, vertex)| (face, i64::from(vertex))));
        match bad {
            Some((face, vertex)) => Err(IoError::BadIndex { path: path.to_path_buf(), face, vertex, vertices }),
            None => Ok(self.triangles),
        }
    }
}
