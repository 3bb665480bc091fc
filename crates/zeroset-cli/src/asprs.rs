//! Names of ASPRS classes.

/// The name that the LAS 1.4 R15 specification gives to a class, table 17.
pub(crate) fn class_name(class: u8) -> &'static str {
    match class {
        0 => "never classified",
        1 => "unclassified",
        2 => "ground",
        3 => "low vegetation",
        4 => "medium vegetation",
        5 => "high vegetation",
        6 => "building",
        7 => "low point (noise)",
        8 => "model key-point (LAS 1.0 to 1.3)",
        9 => "water",
        10 => "rail",
        11 => "road surface",
        12 => "overlap (LAS 1.0 to 1.3)",
        13 => "wire guard (shield)",
        14 => "wire conductor (phase)",
        15 => "transmission tower",
        16 => "wire-structure connector",
        17 => "bridge deck",
        18 => "high noise",
        19 => "overhead structure",
        20 => "ignored ground",
        21 => "snow",
        22 => "temporal exclusion",
        23..=63 => "reserved",
        64.. => "user definable",
    }
}
