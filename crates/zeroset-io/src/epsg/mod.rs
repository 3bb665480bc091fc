//! EPSG codes in the text of a reference system.

mod geographic;

pub(crate) use geographic::is_geographic;

/// The code of the horizontal system, out of `EPSG:n`, `EPSG:n+m` or WKT. `None` if the text states none.
pub(crate) fn code(crs: &str) -> Option<u32> {
    let crs = crs.trim();
    if let Some(codes) = crs.strip_prefix("EPSG:").or_else(|| crs.strip_prefix("epsg:")) {
        return codes.split('+').next()?.trim().parse().ok();
    }
    // The outermost of these, in the order of what contains what.
    PROJECTED.iter().chain(&GEODETIC).find_map(|word| node(crs, word)).and_then(of_node)
}

/// The code of the vertical system, out of `EPSG:n+m` or WKT.
pub(crate) fn vertical_code(crs: &str) -> Option<u32> {
    let crs = crs.trim();
    if let Some(codes) = crs.strip_prefix("EPSG:").or_else(|| crs.strip_prefix("epsg:")) {
        return codes.split_once('+')?.1.trim().parse().ok();
    }
    vertical_node(crs).and_then(of_node)
}

/// What follows the opening bracket of the vertical system in WKT.
pub(crate) fn vertical_node(crs: &str) -> Option<&str> {
    VERTICAL.iter().find_map(|word| node(crs, word))
}

/// Whether a text is WKT of a geographic or a projected system.
pub(crate) fn wkt_kind(crs: &str) -> Option<Kind> {
    let any = |words: &[&str]| words.iter().any(|word| crs.contains(word));
    match (any(&PROJECTED), any(&GEODETIC)) {
        (true, _) => Some(Kind::Projected),
        (false, true) => Some(Kind::Geographic),
        (false, false) => None,
    }
}

/// What horizontal coordinates are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Lengths in a map.
    Projected,
    /// Angles.
    Geographic,
}

const PROJECTED: [&str; 3] = ["PROJCS[", "PROJCRS[", "PROJECTEDCRS["];
const GEODETIC: [&str; 5] = ["GEOGCS[", "GEOGCRS[", "GEOGRAPHICCRS[", "GEODCRS[", "GEODETICCRS["];
const VERTICAL: [&str; 4] = ["VERT_CS[", "VERTCRS[", "VERTICALCRS[", "VERTCS["];

/// What follows the opening bracket of the first node of a name.
fn node<'a>(crs: &'a str, word: &str) -> Option<&'a str> {
    Some(&crs[crs.find(word)? + word.len()..])
}

/// The code that a node of WKT states for itself, given what follows its opening bracket.
fn of_node(inside: &str) -> Option<u32> {
    let (mut depth, mut quoted) = (0_usize, false);
    for (at, c) in inside.char_indices() {
        match c {
            '"' => quoted = !quoted,
            _ if quoted => {}
            '[' | '(' => {
                let name = inside[..at].rsplit(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or_default();
                if depth == 0 && matches!(name, "AUTHORITY" | "ID") {
                    let rest = &inside[at + 1..];
                    return of_authority(&rest[..rest.find([']', ')'])?]);
                }
                depth += 1;
            }
            ']' | ')' => depth = depth.checked_sub(1)?,
            _ => {}
        }
    }
    None
}

/// The code in `"EPSG","28992"` or `"EPSG",28992`.
fn of_authority(words: &str) -> Option<u32> {
    let mut words = words.split(',').map(|word| word.trim().trim_matches('"'));
    (words.next()? == "EPSG").then(|| words.next()?.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::{Kind, code, is_geographic, vertical_code, wkt_kind};

    #[test]
    fn codes_of_the_horizontal_system() {
        let projected = r#"PROJCS["Amersfoort / RD New",GEOGCS["Amersfoort",DATUM["d",AUTHORITY["EPSG","6289"]],
            UNIT["degree",0.0174,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4289"]],UNIT["metre",1,AUTHORITY["EPSG","9001"]],
            AXIS["X",EAST],AUTHORITY["EPSG","28992"]]"#;
        let compound = format!(
            r#"COMPD_CS["RD + NAP",{projected},VERT_CS["NAP",AUTHORITY["EPSG","5709"]],AUTHORITY["EPSG","7415"]]"#
        );
        let second = r#"PROJCRS["a, [b",BASEGEOGCRS["c",ID["EPSG",4289]],CS[Cartesian,2],ID["EPSG",28992]]"#;
        for text in ["EPSG:28992", "EPSG:28992+5709", projected, &compound, second] {
            assert_eq!(code(text), Some(28992), "{text}");
        }
        for (text, vertical) in [("EPSG:28992", None), ("EPSG:28992+5709", Some(5709)), (&compound, Some(5709))] {
            assert_eq!(vertical_code(text), vertical, "{text}");
        }
        assert_eq!((wkt_kind(&compound), wkt_kind("GEOGCRS[")), (Some(Kind::Projected), Some(Kind::Geographic)));
        assert_eq!(wkt_kind("EPSG:4326"), None);
        assert_eq!(
            code(r#"GEOGCS["WGS 84",UNIT["degree",1,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]]"#),
            Some(4326)
        );
    }

    #[test]
    fn codes_of_geographic_systems() {
        // WGS 84, ETRS89, Amersfoort, GDA2020; then RD New, ETRS89 / UTM zone 32N in two forms, WGS 84 / Pseudo-Mercator.
        assert!([4326, 4258, 4289, 7844].into_iter().all(is_geographic));
        assert!(![28992, 25832, 4647, 3857, 0, u32::MAX].into_iter().any(is_geographic));
    }

    #[test]
    fn no_code_is_made_up() {
        for text in [
            "",
            "EPSG:",
            "EPSG:x",
            "a local grid",
            r#"PROJCS["a",GEOGCS["b",AUTHORITY["EPSG","4289"]],UNIT["metre",1,AUTHORITY["EPSG","9001"]]]"#,
            r#"PROJCS["a",AUTHORITY["ESRI","28992"]]"#,
            r#"PROJCS["a",AUTHORITY["EPSG"#,
            "PROJCS[]]]",
            "PROJCS[é[",
        ] {
            assert_eq!(code(text), None, "{text}");
        }
    }
}
