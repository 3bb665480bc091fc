//! Pictures whose pixels are known.

use super::*;
use crate::color::{ColorMap, Legend, Scale};
use crate::scene::{Layer, Paint, Shape};

const RED: Rgb = [255, 0, 0];
const BLUE: Rgb = [0, 0, 255];
const WHITE: [u8; 4] = [255; 4];

fn layer(positions: Vec<[f64; 3]>, shape: Shape, color: Rgb) -> Layer {
    Layer { world_from_local: [84_000.0, 447_000.0, 10.0], positions, shape, paint: Paint::Plain(color), lifted: false }
}

/// A level square of so many cells a side, seen as outside from above.
fn square(cells: u32, side: f64, z: f64, color: Rgb) -> Layer {
    let n = cells + 1;
    let at = |i: u32| (f64::from(i) / f64::from(cells) - 0.5) * side;
    // Uneven, so that edges run at all angles.
    let uneven = |i: u32, j: u32| 0.3 * side / f64::from(cells) * f64::from((7 * i + 13 * j) % 5) / 5.0;
    let inner = |i: u32| i > 0 && i < cells;
    let positions = (0..n * n)
        .map(|k| {
            let (i, j) = (k % n, k / n);
            let shift = if inner(i) && inner(j) { uneven(i, j) } else { 0.0 };
            [at(i) + shift, at(j) - shift, z]
        })
        .collect();
    let triangles = (0..cells * cells)
        .flat_map(|k| {
            let a = k / cells * n + k % cells;
            [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]
        })
        .collect();
    layer(positions, Shape::Surface { triangles }, color)
}

fn points(positions: Vec<[f64; 3]>, diameter: f32, color: Rgb) -> Layer {
    layer(positions, Shape::Points { diameter: Some(diameter) }, color)
}

fn scene(layers: Vec<Layer>) -> Scene {
    Scene { layers, legend: None }
}

fn small(direction: Direction) -> View {
    View { direction, size: [90, 90], ..View::default() }
}

fn at(picture: &Picture, x: u32, y: u32) -> [u8; 4] {
    picture.pixels[(y * picture.size[0] + x) as usize]
}

fn is_reddish(pixel: [u8; 4]) -> bool {
    pixel[0] > 60 && pixel[1] < pixel[0] / 2 && pixel[2] < pixel[0] / 2
}

fn is_bluish(pixel: [u8; 4]) -> bool {
    pixel[2] > 60 && pixel[0] < pixel[2] / 2 && pixel[1] < pixel[2] / 2
}

/// Where the middle of all pixels lies that pass a test.
fn middle(picture: &Picture, is: fn([u8; 4]) -> bool) -> Option<[f64; 2]> {
    let width = picture.size[0] as usize;
    let found: Vec<usize> = (0..picture.pixels.len()).filter(|&i| is(picture.pixels[i])).collect();
    let mean = |of: fn(usize, usize) -> usize| {
        found.iter().map(|&i| of(i, width) as f64 + 0.5).sum::<f64>() / found.len() as f64
    };
    (!found.is_empty()).then(|| [mean(|i, width| i % width), mean(|i, width| i / width)])
}

#[test]
fn triangles_with_common_edges_leave_no_gap_and_nothing_shows_beside_them() {
    for projection in [Projection::default(), Projection::Parallel] {
        for cells in [1, 7, 60, 300] {
            let view = View { projection, antialias: 1, ..small(Direction::Top) };
            let picture = render(&scene(vec![square(cells, 10.0, 0.0, RED)]), &view).unwrap();
            let is_within = |c: u32| (4..86).contains(&c);
            for (x, y) in (0..90).flat_map(|y| (0..90).map(move |x| (x, y))) {
                let pixel = at(&picture, x, y);
                if is_within(x) && is_within(y) {
                    assert!(is_reddish(pixel), "{projection:?} {cells}: {x}, {y} is {pixel:?}");
                }
            }
            assert_eq!(at(&picture, 1, 45), WHITE);
            assert_eq!(at(&picture, 45, 88), WHITE);
        }
    }
}

#[test]
fn presets_show_the_axes_where_they_are_expected() {
    // A red point to the east, a blue one in the north and higher.
    let corners = points(vec![[-1.0; 3], [1.0; 3]], 1.0, [0, 200, 0]);
    let all = scene(vec![points(vec![[1.0, 0.0, 0.0]], 6.0, RED), points(vec![[0.0, 1.0, 0.5]], 6.0, BLUE), corners]);
    let seen = |direction| {
        let picture = render(&all, &View { projection: Projection::Parallel, ..small(direction) }).unwrap();
        (middle(&picture, is_reddish).unwrap(), middle(&picture, is_bluish).unwrap())
    };
    let centre = 45.0;
    let (red, blue) = seen(Direction::Top);
    assert!(red[0] > centre + 20.0 && (red[1] - centre).abs() < 2.0, "{red:?}");
    assert!(blue[1] < centre - 20.0 && (blue[0] - centre).abs() < 2.0, "{blue:?}");
    let (red, blue) = seen(Direction::Front);
    assert!(red[0] > centre + 20.0 && (blue[0] - centre).abs() < 2.0 && blue[1] < centre - 8.0, "{red:?} {blue:?}");
    let (red, _) = seen(Direction::Back);
    assert!(red[0] < centre - 20.0, "{red:?}");
    let (_, blue) = seen(Direction::Right);
    assert!(blue[0] > centre + 20.0, "{blue:?}");
    let (_, blue) = seen(Direction::Left);
    assert!(blue[0] < centre - 20.0, "{blue:?}");
    let (red, blue) = seen(Direction::Bottom);
    assert!(red[0] > centre + 20.0 && blue[1] > centre + 20.0, "{red:?} {blue:?}");
    let (red, blue) = seen(Direction::From { azimuth: std::f64::consts::PI, elevation: 0.0 });
    assert_eq!((red, blue), seen(Direction::Front));
}

#[test]
fn everything_is_in_the_picture_and_fills_it() {
    let cloud = points(
        (0..500).map(|i| f64::from(i) * 0.7).map(|t| [9.0 * t.cos(), 4.0 * t.sin(), 0.01 * t]).collect(),
        3.0,
        RED,
    );
    for projection in [Projection::default(), Projection::Parallel] {
        for direction in [Direction::Iso, Direction::Top, Direction::From { azimuth: 0.3, elevation: -0.4 }] {
            let view = View { projection, size: [120, 80], ..small(direction) };
            let picture = render(&scene(vec![cloud.clone()]), &view).unwrap();
            let is_drawn = |x: u32, y: u32| at(&picture, x, y) != WHITE;
            let rim = (0..120).flat_map(|x| [(x, 0), (x, 79)]).chain((0..80).flat_map(|y| [(0, y), (119, y)]));
            assert!(!rim.into_iter().any(|(x, y)| is_drawn(x, y)), "{projection:?} {direction:?}");
            let near = (0..120).flat_map(|x| (2..9).flat_map(move |d| [(x, d), (x, 79 - d)]));
            let near = near.chain((0..80).flat_map(|y| (2..9).flat_map(move |d| [(d, y), (119 - d, y)])));
            assert!(near.into_iter().any(|(x, y)| is_drawn(x, y)), "{projection:?} {direction:?}");
        }
    }
}

#[test]
fn the_nearest_is_seen_and_lifted_lines_lie_over_their_surface() {
    let (low, high) = (square(4, 10.0, 0.0, RED), square(4, 5.0, 1.0, BLUE));
    for layers in [vec![low.clone(), high.clone()], vec![high.clone(), low.clone()]] {
        let above = render(&scene(layers.clone()), &small(Direction::Top)).unwrap();
        assert!(is_bluish(at(&above, 45, 45)) && is_reddish(at(&above, 10, 45)));
        let below = render(&scene(layers), &small(Direction::Bottom)).unwrap();
        assert!(is_reddish(at(&below, 45, 45)));
    }
    let ends = vec![[-4.0, -0.02, -0.001], [4.0, -0.02, -0.001]];
    let mut line = layer(ends, Shape::Lines { segments: vec![[0, 1]], width: 4.0 }, BLUE);
    let hidden = render(&scene(vec![low.clone(), line.clone()]), &small(Direction::Top)).unwrap();
    line.lifted = true;
    let seen = render(&scene(vec![low, line]), &small(Direction::Top)).unwrap();
    assert!(is_reddish(at(&hidden, 45, 45)) && is_bluish(at(&seen, 45, 45)));
}

#[test]
fn the_inside_of_a_surface_is_darker() {
    let all = scene(vec![square(4, 10.0, 0.0, [200; 3])]);
    let [above, below] = [Direction::Top, Direction::Bottom].map(|d| at(&render(&all, &small(d)).unwrap(), 45, 45)[0]);
    assert!(f64::from(below) < 0.8 * f64::from(above), "{below} and {above}");
}

#[test]
fn a_surface_around_the_camera_is_seen_in_part() {
    // Triangles reach from far before the camera to far behind it.
    let ground = square(1, 100.0, 0.0, RED);
    let o = ground.world_from_local;
    let from = |p: [f64; 3]| [0, 1, 2].map(|a| p[a] + o[a]);
    let direction = Direction::Placed { eye: from([0.0, 0.0, 2.0]), target: from([10.0, 0.0, 2.0]) };
    let picture = render(&scene(vec![ground]), &View { antialias: 1, ..small(direction) }).unwrap();
    for x in 0..90 {
        assert_eq!(at(&picture, x, 20), WHITE);
        assert!(is_reddish(at(&picture, x, 70)), "{x}");
    }
}

#[test]
fn pictures_do_not_depend_on_the_number_of_threads() {
    let cloud =
        points((0..20_000).map(f64::from).map(|t| [t.sin(), (1.7 * t).cos(), (0.3 * t).sin()]).collect(), 2.0, BLUE);
    let all = scene(vec![square(90, 2.5, 0.1, RED), cloud]);
    let view = View { size: [300, 200], ..View::default() };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render(&all, &view).unwrap())
    };
    let one = on(1);
    assert!(one.pixels.iter().any(|p| is_reddish(*p)) && one.pixels.iter().any(|p| is_bluish(*p)));
    assert_eq!(one, on(2));
    assert_eq!(one, on(5));
}

#[test]
fn a_transparent_background_is_clear_and_edges_are_in_between() {
    let view = View { background: Background::Transparent, ..small(Direction::Iso) };
    let picture = render(&scene(vec![square(3, 4.0, 0.0, RED)]), &view).unwrap();
    assert_eq!(at(&picture, 0, 0)[3], 0);
    assert_eq!(at(&picture, 45, 45)[3], 255);
    assert!(picture.pixels.iter().any(|p| p[3] > 0 && p[3] < 255));
}

#[test]
fn a_legend_stands_beside_what_is_drawn() {
    let scale = Scale { map: ColorMap::Viridis, low: 0.0, high: 12.0 };
    let with = Scene {
        layers: vec![square(4, 10.0, 0.0, RED)],
        legend: Some(Legend::Bar { title: "height (m)".into(), scale }),
    };
    let view = View { size: [640, 480], ..small(Direction::Top) };
    let [bare, full] = [render(&scene(with.layers.clone()), &view).unwrap(), render(&with, &view).unwrap()];
    let right = |picture: &Picture| middle(picture, is_reddish).unwrap()[0];
    assert!(right(&full) < right(&bare) - 40.0);
    // The bar has its colours, the highest on top; letters are grey.
    let is_colored = |p: &[u8; 4]| p[..3].iter().max().unwrap() - p[..3].iter().min().unwrap() > 40;
    let columns = (500..640).map(|x| (0..480).map(|y| at(&full, x, y)).filter(is_colored).collect::<Vec<_>>());
    let column = columns.max_by_key(Vec::len).unwrap();
    assert!(column.len() > 250, "{}", column.len());
    let [first, last] = [column[0], column[column.len() - 1]].map(|p| [p[0], p[1], p[2]]);
    assert!(first[0] > 220 && first[2] < 80 && last[2] > last[1], "{first:?} {last:?}");
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let good = || scene(vec![square(1, 1.0, 0.0, RED)]);
    let refused = |scene: &Scene, view: &View| render(scene, view).unwrap_err();
    assert_eq!(refused(&Scene::default(), &View::default()), RenderError::Empty);
    let nan = scene(vec![points(vec![[f64::NAN, 0.0, 0.0]], 1.0, RED)]);
    assert_eq!(refused(&nan, &View::default()), RenderError::Empty);
    let view = |change: fn(&mut View)| {
        let mut view = small(Direction::Iso);
        change(&mut view);
        view
    };
    assert!(matches!(refused(&good(), &view(|v| v.size = [0, 5])), RenderError::Size { .. }));
    assert!(matches!(refused(&good(), &view(|v| v.antialias = 9)), RenderError::Antialias(9)));
    assert!(matches!(refused(&good(), &view(|v| v.zoom = f64::NAN)), RenderError::Zoom(_)));
    let flat = view(|v| v.projection = Projection::Perspective { field_of_view: 3.1 });
    assert!(matches!(refused(&good(), &flat), RenderError::FieldOfView(_)));
    let inside = view(|v| v.direction = Direction::Placed { eye: [1.0; 3], target: [1.0; 3] });
    assert_eq!(refused(&good(), &inside), RenderError::CameraInTarget);
    let mut broken = good();
    broken.layers[0].paint = Paint::Each(vec![RED]);
    assert_eq!(refused(&broken, &small(Direction::Iso)), RenderError::Broken(0));
}

#[test]
fn one_point_and_points_that_are_not_finite_can_be_drawn() {
    for projection in [Projection::default(), Projection::Parallel] {
        let lone = points(vec![[5.0, 6.0, 7.0], [f64::INFINITY, 0.0, 0.0], [f64::NAN; 3]], 9.0, RED);
        let picture = render(&scene(vec![lone]), &View { projection, ..small(Direction::Iso) }).unwrap();
        let found = middle(&picture, is_reddish).unwrap();
        assert!(found.iter().all(|c| (c - 45.0).abs() < 1.0), "{found:?}");
    }
}
