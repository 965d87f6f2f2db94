//! Plans a goal, writes its program and checks it.
use std::collections::BTreeSet;

use stochc_compiler::diagnostic::{Code, Diagnostic};
use stochc_compiler::scene::DEFAULT;
use stochc_compiler::{Checked, check_text};
use stochc_estimate::Rates;
use stochc_ir::scene::Scene;

use super::definition::{Goal, NAME};
use super::existing_structure::Repair;
use super::price::price;
use crate::plan::build_plan::{baseline_plans, plan};
use crate::{
    Alternative, BuildPlan, Hardware, Naming, PlanSearch, RateLaw, ScaffoldTrial, Target,
    TargetError, declaration, draft, program,
};

/// A program that builds a shape.
#[derive(Debug)]
pub struct Planned {
    /// The plan, with its captures in order.
    pub plan: BuildPlan,
    /// Source of the program.
    pub text: String,
    /// Name of the source in diagnostics. Imports are relative to it.
    pub name: String,
    /// Name of the assembly that builds the shape.
    pub assembly: String,
    /// Name of its scene.
    pub scene: String,
    /// Names and sources of the imported files.
    pub imported: Vec<(String, String)>,
    /// Number of claims that are still false.
    pub untrue: usize,
}

/// Reason why there is no plan.
#[derive(Debug)]
pub enum Unplanned {
    /// The shape cannot be built.
    Refused(TargetError),
    /// The names, the scene or the plate are invalid. The result of the check contains the errors.
    Wrong(Box<Checked>),
}

/// Largest number of cells for comparison with the baseline plans.
const MAX_COMPARED: usize = 1000;

/// A list of at least `MANY` diagnostics may be incomplete, because the check has a limit.
const MANY: usize = 100;

/// Returns whether a warning is about the scene, which a plan cannot change.
fn is_of_scene(code: Code) -> bool {
    code == Code::TooManyBlocks || code.is_of_runs()
}

/// Returns the name of a warning that a planned program allows, with the reason. Returns `None` for
/// all other codes.
fn allowance(code: Code, hardware: Hardware) -> Option<(&'static str, String)> {
    let reason = match code {
        Code::TightApproach => "not every block has an access path two cells wide",
        Code::ReachUndecided => "the planner has found a way in for every block",
        Code::UnusedSeed => "in a planar world, every seed is an obstacle",
        code if is_of_scene(code) => "the scene is as it was given",
        Code::UnplannedBond if hardware.attracts_always => {
            "where every face attracts, none can be kept from it"
        }
        Code::CrowdedCaptures if hardware.attracts_always => {
            "where every face attracts, none can be kept closed"
        }
        Code::BlockedRelease if hardware.attracts_always => {
            "the planner did not search for a path out"
        }
        _ => return None,
    };
    Some((code.name(), reason.to_owned()))
}

/// Returns the name of a warning about jams that the winner of a race allows, with the reason.
/// Returns `None` for all other codes.
fn jam_allowance(code: Code) -> Option<(&'static str, String)> {
    let is_jam = matches!(code, Code::TightApproach | Code::CrowdedCaptures);
    is_jam.then(|| {
        (
            code.name(),
            "faster in simulated runs, jams included".to_owned(),
        )
    })
}

impl Goal {
    /// Plans the shape, writes the program and checks it. Minimizes the objective with the given or
    /// built-in rates of the scene. A baseline plan wins if it is faster and the check has no
    /// warnings about it.
    ///
    /// # Errors
    /// If the shape cannot be built, or names, scene or plate are invalid.
    pub fn plan(&self, rates: &[Rates], search: PlanSearch<'_>) -> Result<Planned, Unplanned> {
        let scene = self.scene().map_err(Unplanned::Wrong)?;
        let hardware = Hardware::from_scene(&scene);
        let target = (self.target(Some(&scene), hardware.free)).map_err(Unplanned::Refused)?;
        let law = RateLaw::for_scene(&scene, rates);
        let found = plan(&target, hardware, &law, search).map_err(Unplanned::Refused)?;
        let mut best = self.accepted(&target, found.plain, hardware, &law)?;
        if let Some(scaffolded) = found.scaffolded
            && let Ok(other) = self.accepted(&target, scaffolded, hardware, &law)
        {
            let value = |planned: &Planned| planned.plan.estimate.value(search.objective);
            let has_narrow = |planned: &Planned| planned.text.contains(Code::TightApproach.name());
            let (without, with) = (value(&best), value(&other));
            let is_used = with < without && has_narrow(&other) <= has_narrow(&best);
            if is_used {
                best = other;
            }
            best.plan.scaffolds = ScaffoldTrial::Tried {
                without,
                with,
                is_used,
            };
        }
        let mut alternatives = Vec::new();
        let has_baselines = self.repair == Repair::default() && target.plane().is_none();
        if self.cells.len() <= MAX_COMPARED && has_baselines {
            let objective = search.objective;
            for (baseline, mut plan) in baseline_plans(&target, hardware, &law, search.seed) {
                let checked = self.check(&target, &plan, &[]);
                price(&mut plan, &checked, &law);
                let estimate = plan.estimate;
                // Warnings about the scene hold for all plans.
                let is_of_scene = |it: &&Diagnostic| is_of_scene(it.code);
                let mut diagnostics = checked.diagnostics.iter();
                let diagnostic = diagnostics.find(|it| !is_of_scene(it));
                let diagnostic = diagnostic.map(|it| it.code.name());
                let is_better = estimate.value(objective) < best.plan.estimate.value(objective);
                if diagnostic.is_none() && is_better {
                    plan.baseline = Some(baseline);
                    plan.rounds = best.plan.rounds;
                    plan.scaffolds = best.plan.scaffolds.unused();
                    let found = checked.diagnostics.iter().filter(is_of_scene);
                    let reasons = found.filter_map(|it| allowance(it.code, hardware));
                    let text = self.text(&target, &plan, &reasons.collect::<Vec<_>>());
                    best = self.planned(plan, text);
                }
                alternatives.push(Alternative {
                    baseline,
                    estimate,
                    diagnostic,
                });
            }
        }
        best.plan.alternatives = alternatives;
        Ok(best)
    }

    /// Returns the baseline plans whose only warnings are about jams and the scene.
    ///
    /// # Errors
    /// If the shape cannot be built, or the scene has errors.
    pub fn plans_that_may_jam(
        &self,
        rates: &[Rates],
        seed: u64,
    ) -> Result<Vec<Planned>, Unplanned> {
        let scene = self.scene().map_err(Unplanned::Wrong)?;
        let hardware = Hardware::from_scene(&scene);
        let target = (self.target(Some(&scene), hardware.free)).map_err(Unplanned::Refused)?;
        let law = RateLaw::for_scene(&scene, rates);
        if target.plane().is_some() {
            return Ok(Vec::new());
        }
        let plans = baseline_plans(&target, hardware, &law, seed).into_iter();
        let accepted = plans.filter_map(|(baseline, plan)| {
            let plan = BuildPlan {
                baseline: Some(baseline),
                ..plan
            };
            let allowance = |code| jam_allowance(code).or_else(|| allowance(code, hardware));
            self.accepted_with(&target, plan, allowance, &law).ok()
        });
        Ok(accepted.collect())
    }

    /// Returns the target in a scene with a number of free blocks.
    pub(super) fn target(&self, scene: Option<&Scene>, free: u32) -> Result<Target, TargetError> {
        let plate = self.plate.clone().unwrap_or_else(|| self.smallest_plate());
        let Repair { existing, released } = self.repair.clone();
        let (cells, seeds) = (self.cells.clone(), self.seeds.clone());
        match scene.filter(|scene| scene.planar.is_some()) {
            Some(scene) => Target::in_plane(cells, scene, plate, seeds, free),
            None => Target::with_existing(cells, (existing, released), plate, seeds, free),
        }
    }

    /// Calls `written` with a plan and the names of its program.
    fn write<T>(
        &self,
        plan: &BuildPlan,
        allowed: &[(&str, String)],
        written: impl FnOnce(&BuildPlan, Naming<'_>) -> T,
    ) -> T {
        let are_permanent = plan.dismantling.as_ref().is_some_and(|it| it.are_permanent);
        let with_scaffolds = format!("{}_with_scaffolds", self.name);
        // If scaffolds remain, the program claims the shape together with them.
        let (name, shape) = if are_permanent {
            (&with_scaffolds, declaration(&with_scaffolds, &plan.cells()))
        } else {
            (&self.name, self.shape.clone())
        };
        let naming = Naming {
            assembly: &self.assembly(),
            scene: self.scene.as_deref(),
            shape: shape.as_ref().map(|_| name.as_str()),
            declarations: &(self.needed_scenes() + "\n" + shape.as_deref().unwrap_or("")),
            allowed,
        };
        written(plan, naming)
    }

    /// Returns the formatted program of a plan.
    pub(super) fn text(
        &self,
        target: &Target,
        plan: &BuildPlan,
        allowed: &[(&str, String)],
    ) -> String {
        self.write(plan, allowed, |plan, naming| {
            // If a name is invalid, the check reports it in this program without captures.
            program(target, plan, naming).unwrap_or_else(|_| {
                format!(
                    "{}\nassembly {} {{ }}",
                    naming.declarations, naming.assembly
                )
            })
        })
    }

    pub(super) fn check(
        &self,
        target: &Target,
        plan: &BuildPlan,
        allowed: &[(&str, String)],
    ) -> Checked {
        let draft = self.write(plan, allowed, |plan, naming| draft(target, plan, naming));
        check_text(NAME, &draft)
    }

    /// Returns the program of a plan. The program allows the warnings that the check reports. The
    /// estimate of the whole program replaces the plan's estimate.
    ///
    /// # Errors
    ///
    /// If the check reports diagnostics that cannot be allowed.
    fn accepted(
        &self,
        target: &Target,
        plan: BuildPlan,
        hardware: Hardware,
        law: &RateLaw<'_>,
    ) -> Result<Planned, Unplanned> {
        self.accepted_with(target, plan, |code| allowance(code, hardware), law)
    }

    /// Returns the program of a plan like [`Goal::accepted`]. `allowance` gives the name and the
    /// reason for each warning that may be allowed.
    fn accepted_with(
        &self,
        target: &Target,
        mut plan: BuildPlan,
        allowance: impl Fn(Code) -> Option<(&'static str, String)>,
        law: &RateLaw<'_>,
    ) -> Result<Planned, Unplanned> {
        let found = self.check(target, &plan, &[]);
        let codes: BTreeSet<Code> = found.diagnostics.iter().map(|it| it.code).collect();
        let found_codes = codes.len();
        let allowed = codes.into_iter().filter_map(allowance);
        let allowed: Vec<(&str, String)> = allowed.collect();
        // With many diagnostics, the check may have left out others.
        let is_accepted = allowed.len() == found_codes
            && (found.diagnostics.len() < MANY
                || self.check(target, &plan, &allowed).diagnostics.is_empty());
        if !is_accepted {
            // The diagnostics must refer to the formatted program.
            let found = check_text(NAME, &self.text(target, &plan, &allowed));
            return Err(Unplanned::Wrong(Box::new(found)));
        }
        price(&mut plan, &found, law);
        let text = self.text(target, &plan, &allowed);
        Ok(self.planned(plan, text))
    }

    /// Returns a plan with its program, which has no imports.
    pub(super) fn planned(&self, plan: BuildPlan, text: String) -> Planned {
        Planned {
            plan,
            text,
            name: NAME.to_owned(),
            assembly: self.assembly(),
            scene: self.scene.clone().unwrap_or_else(|| DEFAULT.to_owned()),
            imported: Vec::new(),
            untrue: 0,
        }
    }
}
