//! What an EPSG code stands for, in the notation of PROJ, and which of these can be placed.

use super::GlobeError;

/// Systems whose axes point south and west, of which the parameters say nothing. Out of version 11.022 of the EPSG data set.
const SOUTH_AND_WEST: [u32; 4] = [2065, 5513, 8044, 8045];

/// Systems of longitude and latitude in grads. Out of the same.
const GRADS: [u32; 9] = [4807, 4810, 4811, 4816, 4819, 4821, 4901, 4902, 7400];

/// Systems that the parameters place a hundred metres to thousands of kilometres away from where the EPSG data set does:
/// by other spheres, parallels, meridians, signs of rotations, and shifts.
const WRONG: [u32; 19] = [
    2082, 2984, 3303, 3973, 3974, 3975, 4055, 4161, 4240, 4645, 4688, 6200, 6871, 6996, 6997, 24_047, 24_048, 26_591,
    26_592,
];

/// Ellipsoids about the centre of the earth. Where no shift is given, a datum on one of these is WGS 84 to metres.
const GEOCENTRIC_ELLIPSOIDS: [&str; 2] = ["GRS80", "WGS84"];

/// Parameters `+key` and `+key=value`, apart from each other by spaces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Definition(&'static str);

impl Definition {
    /// What a code stands for, if its positions can be placed.
    pub(super) fn of(code: u32) -> Result<Self, GlobeError> {
        let known = u16::try_from(code).ok().and_then(crs_definitions::from_code);
        let definition = Self(known.ok_or(GlobeError::UnknownCode { code })?.proj4);
        definition.check(code)?;
        Ok(definition)
    }

    pub(super) fn text(self) -> &'static str {
        self.0
    }

    pub(super) fn states_vertical_unit(self) -> bool {
        self.value("vunits").is_some()
    }

    fn value(self, key: &str) -> Option<&'static str> {
        self.0.split_whitespace().find_map(|word| word.strip_prefix('+')?.strip_prefix(key)?.strip_prefix('='))
    }

    fn check(self, code: u32) -> Result<(), GlobeError> {
        if self.value("proj") == Some("geocent") {
            return Err(GlobeError::Geocentric { code });
        }
        if self.value("axis").is_some() || SOUTH_AND_WEST.contains(&code) {
            return Err(GlobeError::Axes { code });
        }
        if GRADS.contains(&code) {
            return Err(GlobeError::Grads { code });
        }
        if WRONG.contains(&code) {
            return Err(GlobeError::Definition { code });
        }
        match (self.value("nadgrids"), self.value("datum"), self.value("towgs84"), self.value("ellps")) {
            (Some("@null"), ..) => Ok(()),
            (Some(grid), ..) | (None, Some(grid @ "NAD27"), ..) => Err(GlobeError::Grid { code, grid }),
            (_, Some(_), ..) | (.., Some(_), _) => Ok(()),
            (.., ellipsoid) if ellipsoid.is_some_and(|name| GEOCENTRIC_ELLIPSOIDS.contains(&name)) => Ok(()),
            // Two codes of the data set have no parameters at all.
            _ if self.value("proj").is_some() => Err(GlobeError::Datum { code }),
            _ => Err(GlobeError::UnknownCode { code }),
        }
    }
}
