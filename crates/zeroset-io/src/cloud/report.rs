//! What was read, and what there is to say about it.

use std::path::{Path, PathBuf};

use zeroset::cloud::{Attributes, Cloud};

use crate::{CloudFormat, shown};

/// The unit of coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LinearUnit {
    /// Metres.
    Metre,
    /// International feet, 0.3048 m.
    Foot,
    /// US survey feet, 1200 / 3937 m.
    UsSurveyFoot,
}

impl LinearUnit {
    /// Length of the unit in metres.
    #[must_use]
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Foot => 0.3048,
            Self::UsSurveyFoot => 1200.0 / 3937.0,
        }
    }

    /// The name that messages and file comments use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "metre",
            Self::Foot => "foot",
            Self::UsSurveyFoot => "US survey foot",
        }
    }

    /// The sign that stands behind numbers.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Foot => "ft",
            Self::UsSurveyFoot => "us-ft",
        }
    }

    /// The unit of a given [`name`](Self::name).
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Metre, Self::Foot, Self::UsSurveyFoot].into_iter().find(|unit| unit.name() == name)
    }

    /// The unit of a given length in metres. The two feet differ by 2e-6, files give at least seven digits.
    pub(crate) fn from_metres(metres: f64) -> Option<Self> {
        let near = |unit: &Self| (unit.metres() - metres).abs() < 1e-7 * metres;
        [Self::Metre, Self::Foot, Self::UsSurveyFoot].into_iter().find(near)
    }
}

/// One of the files that a cloud was read from.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Source {
    /// The file; `-` is standard input.
    pub path: PathBuf,
    /// Its format.
    pub format: CloudFormat,
    /// Points that the cloud has of it.
    pub points: u64,
    /// Points left out because they are not finite or marked as invalid.
    pub non_finite: u64,
    /// Points left out because they are marked as withheld.
    pub withheld: u64,
    /// What the file holds beside positions: "colors", "intensities", "classes".
    pub attributes: Vec<&'static str>,
}

impl Source {
    /// Whether the file holds an attribute.
    #[must_use]
    pub fn has(&self, attribute: &str) -> bool {
        self.attributes.contains(&attribute)
    }
}

/// The colour of points that have none, among points that do: white.
pub const NO_COLOR: [u8; 3] = [255; 3];
/// The intensity of points that have none, among points that do.
pub const NO_INTENSITY: f32 = 0.0;
/// The class of points that have none, among points that do: "created, never classified".
pub const NO_CLASS: u8 = 0;

/// What reading a cloud found out.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ReadReport {
    /// The format; of the first input if there were several.
    pub format: CloudFormat,
    /// The files that were read, in the order given.
    pub sources: Vec<Source>,
    /// How many points the files state, where they do.
    pub points_declared: Option<u64>,
    /// How many points the cloud has.
    pub points_read: u64,
    /// Points left out because a coordinate was NaN or infinite, or because the scanner marked the point as invalid.
    pub non_finite: u64,
    /// Points left out because a LAS file marks them as withheld, that is, deleted.
    pub withheld: u64,
    /// The unit of the coordinates, where the file tells.
    pub unit: Option<LinearUnit>,
    /// The coordinate reference system as the file states it.
    pub crs: Option<String>,
    /// What else the file tells about its origin, as name and value: software, scanner, date, version and so on.
    pub facts: Vec<(&'static str, String)>,
    /// Sentences about what a user may want to know: columns passed over, conflicts between inputs.
    pub notes: Vec<String>,
}

/// A cloud and what reading it found out.
#[derive(Debug, Clone)]
pub struct CloudFile {
    /// The points.
    pub cloud: Cloud,
    /// What reading found out.
    pub report: ReadReport,
}

/// A cloud before the offset is taken off, so that several can be joined without rounding twice.
#[derive(Debug)]
pub(crate) struct WorldCloud {
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) attributes: Attributes,
    pub(crate) crs: Option<String>,
    pub(crate) report: ReadReport,
}

impl WorldCloud {
    pub(crate) fn into_file(mut self) -> CloudFile {
        let there = attribute_names(&self.attributes);
        for source in &self.report.sources {
            let lacks: Vec<&str> = there.iter().copied().filter(|name| !source.has(name)).collect();
            if !lacks.is_empty() {
                self.report.notes.push(lacking(&source.path, &lacks));
            }
        }
        let cloud = Cloud { attributes: self.attributes, crs: self.crs, ..Cloud::from_world(self.points) };
        CloudFile { cloud, report: self.report }
    }

    pub(crate) fn append(&mut self, path: &Path, next: Self) {
        let points = [self.points.len(), next.points.len()];
        join(&mut self.attributes.colors, next.attributes.colors, points, NO_COLOR);
        join(&mut self.attributes.intensities, next.attributes.intensities, points, NO_INTENSITY);
        join(&mut self.attributes.classes, next.attributes.classes, points, NO_CLASS);
        self.points.extend_from_slice(&next.points);

        let (report, other) = (&mut self.report, next.report);
        let name = shown(path);
        match (&self.crs, next.crs) {
            (None, Some(crs)) => {
                report.notes.push(format!("{name} states a reference system, files before it state none"));
                report.crs = Some(crs.clone());
                self.crs = Some(crs);
            }
            (Some(_), None) => report.notes.push(format!("{name} states no reference system, files before it do")),
            (Some(first), Some(crs)) if *first != crs => report.notes.push(format!(
                "{name} states another reference system than the files before it; coordinates are taken as they are"
            )),
            _ => {}
        }
        match (report.unit, other.unit) {
            (Some(first), Some(unit)) if first != unit => report.notes.push(format!(
                "{name} is in the unit {}, the files before it in the unit {}; lengths are taken as they are",
                unit.name(),
                first.name()
            )),
            (first, unit) => report.unit = first.or(unit),
        }
        report.sources.extend(other.sources);
        // A total is only stated if every input states its part.
        report.points_declared = report.points_declared.zip(other.points_declared).map(|(a, b)| a.saturating_add(b));
        report.points_read += other.points_read;
        report.non_finite += other.non_finite;
        report.withheld += other.withheld;
        for fact in other.facts {
            if !report.facts.contains(&fact) {
                report.facts.push(fact);
            }
        }
        report.notes.extend(other.notes.into_iter().map(|note| format!("{name}: {note}")));
    }
}

/// Appends the values of `points[1]` points to those of `points[0]`; where only one side has values, `none` stands in.
fn join<T: Clone>(all: &mut Option<Vec<T>>, next: Option<Vec<T>>, points: [usize; 2], none: T) {
    if all.is_none() && next.is_none() {
        return;
    }
    let values = all.get_or_insert_with(|| vec![none.clone(); points[0]]);
    match next {
        Some(next) => values.extend(next),
        None => values.resize(points[0] + points[1], none),
    }
}

/// The names of what there is beside positions.
pub(crate) fn attribute_names(attributes: &Attributes) -> Vec<&'static str> {
    let there = [
        ("colors", attributes.colors.is_some()),
        ("intensities", attributes.intensities.is_some()),
        ("classes", attributes.classes.is_some()),
    ];
    there.into_iter().filter(|(_, there)| *there).map(|(name, _)| name).collect()
}

/// The sentence about what other inputs have and this one does not.
fn lacking(path: &Path, names: &[&str]) -> String {
    let stand_in = |name: &&str| match *name {
        "colors" => "white",
        "intensities" => "intensity 0",
        _ => "class 0 (never classified)",
    };
    let stand_ins: Vec<&str> = names.iter().map(stand_in).collect();
    format!("{} has no {}; its points get {}", shown(path), names.join(", no "), stand_ins.join(", "))
}
