//! Makes the pictures of the normalised fit, with their inputs: `cargo run --release -p zeroset-cli --example figures -- DIR`.
//!
//! Into DIR it writes the inputs, the pictures and a `README.md` with the commands: each picture but the last is what `zeroset fit2d`
//! makes of a file that lies beside it. `convergence.svg` is measured here, and its figures go to standard output as a table.
//! Equal programs write equal bytes.

mod convergence;
mod inputs;
mod plot;

use std::path::Path;
use std::process::ExitCode;

use convergence::Series;

/// A picture by the command.
struct Figure {
    title: &'static str,
    /// Words after `zeroset fit2d`.
    words: &'static str,
}

const FIGURES: [Figure; 9] = [
    Figure {
        title: "Thirteen points and four triangles: figures 2 and 3 of the paper",
        words: "thirteen.csv -o thirteen.svg --domain four --bounds 0,0,1,1",
    },
    Figure {
        title: "Points, segments and a polygon in one fit, after figure 4",
        words: "mixed.json -o mixed.svg --line-weight 35 --bounds 0,0,1,1 --cells 20 --basis p2 --normalization mean-gradient --order 2 --smoothness 1e-5",
    },
    Figure {
        title: "A noisy corner inside one of two triangles, after figure 8: quadratic functions hold it",
        words: "corner.csv -o corner-p2.svg --basis p2 --bounds 0,0,1,1 --cells 1",
    },
    Figure {
        title: "The same with every branch of the zero set",
        words: "corner.csv -o corner-p2-all.svg --basis p2 --bounds 0,0,1,1 --cells 1 --branches all",
    },
    Figure {
        title: "The same by linear functions, which cannot",
        words: "corner.csv -o corner-p1.svg --basis p1 --bounds 0,0,1,1 --cells 1",
    },
    Figure {
        title: "A closed curve from 60 Gaussians",
        words: "clover.csv -o radial.svg --basis gaussian --centres 60 --normalization squared-gradient --order 2 --no-cells",
    },
    Figure {
        title: "The normalisation by coefficients, without smoothness, on a fine lattice: F sits where data are few",
        words: "peanut.csv -o normalization-coefficients.svg --cells 20 --normalization coefficients --order 0",
    },
    Figure {
        title: "The same data and lattice, by the squared gradient",
        words: "peanut.csv -o normalization-squared-gradient.svg --cells 20 --normalization squared-gradient --order 2",
    },
    Figure {
        title: "The same data and lattice, by the mean gradient",
        words: "peanut.csv -o normalization-mean-gradient.svg --cells 20 --normalization mean-gradient --order 2",
    },
];

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1) else {
        eprintln!("Usage: figures DIR");
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
    // So the words that run are those that are shown.
    std::env::set_current_dir(folder)?;
    inputs::write()?;
    for figure in &FIGURES {
        let words = ["zeroset", "fit2d"].into_iter().chain(figure.words.split_whitespace());
        if zeroset_cli::main(words.map(Into::into)) != ExitCode::SUCCESS {
            return Err(format!("`zeroset fit2d {}` failed", figure.words).into());
        }
    }
    let series = convergence::measure()?;
    let table = convergence::table(&series);
    print!("{table}");
    std::fs::write("convergence.svg", plot::draw(&series))?;
    std::fs::write("README.md", page(&table))?;
    Ok(())
}

/// The pictures with their commands.
fn page(table: &str) -> String {
    let mut page = "# Pictures of the normalised fit\n\nThe commands run in this folder. The pictures, their inputs and this page are made by\n\n\
        ```sh\ncargo run --release -p zeroset-cli --example figures -- docs/pictures/normalized-fit\n```\n"
        .to_owned();
    for Figure { title, words } in &FIGURES {
        let picture = words.split_whitespace().find(|word| word.ends_with(".svg")).unwrap_or_default();
        page += &format!("\n## {title}\n\n```sh\nzeroset fit2d {words}\n```\n\n![{title}]({picture})\n");
    }
    let title = Series::TITLE;
    page + &format!("\n## {title}\n\n![{title}](convergence.svg)\n\n{table}")
}
