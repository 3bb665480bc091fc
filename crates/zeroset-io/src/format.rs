//! The formats, and which suffix stands for which.

use std::path::Path;

use crate::IoError;

/// A format of point clouds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum CloudFormat {
    /// ASPRS LAS 1.0 to 1.4.
    Las,
    /// LAS compressed by LASzip; a cloud-optimised `.copc.laz` is one of these.
    Laz,
    /// Stanford polygon file; only its vertices are read.
    Ply,
    /// Text, a point a line, with spaces between the values: `.xyz`, `.txt`, `.asc`.
    Xyz,
    /// The same with commas, and with a line of names at the top. Any separator is read from either.
    Csv,
    /// Leica's text format: a line with the count, then x y z, intensity, red, green, blue.
    Pts,
    /// Point Cloud Library's format.
    Pcd,
    /// ASTM E2807 scans.
    E57,
}

/// A format of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Stanford polygon file.
    Ply,
    /// Wavefront OBJ.
    Obj,
    /// Stereolithography triangles.
    Stl,
    /// Object file format.
    Off,
    /// glTF 2.0 in one binary file.
    Glb,
}

impl CloudFormat {
    /// Every suffix that is known, with its format.
    pub const KNOWN: &'static [(&'static str, Self)] = &[
        ("las", Self::Las),
        ("laz", Self::Laz),
        ("ply", Self::Ply),
        ("xyz", Self::Xyz),
        ("txt", Self::Xyz),
        ("csv", Self::Csv),
        ("asc", Self::Xyz),
        ("pts", Self::Pts),
        ("pcd", Self::Pcd),
        ("e57", Self::E57),
    ];

    /// The format that the suffix of `path` stands for, in upper or lower case. `-` is a standard stream and is text.
    ///
    /// # Errors
    /// [`IoError::UnknownSuffix`], which lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, IoError> {
        if path == Path::new("-") {
            return Ok(Self::Xyz);
        }
        by_suffix(path, "cloud", Self::KNOWN)
    }

    /// The name that messages use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Las => "LAS",
            Self::Laz => "LAZ",
            Self::Ply => "PLY",
            Self::Xyz => "XYZ text",
            Self::Csv => "CSV text",
            Self::Pts => "PTS text",
            Self::Pcd => "PCD",
            Self::E57 => "E57",
        }
    }
}

impl MeshFormat {
    /// Every suffix that is known, with its format.
    pub const KNOWN: &'static [(&'static str, Self)] =
        &[("ply", Self::Ply), ("obj", Self::Obj), ("stl", Self::Stl), ("off", Self::Off), ("glb", Self::Glb)];

    /// The format that the suffix of `path` stands for, in upper or lower case.
    ///
    /// # Errors
    /// [`IoError::UnknownSuffix`], which lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, IoError> {
        by_suffix(path, "mesh", Self::KNOWN)
    }

    /// The name that messages use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ply => "PLY",
            Self::Obj => "OBJ",
            Self::Stl => "STL",
            Self::Off => "OFF",
            Self::Glb => "GLB",
        }
    }
}

/// What the suffix of `path` stands for among `known`, in upper or lower case. `kind` is for the message: "cloud", "mesh"
/// and so on.
///
/// # Errors
/// [`IoError::UnknownSuffix`], which lists the known ones.
pub fn by_suffix<F: Copy>(path: &Path, kind: &'static str, known: &[(&'static str, F)]) -> Result<F, IoError> {
    let suffix = path.extension().map(|s| s.to_string_lossy().to_ascii_lowercase());
    let found = suffix.as_deref().and_then(|suffix| known.iter().find(|(name, _)| *name == suffix));
    found.map(|(_, format)| *format).ok_or_else(|| IoError::UnknownSuffix {
        path: path.to_path_buf(),
        kind,
        suffix,
        known: known.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
    })
}

/// What the first bytes look like, for the message about a wrong suffix.
pub(crate) fn sniff(bytes: &[u8]) -> Option<&'static str> {
    const MARKS: &[(&[u8], &str)] = &[
        (b"LASF", "LAS or LAZ"),
        (b"ply\n", "PLY"),
        (b"ply\r", "PLY"),
        (b"ASTM-E57", "E57"),
        (b"glTF", "GLB"),
        (b"# .PCD", "PCD"),
        (b"VERSION ", "PCD"),
        (b"OFF", "OFF"),
        (b"\x93NUMPY", "NPY"),
        (b"solid ", "ASCII STL"),
        (b"PK\x03\x04", "a ZIP archive"),
        (b"\x1f\x8b", "a gzip archive"),
        (b"<", "XML or HTML"),
        (b"{", "JSON"),
    ];
    MARKS.iter().find(|(mark, _)| bytes.starts_with(mark)).map(|(_, name)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suffixes_in_any_case() {
        let format = |name: &str| CloudFormat::from_path(Path::new(name)).ok();
        assert_eq!(format("a/B.LaZ"), Some(CloudFormat::Laz));
        assert_eq!(format("tile.copc.laz"), Some(CloudFormat::Laz));
        assert_eq!(format("-"), Some(CloudFormat::Xyz));
        assert_eq!(format("a.dwg"), None);
        assert_eq!(MeshFormat::from_path(Path::new("x.GLB")).ok(), Some(MeshFormat::Glb));
    }

    #[test]
    fn an_unknown_suffix_lists_the_known_ones() {
        for name in ["a.dwg", "a"] {
            let text = MeshFormat::from_path(Path::new(name)).unwrap_err().to_string();
            assert!(text.starts_with(name) && text.contains("ply, obj, stl, off, glb"), "{text}");
        }
    }
}
