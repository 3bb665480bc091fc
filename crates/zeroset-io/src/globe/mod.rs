//! Where positions of a coordinate reference system lie on the globe.
//!
//! A [`Globe`] takes positions of one reference system to earth-centred, earth-fixed metres of WGS 84 (EPSG:4978), in
//! which 3D Tiles are placed. A [`Frame`] is the tangent plane at such a position: east, north and up.
//!
//! ```
//! use zeroset_io::Globe;
//! let globe = Globe::of("EPSG:28992+5709")?;
//! let delft = [84_800.0, 447_400.0, 2.0];
//! let frame = globe.frame(delft)?;
//! let [east, north, up] = frame.local(globe.geocentric([84_900.0, 447_400.0, 2.0])?);
//! assert!((east - 100.0).abs() < 0.1 && north.abs() < 1.5 && up.abs() < 0.01);
//! # Ok::<(), zeroset_io::GlobeError>(())
//! ```
//!
//! # Coordinates
//! - x is east or the longitude, y is north or the latitude, as files of points have them, whatever order the EPSG data
//!   set gives the axes. Longitudes and latitudes are degrees.
//! - x and y are in the unit of the system: metres, feet, US survey feet and so on.
//! - z is in the unit of the vertical system, where the text states one: in WKT, or as a code. Else it is in the unit of
//!   the horizontal system, and in metres beside degrees.
//!
//! # Accuracy
//! - **Heights** are taken as heights above the ellipsoid of the system itself: there is no model of the geoid. Under a
//!   system on the ellipsoid of WGS 84 or GRS 80, heights above the sea come to lie too low or too high by the
//!   undulation of the geoid, up to 100 m. The ellipsoids of older national grids follow the geoid of their country:
//!   at Delft, heights of NAP under RD New come to lie 43.6 m higher in WGS 84, about as high as the geoid is there.
//! - **Datums** are shifted by the three or seven Helmert parameters of the definition, without grids of corrections. RD
//!   New comes to lie 13 mm from where PROJ 9.5 puts it by default at Delft, and up to about 0.25 m from where its grid
//!   of corrections does. Other national grids are some metres off, where three parameters stand for a country.
//! - **NAD 83, ETRS 89, GDA** and their like are taken for WGS 84, from which the drift of continents has taken them by up to
//!   two metres.
//! - Projections are inverted to less than a millimetre within the area of use of a system. Far outside of it a result may
//!   be meaningless. Grids on the ellipsoid of Clarke 1880 are up to a decimetre off, as the definitions round it.
//!
//! # Refused
//! - Texts that state no EPSG code: what projections and datums are called in WKT is not settled well enough.
//! - Systems whose axes point west or south, whose angles are not degrees, or which are geocentric themselves.
//! - Systems that only a grid of corrections ties to WGS 84, such as NAD 27, and systems that nothing ties to it. The empty
//!   grid of EPSG:3857 counts as a tie: its coordinates are those of WGS 84.
//! - Nineteen systems whose parameters at hand contradict the EPSG data set.
//! - Vertical systems of depths.
//!
//! # Guaranteed
//! - Equal positions give equal results, bit for bit, alone or among others, on any number of threads.
//! - A result is finite. No text and no position makes it panic.
//!
//! # Source
//! Definitions: the EPSG data set, as parameters of PROJ. Earth-centred coordinates and Helmert parameters: IOGP Guidance
//! Note 373-7-2, methods 9602 and 9606.

mod definition;
mod frame;
mod height;

use proj4rs::Proj;
use proj4rs::transform::transform;
use rayon::prelude::*;

use crate::{LinearUnit, epsg};
use definition::Definition;
pub use frame::Frame;

/// Where positions of one reference system lie on the globe.
#[derive(Debug, Clone)]
pub struct Globe {
    code: u32,
    system: Proj,
    geocentric: Proj,
    /// From x, y and z as they are stated to what the projection takes.
    scale: [f64; 3],
}

/// Why positions cannot be placed on the globe.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GlobeError {
    /// The text of the reference system states no EPSG code.
    #[error(
        "the reference system states no EPSG code, so it cannot be placed on the globe; give the input one that does"
    )]
    NoCode,
    /// The code is not known.
    #[error("no reference system EPSG:{code} is known; check the code, or transform the input to another system")]
    UnknownCode {
        /// The code.
        code: u32,
    },
    /// The projection cannot be inverted.
    #[error("the projection of EPSG:{code} cannot be inverted ({why}); transform the input to another system")]
    Projection {
        /// The code.
        code: u32,
        /// What is wrong with it.
        why: String,
    },
    /// What is known of the system contradicts the EPSG data set.
    #[error("the parameters of EPSG:{code} at hand are wrong; transform the input to another system")]
    Definition {
        /// The code.
        code: u32,
    },
    /// The axes of the system do not point east and north.
    #[error(
        "the axes of EPSG:{code} do not point east and north; transform the input to a system whose axes do, such as UTM"
    )]
    Axes {
        /// The code.
        code: u32,
    },
    /// The angles of the system are not degrees.
    #[error("the angles of EPSG:{code} are grads; transform the input to a system in degrees or metres")]
    Grads {
        /// The code.
        code: u32,
    },
    /// Positions of the system are relative to the centre of the earth.
    #[error(
        "EPSG:{code} is relative to the centre of the earth; transform the input to a map projection, where z is up"
    )]
    Geocentric {
        /// The code.
        code: u32,
    },
    /// Only a grid of corrections ties the system to WGS 84.
    #[error("EPSG:{code} is tied to WGS 84 by a grid of corrections ({grid}); transform the input to another system")]
    Grid {
        /// The code.
        code: u32,
        /// Name of the grid, or of the datum that needs grids.
        grid: &'static str,
    },
    /// Nothing is known about where the datum of the system lies.
    #[error("nothing is known about where the datum of EPSG:{code} lies; transform the input to another system")]
    Datum {
        /// The code.
        code: u32,
    },
    /// The vertical axis points down.
    #[error("the vertical reference system measures depths; give the input heights")]
    Depths,
    /// A position lies outside of what the system can show.
    #[error("the position {position:?} does not lie in EPSG:{code} ({why}); check the reference system of the input")]
    Position {
        /// The code.
        code: u32,
        /// The position.
        position: [f64; 3],
        /// What is wrong with it.
        why: String,
    },
}

impl Globe {
    /// Finds the place of a reference system, given as what [`ReadReport::crs`](crate::ReadReport::crs) holds:
    /// `EPSG:28992`, `EPSG:28992+5709`, or WKT with codes.
    ///
    /// # Errors
    /// If the text states no code, or one of a system that is not known or is refused.
    pub fn of(crs: &str) -> Result<Self, GlobeError> {
        let code = epsg::code(crs).ok_or(GlobeError::NoCode)?;
        let definition = Definition::of(code)?;
        let no_projection =
            |error: proj4rs::errors::Error| GlobeError::Projection { code, why: error.to_string().to_lowercase() };
        let system = Proj::from_proj_string(definition.text()).map_err(no_projection)?;
        let geocentric = Proj::from_proj_string("+proj=geocent +datum=WGS84 +units=m").map_err(no_projection)?;
        let horizontal = if system.is_latlong() { 1.0 } else { system.to_meter() };
        let height = match height::metres(crs)? {
            Some(metres) => metres,
            None if definition.states_vertical_unit() => system.vto_meter(),
            None => horizontal,
        };
        let angle = if system.is_latlong() { 1_f64.to_radians() } else { 1.0 };
        // The projection scales x, y and z by its own units.
        Ok(Self { code, scale: [angle, angle, height / system.vto_meter()], system, geocentric })
    }

    /// The EPSG code of the horizontal system.
    #[must_use]
    pub fn code(&self) -> u32 {
        self.code
    }

    /// The unit of x and y; `None` if they are degrees, or in a unit without a name here.
    #[must_use]
    pub fn unit(&self) -> Option<LinearUnit> {
        if self.system.is_latlong() { None } else { LinearUnit::from_metres(self.system.to_meter()) }
    }

    /// Where a position lies, in earth-centred, earth-fixed metres of WGS 84.
    ///
    /// # Errors
    /// If the position does not lie in the system, or is not finite.
    pub fn geocentric(&self, position: [f64; 3]) -> Result<[f64; 3], GlobeError> {
        let outside = |why: String| GlobeError::Position { code: self.code, position, why };
        let [x, y, z] = position;
        let mut at = (x * self.scale[0], y * self.scale[1], z * self.scale[2]);
        if !(at.0.is_finite() && at.1.is_finite() && at.2.is_finite()) {
            return Err(outside("not a number".into()));
        }
        transform(&self.system, &self.geocentric, &mut at)
            .map_err(|error| outside(error.to_string().to_lowercase()))?;
        let found = [at.0, at.1, at.2];
        if found.iter().all(|v| v.is_finite()) { Ok(found) } else { Err(outside("outside of the projection".into())) }
    }

    /// Puts every position where [`Globe::geocentric`] says, in parallel.
    ///
    /// # Errors
    /// If one of them cannot be placed: that of the first. Some are placed then, and others are not.
    pub fn geocentric_all(&self, positions: &mut [[f64; 3]]) -> Result<(), GlobeError> {
        let place = |position: &mut [f64; 3]| match self.geocentric(*position) {
            Ok(found) => {
                *position = found;
                None
            }
            Err(error) => Some(error),
        };
        match positions.par_iter_mut().with_min_len(256).find_map_first(place) {
            None => Ok(()),
            Some(error) => Err(error),
        }
    }

    /// The frame of east, north and up at a position.
    ///
    /// # Errors
    /// If the position does not lie in the system, or is not finite.
    pub fn frame(&self, position: [f64; 3]) -> Result<Frame, GlobeError> {
        self.geocentric(position).map(Frame::at)
    }
}

#[cfg(test)]
mod tests;
