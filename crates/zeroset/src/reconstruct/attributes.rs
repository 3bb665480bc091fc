//! Values of the nearest points for the vertices of the mesh.

use rayon::prelude::*;

use super::AttributeChoice;
use crate::cloud::{Attributes, Cloud};
use crate::mesh::Mesh;
use crate::spatial::PointTree;

/// Gives each vertex the chosen values of the point nearest to it.
pub(super) fn transfer(cloud: &Cloud, mesh: &mut Mesh, choice: AttributeChoice) {
    let from = &cloud.attributes;
    let wanted = match choice {
        AttributeChoice::Off => return,
        AttributeChoice::Rgb => from.colors.is_some(),
        AttributeChoice::Intensity => from.intensities.is_some(),
        AttributeChoice::Class => from.classes.is_some(),
    };
    if !wanted {
        return;
    }
    let tree = PointTree::new(&cloud.points);
    let nearest: Vec<u32> = mesh.vertices.par_iter().map(|v| tree.nearest(*v).map_or(0, |n| n.index as u32)).collect();
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
}

fn pick<T: Copy + Send + Sync>(values: &[T], indices: &[u32]) -> Vec<T> {
    indices.par_iter().map(|&i| values[i as usize]).collect()
}
