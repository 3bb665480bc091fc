//! Files as layers of the page.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use zeroset::cloud::Cloud;
use zeroset::feature::Features;
use zeroset::mesh::Mesh;
use zeroset::model::Solid;
use zeroset::monitor::Monitor;
use zeroset::reconstruct::Up;
use zeroset_io::LinearUnit;
use zeroset_view::color::{Ends, PLAIN_POINTS, PLAIN_SURFACE, plane_color};
use zeroset_view::scene::{Layer, Paint, Reference, curvatures, distances, heights, plane_of_points, variations};
use zeroset_view::serve::{Channel, Data, Kind, Loader, ViewLayer, ViewPlane};

use crate::asprs::class_name;
use crate::content::{Content, Item, off_model, reference};
use crate::error::CliError;

/// Points of which the surface variation is measured, at most: it takes some two seconds for a million.
const MOST_VARIATIONS: usize = 2_000_000;

/// Reads files for the page, and remembers what others are coloured by.
pub(super) struct Files {
    up: Up,
    distance_to: Option<PathBuf>,
    known: Mutex<Known>,
}

/// What was read before.
#[derive(Default)]
struct Known {
    /// The last ones, and the number of their first plane: planes are numbered through all files.
    features: Option<(u32, Features)>,
    planes: u32,
    solid: Option<(String, Solid)>,
    reference: Option<Reference>,
}

impl Files {
    pub(super) fn new(up: Up, distance_to: Option<PathBuf>) -> Self {
        Self { up, distance_to, known: Mutex::new(Known::default()) }
    }
}

impl Loader for Files {
    fn load(&self, path: &Path, monitor: &dyn Monitor) -> Result<Vec<ViewLayer>, String> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        self.layers(path, &mut known, monitor).map_err(|error| error.to_string())
    }
}

impl Files {
    fn layers(&self, path: &Path, known: &mut Known, monitor: &dyn Monitor) -> Result<Vec<ViewLayer>, CliError> {
        if let (Some(path), None) = (&self.distance_to, &known.reference) {
            known.reference = Some(match reference(path, monitor)? {
                Item::Cloud(cloud) => Reference::points(&cloud),
                Item::Mesh(mesh) => Reference::surface(&mesh),
            });
        }
        let Content { items, solids, features, unit } = Content::read(&[path.to_path_buf()], monitor)?;
        known.solid = solids.into_iter().next().or(known.solid.take());
        monitor.stage("finding what colours can tell");
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let mut layers = Vec::new();
        for item in items {
            let channels = self.channels(&item, path, unit, known, monitor)?;
            layers.push(of_item(item, &name, channels, unit));
        }
        for features in features {
            let first = known.planes;
            layers.extend(of_features(&features, &name, first));
            known.planes += features.planes.len() as u32;
            known.features = Some((first, features));
        }
        Ok(layers)
    }

    /// What the colours of points or triangles can tell.
    fn channels(
        &self,
        item: &Item,
        path: &Path,
        unit: Option<LinearUnit>,
        known: &Known,
        monitor: &dyn Monitor,
    ) -> Result<Vec<Channel>, CliError> {
        let (positions, offset) = item.positions();
        let of_unit = |what: &str| unit.map_or_else(|| what.to_owned(), |unit| format!("{what} ({})", unit.symbol()));
        let mut channels = vec![Channel::height(of_unit("height"), &heights(positions, offset, self.up))];
        let attributes = item.attributes();
        if let Some(colors) = &attributes.colors {
            channels.push(Channel { name: "rgb", title: "colour".into(), data: Data::Colors(colors.clone()) });
        }
        if let Some(values) = &attributes.classes {
            let data = Data::Classes { values: values.clone(), name: class_name };
            channels.push(Channel { name: "class", title: "class".into(), data });
        }
        if let Some(intensities) = &attributes.intensities {
            let values: Vec<_> = intensities.iter().map(|v| Some(f64::from(*v))).collect();
            channels.push(Channel::values("intensity", "intensity".into(), &values, Ends::Both));
        }
        if let Some((first, features)) = &known.features {
            let planes = plane_of_points(positions, offset, features);
            let data = Data::Planes(planes.into_iter().map(|plane| plane.map(|i| first + i as u32)).collect());
            channels.push(Channel { name: "plane", title: "plane".into(), data });
        }
        match (item, &known.solid) {
            (Item::Cloud(cloud), Some((name, solid))) => {
                let values = off_model(cloud, name, solid, monitor)?;
                channels.push(Channel::values("residual", of_unit("off the model"), &values, Ends::Symmetric));
            }
            (Item::Mesh(_), _) | (_, None) => (),
        }
        match item {
            Item::Mesh(mesh) => {
                let broken = |source| CliError::Mesh { path: path.to_path_buf(), source };
                let values = curvatures(mesh).map_err(broken)?;
                channels.push(Channel::values("curvature", "mean curvature".into(), &values, Ends::Symmetric));
            }
            Item::Cloud(cloud) if cloud.len() <= MOST_VARIATIONS => {
                channels.push(Channel::values(
                    "curvature",
                    "surface variation".into(),
                    &variations(cloud),
                    Ends::FromZero,
                ));
            }
            Item::Cloud(_) => (),
        }
        if let Some(reference) = &known.reference {
            let values = distances(positions, offset, reference);
            channels.push(Channel::values("distance", of_unit("distance"), &values, Ends::FromZero));
        }
        Ok(channels)
    }
}

fn of_item(item: Item, name: &str, channels: Vec<Channel>, unit: Option<LinearUnit>) -> ViewLayer {
    let has = |name: &str| channels.iter().any(|channel| channel.name == name);
    let brought = if has("rgb") { Some("rgb") } else { has("class").then_some("class") };
    let system = |crs: &Option<String>| (crs.clone(), unit.map(LinearUnit::symbol));
    match item {
        Item::Cloud(cloud) => {
            let system = system(&cloud.crs);
            let layer = Layer::points(Cloud { crs: None, ..cloud }, Paint::Plain(PLAIN_POINTS), None);
            let shown = brought.or(Some("height"));
            ViewLayer { channels, shown, system, ..of_layer(layer, name.to_owned(), Kind::Points) }
        }
        Item::Mesh(mesh) => {
            let system = system(&mesh.crs);
            let layer = Layer::surface(Mesh { crs: None, ..mesh }, Paint::Plain(PLAIN_SURFACE));
            let shown = if has("rgb") { Some("rgb") } else { None };
            ViewLayer { channels, shown, system, ..of_layer(layer, name.to_owned(), Kind::Surface) }
        }
    }
}

/// A layer of pictures as one of the page, plain.
fn of_layer(layer: Layer, name: String, kind: Kind) -> ViewLayer {
    let plain = match layer.paint {
        Paint::Plain(color) => color,
        Paint::Each(_) => PLAIN_SURFACE,
    };
    ViewLayer {
        name,
        kind,
        world_from_local: layer.world_from_local,
        positions: layer.positions,
        shape: layer.shape,
        channels: Vec::new(),
        shown: None,
        plain,
        lifted: layer.lifted,
        system: (None, None),
        planes: Vec::new(),
    }
}

/// Corners, edges and planes, which are numbered from `first` on.
fn of_features(features: &Features, name: &str, first: u32) -> Vec<ViewLayer> {
    let mut layers: Vec<ViewLayer> = Layer::edges_and_corners(features)
        .into_iter()
        .map(|layer| {
            let is_points = matches!(layer.shape, zeroset_view::scene::Shape::Points { .. });
            let (what, kind) = if is_points { ("corners", Kind::Points) } else { ("edges", Kind::Lines) };
            of_layer(layer, format!("{name}: {what}"), kind)
        })
        .collect();
    if let Some(layer) = Layer::planes(features) {
        let numbers = (first..).zip(&features.planes);
        let of_vertices = numbers.flat_map(|(i, plane)| plane.rings.iter().flatten().map(move |_| Some(i)));
        let data = Data::Planes(of_vertices.collect());
        let channel = Channel { name: "plane", title: "plane".into(), data };
        let planes = (0..features.planes.len()).map(|i| view_plane(features, i, first as usize + i)).collect();
        let plain = of_layer(layer, format!("{name}: planes"), Kind::Planes);
        layers.push(ViewLayer { channels: vec![channel], shown: Some("plane"), planes, ..plain });
    }
    layers
}

fn view_plane(features: &Features, i: usize, number: usize) -> ViewPlane {
    let plane = &features.planes[i];
    ViewPlane {
        normal: plane.normal,
        offset: features.world_offset(i),
        area: plane.area,
        rms: plane.rms,
        points: plane.points,
        color: plane_color(number),
    }
}
