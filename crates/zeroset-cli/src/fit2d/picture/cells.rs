//! The edges of the cells.

use svg::node::element::Path;
use zeroset::domain::SimplicialMesh;

use super::canvas::Canvas;
use super::{EDGES, Pixel, path, polyline};

/// Two edges go on in one line if the sine of the angle between them is less than this.
const STRAIGHT: f64 = 1e-6;

pub(super) fn draw(domain: &SimplicialMesh<2>, canvas: &Canvas) -> Path {
    let pixels: Vec<Pixel> = domain.vertices().iter().map(|&v| canvas.pixel(v)).collect();
    let lines = straight_lines(domain);
    let commands: String = lines.iter().map(|ends| polyline(&ends.map(|v| pixels[v as usize]), false)).collect();
    // Where cells are small, thick lines would hide what is below.
    let length = |[p, q]: [u32; 2]| {
        let [p, q] = [p, q].map(|v| canvas.place(domain.vertices()[v as usize]));
        (p[0] - q[0]).hypot(p[1] - q[1])
    };
    let mean = domain.edges().iter().map(|&e| length(e)).sum::<f64>() / domain.edges().len() as f64;
    let width = (0.03 * mean).clamp(0.05, 0.7);
    let cells = path(&commands).set("id", "cells").set("fill", "none").set("stroke", EDGES);
    cells.set("stroke-width", format!("{width:.2}")).set("stroke-opacity", "0.6")
}

/// Edges joined where they go on straight, by their ends: a lattice has few lines.
fn straight_lines(domain: &SimplicialMesh<2>) -> Vec<[u32; 2]> {
    let edges = domain.edges();
    let mut around = vec![Vec::new(); domain.vertices().len()];
    for (e, ends) in edges.iter().enumerate() {
        ends.iter().for_each(|&v| around[v as usize].push(e));
    }
    let mut used = vec![false; edges.len()];
    let direction = |from: u32, to: u32| {
        let [p, q] = [from, to].map(|v| domain.vertices()[v as usize]);
        let length = (q[0] - p[0]).hypot(q[1] - p[1]);
        [0, 1].map(|a| (q[a] - p[a]) / length)
    };
    let mut lines = Vec::new();
    for e in 0..edges.len() {
        if used[e] {
            continue;
        }
        used[e] = true;
        let mut ends = edges[e];
        for side in 0..2 {
            let along = direction(ends[1 - side], ends[side]);
            while let Some((next, to)) = around[ends[side] as usize].iter().find_map(|&n| {
                let to = edges[n][usize::from(edges[n][0] == ends[side])];
                let way = direction(ends[side], to);
                let straight = (along[0] * way[1] - along[1] * way[0]).abs() < STRAIGHT;
                (!used[n] && straight && along[0] * way[0] + along[1] * way[1] > 0.0).then_some((n, to))
            }) {
                used[next] = true;
                ends[side] = to;
            }
        }
        lines.push(ends);
    }
    lines
}
