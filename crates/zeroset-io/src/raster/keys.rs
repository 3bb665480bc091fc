//! The reference system as keys of GeoTIFF (OGC 19-008, version 1.1).

use crate::epsg::{self, Kind};

const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;
const CITATION: u16 = 1026;
const GEODETIC: u16 = 2048;
const PROJECTED: u16 = 3072;
const PROJECTED_CITATION: u16 = 3073;
const VERTICAL: u16 = 4096;

/// The tag that holds texts.
const TEXTS: u16 = 34737;
/// In place of a code: the system is described by other keys.
const USER_DEFINED: u16 = 32767;
/// The value of the raster type: a value stands for the area of its cell.
const AREA: u16 = 1;
/// What GDAL looks for in front of WKT in a citation.
const WKT_MARK: &str = "ESRI PE String = ";

/// Keys in ascending order, and the texts that they point to.
#[derive(Debug, Default)]
pub(super) struct GeoKeys {
    /// Key, place of the value, count and value, as the directory has them.
    entries: Vec<[u16; 4]>,
    pub(super) texts: String,
}

impl GeoKeys {
    /// The keys for a text of a reference system.
    pub(super) fn of(crs: &str) -> Self {
        let mut keys = Self::default();
        keys.add(RASTER_TYPE, AREA);
        let kind = epsg::wkt_kind(crs);
        if let Some(code) = epsg::code(crs).and_then(valid) {
            let of_code = || if epsg::is_geographic(code.into()) { Kind::Geographic } else { Kind::Projected };
            let (model, system) = match kind.unwrap_or_else(of_code) {
                Kind::Projected => (1, PROJECTED),
                Kind::Geographic => (2, GEODETIC),
            };
            keys.add(MODEL_TYPE, model);
            keys.add(system, code);
            if let Some(vertical) = epsg::vertical_code(crs).and_then(valid) {
                keys.add(VERTICAL, vertical);
            }
        } else if kind.is_some() {
            // Only beside a model of no kind does GDAL look at the WKT.
            keys.add(MODEL_TYPE, USER_DEFINED);
            keys.add(PROJECTED, USER_DEFINED);
            keys.add_text(PROJECTED_CITATION, &format!("{WKT_MARK}{crs}"));
        } else {
            keys.add_text(CITATION, crs);
        }
        keys.entries.sort_unstable();
        keys
    }

    /// The directory: version 1.1 of the keys, their number, then each.
    pub(super) fn directory(&self) -> Vec<u16> {
        let head = [1, 1, 1, self.entries.len() as u16];
        head.iter().chain(self.entries.iter().flatten()).copied().collect()
    }

    fn add(&mut self, key: u16, value: u16) {
        self.entries.push([key, 0, 1, value]);
    }

    /// A text ends with a bar, which therefore cannot be in it; nor can letters beyond ASCII.
    fn add_text(&mut self, key: u16, text: &str) {
        let plain = |c: char| if c.is_ascii_graphic() && c != '|' || c == ' ' { c } else { '?' };
        let text: String = text.split_whitespace().collect::<Vec<_>>().join(" ").chars().map(plain).collect();
        // More than the count can tell is left out.
        if let (Ok(count), Ok(start)) = (u16::try_from(text.len() + 1), u16::try_from(self.texts.len())) {
            self.entries.push([key, TEXTS, count, start]);
            self.texts.push_str(&text);
            self.texts.push('|');
        }
    }
}

/// A code that the keys have room for.
fn valid(code: u32) -> Option<u16> {
    u16::try_from(code).ok().filter(|code| (1024..USER_DEFINED).contains(code))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(crs: &str) -> Vec<[u16; 4]> {
        GeoKeys::of(crs).entries
    }

    #[test]
    fn codes_are_keys() {
        let area = [RASTER_TYPE, 0, 1, AREA];
        assert_eq!(GeoKeys::of("").directory()[..8], [1, 1, 1, 2, RASTER_TYPE, 0, 1, AREA]);
        assert_eq!(entries("EPSG:28992"), [[MODEL_TYPE, 0, 1, 1], area, [PROJECTED, 0, 1, 28992]]);
        let vertical = [[MODEL_TYPE, 0, 1, 1], area, [PROJECTED, 0, 1, 28992], [VERTICAL, 0, 1, 5709]];
        assert_eq!(entries("EPSG:28992+5709"), vertical);
        assert_eq!(entries("EPSG:4326"), [[MODEL_TYPE, 0, 1, 2], area, [GEODETIC, 0, 1, 4326]]);
        assert_eq!(entries("EPSG:4647")[2], [PROJECTED, 0, 1, 4647]);
    }

    #[test]
    fn other_texts_are_citations() {
        let keys = GeoKeys::of(r#"PROJCS["a|b é",GEOGCS["c"]]"#);
        assert_eq!(keys.entries[2..], [[PROJECTED, 0, 1, USER_DEFINED], [PROJECTED_CITATION, TEXTS, 45, 0]]);
        assert_eq!(keys.texts, r#"ESRI PE String = PROJCS["a?b ?",GEOGCS["c"]]|"#);
        let keys = GeoKeys::of("a local\n grid");
        assert_eq!((keys.entries.len(), keys.texts.as_str()), (2, "a local grid|"));
        // A code that does not fit, and a text that does not.
        assert_eq!(entries("EPSG:900913")[1][0], CITATION);
        assert_eq!(GeoKeys::of(&"x".repeat(70_000)).texts, "");
    }
}
