//! Values with a shape of their own.

use std::num::NonZeroUsize;

use zeroset_io::LinearUnit;
use zeroset_view::render::{Background, Direction};

/// ASPRS classes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Classes(pub Vec<u8>);

/// A box of world coordinates: the lowest and highest value on each axis, infinite where it is open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds(pub [[f64; 2]; 3]);

impl Bounds {
    /// The lower and the upper corner.
    pub(crate) fn corners(self) -> [[f64; 3]; 2] {
        [0, 1].map(|end| self.0.map(|side| side[end]))
    }
}

/// A plane: a position on it and a normal of any length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// The position.
    pub point: [f64; 3],
    /// The normal.
    pub normal: [f64; 3],
}

/// A box in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// Lower corner.
    pub low: [f64; 2],
    /// Upper corner, above the lower one on both axes.
    pub high: [f64; 2],
}

/// Where a picture is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewpoint(pub Direction);

/// What is behind a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Backdrop(pub Background);

/// A value, or `off`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OrOff<T> {
    /// `off`.
    Off,
    /// The value.
    Value(T),
}

impl<T> OrOff<T> {
    /// `None` for `off`.
    pub fn value(self) -> Option<T> {
        match self {
            Self::Off => None,
            Self::Value(value) => Some(value),
        }
    }

    fn parse(text: &str, value: impl FnOnce(&str) -> Result<T, String>) -> Result<Self, String> {
        if text == "off" { Ok(Self::Off) } else { value(text).map(Self::Value) }
    }
}

/// A value, or `auto`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OrAuto<T> {
    /// `auto`.
    Auto,
    /// The value.
    Value(T),
}

impl<T> OrAuto<T> {
    /// `None` for `auto`.
    pub fn value(self) -> Option<T> {
        match self {
            Self::Auto => None,
            Self::Value(value) => Some(value),
        }
    }
}

fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err("a finite number is needed".into()) }
}

pub(super) fn positive(text: &str) -> Result<f64, String> {
    number(text).and_then(|v| if v > 0.0 { Ok(v) } else { Err("it must be greater than 0".into()) })
}

/// A length, and its unit where one was typed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Length {
    /// How many.
    pub value: f64,
    /// Of what; `None`: of the unit of the input.
    pub unit: Option<LinearUnit>,
}

/// `250`, `250m`, `0.25 km`, `800ft`, `800 us-ft`.
pub(super) fn length(text: &str) -> Result<Length, String> {
    const UNITS: [(&str, f64, LinearUnit); 4] = [
        ("us-ft", 1.0, LinearUnit::UsSurveyFoot),
        ("ft", 1.0, LinearUnit::Foot),
        ("km", 1000.0, LinearUnit::Metre),
        ("m", 1.0, LinearUnit::Metre),
    ];
    let typed = text.trim().to_ascii_lowercase();
    let found = UNITS.iter().find_map(|(suffix, factor, unit)| Some((typed.strip_suffix(suffix)?, *factor, *unit)));
    let (digits, factor, unit) = found.map_or((typed.as_str(), 1.0, None), |(d, f, u)| (d.trim_end(), f, Some(u)));
    Ok(Length { value: factor * positive(digits)?, unit })
}

pub(super) fn not_negative(text: &str) -> Result<f64, String> {
    number(text).and_then(|v| if v >= 0.0 { Ok(v) } else { Err("it must not be negative".into()) })
}

pub(super) fn smooth(text: &str) -> Result<OrAuto<f64>, String> {
    if text == "auto" { Ok(OrAuto::Auto) } else { positive(text).map(OrAuto::Value) }
}

/// Degrees, as typed.
pub(super) fn sharp_angle(text: &str) -> Result<f64, String> {
    positive(text).and_then(|v| if v < 180.0 { Ok(v) } else { Err("it must be less than 180".into()) })
}

/// Degrees between two planes, as typed.
pub(super) fn plane_angle(text: &str) -> Result<f64, String> {
    positive(text).and_then(|v| if v < 90.0 { Ok(v) } else { Err("it must be less than 90".into()) })
}

pub(super) fn classes(text: &str) -> Result<Classes, String> {
    let class = |word: &str| {
        let word = word.trim();
        word.parse().map_err(|_| format!("`{word}` is no class; classes are whole numbers from 0 to 255, as in 2,6,9"))
    };
    text.split(',').map(class).collect::<Result<_, _>>().map(Classes)
}

pub(super) fn excluded(text: &str) -> Result<Classes, String> {
    if text == "none" { Ok(Classes(Vec::new())) } else { classes(text) }
}

pub(super) fn bounds(text: &str) -> Result<Bounds, String> {
    let values = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    let open = [f64::NEG_INFINITY, f64::INFINITY];
    let sides = match values[..] {
        [x0, y0, x1, y1] => [[x0, x1], [y0, y1], open],
        [x0, y0, x1, y1, z0, z1] => [[x0, x1], [y0, y1], [z0, z1]],
        _ => return Err(format!("4 or 6 numbers are needed, {} were given", values.len())),
    };
    for (axis, [low, high]) in ["x", "y", "z"].iter().zip(sides) {
        if low > high {
            return Err(format!("{axis}min is greater than {axis}max; the order is xmin,ymin,xmax,ymax[,zmin,zmax]"));
        }
    }
    Ok(Bounds(sides))
}

/// A height, or a position and a normal.
pub(super) fn plane(text: &str) -> Result<Plane, String> {
    let three = |text: &str| -> Result<[f64; 3], String> {
        let values = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
        values[..].try_into().map_err(|_| format!("`{}` has not three numbers", text.trim()))
    };
    match text.split_once(';') {
        None if text.contains(',') => Err("a height or x,y,z; nx,ny,nz is needed".into()),
        None => Ok(Plane { point: [0.0, 0.0, number(text)?], normal: [0.0, 0.0, 1.0] }),
        Some((point, normal)) => {
            let (point, normal) = (three(point)?, three(normal)?);
            if normal == [0.0; 3] { Err("the normal is zero".into()) } else { Ok(Plane { point, normal }) }
        }
    }
}

pub(super) fn rectangle(text: &str) -> Result<Rectangle, String> {
    let values = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
    let [x0, y0, x1, y1] = values[..] else { return Err(format!("4 numbers are needed, {} were given", values.len())) };
    if x0 < x1 && y0 < y1 {
        Ok(Rectangle { low: [x0, y0], high: [x1, y1] })
    } else {
        Err("xmax must be greater than xmin, and ymax than ymin; the order is xmin,ymin,xmax,ymax".into())
    }
}

/// A preset, an azimuth and an elevation in degrees, or two positions.
pub(super) fn viewpoint(text: &str) -> Result<Viewpoint, String> {
    let preset = match text.trim().to_ascii_lowercase().as_str() {
        "iso" => Some(Direction::Iso),
        "top" => Some(Direction::Top),
        "bottom" => Some(Direction::Bottom),
        "front" => Some(Direction::Front),
        "back" => Some(Direction::Back),
        "left" => Some(Direction::Left),
        "right" => Some(Direction::Right),
        _ => None,
    };
    if let Some(direction) = preset {
        return Ok(Viewpoint(direction));
    }
    let wanted = "iso, top, bottom, front, back, left, right, azimuth,elevation in degrees, or x,y,z,x,y,z of the camera and of what it looks at";
    if !text.contains(',') {
        return Err(format!("`{text}` is none of {wanted}"));
    }
    match text.split(',').map(number).collect::<Result<Vec<f64>, String>>()?[..] {
        [azimuth, elevation] if (-90.0..=90.0).contains(&elevation) => {
            Ok(Viewpoint(Direction::From { azimuth: azimuth.to_radians(), elevation: elevation.to_radians() }))
        }
        [_, elevation] => Err(format!("an elevation of {elevation} is not possible; give -90 to 90")),
        [ex, ey, ez, x, y, z] => Ok(Viewpoint(Direction::Placed { eye: [ex, ey, ez], target: [x, y, z] })),
        ref others => Err(format!("{} numbers are given; wanted is one of {wanted}", others.len())),
    }
}

/// `1600x1200`.
pub(super) fn pixels(text: &str) -> Result<[u32; 2], String> {
    let sides = text.trim().split_once(['x', 'X']).map(|(width, height)| [width, height].map(|s| s.trim().parse()));
    match sides {
        Some([Ok(width), Ok(height)]) => Ok([width, height]),
        _ => Err(format!("`{text}` is no size such as 1600x1200")),
    }
}

/// `white`, `black`, `transparent`, `#rrggbb`.
pub(super) fn backdrop(text: &str) -> Result<Backdrop, String> {
    let plain = |color| Ok(Backdrop(Background::Plain(color)));
    match text.trim().to_ascii_lowercase().as_str() {
        "transparent" => Ok(Backdrop(Background::Transparent)),
        "white" => plain([255; 3]),
        "black" => plain([0; 3]),
        other => {
            let digits = other.strip_prefix('#').filter(|d| d.len() == 6 && d.bytes().all(|b| b.is_ascii_hexdigit()));
            let value = digits.and_then(|d| u32::from_str_radix(d, 16).ok());
            let value = value.ok_or_else(|| format!("`{text}` is none of white, black, transparent and #rrggbb"))?;
            let [_, r, g, b] = value.to_be_bytes();
            plain([r, g, b])
        }
    }
}

/// `LOW,HIGH`.
pub(super) fn range(text: &str) -> Result<[f64; 2], String> {
    match text.split(',').map(number).collect::<Result<Vec<f64>, String>>()?[..] {
        [low, high] if low < high => Ok([low, high]),
        _ => Err("two numbers are needed, the lower one first".into()),
    }
}

pub(super) fn angle_of_view(text: &str) -> Result<f64, String> {
    positive(text).and_then(|v| if v < 170.0 { Ok(v) } else { Err("it must be less than 170".into()) })
}

pub(super) fn outliers(text: &str) -> Result<OrOff<NonZeroUsize>, String> {
    OrOff::parse(text, |text| {
        let groups = text.parse().ok().filter(|k: &NonZeroUsize| k.get() <= 1000);
        groups.ok_or_else(|| "`off` or a whole number from 1 to 1000 is needed".into())
    })
}

pub(super) fn min_component(text: &str) -> Result<OrOff<NonZeroUsize>, String> {
    OrOff::parse(text, |text| text.parse().map_err(|_| "`off` or a whole number from 1 is needed".into()))
}

pub(super) fn trim(text: &str) -> Result<OrOff<f64>, String> {
    OrOff::parse(text, positive)
}

pub(super) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let threads = text.parse().ok().filter(|n: &NonZeroUsize| n.get() <= 1024);
    threads.ok_or_else(|| "a whole number from 1 to 1024 is needed".into())
}

/// Bytes: `4GB`, `4 GiB`, `500M`, `1e9`.
pub(super) fn size(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 13] = [
        ("kib", 1024.0),
        ("mib", 1_048_576.0),
        ("gib", 1_073_741_824.0),
        ("tib", 1_099_511_627_776.0),
        ("kb", 1e3),
        ("mb", 1e6),
        ("gb", 1e9),
        ("tb", 1e12),
        ("k", 1e3),
        ("m", 1e6),
        ("g", 1e9),
        ("t", 1e12),
        ("b", 1.0),
    ];
    let lower = text.trim().to_ascii_lowercase();
    let with_unit = UNITS.iter().find_map(|(unit, bytes)| Some((lower.strip_suffix(unit)?, *bytes)));
    let (digits, unit) = with_unit.unwrap_or((&lower, 1.0));
    let bytes = positive(digits).map_err(|why| format!("{why}; give a size such as 500MB or 4GB"))? * unit;
    // A plain number is more likely meant in another unit than in bytes.
    if bytes < 1e6 {
        Err("less than 1 MB is never enough; give a size such as 500MB or 4GB".into())
    } else {
        Ok(bytes as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_in_every_unit() {
        for (text, bytes) in
            [("4GB", 4_000_000_000), ("4g", 4_000_000_000), ("0.5 GiB", 536_870_912), ("2000000", 2_000_000)]
        {
            assert_eq!(size(text), Ok(bytes), "{text}");
        }
        for text in ["", "GB", "-1GB", "4", "nan", "4 PB", "infGB"] {
            assert!(size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn bounds_with_and_without_heights() {
        assert_eq!(bounds("-1,-2,3.5,4").map(|b| b.0[0]), Ok([-1.0, 3.5]));
        assert_eq!(bounds("-1, -2, 3, 4, -5, 6").map(|b| b.0[2]), Ok([-5.0, 6.0]));
        for text in ["", "1,2,3", "1,2,3,4,5", "3,0,1,1", "a,b,c,d", "0,0,nan,1"] {
            assert!(bounds(text).is_err(), "{text}");
        }
    }

    #[test]
    fn planes_are_heights_or_have_a_normal() {
        assert_eq!(plane("-2.5"), Ok(Plane { point: [0.0, 0.0, -2.5], normal: [0.0, 0.0, 1.0] }));
        assert_eq!(plane("1,2,3; 0,-1,0"), Ok(Plane { point: [1.0, 2.0, 3.0], normal: [0.0, -1.0, 0.0] }));
        for text in ["", "1,2,3", "1,2,3;0,0,0", "1,2;0,0,1", "1,2,3;0,0,1;4", "x", "nan"] {
            assert!(plane(text).is_err(), "{text}");
        }
    }

    #[test]
    fn rectangles_have_an_area() {
        assert_eq!(rectangle("-1,0, 2,3"), Ok(Rectangle { low: [-1.0, 0.0], high: [2.0, 3.0] }));
        for text in ["", "0,0,1", "0,0,1,1,1", "0,0,0,1", "1,0,0,1", "0,0,inf,1"] {
            assert!(rectangle(text).is_err(), "{text}");
        }
    }

    #[test]
    fn classes_are_lists() {
        assert_eq!(classes("2, 6,9"), Ok(Classes(vec![2, 6, 9])));
        assert_eq!(excluded("none"), Ok(Classes(vec![])));
        for text in ["", "256", "-1", "2;6", "ground"] {
            assert!(classes(text).is_err(), "{text}");
        }
    }
}
