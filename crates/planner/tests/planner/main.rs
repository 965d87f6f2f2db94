//! Tests plans of shapes and the programs that build them.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests read shapes from the disk"
)]
mod order;
mod planar;
mod random;
mod refused;
mod rest;
mod scaffolds;
mod shapes;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use stochc_compiler::{Checked, Program};
use stochc_ir::record::RunRecord;
use stochc_ir::{Cell, Executable};
use stochc_planner::{BuildPlan, Goal, PlanSearch, Planned, Unplanned, layers};
use stochc_runtime::Settings;

/// Returns the files of the shapes of the lab, sorted by name.
pub fn files() -> Vec<PathBuf> {
    let files = std::fs::read_dir("../../lab/planner/shapes").unwrap();
    let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    files
}

/// Returns the target of a shape file.
pub fn goal(path: &Path) -> Goal {
    let cells = layers(&std::fs::read_to_string(path).unwrap()).unwrap();
    Goal::from_cells(path.file_stem().unwrap().to_str().unwrap(), cells)
}

/// Returns a target by the name of its shape.
pub fn named(name: &str) -> Goal {
    goal(&Path::new("../../lab/planner/shapes").join(format!("{name}.txt")))
}

/// Returns a plan after this number of rounds.
pub fn tried(goal: &Goal, rounds: u64) -> Result<Planned, Unplanned> {
    let seed = 7;
    goal.plan(
        &[],
        PlanSearch {
            rounds,
            seed,
            ..PlanSearch::default()
        },
    )
}

/// Returns the programs of a file without errors.
pub fn compile(checked: Checked) -> Vec<Executable> {
    assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
    let programs = checked.programs.into_iter();
    programs.filter_map(Program::into_executable).collect()
}

/// Executes one run.
pub fn simulate(executable: &Executable, settings: &Settings, seed: u64, run: u64) -> RunRecord {
    let (tables, scene) = (&executable.tables, &executable.scene);
    let mut watch = |_, _| ControlFlow::Continue(());
    stochc_runtime::run(tables, scene, settings, seed, run, &mut watch).unwrap()
}

/// Returns the cells of a plan, sorted.
pub fn cells(plan: &BuildPlan) -> Vec<Cell> {
    plan.cells()
}
