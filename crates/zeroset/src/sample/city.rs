//! The city: open ground with houses welded to it.

use super::random::Chance;
use crate::mesh::Mesh;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// Number of houses.
const HOUSES: usize = 40;
/// Least distance from a house to the border of the ground.
const MARGIN: f64 = 0.02;
/// Least distance between two houses.
const GAP: f64 = 0.012;

/// A house on a rectangle; the roof is flat, or rises to a ridge along the longer side.
#[derive(Debug, Clone, Copy)]
struct House {
    centre: [f64; 2],
    /// Half the sides; the first is the longer.
    half: [f64; 2],
    /// The longer side's direction.
    along: [f64; 2],
    eaves: f64,
    roof: Roof,
}

#[derive(Debug, Clone, Copy)]
enum Roof {
    Flat,
    /// The ridge's height above the eaves, and how far its ends stand in from the short walls: 0 for a gable.
    Ridge {
        rise: f64,
        inset: f64,
    },
}

impl House {
    /// Sides 0.03 to 0.1, eaves at 0.03 to 0.17, roof pitch 25 to 45 degrees, any direction.
    fn random(chance: &mut Chance, number: usize) -> Self {
        let half = [0.5 * chance.between(0.05, 0.1), 0.5 * chance.between(0.03, 0.065)];
        let half = if half[0] < half[1] { [half[1], half[0]] } else { half };
        // Squared, so that low houses outnumber towers.
        let eaves = 0.03 + 0.14 * chance.uniform().powi(2);
        let rise = half[1] * chance.between(25.0, 45.0).to_radians().tan();
        let inset = half[1].min(0.7 * half[0]) * chance.between(0.7, 1.0);
        let roof = match number % 3 {
            0 => Roof::Flat,
            1 => Roof::Ridge { rise, inset: 0.0 },
            _ => Roof::Ridge { rise, inset },
        };
        let angle = std::f64::consts::TAU * chance.uniform();
        let mut house = Self { centre: [0.0; 2], half, along: [angle.cos(), angle.sin()], eaves, roof };
        house.move_to(chance);
        house
    }

    /// Puts the house anywhere on the ground.
    fn move_to(&mut self, chance: &mut Chance) {
        let reach =
            [0, 1].map(|a| MARGIN + self.half[0] * self.along[a].abs() + self.half[1] * self.along[1 - a].abs());
        self.centre = reach.map(|r| chance.between(r, 1.0 - r));
    }

    /// A point given along and across the house, on the ground.
    fn at(&self, along: f64, across: f64) -> [f64; 2] {
        let [c, s] = self.along;
        [self.centre[0] + along * c - across * s, self.centre[1] + along * s + across * c]
    }

    /// The footprint, counter-clockwise from above.
    fn footprint(&self) -> [[f64; 2]; 4] {
        let [a, b] = self.half;
        [self.at(-a, -b), self.at(a, -b), self.at(a, b), self.at(-a, b)]
    }

    /// Whether a point of the ground lies under the house.
    fn covers(&self, [x, y]: [f64; 2]) -> bool {
        let (x, y) = (x - self.centre[0], y - self.centre[1]);
        let [c, s] = self.along;
        (x * c + y * s).abs() < self.half[0] && (y * c - x * s).abs() < self.half[1]
    }

    /// Whether two houses are closer than the gap along every direction of a wall (so possibly a little farther apart).
    fn crowds(&self, other: &Self) -> bool {
        let parted = |a: &Self, b: &Self| {
            let [c, s] = a.along;
            [([c, s], a.half[0]), ([-s, c], a.half[1])].into_iter().any(|(axis, reach)| {
                b.footprint().iter().all(|p| project(axis, *p, a.centre) > reach + GAP)
                    || b.footprint().iter().all(|p| project(axis, *p, a.centre) < -reach - GAP)
            })
        };
        !parted(self, other) && !parted(other, self)
    }
}

fn project(axis: [f64; 2], p: [f64; 2], origin: [f64; 2]) -> f64 {
    axis[0] * (p[0] - origin[0]) + axis[1] * (p[1] - origin[1])
}

/// Houses that do not crowd each other.
fn lay_out(seed: u64) -> Vec<House> {
    let mut chance = Chance::new(seed, 2, 0);
    let mut houses: Vec<House> = Vec::with_capacity(HOUSES);
    while houses.len() < HOUSES {
        let mut house = House::random(&mut chance, houses.len());
        let mut tries = 0;
        while houses.iter().any(|other| house.crowds(other)) {
            house.move_to(&mut chance);
            tries += 1;
            // A house for which there is no room is drawn again; small ones always find some.
            if tries > 200 {
                house = House::random(&mut chance, houses.len());
                tries = 0;
            }
        }
        houses.push(house);
    }
    houses
}

/// The unit square at z = 0 with 40 houses on it, one connected surface that is open at the square's border only.
///
/// Vertices 0 to 3 are the corners of the ground; the ground's triangles come first.
pub(super) fn city(seed: u64) -> Mesh {
    let houses = lay_out(seed);
    let mut mesh = Mesh::default();
    mesh.vertices.extend([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    for house in &houses {
        mesh.vertices.extend(house.footprint().map(|[x, y]| [x, y, 0.0]));
    }
    mesh.triangles = ground(&mesh.vertices, &houses);
    for (number, house) in houses.iter().enumerate() {
        build(&mut mesh, house, 4 + 4 * number as u32);
    }
    mesh
}

/// The triangles of the ground around the footprints. Vertices 4 n + 4 to 4 n + 7 are the footprint of house n.
fn ground(vertices: &[[f64; 3]], houses: &[House]) -> Vec<[u32; 3]> {
    let mut plane = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let handles: Vec<_> = vertices
        .iter()
        .map(|v| plane.insert(Point2::new(v[0], v[1])).expect("coordinates are 0 or between 0.01 and 1"))
        .collect();
    for house in 0..houses.len() {
        for side in 0..4 {
            plane.add_constraint(handles[4 + 4 * house + side], handles[4 + 4 * house + (side + 1) % 4]);
        }
    }
    plane
        .inner_faces()
        .filter(|face| {
            let middle = face.center();
            !houses.iter().any(|house| house.covers([middle.x, middle.y]))
        })
        .map(|face| face.vertices().map(|v| v.fix().index() as u32))
        .collect()
}

/// Walls and roof over a footprint whose first vertex is `foot`.
fn build(mesh: &mut Mesh, house: &House, foot: u32) {
    let feet = [0, 1, 2, 3].map(|i| foot + i);
    let top = mesh.vertices.len() as u32;
    let eaves = [0, 1, 2, 3].map(|i| top + i);
    mesh.vertices.extend(house.footprint().map(|[x, y]| [x, y, house.eaves]));
    let mut quad = |[a, b, c, d]: [u32; 4]| mesh.triangles.extend([[a, b, c], [a, c, d]]);
    for (i, j) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        quad([feet[i], feet[j], eaves[j], eaves[i]]);
    }
    match house.roof {
        Roof::Flat => quad(eaves),
        Roof::Ridge { rise, inset } => {
            let ridge = [top + 4, top + 5];
            quad([eaves[0], eaves[1], ridge[1], ridge[0]]);
            quad([eaves[2], eaves[3], ridge[0], ridge[1]]);
            mesh.triangles.extend([[eaves[1], eaves[2], ridge[1]], [eaves[3], eaves[0], ridge[0]]]);
            let end = house.half[0] - inset;
            mesh.vertices.extend([-end, end].map(|along| {
                let [x, y] = house.at(along, 0.0);
                [x, y, house.eaves + rise]
            }));
        }
    }
}
