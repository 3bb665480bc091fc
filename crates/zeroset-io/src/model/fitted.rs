//! Fitted models as arrays.

use std::sync::Arc;

use rayon::prelude::*;
use zeroset::cloud::Attributes;
use zeroset::domain::{Lattice, Mask};
use zeroset::field::LatticeField;
use zeroset::model::{Fitted, FittedParts, Structure};

use super::container::{Reader, Writer};
use super::header::{LatticeHeader, ModelHeader};
use super::is_possible;
use crate::MAX_COORDINATE;

/// The most blocks at the coarsest level. A fit has some dozen; of a million, an evaluation takes seconds before it begins, however small the file.
const MOST_COARSE_BLOCKS: u64 = 4096;
/// A point on no plane.
const NO_PLANE: i32 = -1;

pub(super) fn write(fitted: &[Arc<Fitted>], arrays: &mut Writer) -> Result<Vec<ModelHeader>, String> {
    fitted.iter().enumerate().map(|(i, fitted)| write_one(i, fitted, arrays)).collect()
}

fn write_one(i: usize, fitted: &Fitted, arrays: &mut Writer) -> Result<ModelHeader, String> {
    let name = |array: &str| format!("models/{i}/{array}");
    let (parts, field) = (fitted.parts(), fitted.lattice());
    check(i, parts, &field.lattice)?;
    let (inside, values) = field.packed();
    arrays.add(name("keys"), &field.blocks.keys);
    arrays.add(name("known"), &field.known);
    arrays.add(name("inside"), &inside);
    arrays.add(name("values"), &values);
    arrays.add(name("points"), &parts.points);
    let Attributes { colors, intensities, classes } = &parts.attributes;
    if let Some(colors) = colors {
        arrays.add(name("colors"), colors);
    }
    if let Some(intensities) = intensities {
        arrays.add(name("intensities"), intensities);
    }
    if let Some(classes) = classes {
        arrays.add(name("classes"), classes);
    }
    if let Some(structure) = &parts.structure {
        let planes: Vec<[f64; 4]> = structure.planes.iter().map(|&([x, y, z], offset)| [x, y, z, offset]).collect();
        arrays.add(name("planes"), &planes);
        arrays.add(name("facets"), &structure.triangles);
        arrays.add(name("plane_of_facet"), &structure.plane_of_triangle);
        let plane_of: Vec<i32> =
            structure.plane_of_point.iter().map(|plane| plane.map_or(NO_PLANE, |plane| plane as i32)).collect();
        arrays.add(name("plane_of_point"), &plane_of);
    }
    if !parts.lines.is_empty() {
        let lengths: Vec<u32> = parts.lines.iter().map(|line| line.len() as u32).collect();
        arrays.add(name("line_lengths"), &lengths);
        arrays.add(name("line_segments"), &parts.lines.concat());
    }
    if !parts.polygons.is_empty() {
        arrays.add(name("polygons"), &parts.polygons);
    }
    let lattice = &field.lattice;
    Ok(ModelHeader {
        world_from_local: parts.world_from_local,
        frame: parts.frame,
        lattice: LatticeHeader {
            origin: lattice.origin,
            spacing: lattice.spacing,
            finest: lattice.finest,
            blocks: lattice.blocks,
        },
        metric: parts.metric,
        scene: parts.scene,
        bounds: parts.bounds,
        noise: parts.noise,
        trim: parts.trim,
        min_component: parts.min_component,
        curved_creases: parts.structure.as_ref().map(|structure| structure.curved_creases),
    })
}

pub(super) fn read(headers: &[ModelHeader], arrays: &Reader<'_>) -> Result<Vec<Arc<Fitted>>, String> {
    headers.iter().enumerate().map(|(i, header)| read_one(i, header, arrays).map(Arc::new)).collect()
}

fn read_one(i: usize, header: &ModelHeader, arrays: &Reader<'_>) -> Result<Fitted, String> {
    let name = |array: &str| format!("models/{i}/{array}");
    let LatticeHeader { origin, spacing, finest, blocks } = header.lattice.clone();
    let lattice = Lattice::new(origin, spacing, finest, blocks);
    let lattice = lattice.map_err(|_| format!("the lattice of model {i} is not possible"))?;
    let (keys, known, inside) =
        (arrays.array(&name("keys"))?, arrays.array(&name("known"))?, arrays.array::<Mask>(&name("inside"))?);
    let packed = arrays.array::<f32>(&name("values"))?;
    let field = LatticeField::from_packed(lattice, keys, known, &inside, &packed);
    let field = field.map_err(|what| format!("model {i}: {what}"))?;
    let structure = match header.curved_creases {
        None => None,
        Some(curved_creases) => Some(read_structure(i, curved_creases, arrays)?),
    };
    let parts = FittedParts {
        world_from_local: header.world_from_local,
        scene: header.scene,
        frame: header.frame,
        metric: header.metric,
        bounds: header.bounds,
        noise: header.noise,
        trim: header.trim,
        min_component: header.min_component,
        points: arrays.array(&name("points"))?,
        attributes: Attributes {
            colors: arrays.optional(&name("colors"))?,
            intensities: arrays.optional(&name("intensities"))?,
            classes: arrays.optional(&name("classes"))?,
        },
        structure,
        lines: read_lines(i, arrays)?,
        polygons: arrays.optional(&name("polygons"))?.unwrap_or_default(),
    };
    check(i, &parts, &field.lattice)?;
    Fitted::kept(field, parts).map_err(|error| format!("model {i}: {error}"))
}

fn read_structure(i: usize, curved_creases: bool, arrays: &Reader<'_>) -> Result<Structure, String> {
    let name = |array: &str| format!("models/{i}/{array}");
    let plane_of_point = arrays.array::<i32>(&name("plane_of_point"))?;
    if plane_of_point.iter().any(|&plane| plane < NO_PLANE) {
        return Err(format!("model {i}: a plane of a point is not possible"));
    }
    let planes = arrays.array::<[f64; 4]>(&name("planes"))?;
    Ok(Structure {
        planes: planes.into_iter().map(|[x, y, z, offset]| ([x, y, z], offset)).collect(),
        triangles: arrays.array(&name("facets"))?,
        plane_of_triangle: arrays.array(&name("plane_of_facet"))?,
        plane_of_point: plane_of_point.into_iter().map(|plane| u32::try_from(plane).ok()).collect(),
        curved_creases,
    })
}

fn read_lines(i: usize, arrays: &Reader<'_>) -> Result<Vec<Vec<[[f64; 3]; 2]>>, String> {
    let segments: Vec<[[f64; 3]; 2]> = arrays.optional(&format!("models/{i}/line_segments"))?.unwrap_or_default();
    let lengths: Vec<u32> = arrays.optional(&format!("models/{i}/line_lengths"))?.unwrap_or_default();
    if lengths.iter().map(|&length| u64::from(length)).sum::<u64>() != segments.len() as u64 {
        return Err(format!("model {i}: the lengths of its lines do not fit their segments"));
    }
    let mut left = segments.into_iter();
    Ok(lengths.into_iter().map(|length| left.by_ref().take(length as usize).collect()).collect())
}

/// Checks the size of numbers; [`Fitted`] checks the rest.
fn check(i: usize, parts: &FittedParts, lattice: &Lattice) -> Result<(), String> {
    let nodes = lattice.nodes_at(lattice.finest).map(|n| f64::from(n) * lattice.spacing);
    let given = [parts.world_from_local, parts.bounds[0], parts.bounds[1], lattice.origin, nodes];
    let mut constraints = parts.lines.iter().flatten().flatten().chain(parts.polygons.iter().flatten());
    let coarse = lattice.blocks.iter().fold(1_u64, |all, &n| all.saturating_mul(n.into()));
    let is_sound = coarse <= MOST_COARSE_BLOCKS
        && given.iter().all(is_possible)
        && (0.0..=MAX_COORDINATE).contains(&parts.noise)
        && parts.trim.is_none_or(|trim| trim <= MAX_COORDINATE)
        && constraints.all(is_possible)
        && parts.points.par_iter().with_min_len(1 << 14).all(|p| is_possible(&p.map(f64::from)))
        && parts.structure.as_ref().is_none_or(|structure| {
            structure.planes.iter().all(|(_, offset)| offset.abs() <= MAX_COORDINATE)
                && structure.triangles.iter().flatten().all(is_possible)
        });
    if is_sound { Ok(()) } else { Err(format!("a number of model {i} is not possible")) }
}
