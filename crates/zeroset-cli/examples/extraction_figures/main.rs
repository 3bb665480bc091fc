//! Makes the pictures and figures of the extraction: `cargo run --release -p zeroset-cli --example extraction_figures -- DIR [FERTILITY]`.
//!
//! Into DIR it writes pictures of segmentations, with vertices in the middle and at least curvature, and a `README.md` with what was
//! measured. FERTILITY is a mesh whose cloud is fitted and extracted, too. Equal programs write equal bytes, but for times.

mod draw;
mod fertility;
mod shapes;

use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use draw::picture;
use shapes::{BLOBS, ELLIPSOID, Known, Place, SPHERE, Shape, TORUS, agreement, field};
use zeroset::contour::{
    Candidates, ContourParams, ContourReport, LeastCurvature, Nodes, Norm, Placement, contour_tetrahedra, contour_with,
};
use zeroset::domain::SimplicialMesh;
use zeroset::field::LatticeField;
use zeroset::mesh::Mesh;

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let Some(folder) = arguments.first() else {
        eprintln!("Usage: extraction_figures DIR [FERTILITY]");
        return ExitCode::from(2);
    };
    match make(Path::new(folder), arguments.get(1).map(Path::new)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::FAILURE
        }
    }
}

/// The placements that are compared, with their names.
pub(crate) fn placements() -> [(&'static str, Placement); 6] {
    let least = LeastCurvature { halvings: 0, ..LeastCurvature::default() };
    let named = |name, least| (name, Placement::LeastCurvature(least));
    [
        ("mean of crossings", Placement::MeanOfCrossings),
        named("least curvature on F = 0", LeastCurvature { candidates: Candidates::ZeroSet, ..least }),
        named("norm as printed, N = 9", LeastCurvature { norm: Norm::Printed, ..least }),
        named("least curvature, N = 7", LeastCurvature { divisions: 7, ..least }),
        named("least curvature, N = 9", least),
        named("least curvature, 2 halvings", LeastCurvature::default()),
    ]
}

fn make(folder: &Path, fertility: Option<&Path>) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all(folder)?;
    let mut page = "# Pictures and figures of the extraction\n\nMade by\n\n```sh\ncargo run --release -p zeroset-cli --example \
        extraction_figures -- docs/pictures/extraction fertility.off\n```\n\nTimes are those of one run on a shared machine.\n"
        .to_owned();
    let (title, file) = ("Marks of a torus on a lattice, 16 cells over the side of the box", "torus-marks.svg");
    let marks = field(TORUS.1, 16.0, Known::Marks);
    let meshes = pictured().map(|(_, placement)| extract(&marks, &ContourParams { placement }).0);
    std::fs::write(folder.join(file), picture(title, &captions(&meshes)))?;
    write!(page, "\n## {title}\n\n![{title}]({file})\n")?;
    let (title, file) = ("Marks of two blobs on a Delaunay mesh of 6000 sites", "delaunay-marks.svg");
    let (mesh, marks) = delaunay(BLOBS, 6000)?;
    let surface = |placement| contour_tetrahedra(&mesh, Nodes::Marks(&marks), &ContourParams { placement });
    let [middle, candidates, halved] = pictured().map(|(_, placement)| surface(placement));
    std::fs::write(folder.join(file), picture(title, &captions(&[middle?.0, candidates?.0, halved?.0])))?;
    write!(page, "\n## {title}\n\n![{title}]({file})\n")?;

    page += &agreements()?;
    page += &sweeps()?;
    if let Some(path) = fertility {
        page += &fertility::figures(path)?;
    }
    std::fs::write(folder.join("README.md"), page)?;
    Ok(())
}

fn extract(field: &LatticeField, params: &ContourParams) -> (Mesh, ContourReport) {
    contour_with(field, params, |_| true)
}

/// The placements that pictures show, with their captions.
fn pictured() -> [(&'static str, Placement); 3] {
    let least = LeastCurvature::default();
    [
        ("middle", Placement::MeanOfCrossings),
        ("least curvature", Placement::LeastCurvature(LeastCurvature { halvings: 0, ..least })),
        ("least curvature, two halvings", Placement::LeastCurvature(least)),
    ]
}

fn captions(meshes: &[Mesh; 3]) -> Vec<(&'static str, &Mesh)> {
    pictured().into_iter().zip(meshes).map(|((caption, _), mesh)| (caption, mesh)).collect()
}

/// A Delaunay mesh of the cube -1.1..1.1, and the marks of a shape.
fn delaunay((_, f): Shape, sites: u64) -> Result<(SimplicialMesh<3>, Vec<bool>), zeroset::domain::DomainError> {
    let corner = |bits: u64| -> Place { std::array::from_fn(|a| if bits >> a & 1 == 1 { 1.1 } else { -1.1 }) };
    // Halton's points in bases 2, 3 and 5: spread evenly, and no two on one plane of a lattice.
    let radical = |mut i: u64, base: u64| {
        let (mut value, mut scale) = (0.0, 1.0);
        while i > 0 {
            scale /= base as f64;
            value += scale * (i % base) as f64;
            i /= base;
        }
        value
    };
    let site = |i: u64| -> Place { [2, 3, 5].map(|base| 2.2 * radical(i, base) - 1.1) };
    let places: Vec<Place> = (0..8).map(corner).chain((1..=sites).map(site)).collect();
    let mesh = SimplicialMesh::<3>::delaunay(&places)?;
    let marks = mesh.vertices().iter().map(|&p| f(p) < 0.0).collect();
    Ok((mesh, marks))
}

/// How placements agree with shapes that are known, and what they cost.
fn agreements() -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    for (known, what) in [(Known::Values, "Values of F"), (Known::Marks, "Marks")] {
        write!(
            text,
            "\n## {what}: how meshes agree with the shapes\n\n40 cells over the side of the box. Distance is in parts of a cell; the angle is that between triangles and the truth, root of mean square; slim are triangles with an angle below 15 degrees; cost is the time of the extraction over that of the first line.\n"
        )?;
        write!(
            text,
            "\n| shape | placement | distance | normal consistency | angle | slim | cost |\n|---|---|--:|--:|--:|--:|--:|\n"
        )?;
        for (name, f) in [SPHERE, TORUS, ELLIPSOID] {
            let field = field(f, 40.0, known);
            let mut first = None;
            for (placement_name, placement) in placements() {
                let params = ContourParams { placement };
                let seconds = (0..5)
                    .map(|_| {
                        let start = Instant::now();
                        extract(&field, &params);
                        start.elapsed().as_secs_f64()
                    })
                    .fold(f64::INFINITY, f64::min);
                let found = agreement(&extract(&field, &params).0, f);
                let cost = seconds / *first.get_or_insert(seconds);
                writeln!(
                    text,
                    "| {name} | {placement_name} | {:.4} | {:.4} | {:.1}\u{b0} | {:.3} | {cost:.1} |",
                    found.distance / field.lattice.spacing,
                    found.normal_consistency,
                    found.angle_deg,
                    found.slim
                )?;
            }
        }
    }
    Ok(text)
}

/// How vertices move from sweep to sweep.
fn sweeps() -> Result<String, std::fmt::Error> {
    let mut text = "\n## Movement of vertices\n\nThe largest and the mean movement of each sweep, in parts of the longest edge of the tetrahedron. From sweep 9 on the distance of candidates is halved each time.\n"
        .to_owned();
    let least = LeastCurvature { most_sweeps: 8, halvings: 22, ..LeastCurvature::default() };
    let on_zero_set = LeastCurvature { candidates: Candidates::ZeroSet, ..least };
    let shown = [1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30];
    let head: String = shown.iter().map(|k| format!(" {k} |")).collect();
    write!(text, "\n| shape | candidates |{head}\n|---|---|{}\n", "--:|".repeat(shown.len()))?;
    for (name, f) in [SPHERE, TORUS, ELLIPSOID] {
        for (known, least, what) in
            [(Known::Marks, least, "marks, tetrahedron"), (Known::Values, on_zero_set, "values, zero set")]
        {
            let field = field(f, 40.0, known);
            let (_, report) = extract(&field, &ContourParams { placement: Placement::LeastCurvature(least) });
            let sweeps = report.placement.map(|p| p.sweeps).unwrap_or_default();
            // Candidates may settle before the most sweeps are made; the last sweeps are those of the halvings.
            let (settling, halving) = sweeps.split_at(sweeps.len().saturating_sub(least.halvings as usize));
            let at = |k: usize| {
                if k <= least.most_sweeps { settling.get(k - 1) } else { halving.get(k - 1 - least.most_sweeps) }
            };
            let cells: String = shown
                .iter()
                .map(|&k| at(k).map_or(" 0 |".to_owned(), |s| format!(" {:.0e} / {:.0e} |", s.largest_rel, s.mean_rel)))
                .collect();
            writeln!(text, "| {name} | {what} |{cells}")?;
        }
    }
    Ok(text)
}
