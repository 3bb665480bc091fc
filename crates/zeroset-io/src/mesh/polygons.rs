//! Faces of any number of corners on the way to triangles.

use std::path::Path;

use crate::IoError;

/// Collects polygons and cuts them into fans of triangles.
#[derive(Debug, Default)]
pub(crate) struct Polygons {
    corners: Vec<i64>,
    triangles: Vec<[u32; 3]>,
    faces: u64,
}

impl Polygons {
    /// Adds a corner to the polygon at hand.
    #[inline]
    pub(crate) fn corner(&mut self, vertex: i64) {
        self.corners.push(vertex);
    }

    /// Ends the polygon; one with fewer than three corners is a point or a line and is passed over.
    #[inline]
    pub(crate) fn close(&mut self, path: &Path, vertices: usize) -> Result<(), IoError> {
        let bad = self.corners.iter().find(|v| !(0..vertices as i64).contains(*v) || **v > i64::from(u32::MAX));
        if let Some(vertex) = bad {
            let (path, face) = (path.to_path_buf(), self.faces);
            return Err(IoError::BadIndex { path, face, vertex: *vertex, vertices: vertices as u64 });
        }
        if let [first, rest @ ..] = self.corners.as_slice() {
            // All corners were just seen to fit.
            self.triangles.extend(rest.windows(2).map(|pair| [*first as u32, pair[0] as u32, pair[1] as u32]));
        }
        self.corners.clear();
        self.faces += 1;
        Ok(())
    }

    pub(crate) fn into_triangles(self) -> Vec<[u32; 3]> {
        self.triangles
    }
}
