//! Makes the pictures of NEWE: `cargo run --release -p zeroset-cli --example newe_figures -- DIR`.
//!
//! Into DIR it writes the pictures and a `README.md`. Three of them are figures 5 to 7 of the paper in spirit: a corner in the plane, an
//! outside corner of three planes, and a notch, each with the first, the second and the last iterate of the method as printed. One more shows
//! what outliers do to it, and not to the fit of this library. Equal programs write equal bytes.

mod clip;
mod draw;
mod scenes;

use std::path::Path;
use std::process::ExitCode;

use draw::{Panel, nearest, picture};
use zeroset::feature::newe::{
    Flat, FlatCount, Iterate, NeweParams, Normalization, Stage, fit, fit_as_printed, halving_schedule,
};

/// A picture, as text.
struct Figure {
    file: &'static str,
    title: &'static str,
    /// What the reader should know.
    remark: &'static str,
    content: String,
}

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1) else {
        eprintln!("Usage: newe_figures DIR");
        return ExitCode::from(2);
    };
    match make(Path::new(&folder)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::FAILURE
        }
    }
}

fn make(folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all(folder)?;
    let figures = [
        iterates(
            ["corner.svg", "A corner in the plane", "After figure 5 of the paper. 120 points."],
            &scenes::corner_in_plane(0.0),
        )?,
        iterates(
            [
                "outside.svg",
                "An outside corner of three planes",
                "After figure 6. 600 points, from one start that succeeds.",
            ],
            &scenes::outside_corner(),
        )?,
        iterates(
            [
                "notch.svg",
                "A notch",
                "After figure 7: one face has three quadrants, two have one. 600 points, from one start that succeeds.",
            ],
            &scenes::notch(),
        )?,
        outliers()?,
    ];
    let mut page = "# Pictures of NEWE\n\nPoints have the colour of the flat that they lie nearest to; flats are drawn where they cross the box of the points, and a ring marks \
        the corner that the flats share. The pictures and this page are made by\n\n\
        ```sh\ncargo run --release -p zeroset-cli --example newe_figures -- docs/pictures/newe\n```\n"
        .to_owned();
    for Figure { file, title, remark, content } in &figures {
        std::fs::write(folder.join(file), content)?;
        page += &format!("\n## {title}\n\n{remark}\n\n![{title}]({file})\n");
    }
    std::fs::write(folder.join("README.md"), page)?;
    Ok(())
}

/// The first, the second and the last iterate of the method as printed.
fn iterates<const D: usize>(
    [file, title, remark]: [&'static str; 3],
    scene: &scenes::Scene<D>,
) -> Result<Figure, Box<dyn std::error::Error>> {
    let all = fit_as_printed(&scene.points, scene.flats.len(), &halving_schedule(5), Normalization::Affine)?;
    let panels: Vec<Panel<D>> = [(1, "first iterate"), (2, "second iterate"), (all.len() - 1, "last iterate")]
        .into_iter()
        .map(|(i, name)| panel(name, &all[i], scene))
        .collect();
    Ok(Figure { file, title, remark, content: picture(title, &scene.points, &panels) })
}

fn panel<const D: usize>(name: &str, iterate: &Iterate<D>, scene: &scenes::Scene<D>) -> Panel<D> {
    let exponent = match iterate.stage {
        Stage::Weighted { exponent } => format!(", P = {exponent}"),
        _ => String::new(),
    };
    Panel {
        title: format!("{name}{exponent}"),
        note: angle_note(&iterate.flats, scene),
        assignment: nearest(&scene.points, &iterate.flats),
        flats: iterate.flats.clone(),
    }
}

fn angle_note<const D: usize>(flats: &[Flat<D>], scene: &scenes::Scene<D>) -> String {
    format!("largest angle from the truth {:.1}\u{b0}", scene.angle(flats).to_degrees())
}

/// The method as printed and the dependable fit, on the same points.
fn outliers() -> Result<Figure, Box<dyn std::error::Error>> {
    let title = "A corner among outliers";
    let scene = scenes::corner_in_plane(0.2);
    let printed = fit_as_printed(&scene.points, 2, &halving_schedule(5), Normalization::Affine)?;
    let last = &printed[printed.len() - 1];
    let found =
        fit(&scene.points, &NeweParams { flats: FlatCount::Between { least: 1, most: 4 }, ..NeweParams::default() })?;
    let panels = [
        Panel { title: "as printed".into(), ..panel("", last, &scene) },
        Panel {
            title: "dependable".into(),
            note: angle_note(&found.flats, &scene),
            flats: found.flats,
            assignment: found.assignment,
        },
    ];
    let content = picture(title, &scene.points, &panels);
    let remark = "120 points and 30 outliers. Noise and number of lines were found too; points in grey are called outliers. The errors of outliers are large, and so are their weights; the truncated objective is not drawn to them.";
    Ok(Figure { file: "outliers.svg", title, remark, content })
}
