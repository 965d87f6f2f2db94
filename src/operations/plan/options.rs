//! Options of planning a program.
use std::path::PathBuf;

use stochc_planner::Objective;

use super::budget::Budget;
use super::offset::Offset;
use super::seed_plate::SeedPlate;

/// Options of planning a program.
#[derive(Clone, Copy, Debug)]
pub struct PlanOptions<'a> {
    /// Path of the target: a program with a shape, a voxel file, or a results folder.
    pub target: &'a str,
    /// Part of the target to plan.
    pub extent: PlanScope<'a>,
    /// Name of the shape in the target program. `None` means the only shape, or the shape of the
    /// last claim.
    pub shape: Option<&'a str>,
    /// Number of the model to build from a `.vox` file. `None` means all models, at their positions
    /// in the voxel scene.
    pub model: Option<u32>,
    /// Plate to build on. `None` means the plate of the target.
    pub seed_plate: Option<&'a SeedPlate>,
    /// Displacement of the shape from its position in the target. `None` means no displacement.
    pub offset: Option<Offset>,
    /// Scene to build in, also as `FILE.sa:NAME`. `None` means the scene of the target.
    pub scene: Option<&'a str>,
    /// Number of free blocks. `None` means the number of the scene.
    pub free: Option<u32>,
    /// Name of the assembly. `None` means the name of the shape.
    pub name: Option<&'a str>,
    /// Treatment of loose parts.
    pub loose: LooseParts,
    /// Additional folders that imports may come from.
    pub imports: &'a [PathBuf],
    /// Budget of the search. `None` means a budget of about one second.
    pub budget: Option<Budget>,
    /// Statistic of the completion time that the plan minimizes.
    pub objective: Objective,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Whether scaffolds remain in the structure.
    pub keeps_scaffolds: bool,
    /// Number of runs of each plan in a race. `None` means no race.
    pub race: Option<u64>,
    /// Files with calibrated rates, for scenes without built-in rates.
    pub rates: &'a [PathBuf],
}

/// Treatment of loose parts, which are not attached to a block that can capture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LooseParts {
    /// Loose parts are an error.
    #[default]
    Refuse,
    /// Loose parts are left out.
    Drop,
    /// Loose parts are supported by additional cells.
    Support,
}

impl LooseParts {
    /// Returns the treatment that two options select. At most one of them may be set.
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

/// Part of a target to plan.
#[derive(Clone, Copy, Debug, Default)]
pub enum PlanScope<'a> {
    /// The whole shape.
    #[default]
    Whole,
    /// Captures that are missing in a program.
    Completion,
    /// Blocks that are missing at the end of a run.
    Rest(RunEnd<'a>),
}

impl<'a> PlanScope<'a> {
    /// Returns the part to plan. This is the rest of a run if one is given. Otherwise it is the
    /// completion of a program or the whole shape.
    pub fn new(rest: Option<RunEnd<'a>>, completes: bool) -> PlanScope<'a> {
        match rest {
            Some(end) => PlanScope::Rest(end),
            None if completes => PlanScope::Completion,
            None => PlanScope::Whole,
        }
    }
}

/// End of a run, where planning continues.
#[derive(Clone, Copy, Debug)]
pub struct RunEnd<'a> {
    /// Number of the run, from 0.
    pub run: u64,
    /// Name of the program. `None` means the only program of the folder.
    pub program: Option<&'a str>,
    /// Names of broken blocks, which neither capture nor forward messages.
    pub dead: &'a [String],
}
