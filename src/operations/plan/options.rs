//! Options of a plan.
use std::path::PathBuf;

use stochc_planner::Objective;

use super::budget::Budget;
use super::offset::Offset;
use super::seed_plate::SeedPlate;

/// Options of a plan.
#[derive(Clone, Copy, Debug)]
pub struct PlanOptions<'a> {
    /// A program with a shape, a voxel file, or a results folder.
    pub target: &'a str,
    /// The part of the target to plan.
    pub extent: PlanScope<'a>,
    /// Name of the shape in the program. `None` means the only shape, or the one claimed last.
    pub shape: Option<&'a str>,
    /// Number of the model in a `.vox` file to build. `None` means all models, placed as in the
    /// voxel scene.
    pub model: Option<u32>,
    /// The plate to build on. `None` means that of the target.
    pub seed_plate: Option<&'a SeedPlate>,
    /// Displacement of the shape from its position in the target.
    pub offset: Option<Offset>,
    /// The scene to build in, also as `FILE.sa:NAME`. The default is that of the target.
    pub scene: Option<&'a str>,
    /// Number of free blocks. The default is that of the scene.
    pub free: Option<u32>,
    /// Name of the assembly. The default is the name of the shape.
    pub name: Option<&'a str>,
    /// The treatment of loose parts.
    pub loose: LooseParts,
    /// Further folders for imports.
    pub imports: &'a [PathBuf],
    /// Budget of the search. `None` means about one second.
    pub budget: Option<Budget>,
    /// The time to minimize.
    pub objective: Objective,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Whether scaffolds remain in the structure.
    pub keeps_scaffolds: bool,
    /// Number of runs of each plan in a race. `None` if there is no race.
    pub race: Option<u64>,
    /// Files of rates for scenes without built-in rates.
    pub rates: &'a [PathBuf],
}

/// Treatment of parts that are not attached to a block that can capture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LooseParts {
    /// Reject the target.
    #[default]
    Refuse,
    /// Leave the parts out.
    Drop,
    /// Add cells that support the parts.
    Support,
}

impl LooseParts {
    /// Combines the two options. At most one of them is given.
    pub fn new(are_dropped: bool, are_supported: bool) -> LooseParts {
        if are_dropped {
            LooseParts::Drop
        } else if are_supported {
            LooseParts::Support
        } else {
            LooseParts::Refuse
        }
    }
}

/// The part of a target to plan.
#[derive(Clone, Copy, Debug, Default)]
pub enum PlanScope<'a> {
    /// The whole shape.
    #[default]
    Whole,
    /// The captures that are missing in a program.
    Completion,
    /// The blocks that are missing at the end of a run.
    Rest(RunEnd<'a>),
}

impl<'a> PlanScope<'a> {
    /// Returns the part to plan: the rest of a run if given, else the completion of a program, else
    /// the whole shape.
    pub fn new(rest: Option<RunEnd<'a>>, completes: bool) -> PlanScope<'a> {
        match rest {
            Some(end) => PlanScope::Rest(end),
            None if completes => PlanScope::Completion,
            None => PlanScope::Whole,
        }
    }
}

/// The end of a run. The rest is planned from here.
#[derive(Clone, Copy, Debug)]
pub struct RunEnd<'a> {
    /// Number of the run, from 0.
    pub run: u64,
    /// Name of the program. `None` means the only one of the folder.
    pub program: Option<&'a str>,
    /// Names of blocks that are broken: they neither capture nor pass on messages.
    pub dead: &'a [String],
}
