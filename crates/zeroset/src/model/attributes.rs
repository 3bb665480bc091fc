//! Values of the nearest points for the vertices of the mesh.

use std::ops::Range;

use rayon::prelude::*;

use serde::{Deserialize, Serialize};

use super::Fitted;
use crate::cloud::Attributes;
use crate::mesh::Mesh;
use crate::monitor::{Cancelled, Monitor, Steps};
use crate::spatial::PointTree;

/// Vertices between two looks at the monitor.
const CHUNK: usize = 1 << 14;

/// Which values of the points the vertices get.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AttributeChoice {
    /// None.
    Off,
    /// Colour, where the cloud has it.
    #[default]
    Rgb,
    /// Intensity, where the cloud has it.
    Intensity,
    /// Class, where the cloud has it.
    Class,
}

/// Gives each vertex the chosen values of the point nearest to it. `shares` is the part of the whole that this is.
pub(super) fn transfer(
    fitted: &Fitted,
    mesh: &mut Mesh,
    choice: AttributeChoice,
    monitor: &dyn Monitor,
    shares: Range<f64>,
) -> Result<(), Cancelled> {
    let from = fitted.attributes();
    let wanted = match choice {
        AttributeChoice::Off => return Ok(()),
        AttributeChoice::Rgb => from.colors.is_some(),
        AttributeChoice::Intensity => from.intensities.is_some(),
        AttributeChoice::Class => from.classes.is_some(),
    };
    if !wanted {
        return Ok(());
    }
    let tree = PointTree::new(&fitted.positions());
    let steps = Steps::new(monitor, shares, mesh.vertices.len());
    let nearest = mesh.vertices.par_chunks(CHUNK).map(|vertices| {
        let index = |v: &[f64; 3]| tree.nearest(*v).map_or(0, |n| n.index as u32);
        let indices: Vec<u32> = vertices.iter().map(index).collect();
        steps.advance(vertices.len()).map(|()| indices)
    });
    let nearest = nearest.collect::<Result<Vec<_>, _>>()?.concat();
    mesh.attributes = Attributes {
        colors: from.colors.as_ref().filter(|_| choice == AttributeChoice::Rgb).map(|values| pick(values, &nearest)),
        intensities: from
            .intensities
            .as_ref()
            .filter(|_| choice == AttributeChoice::Intensity)
            .map(|values| pick(values, &nearest)),
        classes: from
            .classes
            .as_ref()
            .filter(|_| choice == AttributeChoice::Class)
            .map(|values| pick(values, &nearest)),
    };
    Ok(())
}

fn pick<T: Copy + Send + Sync>(values: &[T], indices: &[u32]) -> Vec<T> {
    indices.par_iter().map(|&i| values[i as usize]).collect()
}
