//! `zeroset info`.

mod model;

use std::path::Path;

use serde::Serialize;
use zeroset::cloud::{Cloud, Spacing};
use zeroset::mesh::{Topology, topology};
use zeroset_io::solid::MODEL_SUFFIX;
use zeroset_io::{LinearUnit, ReadReport, is_model, shown};

use self::model::ModelInfo;
use crate::args::InfoArgs;
use crate::asprs::class_name;
use crate::compare::topologies;
use crate::console::Console;
use crate::error::CliError;
use crate::input::{CloudOrMesh, cloud_or_mesh, read_cloud_or_mesh};
use crate::report::to_json_line;
use crate::table::{columns, count, decimals_for, pairs, position, significant};

pub(crate) fn run(args: &InfoArgs) -> Result<(), CliError> {
    for (i, path) in args.files.iter().enumerate() {
        let info = Info::of(path)?;
        if args.json {
            Console::print(&to_json_line(&info))?;
        } else {
            Console::print(&format!("{}{}", if i > 0 { "\n" } else { "" }, info.text()))?;
        }
    }
    Ok(())
}

#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Info {
    Cloud(CloudInfo),
    Mesh(MeshInfo),
    Model(ModelInfo),
}

#[derive(Debug, Serialize)]
struct CloudInfo {
    file: String,
    format: &'static str,
    points: usize,
    points_declared: Option<u64>,
    non_finite: u64,
    withheld: u64,
    /// Lowest and highest corner in world coordinates.
    bounds: Option<[[f64; 3]; 2]>,
    spacing: Option<Spacing>,
    classes: Option<Vec<Class>>,
    attributes: Vec<&'static str>,
    crs: Option<String>,
    unit: Option<&'static str>,
    facts: Vec<(&'static str, String)>,
    notes: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Class {
    class: u8,
    name: &'static str,
    points: u64,
}

#[derive(Debug, Serialize)]
struct MeshInfo {
    file: String,
    format: &'static str,
    /// Lowest and highest corner in world coordinates.
    bounds: Option<[[f64; 3]; 2]>,
    world_from_local: [f64; 3],
    attributes: Vec<&'static str>,
    crs: Option<String>,
    topology: Topology,
}

impl Info {
    fn of(path: &Path) -> Result<Self, CliError> {
        if is_model(path) {
            return Ok(Self::Model(ModelInfo::read(path)?));
        }
        let format = cloud_or_mesh(path, "cloud, mesh or model", &[MODEL_SUFFIX])?;
        let (mesh, format) = match read_cloud_or_mesh(path, format)? {
            CloudOrMesh::Cloud(cloud, format, report) => {
                return Ok(Self::Cloud(CloudInfo::new(path, format, &cloud, report)));
            }
            CloudOrMesh::Mesh(mesh, format) => (mesh, format),
        };
        let topology = topology(&mesh).map_err(|source| CliError::Mesh { path: path.to_path_buf(), source })?;
        let o = mesh.world_from_local;
        Ok(Self::Mesh(MeshInfo {
            file: shown(path),
            format,
            bounds: topology.bounds.map(|b| b.map(|p| std::array::from_fn(|a| p[a] + o[a]))),
            world_from_local: o,
            attributes: attribute_names(&mesh.attributes),
            crs: mesh.crs,
            topology,
        }))
    }

    fn text(&self) -> String {
        match self {
            Self::Cloud(cloud) => cloud.text(),
            Self::Mesh(mesh) => mesh.text(),
            Self::Model(model) => model.text(),
        }
    }
}

impl CloudInfo {
    fn new(path: &Path, format: &'static str, cloud: &Cloud, report: Option<ReadReport>) -> Self {
        let classes = cloud.attributes.classes.as_ref().map(|classes| {
            let mut counts = [0_u64; 256];
            for class in classes {
                counts[usize::from(*class)] += 1;
            }
            let present = (0..=u8::MAX).zip(counts).filter(|(_, points)| *points > 0);
            present.map(|(class, points)| Class { class, name: class_name(class), points }).collect()
        });
        Self {
            file: shown(path),
            format,
            points: cloud.len(),
            points_declared: report.as_ref().and_then(|r| r.points_declared),
            non_finite: report.as_ref().map_or(0, |r| r.non_finite),
            withheld: report.as_ref().map_or(0, |r| r.withheld),
            bounds: cloud.bounds(),
            spacing: Spacing::of(cloud),
            classes,
            attributes: attribute_names(&cloud.attributes),
            crs: cloud.crs.clone(),
            unit: report.as_ref().and_then(|r| r.unit).map(LinearUnit::name),
            facts: report.as_ref().map(|r| r.facts.clone()).unwrap_or_default(),
            notes: report.map(|r| r.notes).unwrap_or_default(),
        }
    }

    fn text(&self) -> String {
        let decimals = decimals_for(self.spacing.map_or(1.0, |s| s.median));
        let unit = self.unit.map(|unit| format!(" ({unit})")).unwrap_or_default();
        let mut rows = vec![("file", self.file.clone()), ("format", format!("{}, a cloud", self.format))];
        rows.push(("points", count(self.points)));
        if self.non_finite > 0 {
            rows.push(("not finite", format!("{}, left out", count(self.non_finite))));
        }
        if self.withheld > 0 {
            rows.push(("withheld", format!("{}, left out", count(self.withheld))));
        }
        rows.extend(box_rows(self.bounds, decimals));
        rows.push((
            "spacing",
            self.spacing.map_or_else(
                || "all points are in one place".to_owned(),
                |s| {
                    let [median, p10, p90] = [s.median, s.p10, s.p90].map(|v| significant(v, 4));
                    format!("{median}{unit}, 10 to 90 %: {p10} to {p90}")
                },
            ),
        ));
        rows.extend(common_rows(&self.attributes, self.crs.as_deref()));
        rows.push(("unit", self.unit.unwrap_or("not stated").to_owned()));
        rows.extend(self.facts.iter().map(|(name, value)| (*name, value.clone())));
        rows.extend(self.notes.iter().map(|note| ("note", note.clone())));
        let mut text = pairs(&rows);
        if let Some(classes) = &self.classes {
            let head = ["class", "points", "share"].map(String::from).to_vec();
            let share = |points: u64| format!("{:.2} %", 100.0 * points as f64 / self.points as f64);
            let row = |c: &Class| vec![format!("{:>3} {}", c.class, c.name), count(c.points), share(c.points)];
            text += "\n";
            text += &columns(&std::iter::once(head).chain(classes.iter().map(row)).collect::<Vec<_>>());
        }
        text
    }
}

impl MeshInfo {
    fn text(&self) -> String {
        let side = self.bounds.map_or(1.0, |[low, high]| (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max));
        let mut rows = vec![("file", self.file.clone()), ("format", format!("{}, a mesh", self.format))];
        rows.extend(box_rows(self.bounds, decimals_for(side / 1000.0)));
        rows.extend(common_rows(&self.attributes, self.crs.as_deref()));
        format!("{}\n{}", pairs(&rows), topologies(&["mesh"], &[&self.topology]))
    }
}

fn box_rows(bounds: Option<[[f64; 3]; 2]>, decimals: usize) -> Vec<(&'static str, String)> {
    let Some([low, high]) = bounds else { return Vec::new() };
    let sides = std::array::from_fn(|a| high[a] - low[a]);
    vec![
        ("box from", position(low, decimals)),
        ("box to", position(high, decimals)),
        ("box sides", position(sides, decimals)),
    ]
}

fn common_rows(attributes: &[&str], crs: Option<&str>) -> Vec<(&'static str, String)> {
    let attributes = if attributes.is_empty() { "none".to_owned() } else { attributes.join(", ") };
    let crs = crs.map_or_else(|| "not stated".to_owned(), |crs| crs.split_whitespace().collect::<Vec<_>>().join(" "));
    vec![("attributes", attributes), ("crs", crs)]
}

fn attribute_names(attributes: &zeroset::cloud::Attributes) -> Vec<&'static str> {
    let present = [
        ("colors", attributes.colors.is_some()),
        ("intensities", attributes.intensities.is_some()),
        ("classes", attributes.classes.is_some()),
    ];
    present.into_iter().filter(|(_, present)| *present).map(|(name, _)| name).collect()
}
