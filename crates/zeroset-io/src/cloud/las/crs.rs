//! The coordinate reference system out of the variable length records.

use super::header::VariableRecord;
use crate::cloud::report::LinearUnit;
use crate::globe::Globe;
use crate::input::Fields;

/// What the records tell.
#[derive(Debug, Default)]
pub(super) struct System {
    /// WKT, or `EPSG:n`.
    pub(super) text: Option<String>,
    pub(super) unit: Option<LinearUnit>,
    pub(super) note: Option<String>,
}

const USER: &str = "LASF_Projection";
const WKT: u16 = 2112;
const GEO_KEYS: u16 = 34735;
const GEO_DOUBLES: u16 = 34736;

/// GeoTIFF keys, by the names of its specification.
mod key {
    pub(super) const MODEL_TYPE: u16 = 1024;
    pub(super) const GEODETIC_CRS: u16 = 2048;
    pub(super) const PROJECTED_CRS: u16 = 3072;
    pub(super) const PROJ_LINEAR_UNITS: u16 = 3076;
    pub(super) const PROJ_LINEAR_UNIT_SIZE: u16 = 3077;
    pub(super) const VERTICAL: u16 = 4096;
}

/// WKT where there is any, else the GeoTIFF keys.
pub(super) fn find(records: &[VariableRecord]) -> System {
    let data = |id: u16| records.iter().find(|r| r.user == USER && r.id == id).map(|r| &r.data[..]);
    let wkt = data(WKT).map(|bytes| String::from_utf8_lossy(bytes).trim_matches(['\0', ' ', '\r', '\n']).to_string());
    if let Some(wkt) = wkt.filter(|wkt| !wkt.is_empty()) {
        let unit = unit_of_wkt(&wkt);
        let note = is_geographic_wkt(&wkt).then(degrees);
        return System { text: Some(wkt), unit, note };
    }
    data(GEO_KEYS).map_or_else(System::default, |keys| from_keys(keys, data(GEO_DOUBLES).unwrap_or_default()))
}

fn degrees() -> String {
    "the reference system is geographic: x and y are degrees, not lengths; project the cloud to a metric system".into()
}

fn from_keys(keys: &[u8], doubles: &[u8]) -> System {
    let mut fields = Fields::new(keys);
    let (mut projected, mut geodetic, mut vertical, mut model) = (None, None, None, None);
    let (mut unit, mut unit_size) = (None, None);
    let mut read = || {
        let [_, _, _, count] = [fields.u16()?, fields.u16()?, fields.u16()?, fields.u16()?];
        for _ in 0..count {
            let [id, place, _, value] = [fields.u16()?, fields.u16()?, fields.u16()?, fields.u16()?];
            match (id, place) {
                (key::MODEL_TYPE, 0) => model = Some(value),
                (key::PROJECTED_CRS, 0) => projected = Some(value),
                (key::GEODETIC_CRS, 0) => geodetic = Some(value),
                (key::VERTICAL, 0) => vertical = Some(value),
                (key::PROJ_LINEAR_UNITS, 0) => unit = Some(value),
                (key::PROJ_LINEAR_UNIT_SIZE, GEO_DOUBLES) => {
                    unit_size = Fields::at(doubles, 8 * usize::from(value)).f64();
                }
                _ => {}
            }
        }
        Some(())
    };
    // Keys that are cut short still count as far as they go.
    let _ = read();
    // 0 is "undefined" and 32767 "user-defined": neither is a code.
    let code = |value: Option<u16>| value.filter(|v| !matches!(v, 0 | 32767));
    let unit = match unit {
        Some(9001) => Some(LinearUnit::Metre),
        Some(9002) => Some(LinearUnit::Foot),
        Some(9003) => Some(LinearUnit::UsSurveyFoot),
        _ => unit_size.and_then(LinearUnit::from_metres),
    };
    let (horizontal, note) = match (code(projected), code(geodetic)) {
        (Some(code), _) => (Some(code), None),
        (None, Some(code)) if model == Some(2) => (Some(code), Some(degrees())),
        _ => (None, None),
    };
    let text = horizontal.map(|horizontal| match code(vertical) {
        Some(vertical) => format!("EPSG:{horizontal}+{vertical}"),
        None => format!("EPSG:{horizontal}"),
    });
    // Writers may leave it to the code to tell.
    let unit = unit.or_else(|| Globe::of(text.as_deref()?).ok()?.unit());
    System { text, unit, note }
}

fn is_geographic_wkt(wkt: &str) -> bool {
    let horizontal = wkt.strip_prefix("COMPD_CS").or_else(|| wkt.strip_prefix("COMPOUNDCRS")).unwrap_or(wkt);
    let projected = ["PROJCS", "PROJCRS", "PROJECTEDCRS"].iter().any(|word| horizontal.contains(word));
    !projected && ["GEOGCS", "GEOGCRS", "GEODCRS", "GEOGRAPHICCRS"].iter().any(|word| horizontal.contains(word))
}

/// The unit of the projected system: the last length that is stated before the vertical part.
///
/// In WKT 1 it is `UNIT["name",metres]` directly inside `PROJCS`, after the angles of its `GEOGCS`; in WKT 2
/// `LENGTHUNIT["name",metres]`. Angles have conversion factors that no length has.
pub(super) fn unit_of_wkt(wkt: &str) -> Option<LinearUnit> {
    let end = ["VERT_CS", "VERTCRS", "VERTICALCRS"].iter().filter_map(|word| wkt.find(word)).min();
    let horizontal = &wkt[..end.unwrap_or(wkt.len())];
    if is_geographic_wkt(horizontal) {
        return None;
    }
    let mut unit = None;
    let mut rest = horizontal;
    while let Some(at) = rest.find("UNIT[") {
        rest = &rest[at + "UNIT[".len()..];
        let inside = &rest[..rest.find(']').unwrap_or(rest.len())];
        // The name is quoted and may hold commas.
        let after_name = inside.splitn(3, '"').nth(2).unwrap_or_default();
        let factor = after_name.trim_start_matches([',', ' ']).split(',').next().unwrap_or_default();
        if let Some(found) = factor.trim().parse().ok().and_then(LinearUnit::from_metres) {
            unit = Some(found);
        }
    }
    unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_in_both_kinds_of_wkt() {
        let first = r#"COMPD_CS["a",PROJCS["b",GEOGCS["c",SPHEROID["d",6378137,298.25],UNIT["degree",0.0174532925]],
            UNIT["US survey foot",0.304800609601219,AUTHORITY["EPSG","9003"]]],VERT_CS["e",UNIT["metre",1]]]"#;
        assert_eq!(unit_of_wkt(first), Some(LinearUnit::UsSurveyFoot));
        let second = r#"PROJCRS["b",BASEGEOGCRS["c",ELLIPSOID["d",6378137,298.25,LENGTHUNIT["metre",1]]],
            CS[Cartesian,2],AXIS["x",east],LENGTHUNIT["foot",0.3048]]"#;
        assert_eq!(unit_of_wkt(second), Some(LinearUnit::Foot));
        let degrees = r#"GEOGCS["WGS 84",DATUM["d",SPHEROID["e",6378137,298.25]],UNIT["degree",0.0174532925199433]]"#;
        assert_eq!(unit_of_wkt(degrees), None);
        assert!(is_geographic_wkt(degrees) && !is_geographic_wkt(first) && !is_geographic_wkt(second));
        for damaged in ["UNIT[", "UNIT[\"", "UNIT[\"é", "LENGTHUNIT[é]]", ""] {
            assert_eq!(unit_of_wkt(damaged), None);
        }
    }

    fn keys(entries: &[[u16; 4]]) -> Vec<u8> {
        let head = [1, 1, 0, entries.len() as u16];
        head.iter().chain(entries.iter().flatten()).flat_map(|v| v.to_le_bytes()).collect()
    }

    #[test]
    fn codes_and_units_in_geotiff_keys() {
        let projected = keys(&[[1024, 0, 1, 1], [3072, 0, 1, 28992], [3076, 0, 1, 9001], [4096, 0, 1, 5709]]);
        let system = from_keys(&projected, &[]);
        assert_eq!((system.text.as_deref(), system.unit), (Some("EPSG:28992+5709"), Some(LinearUnit::Metre)));
        for (code, unit) in [(28992, LinearUnit::Metre), (2994, LinearUnit::Foot), (2263, LinearUnit::UsSurveyFoot)] {
            assert_eq!(from_keys(&keys(&[[3072, 0, 1, code]]), &[]).unit, Some(unit), "{code}");
        }
        let size = keys(&[[3072, 0, 1, 32767], [3077, 34736, 1, 1]]);
        let doubles: Vec<u8> = [0.0_f64, 0.3048].iter().flat_map(|v| v.to_le_bytes()).collect();
        let system = from_keys(&size, &doubles);
        assert_eq!((system.text, system.unit), (None, Some(LinearUnit::Foot)));
        let geographic = from_keys(&keys(&[[1024, 0, 1, 2], [2048, 0, 1, 4326]]), &[]);
        assert_eq!(geographic.text.as_deref(), Some("EPSG:4326"));
        assert!(geographic.note.is_some());
        for length in 0..projected.len() {
            let _ = from_keys(&projected[..length], &[]);
        }
    }
}
