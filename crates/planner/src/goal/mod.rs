//! Turns a shape of a program, or a set of cells, into a checked program that builds it.
mod completion;
mod larger_scene;
mod loose_parts;
mod no_goal;
mod repair;
mod scenes;

use std::collections::{BTreeSet, HashMap};
use std::sync::OnceLock;

use crate::plan::build_plan::{baseline_plans, plan};
use crate::{
    Alternative, BuildPlan, Hardware, Naming, PlanEstimate, PlanSearch, RateLaw, ScaffoldTrial,
    Target, TargetError, declaration, draft, program,
};
use stochc_compiler::diagnostic::{Code, Diagnostic};
use stochc_compiler::plan::{EventId, PlanSeed, ProgramPlan};
use stochc_compiler::scene::{DEFAULT, is_built_in};
use stochc_compiler::{Checked, DeclaredShape, DeclaredShapes, Program, shape_cells};
use stochc_estimate::{Rates, Times};
use stochc_grammar::tree::{Item, Tree};
use stochc_grammar::{Symbols, print};
use stochc_ir::Cell;
use stochc_ir::scene::Scene;
use stochc_ir::table::Plate;

pub use completion::untrue_claims;
pub use completion::{Completion, NotCompleted};
pub use larger_scene::LargerScene;
pub use no_goal::NoGoal;
pub use repair::{ExistingStructure, NoRepair, Repair};
use scenes::WrittenScenes;
use stochc_compiler::check_text;

/// The shape to build, with its plate and scene.
#[derive(Clone, Debug)]
pub struct Goal {
    /// Name of the shape.
    pub name: String,
    /// Cells of the shape.
    pub cells: Vec<Cell>,
    /// The plate. `None` means the smallest one under all cells of the lowest layer.
    pub plate: Option<Plate>,
    /// Positions (x, y) of the plate's blocks that may capture. `None` means all.
    pub seeds: Option<Vec<(i32, i32)>>,
    /// Name of the scene. `None` means the default scene.
    pub scene: Option<String>,
    /// Name of the assembly. `None` means `build_` and the name of the shape.
    pub assembly: Option<String>,
    /// Source of the shape's declaration. `None` if the shape is not declared.
    shape: Option<String>,
    /// Declarations of scenes in the program of the shape.
    scenes: WrittenScenes,
    /// Existing blocks, and those to release.
    repair: Repair,
    /// Cache of the compiled scene, with its name.
    compiled: OnceLock<(Option<String>, Scene)>,
}

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
    /// The names, the scene or the plate are invalid. These diagnostics state the errors.
    Wrong(Box<Checked>),
}

/// Name of programs in diagnostics.
const NAME: &str = "planned.sa";

/// Largest number of cells for comparison with the baseline plans.
const MAX_COMPARED: usize = 1000;

/// From this number of diagnostics on, the check may have left out others.
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
    /// Creates a goal from cells. The name must be valid in a program.
    pub fn of_cells(name: &str, cells: Vec<Cell>) -> Goal {
        let mut sorted = cells.clone();
        sorted.sort_unstable();
        sorted.dedup();
        Goal {
            name: name.to_owned(),
            shape: declaration(name, &sorted),
            cells,
            plate: None,
            seeds: None,
            scene: None,
            assembly: None,
            scenes: WrittenScenes::default(),
            repair: Repair::default(),
            compiled: OnceLock::new(),
        }
    }

    /// Returns a shape of a correct program as a goal. Plate, seeds and scene are those of the
    /// assembly that claims it, or of the only assembly. Without a name, takes the only shape or
    /// the one claimed last.
    ///
    /// # Errors
    /// If there is no such shape.
    pub fn of_program(checked: &Checked, name: Option<&str>) -> Result<Goal, NoGoal> {
        let symbols = &checked.symbols;
        let claims = |plan: &ProgramPlan| -> Vec<&str> {
            let claims = plan.phases.iter().flat_map(|phase| &phase.claims);
            let names = claims.map(|&(name, _)| symbols.word(name));
            // The declared names live as long as the file.
            names.collect()
        };
        let declared = DeclaredShapes::new(checked);
        let known: Vec<&str> = (declared.all().iter())
            .map(|it| symbols.word(it.shape.name.symbol))
            .collect();
        let listed = || {
            known
                .iter()
                .map(|name| format!("`{name}`"))
                .collect::<Vec<_>>()
                .join(", ")
        };
        let programs = || {
            checked
                .programs
                .iter()
                .filter(|program| program.plan.aggregate.is_none())
        };
        let claiming = |wanted: &str| {
            programs().find(|program| {
                let claims = claims(&program.plan);
                claims.contains(&wanted) && declared.seen_from(&program.plan, wanted).is_some()
            })
        };
        let all_claimed = programs().flat_map(|program| {
            let names = claims(&program.plan).into_iter();
            names.map(move |name| (program, name))
        });
        let last_claimed = all_claimed.last();
        let (wanted, claiming) = match (name, &known[..]) {
            (Some(name), _) => (name, claiming(name)),
            (None, []) => return Err(NoGoal::NoShape),
            (None, [only]) => (*only, claiming(only)),
            (None, _) => {
                let (program, name) = last_claimed.ok_or_else(|| NoGoal::Ambiguous(listed()))?;
                let seen = declared.seen_from(&program.plan, name);
                let is_local = seen.is_some_and(|it| it.is_local);
                (
                    name,
                    if is_local {
                        Some(program)
                    } else {
                        claiming(name)
                    },
                )
            }
        };
        let of_claim = claiming.and_then(|program| declared.seen_from(&program.plan, wanted));
        let first =
            || (declared.all().iter()).find(|it| symbols.word(it.shape.name.symbol) == wanted);
        let found = of_claim.or_else(first);
        let found = found.ok_or_else(|| match known.len() {
            0 => NoGoal::NoSuchShape(wanted.to_owned()),
            _ => NoGoal::OtherShapes {
                name: wanted.to_owned(),
                others: listed(),
            },
        })?;
        let only = || programs().next().filter(|_| programs().count() == 1);
        Goal::of_shape(checked, found, claiming.or_else(only))
    }

    /// Returns a shape with the plate, the seeds and the scene of an assembly.
    fn of_shape(
        checked: &Checked,
        declared: &DeclaredShape<'_>,
        assembly: Option<&Program>,
    ) -> Result<Goal, NoGoal> {
        let DeclaredShape {
            file, item, shape, ..
        } = declared;
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        let cells = shape_cells(shape, *file, &mut diagnostics);
        let cells = cells.ok_or_else(|| match diagnostics.first() {
            Some(diagnostic) => NoGoal::Wrong(match diagnostic.labels.first() {
                Some(label) => format!("{}: {}", diagnostic.message(), label.text),
                None => diagnostic.message(),
            }),
            None => NoGoal::NoCells,
        })?;
        let symbols = &checked.symbols;
        Ok(Goal {
            name: symbols.word(shape.name.symbol).to_owned(),
            cells,
            plate: assembly.map(|program| program.plan.plate.clone()),
            seeds: assembly.and_then(|program| seats(&program.plan)),
            scene: assembly.and_then(scene_of),
            assembly: None,
            shape: Some(printed(item, symbols)),
            scenes: WrittenScenes::new(checked),
            repair: Repair::default(),
            compiled: OnceLock::new(),
        })
    }

    /// Moves the shape by this number of cells. Returns `None` if coordinates overflow.
    pub fn moved(self, east: i32, north: i32) -> Option<Goal> {
        let moved = |cell: &Cell| {
            let (x, y) = (cell.x.checked_add(east)?, cell.y.checked_add(north)?);
            Some(Cell::new(x, y, cell.z))
        };
        let cells: Vec<Cell> = self.cells.iter().map(moved).collect::<Option<_>>()?;
        Some(Goal {
            plate: self.plate,
            seeds: self.seeds,
            scene: self.scene,
            assembly: self.assembly,
            scenes: self.scenes,
            ..Goal::of_cells(&self.name, cells)
        })
    }

    /// Declares a scene with this source and selects it.
    pub fn declare_scene(&mut self, name: &str, text: &str) {
        self.scene = Some(name.to_owned());
        self.scenes = WrittenScenes::new(&check_text(NAME, text));
        self.compiled = OnceLock::new();
    }

    /// Selects a scene of another program and copies its declaration.
    ///
    /// # Errors
    /// If the program has no such scene, or several and no name is given. The error lists their
    /// names.
    pub fn take_scene(&mut self, from: &Checked, name: Option<&str>) -> Result<(), Vec<String>> {
        let scenes = WrittenScenes::new(from);
        let names: Vec<&str> = scenes.names().collect();
        let chosen = match (name, &names[..]) {
            (Some(name), _) => names.contains(&name).then_some(name),
            (None, [only]) => Some(*only),
            (None, _) => None,
        };
        let Some(chosen) = chosen.map(str::to_owned) else {
            return Err(names.into_iter().map(str::to_owned).collect());
        };
        self.scenes = scenes;
        self.scene = Some(chosen);
        self.compiled = OnceLock::new();
        Ok(())
    }

    /// Returns the names of the scenes that are declared in the program of the shape.
    pub fn declared_scenes(&self) -> impl Iterator<Item = &str> {
        self.scenes.names()
    }

    /// Returns the selected scene.
    ///
    /// # Errors
    /// If the scene does not exist or has errors.
    pub fn scene(&self) -> Result<Scene, Box<Checked>> {
        match self.compiled.get() {
            Some((name, scene)) if *name == self.scene => Ok(scene.clone()),
            _ => {
                let scene = self.compile_scene()?;
                // The cache keeps only the first scene. Another one is compiled each time.
                let _ = self.compiled.set((self.scene.clone(), scene.clone()));
                Ok(scene)
            }
        }
    }

    fn compile_scene(&self) -> Result<Scene, Box<Checked>> {
        let scene = self
            .scene
            .as_ref()
            .map_or(String::new(), |scene| format!(" in {scene}"));
        let text = format!(
            "{}\nassembly probe{scene} {{ seed plate 1 x 1 {{ M at (0, 0) }}\nphase grow {{ M.up -> A }} }}",
            self.scenes.all()
        );
        let mut checked = check_text(NAME, &text);
        let scene = checked
            .programs
            .first_mut()
            .and_then(|program| program.scene.take());
        scene.ok_or_else(|| Box::new(checked))
    }

    /// Returns whether a scene is built in or declared in the program of the shape.
    pub fn knows_scene(&self, name: &str) -> bool {
        is_built_in(name) || self.scenes.declare(name)
    }

    /// Returns the declarations of the selected scene and its bases.
    fn needed_scenes(&self) -> String {
        // A file may declare a scene with the name of the default scene.
        self.scenes
            .needed_for(self.scene.as_deref().unwrap_or(DEFAULT))
    }

    /// Returns the smallest plate under all cells of the lowest layer.
    fn smallest_plate(&self) -> Plate {
        let feet = || self.cells.iter().filter(|cell| cell.z == 1);
        let edge = |axis: fn(&Cell) -> i32| {
            let last = feet().map(axis).max().unwrap_or(0);
            (last.max(0) as u32).saturating_add(1).min(Plate::LONGEST)
        };
        Plate {
            width: edge(|cell| cell.x),
            depth: edge(|cell| cell.y),
        }
    }

    /// Plans the shape, writes the program and checks it. Minimizes the objective with the given or
    /// built-in rates of the scene. A baseline plan wins if it is faster and the check has no
    /// warnings about it.
    ///
    /// # Errors
    /// If the shape cannot be built, or names, scene or plate are invalid.
    pub fn plan(&self, rates: &[Rates], search: PlanSearch<'_>) -> Result<Planned, Unplanned> {
        let scene = self.scene().map_err(Unplanned::Wrong)?;
        let hardware = Hardware::from_scene(&scene);
        let target = self.target(hardware).map_err(Unplanned::Refused)?;
        let law = RateLaw::for_scene(&scene, rates);
        let found = plan(&target, hardware, &law, search).map_err(Unplanned::Refused)?;
        let mut best = self.accepted(&target, found.plain, hardware, &law)?;
        if let Some(scaffolded) = found.scaffolded
            && let Ok(other) = self.accepted(&target, scaffolded, hardware, &law)
        {
            let value = |planned: &Planned| planned.plan.estimate.of(search.objective);
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
        if self.cells.len() <= MAX_COMPARED && self.repair == Repair::default() {
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
                let is_better = estimate.of(objective) < best.plan.estimate.of(objective);
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
        let target = self.target(hardware).map_err(Unplanned::Refused)?;
        let law = RateLaw::for_scene(&scene, rates);
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

    fn target(&self, hardware: Hardware) -> Result<Target, TargetError> {
        let plate = self.plate.clone().unwrap_or_else(|| self.smallest_plate());
        let Repair { existing, released } = self.repair.clone();
        let (cells, seeds) = (self.cells.clone(), self.seeds.clone());
        Target::with_existing(cells, (existing, released), plate, seeds, hardware.free)
    }

    /// Calls `written` with a plan and the names of its program.
    fn write<T>(
        &self,
        plan: &BuildPlan,
        allowed: &[(&str, String)],
        written: impl FnOnce(&BuildPlan, Naming<'_>) -> T,
    ) -> T {
        let are_kept = plan.dismantling.as_ref().is_some_and(|it| it.are_kept);
        let with_scaffolds = format!("{}_with_scaffolds", self.name);
        // If scaffolds remain, the program claims the shape together with them.
        let (name, shape) = if are_kept {
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
    fn text(&self, target: &Target, plan: &BuildPlan, allowed: &[(&str, String)]) -> String {
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

    /// Checks the program of a plan.
    fn check(&self, target: &Target, plan: &BuildPlan, allowed: &[(&str, String)]) -> Checked {
        let draft = self.write(plan, allowed, |plan, naming| draft(target, plan, naming));
        check_text(NAME, &draft)
    }

    /// Returns the program of a plan, with the warnings that it must allow. Replaces the estimate
    /// by that of the whole program.
    ///
    /// # Errors
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

    /// Returns the program of a plan with other allowed warnings. See [`Goal::accepted`].
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
    fn planned(&self, plan: BuildPlan, text: String) -> Planned {
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

    /// Returns the name of the assembly.
    fn assembly(&self) -> String {
        match &self.assembly {
            Some(name) => name.clone(),
            None => format!("build_{}", self.name),
        }
    }
}

/// Sets the estimate and the waiting times of a plan to those of `check --cost`. Keeps the
/// planner's values if the check has none.
fn price(plan: &mut BuildPlan, checked: &Checked, law: &RateLaw<'_>) {
    let program = checked.programs.first();
    let cost = program.and_then(|program| program.estimate(law.rates()));
    let total = cost.as_ref().and_then(|cost| cost.total);
    let lower_bound = cost.as_ref().map(|cost| cost.lower_bound);
    plan.estimate = PlanEstimate {
        lower_bound: lower_bound.unwrap_or_default(),
        ..estimate(total, law, plan.estimate)
    };
    let (Some(program), Some(cost)) = (program, cost) else {
        return;
    };
    // A handed-over block is captured twice. This takes the first capture.
    let mut waits: HashMap<Cell, (EventId, f64)> = HashMap::new();
    for capture in &cost.captures {
        if let Some(cell) = program.layout.cells[capture.event.0 as usize] {
            let known = waits.entry(cell).or_insert((capture.event, capture.wait));
            if capture.event < known.0 {
                *known = (capture.event, capture.wait);
            }
        }
    }
    for capture in plan.all_captures_mut() {
        if let Some((_, wait)) = waits.get(&capture.cell) {
            capture.wait = *wait;
        }
    }
}

/// Returns the estimate from the times of the check. Uses the estimate `found` by the planner if
/// the times are unknown.
fn estimate(times: Option<Times>, law: &RateLaw<'_>, found: PlanEstimate) -> PlanEstimate {
    let rates = law.rates();
    let known = times.and_then(|times| Some((times.mean?, times.p90?)));
    let (mean, p90) = known.unwrap_or((found.mean, found.p90));
    PlanEstimate {
        mean,
        p90,
        is_typical: rates.is_none(),
        is_first_guess: rates.is_some_and(Rates::is_guess),
        lower_bound: found.lower_bound,
    }
}

fn printed(item: &Item, symbols: &Symbols) -> String {
    let items = vec![item.clone()];
    print(&Tree { items }, symbols)
}

/// Returns the name of a program's scene. Returns `None` for the default scene.
fn scene_of(program: &Program) -> Option<String> {
    let name = program.scene.as_ref().map(|scene| scene.name.clone());
    name.filter(|name| name != DEFAULT)
}

/// Returns the positions of the plate's named blocks. Returns `None` if none has a name.
fn seats(plan: &ProgramPlan) -> Option<Vec<(i32, i32)>> {
    let place = |seed: &PlanSeed| (seed.cell.x, seed.cell.y);
    (!plan.seeds.is_empty()).then(|| plan.seeds.iter().map(place).collect())
}
