//! The scene in words and numbers: `scene.json` and `nodes.json`.
//!
//! Positions are local: the world's less `origin`, but where it is said otherwise.

use serde::Serialize;

use super::channel::{Channel, Data, Kind, ViewLayer, ViewPlane};
use super::state::{Served, State};
use crate::color::{Rgb, class_color};
use crate::scene::Shape;
use crate::vector;

#[derive(Debug, Serialize)]
pub(super) struct SceneText {
    zeroset: &'static str,
    title: String,
    revision: u64,
    work: Option<WorkText>,
    problems: Vec<String>,
    origin: [f64; 3],
    up: &'static str,
    unit: Option<&'static str>,
    crs: Option<String>,
    layers: Vec<NumberedLayer>,
    planes: Vec<ViewPlane>,
}

#[derive(Debug, Serialize)]
struct NumberedLayer {
    id: usize,
    #[serde(flatten)]
    text: LayerText,
}

#[derive(Debug, Serialize)]
struct WorkText {
    what: String,
    share: f64,
}

/// A layer, put together once: the page asks often while something is loaded.
#[derive(Debug, Clone, Serialize)]
pub(super) struct LayerText {
    name: String,
    kind: &'static str,
    count: usize,
    bounds: Option<[[f64; 3]; 2]>,
    plain: Rgb,
    lifted: bool,
    diameter: Option<f32>,
    channels: Vec<ChannelText>,
    color: Option<&'static str>,
}

#[derive(Debug, Clone, Serialize)]
struct ChannelText {
    name: &'static str,
    title: String,
    #[serde(flatten)]
    data: DataText,
}

#[derive(Debug, Clone, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum DataText {
    Value {
        low: f64,
        high: f64,
        signed: bool,
        source: &'static str,
        #[serde(skip_serializing_if = "Option::is_none")]
        from: Option<f64>,
        #[serde(skip_serializing_if = "Option::is_none")]
        to: Option<f64>,
    },
    Class {
        entries: Vec<ClassText>,
    },
    Color,
    Plane,
}

#[derive(Debug, Clone, Serialize)]
struct ClassText {
    value: u8,
    name: &'static str,
    color: Rgb,
}

#[derive(Debug, Serialize)]
pub(super) struct NodesText {
    nodes: Vec<NodeText>,
}

#[derive(Debug, Serialize)]
struct NodeText {
    id: usize,
    parent: Option<u32>,
    low: [f64; 3],
    side: f64,
    count: usize,
    spacing: f64,
}

/// The whole scene.
pub(super) fn scene(state: &State, up: &'static str) -> SceneText {
    let mut names: Vec<&str> = state.layers.iter().map(|served| served.layer.name.as_str()).collect();
    names.dedup();
    let first = |of: fn(&Served) -> Option<String>| state.layers.iter().find_map(|served| of(served));
    SceneText {
        zeroset: env!("CARGO_PKG_VERSION"),
        title: names.join(", "),
        revision: state.revision,
        work: state.work.as_ref().map(|work| WorkText { what: work.what.clone(), share: work.share }),
        problems: state.problems.clone(),
        origin: state.origin.unwrap_or_default(),
        up,
        unit: state.layers.iter().find_map(|served| served.layer.system.1),
        crs: first(|served| served.layer.system.0.clone()),
        layers: state
            .layers
            .iter()
            .enumerate()
            .map(|(id, served)| NumberedLayer { id, text: served.text.clone() })
            .collect(),
        planes: state.layers.iter().flat_map(|served| served.layer.planes.iter().cloned()).collect(),
    }
}

/// A layer whose positions come to lie a step aside.
pub(super) fn layer(own: &ViewLayer, step: [f64; 3]) -> LayerText {
    let finite = own.positions.iter().filter(|p| p.iter().all(|c| c.is_finite()));
    let mut bounds: Option<[[f64; 3]; 2]> = None;
    for p in finite {
        let [low, high] = bounds.get_or_insert([*p; 2]);
        for a in 0..3 {
            (low[a], high[a]) = (low[a].min(p[a]), high[a].max(p[a]));
        }
    }
    LayerText {
        name: own.name.clone(),
        kind: match own.kind {
            Kind::Points => "points",
            Kind::Surface => "surface",
            Kind::Lines => "lines",
            Kind::Planes => "planes",
        },
        count: own.shape.count(own.positions.len()),
        bounds: bounds.map(|corners| corners.map(|p| vector::add(p, step))),
        plain: own.plain,
        lifted: own.lifted,
        diameter: match own.shape {
            Shape::Points { diameter } => diameter,
            Shape::Lines { .. } | Shape::Surface { .. } => None,
        },
        channels: own.channels.iter().map(channel).collect(),
        color: own.shown,
    }
}

fn channel(channel: &Channel) -> ChannelText {
    let data = match &channel.data {
        Data::Height { ends: [low, high] } => {
            DataText::Value { low: *low, high: *high, signed: false, source: "position", from: None, to: None }
        }
        Data::Values { ends: [low, high], signed, reach: [from, to], .. } => DataText::Value {
            low: *low,
            high: *high,
            signed: *signed,
            source: "data",
            from: Some(*from),
            to: Some(*to),
        },
        Data::Classes { values, name } => {
            let mut present = [false; 256];
            values.iter().for_each(|class| present[usize::from(*class)] = true);
            let entries = (0..=u8::MAX).filter(|class| present[usize::from(*class)]);
            let entry = |value| ClassText { value, name: name(value), color: class_color(value) };
            DataText::Class { entries: entries.map(entry).collect() }
        }
        Data::Colors(_) => DataText::Color,
        Data::Planes(_) => DataText::Plane,
    };
    ChannelText { name: channel.name, title: channel.title.clone(), data }
}

/// The octree of a layer.
pub(super) fn nodes(served: &Served) -> NodesText {
    let text = |(id, node): (usize, &super::octree::Node)| NodeText {
        id,
        parent: node.parent,
        low: vector::add(node.low, served.step),
        side: node.side,
        count: node.points.len(),
        spacing: node.spacing,
    };
    NodesText { nodes: served.nodes.iter().enumerate().map(text).collect() }
}
