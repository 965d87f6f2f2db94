//! From shapes to programs that build them.
mod order;
mod random;
mod refused;
mod rest;
mod scaffolds;
mod shapes;

use std::path::{Path, PathBuf};

use stochc::planner::{BuildPlan, PlanSearch, layers};
use stochc::planner::{Goal, Planned, Unplanned};
use stochc_ir::Cell;

/// The shapes of the bench, sorted by name.
pub fn files() -> Vec<PathBuf> {
    let files = std::fs::read_dir("lab/planner/shapes").unwrap();
    let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    files
}

/// What one of them draws.
pub fn goal(path: &Path) -> Goal {
    let cells = layers(&std::fs::read_to_string(path).unwrap()).unwrap();
    Goal::of_cells(path.file_stem().unwrap().to_str().unwrap(), cells)
}

/// The shape of a name.
pub fn named(name: &str) -> Goal {
    goal(&Path::new("lab/planner/shapes").join(format!("{name}.txt")))
}

/// A plan after so many tries.
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

/// The cells of a plan, sorted.
pub fn cells(plan: &BuildPlan) -> Vec<Cell> {
    plan.cells()
}
