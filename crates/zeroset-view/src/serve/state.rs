//! What is there, and what is being loaded.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use zeroset::monitor::Monitor;

use super::channel::{Kind, ViewLayer};
use super::describe::{self, LayerText};
use super::octree::{Node, octree};
use super::{Loader, encode};
use crate::scene::Shape;
use crate::vector;

/// Everything that requests share.
pub(super) struct Shared {
    pub(super) port: u16,
    pub(super) token: String,
    /// The axis that points to the sky.
    pub(super) up: &'static str,
    loader: Box<dyn Loader>,
    /// One file is loaded at a time.
    turn: Mutex<()>,
    state: Mutex<State>,
    stopped: AtomicBool,
}

/// What there is to show.
#[derive(Default)]
pub(super) struct State {
    /// Grows with every change.
    pub(super) revision: u64,
    pub(super) work: Option<Work>,
    pub(super) problems: Vec<String>,
    pub(super) layers: Vec<Arc<Served>>,
    /// The world position of the page's origin: that of the first layer.
    pub(super) origin: Option<[f64; 3]>,
}

/// What is being done.
#[derive(Debug, Clone)]
pub(super) struct Work {
    pub(super) what: String,
    pub(super) share: f64,
}

/// A layer, ready to be sent.
pub(super) struct Served {
    pub(super) layer: ViewLayer,
    /// From its positions to those of the page.
    pub(super) step: [f64; 3],
    pub(super) text: LayerText,
    /// The octree of points; empty for all else.
    pub(super) nodes: Vec<Node>,
}

impl Served {
    fn new(layer: ViewLayer, origin: [f64; 3]) -> Self {
        let step = vector::sub(layer.world_from_local, origin);
        let nodes = if layer.kind == Kind::Points { octree(&layer.positions) } else { Vec::new() };
        let text = describe::layer(&layer, step);
        Self { layer, step, text, nodes }
    }

    /// The points of a node.
    pub(super) fn node(&self, number: usize) -> Option<Vec<u8>> {
        Some(encode::node(self.nodes.get(number)?, &self.layer.positions, &self.layer.channels))
    }

    /// The triangles or lines.
    pub(super) fn mesh(&self) -> Option<Vec<u8>> {
        let ViewLayer { positions, channels, .. } = &self.layer;
        match &self.layer.shape {
            Shape::Points { .. } => None,
            Shape::Surface { triangles } => Some(encode::mesh(positions, self.step, triangles, channels)),
            Shape::Lines { segments, .. } => Some(encode::mesh(positions, self.step, segments, channels)),
        }
    }
}

impl Shared {
    pub(super) fn new(port: u16, token: String, up: &'static str, loader: Box<dyn Loader>) -> Self {
        let (turn, state) = (Mutex::new(()), Mutex::new(State::default()));
        Self { port, token, up, loader, turn, state, stopped: AtomicBool::new(false) }
    }

    pub(super) fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        let mut state = self.state();
        change(&mut state);
        state.revision += 1;
    }

    /// Ends what is being loaded.
    pub(super) fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Loads a file. `name` is what people call it, where that is not the path.
    pub(super) fn load(&self, path: &Path, name: Option<&str>) {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        if self.stopped.load(Ordering::Relaxed) {
            return;
        }
        let own = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let shown = name.unwrap_or(&own).to_owned();
        self.change(|state| state.work = Some(Work { what: format!("reading {shown}"), share: 0.0 }));
        let made = self.loader.load(path, &Progress { shared: self });
        let made = made.map(|layers| {
            let first = layers.first().map(|layer| layer.world_from_local);
            let origin = self.state().origin.or(first).unwrap_or_default();
            let named = layers.into_iter().map(|layer| match name {
                Some(name) => ViewLayer { name: layer.name.replace(&own, name), ..layer },
                None => layer,
            });
            (origin, named.map(|layer| Arc::new(Served::new(layer, origin))).collect::<Vec<_>>())
        });
        self.change(|state| {
            state.work = None;
            match made {
                Ok((origin, layers)) => {
                    state.origin = Some(origin);
                    state.layers.extend(layers);
                }
                Err(problem) => state.problems.push(match name {
                    Some(name) => problem.replace(&*path.to_string_lossy(), name),
                    None => problem,
                }),
            }
        });
    }
}

/// Passes progress on to whoever asks.
struct Progress<'a> {
    shared: &'a Shared,
}

impl Monitor for Progress<'_> {
    fn stage(&self, name: &str) {
        self.shared.change(|state| {
            if let Some(work) = &mut state.work {
                name.clone_into(&mut work.what);
            }
        });
    }

    fn share(&self, done: f64) {
        if let Some(work) = &mut self.shared.state().work {
            work.share = done;
        }
    }

    fn cancelled(&self) -> bool {
        self.shared.stopped.load(Ordering::Relaxed)
    }
}
