//! From a shape of a program, or from cells, to a program that builds it and has been checked.
mod completion;
mod larger_scene;
mod loose_parts;
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
pub use repair::{ExistingStructure, Repair};
use scenes::WrittenScenes;
use stochc_compiler::check_text;

/// What is to be built, on what, and where.
#[derive(Clone, Debug)]
pub struct Goal {
    /// What the shape is called.
    pub name: String,
    /// Its cells.
    pub cells: Vec<Cell>,
    /// The plate. `None` means the smallest one under all cells of the lowest layer.
    pub plate: Option<Plate>,
    /// The blocks of the plate that may capture, as (x, y). `None` means all.
    pub seeds: Option<Vec<(i32, i32)>>,
    /// The scene. `None` means the one of an assembly that names none.
    pub scene: Option<String>,
    /// The name of the assembly. By default it is called after the shape.
    pub assembly: Option<String>,
    /// Declares the shape.
    shape: Option<String>,
    /// The scenes that are declared where the shape comes from.
    scenes: WrittenScenes,
    /// What stands before, and what of it is let go.
    repair: Repair,
    /// The scene, once it has been compiled, by its name.
    compiled: OnceLock<(Option<String>, Scene)>,
}

/// A program that builds a shape.
#[derive(Debug)]
pub struct Planned {
    /// The order of its captures.
    pub plan: BuildPlan,
    /// The program.
    pub text: String,
    /// Name of the text in diagnostics. Imports are relative to it.
    pub name: String,
    /// The assembly that builds the shape.
    pub assembly: String,
    /// The name of the scene that it runs in.
    pub scene: String,
    /// The texts that the program imports, with their names.
    pub imported: Vec<(String, String)>,
    /// How many claims of it are still untrue.
    pub untrue: usize,
}

/// Why there is none.
#[derive(Debug)]
pub enum Unplanned {
    /// The shape cannot be built.
    Refused(TargetError),
    /// The names, the scene or the room that it has are wrong, as these diagnostics say.
    Wrong(Box<Checked>),
}

/// Name of programs in diagnostics.
const NAME: &str = "planned.sa";

/// Cells of a shape for which plans that need no thought are looked at as well, at most.
const MAX_COMPARED: usize = 1000;

/// With as many diagnostics, others may have been left out.
const MANY: usize = 100;

/// Returns whether a warning is about the scene, which a plan does not change.
fn is_of_scene(code: Code) -> bool {
    code == Code::TooManyBlocks || code.is_of_runs()
}

/// What a planned program allows itself, and why: the only warnings that it may have.
fn allowance(code: Code, hardware: Hardware) -> Option<(&'static str, String)> {
    let reason = match code {
        Code::TightApproach => {
            "no order was found in which every block has a way in two cells wide"
        }
        Code::ReachUndecided => "the planner has found a way in for every block",
        code if is_of_scene(code) => "the scene is as it was given",
        Code::UnplannedBond if hardware.attracts_always => {
            "where every face attracts, none can be kept from it"
        }
        Code::CrowdedCaptures if hardware.attracts_always => {
            "where every face attracts, none can be kept closed"
        }
        Code::BlockedRelease if hardware.attracts_always => {
            "no order was looked for in which it has a way out"
        }
        _ => return None,
    };
    Some((code.name(), reason.to_owned()))
}

/// Returns the lint that a plan which won a race allows itself, with the reason.
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
    /// Cells under a name, which has to be one of the language.
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

    /// Returns a shape of a program without errors, with the plate, the seeds and the scene of the
    /// assembly that claims it, or of the only one there is. Without a name, the only shape that
    /// there is, or the last one claimed.
    ///
    /// # Errors
    /// If it has no such shape, in words.
    pub fn of_program(checked: &Checked, name: Option<&str>) -> Result<Goal, String> {
        let symbols = &checked.symbols;
        let claims = |plan: &ProgramPlan| -> Vec<&str> {
            let claims = plan.phases.iter().flat_map(|phase| &phase.claims);
            let names = claims.map(|&(name, _)| symbols.word(name));
            // The words live as long as the file.
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
            (None, []) => return Err("it declares no shape".to_owned()),
            (None, [only]) => (*only, claiming(only)),
            (None, _) => {
                let (program, name) = last_claimed
                    .ok_or_else(|| format!("it declares {}: name one with `--shape`", listed()))?;
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
            0 => format!("it declares no shape `{wanted}`, nor any other"),
            _ => format!("it declares no shape `{wanted}`, but {}", listed()),
        })?;
        let only = || programs().next().filter(|_| programs().count() == 1);
        Goal::of_shape(checked, found, claiming.or_else(only))
    }

    /// Returns a shape, with the plate, the seeds and the scene of an assembly.
    fn of_shape(
        checked: &Checked,
        declared: &DeclaredShape<'_>,
        assembly: Option<&Program>,
    ) -> Result<Goal, String> {
        let DeclaredShape {
            file, item, shape, ..
        } = declared;
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        let cells = shape_cells(shape, *file, &mut diagnostics);
        let cells = cells.ok_or_else(|| match diagnostics.first() {
            Some(diagnostic) => match diagnostic.labels.first() {
                Some(label) => format!("{}: {}", diagnostic.message(), label.text),
                None => diagnostic.message(),
            },
            None => "the shape cannot be read as cells".to_owned(),
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

    /// The same shape so many cells further east and north. `None` means there are no such cells.
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

    /// Builds it in a scene of this name, which the text declares.
    pub fn declare_scene(&mut self, name: &str, text: &str) {
        self.scene = Some(name.to_owned());
        self.scenes = WrittenScenes::new(&check_text(NAME, text));
        self.compiled = OnceLock::new();
    }

    /// Builds it in a scene that another program declares.
    ///
    /// # Errors
    /// If that program has no scene of this name, or several and none is named: with their names.
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

    /// Returns the names of the scenes that are declared where the shape comes from.
    pub fn declared_scenes(&self) -> impl Iterator<Item = &str> {
        self.scenes.names()
    }

    /// Returns the scene it is built in.
    ///
    /// # Errors
    /// If there is none of that name, or it is wrong.
    pub fn scene(&self) -> Result<Scene, Box<Checked>> {
        match self.compiled.get() {
            Some((name, scene)) if *name == self.scene => Ok(scene.clone()),
            _ => {
                let scene = self.compile_scene()?;
                // Where another one has been compiled before, it is compiled each time.
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

    /// Returns whether a scene of this name is built in, or declared where the shape comes from.
    pub fn knows_scene(&self, name: &str) -> bool {
        is_built_in(name) || self.scenes.declare(name)
    }

    /// Returns the scenes that are declared and needed, as they are written.
    fn needed_scenes(&self) -> String {
        // A file may have a scene of its own by the name of the one that nobody has to name.
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

    /// Plans it, writes the program and checks it: the best by the rates of its scene, of those given or built in. A plan that needs no
    /// thought is as good, if the check finds nothing in it.
    ///
    /// # Errors
    /// If it cannot be built, or not there.
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
                // What the scene is warned of holds for all plans.
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

    /// Returns the plans that need no thought and may jam: `check` warns of nothing else in them, except of the scene.
    ///
    /// # Errors
    /// If the shape cannot be built, or the scene is wrong.
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

    /// Has a plan and what is allowed in it written down.
    fn write<T>(
        &self,
        plan: &BuildPlan,
        allowed: &[(&str, String)],
        written: impl FnOnce(&BuildPlan, Naming<'_>) -> T,
    ) -> T {
        let are_kept = plan.dismantling.as_ref().is_some_and(|it| it.are_kept);
        let with_scaffolds = format!("{}_with_scaffolds", self.name);
        // What stays is claimed.
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

    /// Returns the program of a plan, laid out.
    fn text(&self, target: &Target, plan: &BuildPlan, allowed: &[(&str, String)]) -> String {
        self.write(plan, allowed, |plan, naming| {
            // Names that are none are told of as any others are.
            program(target, plan, naming).unwrap_or_else(|_| {
                format!(
                    "{}\nassembly {} {{ }}",
                    naming.declarations, naming.assembly
                )
            })
        })
    }

    /// What the check finds in the program of a plan.
    fn check(&self, target: &Target, plan: &BuildPlan, allowed: &[(&str, String)]) -> Checked {
        let draft = self.write(plan, allowed, |plan, naming| draft(target, plan, naming));
        check_text(NAME, &draft)
    }

    /// Returns the program of a plan, with what has to be allowed in it; its estimate becomes that
    /// of the whole program.
    fn accepted(
        &self,
        target: &Target,
        plan: BuildPlan,
        hardware: Hardware,
        law: &RateLaw<'_>,
    ) -> Result<Planned, Unplanned> {
        self.accepted_with(target, plan, |code| allowance(code, hardware), law)
    }

    /// The same with other allowances.
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
        // With many diagnostics, others may have been left out.
        let is_accepted = allowed.len() == found_codes
            && (found.diagnostics.len() < MANY
                || self.check(target, &plan, &allowed).diagnostics.is_empty());
        if !is_accepted {
            // Told of the program as it would be shown.
            let found = check_text(NAME, &self.text(target, &plan, &allowed));
            return Err(Unplanned::Wrong(Box::new(found)));
        }
        price(&mut plan, &found, law);
        let text = self.text(target, &plan, &allowed);
        Ok(self.planned(plan, text))
    }

    /// Returns a plan and its program, which imports nothing.
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

    /// What the assembly is called that builds it.
    fn assembly(&self) -> String {
        match &self.assembly {
            Some(name) => name.clone(),
            None => format!("build_{}", self.name),
        }
    }
}

/// Has a plan say of its time and of its waits what `check --cost` says of its program; where that says nothing, what was found when it was
/// looked for.
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
    // Of what is captured twice, because it is handed over, the first time.
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

/// How long something takes by the rates of its scene; where nobody knows that, as was found when it was looked for.
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

/// Returns the name of a program's scene, if it has to be named.
fn scene_of(program: &Program) -> Option<String> {
    let name = program.scene.as_ref().map(|scene| scene.name.clone());
    name.filter(|name| name != DEFAULT)
}

/// Returns the places of the blocks of the plate that have a name, if any has.
fn seats(plan: &ProgramPlan) -> Option<Vec<(i32, i32)>> {
    let place = |seed: &PlanSeed| (seed.cell.x, seed.cell.y);
    (!plan.seeds.is_empty()).then(|| plan.seeds.iter().map(place).collect())
}
