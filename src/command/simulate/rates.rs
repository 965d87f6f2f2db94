//! Rates for `--model rate`: those of files, or measured now.
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use stochc_ensemble::Program;
use stochc_files::budget::RATES;
use stochc_files::read_file;
use stochc_ir::scene::Scene;
use stochc_runtime::rates::Rates;

use super::super::calibrate::{Effort, measure};
use super::super::terminal::warn;
use crate::exit::Failure;

/// The rates of the scenes of programs, each once.
/// What has to be measured first takes so many threads, and shows its progress unless it is to be quiet.
pub fn of_scenes(
    files: &[PathBuf],
    programs: &[Program],
    (threads, quiet): (Option<u16>, bool),
    stop: &AtomicBool,
) -> Result<Vec<Rates>, Failure> {
    let known = of_files(files)?;
    let mut found: Vec<Rates> = Vec::new();
    for program in programs {
        let scene = &program.scene;
        if found.iter().any(|rates| rates.are_of(scene)) {
            continue;
        }
        let rates = match at_hand(&known, scene) {
            Some(rates) => rates.clone(),
            None => {
                warn(&format!(
                    "measuring the rates of the scene of {}, of which there are none; `stochc calibrate --out` keeps them\n",
                    program.name
                ));
                measure(scene, &Effort::usual(threads, quiet), stop)?
            }
        };
        found.push(rates);
    }
    Ok(found)
}

/// Those that files hold.
pub fn of_files(files: &[PathBuf]) -> Result<Vec<Rates>, Failure> {
    files.iter().map(|path| read(path)).collect()
}

/// The rates of a scene that are known, or come with the program.
pub fn at_hand<'a>(known: &'a [Rates], scene: &Scene) -> Option<&'a Rates> {
    let given = known.iter().find(|rates| rates.are_of(scene));
    given.or_else(|| Rates::built_in(scene))
}

fn read(path: &Path) -> Result<Rates, Failure> {
    let shown = path.display();
    let bytes = read_file(path, RATES)
        .map_err(|error| Failure::usage(format!("cannot read `{shown}`: {error}")))?;
    let text = String::from_utf8_lossy(&bytes);
    Rates::from_text(&text).map_err(|reason| Failure::usage(format!("`{shown}`: {reason}")))
}
