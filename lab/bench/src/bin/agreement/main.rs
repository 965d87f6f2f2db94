//! Compares the distributions of times of the models `rigid` and `rapier`.
//!
//! `--out FILE` runs the worlds `rigid` and `rapier` with 1 to 16 substeps on three small scenes.
//! It writes every sample to FILE and prints tables in Markdown. `--from FILE` prints the tables
//! again. `--runs N` sets the number of runs per cell (default 200). `--only CASE` selects one
//! scene. `--iterations` adds cells that differ only in Rapier's solver iterations. `--substeps K`
//! selects one number of substeps. `--friction MU` changes the friction of `hemisphere_2005`.
//!
//! Every cell has its own seed, so all samples are independent. Leaving out cells does not change
//! the others.
mod cases;
mod samples;
#[path = "../../../../../runtime/tests/runs/statistics.rs"]
mod statistics;
mod tables;

use std::fs::File;
use std::io::{BufWriter, Write as _};

use cases::{CASES, Cell, cells};
use samples::Sample;

fn main() -> std::io::Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let after = |name: &str| {
        let at = args.iter().position(|arg| arg == name)?;
        args.get(at + 1)
    };
    let samples = if let Some(path) = after("--from") {
        samples::read(&std::io::read_to_string(File::open(path)?)?)
    } else {
        let runs = after("--runs").map_or(200, |n| n.parse().expect("a number of runs"));
        let mut file = after("--out")
            .map(File::create)
            .transpose()?
            .map(BufWriter::new);
        if let Some(file) = &mut file {
            writeln!(file, "{}", samples::HEADER)?;
        }
        let only = after("--only");
        let substeps = after("--substeps").map(|k| k.parse::<u32>().expect("a number"));
        let friction = after("--friction").map(|mu| mu.parse::<f64>().expect("a number"));
        let cells: Vec<_> = cells(args.iter().any(|a| a == "--iterations"))
            .enumerate()
            .filter(|(_, cell)| only.is_none_or(|name| name == cell.case.name))
            .filter(|(_, cell)| substeps.is_none_or(|k| k == cell.substeps))
            .map(|(number, cell)| (number, Cell { friction, ..cell }))
            .collect();
        let mut all = Vec::new();
        // Each round makes one run of every cell. Cells of an interrupted study then have equal
        // numbers of runs.
        for run in 0..runs {
            for (number, cell) in &cells {
                let sample = cell.sample(*number as u64, run);
                if let Some(file) = &mut file {
                    writeln!(file, "{sample}")?;
                }
                all.push(sample);
            }
            if let Some(file) = &mut file {
                file.flush()?;
            }
            eprint!("\r{} of {runs} rounds", run + 1);
        }
        eprintln!();
        all
    };
    for case in &CASES {
        let of_case: Vec<Sample> = samples
            .iter()
            .filter(|s| s.case == case.name)
            .cloned()
            .collect();
        print!("{}", tables::page(case, &of_case));
    }
    Ok(())
}
