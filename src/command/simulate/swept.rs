//! Programs at many points of a sweep, and the files that tell of it.
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use stochc_ir::Executable;

use super::super::check::verdict;
use super::super::terminal::{has_colour, message_width, warn};
use super::{Options, input, usage};
use crate::cli::Exit;
use crate::ensemble::{Compiled, Finished, MOST_RUNS, Manifest, Program};
use crate::files::atomic;
use crate::findings::drawn;
use crate::sweep::{MOST_POINTS, Sweep, pictures, points as combine};

/// Each program at each point, compiled with the values of the point.
///
/// What a program is refused for at a point is told with the point; then nothing is run.
pub(super) fn points(options: &Options, programs: &[Program]) -> Result<Vec<Program>, Exit> {
    let mut at_points = Vec::new();
    for program in programs {
        if program.sources.is_empty() {
            return Err(usage(&format!(
                "--sweep: `{}` is compiled already; name the file of its text instead",
                program.name
            )));
        }
        let points = combine(&options.sweep, &program.scene)
            .map_err(|reason| usage(&format!("--sweep: {reason}")))?;
        for varied in points {
            let mut entry = program.clone();
            entry.varied = varied;
            entry.name += &entry.point();
            at_points.push(entry);
        }
    }
    let count = at_points.len();
    if count > MOST_POINTS {
        return Err(usage(&format!(
            "--sweep: these are {count} points of {} programs, and {MOST_POINTS} is the most; ask for fewer \
             values",
            programs.len()
        )));
    }
    if options.runs.saturating_mul(count as u64) > MOST_RUNS {
        return Err(usage(&format!(
            "--sweep: {} runs at each of {count} points are more than {MOST_RUNS}; lower `--runs`",
            options.runs
        )));
    }
    let mut wrong = Vec::new();
    for entry in &mut at_points {
        if let Err(exit) = compile(entry, options, wrong.is_empty()) {
            wrong.push((entry.name.clone(), exit));
        }
    }
    share_tables(&mut at_points);
    match &wrong[..] {
        [] => Ok(at_points),
        [(_, exit)] => Err(*exit),
        [(_, exit), more @ ..] => {
            let names: Vec<&str> = more.iter().map(|(name, _)| name.as_str()).collect();
            warn(&format!(
                "error: nor can these be run: {}\n",
                names.join(", ")
            ));
            Err(*exit)
        }
    }
}

/// Compiles a program at its point; `is_told`: says why not.
///
/// Warnings have been told when the program was read as it is.
fn compile(entry: &mut Program, options: &Options, is_told: bool) -> Result<(), Exit> {
    let levels = &options.levels.levels;
    let checked = input::recompile(&entry.sources, &entry.varied, entry.assembly(), levels);
    if checked.has_errors() {
        if is_told {
            warn(&format!("error: `{}` cannot be run:\n", entry.name));
            let (colour, width) = (has_colour(), message_width());
            warn(&drawn(&checked, colour, width));
        }
        return Err(verdict(&checked));
    }
    let programs = checked.programs.into_iter();
    let mut compiled = programs.filter_map(stochc_compiler::Program::into_executable);
    let found = compiled.find(|executable| executable.tables.assembly == entry.assembly());
    let Some(Executable {
        tables,
        scene,
        graph,
    }) = found
    else {
        return Err(usage(&format!("`{}` does not compile", entry.name)));
    };
    entry.scene = scene;
    entry.compiled = Arc::new(Compiled::new(tables, graph));
    Ok(())
}

/// Keeps what is the same at many points once.
fn share_tables(programs: &mut [Program]) {
    let mut known: HashMap<String, Arc<Compiled>> = HashMap::new();
    for program in programs {
        let digest = program.compiled.digest().to_owned();
        let first = known
            .entry(digest)
            .or_insert_with(|| program.compiled.clone());
        if first.graph == program.compiled.graph {
            program.compiled = first.clone();
        }
    }
}

/// Writes `sweep.json`, `sweep.csv` and the figures into a results folder, if its ensemble is a sweep.
pub(super) fn keep(out: &Path, manifest: &Manifest, finished: &[Finished]) -> Result<(), Exit> {
    let Some(sweep) = Sweep::of(manifest, finished) else {
        return Ok(());
    };
    let tables = [
        ("sweep.json".to_owned(), sweep.to_json(manifest)),
        ("sweep.csv".to_owned(), sweep.to_csv()),
    ];
    let pictures = pictures(&sweep, "sweep").into_iter();
    let pictures = pictures.map(|drawing| (format!("{}.svg", drawing.name), drawing.file()));
    for (name, text) in tables.into_iter().chain(pictures) {
        let path = out.join(name);
        atomic::replace(&path, text.as_bytes())
            .map_err(|error| usage(&format!("cannot write `{}`: {error}", path.display())))?;
    }
    Ok(())
}
