//! Small pieces are dropped, and nothing else is touched.

use super::{mesh, moved, sheet, together};
use crate::cloud::Attributes;
use crate::mesh::{DroppedComponents, drop_small_components, topology};

/// A sheet of 200 triangles between two scraps of 2 and 8, with a class for each.
fn scene() -> crate::mesh::Mesh {
    let parts = [moved(&sheet(1), [5.0, 0.0, 0.0]), sheet(10), moved(&sheet(2), [0.0, 5.0, 0.0])];
    let classes = parts.iter().zip(1..).flat_map(|(part, class)| vec![class; part.vertices.len()]).collect();
    let mut all = together(&parts);
    all.attributes = Attributes { classes: Some(classes), ..Attributes::default() };
    all
}

#[test]
fn small_pieces_go_with_their_vertices_and_values() {
    let mut mesh = scene();
    let dropped = drop_small_components(&mut mesh, 9);
    assert_eq!(dropped, DroppedComponents { components: 2, triangles: 10 });
    assert_eq!((&mesh.vertices, &mesh.triangles), (&sheet(10).vertices, &sheet(10).triangles));
    assert_eq!(mesh.attributes.classes, Some(vec![2; 121]));
}

#[test]
fn the_limit_is_the_least_that_stays() {
    for (least, pieces) in [(0, 3), (1, 3), (2, 3), (3, 2), (8, 2), (9, 1), (200, 1)] {
        let mut mesh = scene();
        drop_small_components(&mut mesh, least);
        let found = topology(&mesh).unwrap();
        assert_eq!((found.components.len(), found.unused_vertices), (pieces, 0), "{least}");
    }
}

#[test]
fn the_largest_piece_always_stays() {
    let mut all = scene();
    let dropped = drop_small_components(&mut all, usize::MAX);
    assert_eq!((dropped.components, all.triangles.len()), (2, 200));
    // Of two that are equal, one.
    let mut equal = together(&[sheet(1), moved(&sheet(1), [5.0, 0.0, 0.0])]);
    drop_small_components(&mut equal, 100);
    assert_eq!(equal, sheet(1));
    let mut empty = mesh(&[[1.0; 3]], &[]);
    assert_eq!(drop_small_components(&mut empty, 100), DroppedComponents::default());
    assert_eq!(empty.vertices.len(), 1);
}

#[test]
fn pieces_that_touch_at_a_vertex_are_one() {
    let mut mesh = sheet(10);
    let end = mesh.vertices.len() as u32;
    mesh.vertices.extend([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);
    mesh.triangles.push([0, end, end + 1]);
    let before = mesh.clone();
    assert_eq!(drop_small_components(&mut mesh, 100).components, 0);
    assert_eq!(mesh, before);
}
