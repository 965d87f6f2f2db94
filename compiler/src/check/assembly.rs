//! The stages of the check of one assembly, in order.
use rustc_hash::FxHashSet;
use stochc_estimate::Rates;
use stochc_grammar::tree::Assembly;
use stochc_grammar::{Cancellation, Cancelled, Symbol, Symbols};
use stochc_ir::JamRisk;
use stochc_ir::scene::warnings::{SceneWarning, Stepping};
use stochc_ir::scene::{BondKind, Planar, Scene};
use stochc_ir::table::Tables;

use crate::blocks::liveness::Liveness;
use crate::blocks::{bond_loads, capacity, liveness, unplanned_bonds};
use crate::check::checked::Program;
use crate::dependencies::graph::DependencyGraph;
use crate::dependencies::order::Order;
use crate::dependencies::{face_turns, graph, order};
use crate::diagnostic::{Code, Diagnostic};
use crate::emit::lower;
use crate::expand::{Declarations, ExpansionSettings, Shapes, expand};
use crate::expanded::ExpandedProgram;
use crate::scene::scene_check;
use crate::shapes::layout::Layout;
use crate::shapes::{layout, shape};
use crate::{FileId, SourceLocation, Sources, reach};

/// A stage of a check. The variants are in the order of the stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Reads and parses files.
    Parse,
    /// Expands patterns and loops.
    Expand,
    /// Checks names, phase by phase.
    Names,
    /// Computes the cells of blocks.
    Layout,
    /// Builds the dependency graph.
    Graph,
    /// Finds cycles and critical paths.
    Order,
    /// Checks access paths.
    Reach,
    /// Compares shapes and numbers of blocks.
    Compare,
    /// Writes the event tables.
    Lower,
}

/// An expanded program whose blocks have cells and whose events are ordered.
struct OrderedProgram {
    plan: ExpandedProgram,
    liveness: Liveness,
    layout: Layout,
    graph: DependencyGraph,
    order: Option<Order>,
}

impl OrderedProgram {
    fn lower(
        &self,
        scene: &Scene,
        symbols: &Symbols,
        cancellation: Cancellation<'_>,
    ) -> Result<Tables, Cancelled> {
        let OrderedProgram {
            plan,
            liveness,
            layout,
            graph,
            ..
        } = self;
        lower::lower(plan, liveness, layout, graph, scene, symbols, cancellation)
    }

    /// Returns the program without tables.
    fn into_program(self, scene: Option<Scene>) -> Program {
        Program {
            plan: self.plan,
            scene,
            layout: self.layout,
            graph: self.graph,
            order: self.order,
            tables: None,
            stuck: None,
            scene_warnings: Vec::new(),
            bond_loads: Vec::new(),
            claims: Vec::new(),
            jam_risks: Vec::new(),
        }
    }
}

#[derive(Default)]
struct StageDiagnostics {
    /// Diagnostics of the first stages: expansion and check of names.
    early: Vec<Diagnostic>,
    /// Diagnostics of the stages after the check of names.
    later: Vec<Diagnostic>,
    /// Whether the expansion is incomplete. Then errors of later stages may be wrong.
    cut_short: bool,
}

pub(super) struct AssemblyInput<'a> {
    pub declarations: &'a Declarations<'a>,
    pub file: FileId,
    pub assembly: &'a Assembly,
    pub sources: &'a Sources,
    pub settings: ExpansionSettings<'a>,
    /// Whether all files could be read. If not, names may be missing for that reason.
    pub readable: bool,
    /// Function that checks the files with a change, to try a remedy. `None` inside a trial.
    pub trial: Option<&'a reach::Trial<'a>>,
    /// Model and time steps for the check of scenes. `None` if runs have no physics.
    pub stepping: Option<Stepping>,
    pub scene_location: SourceLocation,
    /// Words in those parts of the files that the parser could not read.
    pub uncertain: &'a FxHashSet<Symbol>,
}

impl<'a> AssemblyInput<'a> {
    pub(super) fn compile(
        &self,
        scene: Option<Scene>,
        symbols: &mut Symbols,
        diagnostics: &mut Vec<Diagnostic>,
        done: &mut dyn FnMut(Stage),
    ) -> Result<Program, Cancelled> {
        let cancellation = self.settings.cancellation;
        let mut found = StageDiagnostics::default();
        let (subject, shapes) = self.order(scene.as_ref(), symbols, &mut found, done)?;
        let StageDiagnostics {
            early: mut errors,
            mut later,
            cut_short,
        } = found;
        self.retain_certain(&mut errors, symbols);
        let is_valid = !has_error(&errors) && !has_error(&later);
        // Warnings about an incomplete program may be wrong.
        let is_whole =
            is_valid && self.readable && subject.plan.events.iter().all(|event| event.valid);
        let whole = subject.order.as_ref().filter(|_| is_whole);
        let certain = whole.filter(|order| !order.unneeded.is_empty());
        let certain = certain.map(|order| face_turns::certain(&subject.graph, &order.events));
        let whole = whole.map(|order| (order, certain.as_ref().unwrap_or(&subject.graph)));
        let scene_of = scene.as_ref();
        if let Some(order) = whole {
            self.check_access(&subject, order, scene_of, symbols, &mut later)?;
        }
        done(Stage::Reach);
        if let (Some((order, _)), true) = (whole, is_passive(scene_of)) {
            let OrderedProgram { plan, layout, .. } = &subject;
            unplanned_bonds::check(plan, layout, order, symbols, cancellation, &mut later)?;
        }
        let (mut scene_warnings, mut bond_loads) = (Vec::new(), Vec::new());
        if let (Some((order, _)), Some(scene)) = (whole, scene_of) {
            let OrderedProgram { plan, layout, .. } = &subject;
            bond_loads = bond_loads::largest(plan, layout, order, scene, cancellation)?;
            bond_loads::check(plan, scene, &bond_loads, symbols, &mut later);
        }
        if is_valid {
            scene_warnings =
                self.compare(&subject, &shapes, whole, scene_of, symbols, &mut later)?;
        }
        let jam_risks = jam_risks(&later);
        // The missing blocks may use these seeds.
        if (later.iter()).any(|diagnostic| diagnostic.code == Code::ShapeMismatch) {
            errors.retain(|diagnostic| {
                !matches!(diagnostic.code, Code::UnusedSeed | Code::EmptyPhase)
            });
        }
        done(Stage::Compare);
        if self.readable && !cut_short {
            errors.append(&mut later);
        }
        let mistakes = || {
            let all = errors.iter().chain(diagnostics.iter());
            all.filter(|diagnostic| diagnostic.is_error())
        };
        let is_right = mistakes().next().is_none();
        let is_stuck = mistakes()
            .all(|diagnostic| matches!(diagnostic.code, Code::Cycle | Code::SealedCavity));
        let mut tables = (scene_of.filter(|_| self.readable && is_stuck))
            .map(|scene| subject.lower(scene, symbols, cancellation))
            .transpose()?;
        let stuck = if is_right { None } else { tables.take() };
        done(Stage::Lower);
        diagnostics.append(&mut errors);
        Ok(Program {
            tables,
            stuck,
            scene_warnings,
            bond_loads,
            jam_risks,
            ..subject.into_program(scene)
        })
    }

    /// Runs the stages from the expansion to the order. Also returns the declared shapes.
    fn order(
        &self,
        scene: Option<&Scene>,
        symbols: &mut Symbols,
        found: &mut StageDiagnostics,
        done: &mut dyn FnMut(Stage),
    ) -> Result<(OrderedProgram, Shapes<'a>), Cancelled> {
        let (sources, cancellation) = (self.sources, self.settings.cancellation);
        let assembly = (self.file, self.assembly);
        let errors = &mut found.early;
        let settings = self.settings;
        let (mut plan, shapes) = expand(
            self.declarations,
            assembly,
            sources,
            symbols,
            settings,
            errors,
        )?;
        if scene.is_some_and(|scene| scene.planar.is_some()) {
            plan.seeds
                .iter_mut()
                .for_each(|seed| seed.cell.z = Planar::LAYER);
        }
        done(Stage::Expand);
        found.cut_short = errors.iter().any(|diagnostic| {
            matches!(
                diagnostic.code,
                Code::ExpansionLimit | Code::RecursivePattern | Code::TooDeep | Code::TooManyErrors
            )
        });
        if found.cut_short {
            plan.clear();
        }
        let mut names = Vec::new();
        let liveness = liveness::check(
            &mut plan,
            sources,
            symbols,
            self.uncertain,
            is_passive(scene),
            cancellation,
            &mut names,
        )?;
        if !found.cut_short {
            errors.append(&mut names);
        }
        if let Some(scene) = scene {
            reject_long_delays(&plan, scene, errors);
        }
        done(Stage::Names);
        let later = &mut found.later;
        let layout = layout::lay_out(
            &mut plan,
            &liveness,
            planar(scene),
            symbols,
            sources,
            cancellation,
            later,
        )?;
        done(Stage::Layout);
        let faces = scene.map_or(1, |scene| {
            BondKind::from_scene(scene).faces(scene.block.faces)
        });
        let graph = graph::build(&plan, &liveness, &layout, faces, cancellation)?;
        done(Stage::Graph);
        let order = order::sort(&plan, &graph, symbols, sources, cancellation, later)?;
        done(Stage::Order);
        let subject = OrderedProgram {
            plan,
            liveness,
            layout,
            graph,
            order,
        };
        Ok((subject, shapes))
    }

    /// Removes diagnostics that unreadable or wrong statements may have caused.
    fn retain_certain(&self, errors: &mut Vec<Diagnostic>, symbols: &Symbols) {
        // Missing statements may use seeds, waits and phases that seem to be unused.
        if !self.readable || has_error(errors) {
            errors.retain(Diagnostic::is_error);
        }
        let plate = symbols.get("plate");
        if plate.is_some_and(|word| self.uncertain.contains(&word)) {
            errors.retain(|diagnostic| diagnostic.code != Code::MissingPlate);
        }
    }

    /// Checks the access paths of a program without errors.
    fn check_access(
        &self,
        program: &OrderedProgram,
        (order, certain): (&Order, &DependencyGraph),
        scene: Option<&Scene>,
        symbols: &Symbols,
        later: &mut Vec<Diagnostic>,
    ) -> Result<(), Cancelled> {
        let plane = scene.and_then(|it| reach::Plane::new(it, &program.plan, &program.layout));
        let subject = reach::ValidProgram {
            plan: &program.plan,
            liveness: &program.liveness,
            layout: &program.layout,
            graph: &program.graph,
            certain,
            order,
            assembly: self.assembly,
            patterns: &self.declarations.declared.patterns,
            file: self.file,
            trial: self.trial,
            plane,
            has_passable_gaps: scene.is_some_and(Rates::pass_gaps) && plane.is_none(),
            sources: self.sources,
            symbols,
            cancellation: self.settings.cancellation,
        };
        reach::check(subject, self.settings.limits.search, later)
    }

    /// Compares the program with its shapes and its scene. Returns the warnings of the scene.
    fn compare(
        &self,
        program: &OrderedProgram,
        shapes: &Shapes<'_>,
        order: Option<(&Order, &DependencyGraph)>,
        scene: Option<&Scene>,
        symbols: &Symbols,
        later: &mut Vec<Diagnostic>,
    ) -> Result<Vec<SceneWarning>, Cancelled> {
        let OrderedProgram { plan, layout, .. } = program;
        let cancellation = self.settings.cancellation;
        let names = self.declarations.names;
        shape::check(plan, layout, shapes, names, symbols, cancellation, later)?;
        let Some(scene) = scene else {
            return Ok(Vec::new());
        };
        capacity::check(plan, layout, order, scene, cancellation, later)?;
        capacity::check_room(plan, scene, later);
        // A scene with missing terms is not judged.
        let Some(stepping) = self.stepping.filter(|_| !has_error(later)) else {
            return Ok(Vec::new());
        };
        let layers = scene_check::layers(plan, layout);
        let location = self.scene_location;
        Ok(scene_check::check(scene, layers, stepping, location, later))
    }
}

fn has_error(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(Diagnostic::is_error)
}

fn is_passive(scene: Option<&Scene>) -> bool {
    scene.is_some_and(|scene| BondKind::from_scene(scene).is_passive())
}

/// Returns the name of a scene with a planar world.
fn planar(scene: Option<&Scene>) -> Option<&str> {
    let planar = scene.filter(|scene| scene.planar.is_some())?;
    Some(&planar.name)
}

/// Checks an aggregate. Most stages do not apply.
pub(super) fn compile_aggregate(
    mut plan: ExpandedProgram,
    scene: Option<Scene>,
    wrong: bool,
    symbols: &Symbols,
    sources: &Sources,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Program, Cancelled> {
    if let Some(scene) = &scene {
        capacity::check_aggregate(&plan, scene, diagnostics);
        capacity::check_room(&plan, scene, diagnostics);
    }
    let uncertain = Default::default();
    // Aggregates have no events and no seeds.
    let never = Cancellation::NEVER;
    let liveness = liveness::check(
        &mut plan,
        sources,
        symbols,
        &uncertain,
        false,
        never,
        diagnostics,
    )?;
    let layout = layout::lay_out(
        &mut plan,
        &liveness,
        planar(scene.as_ref()),
        symbols,
        sources,
        never,
        diagnostics,
    )?;
    let graph = graph::build(&plan, &liveness, &layout, 1, never)?;
    let order = order::sort(&plan, &graph, symbols, sources, never, diagnostics)?;
    let is_right = !wrong && !has_error(diagnostics);
    let subject = OrderedProgram {
        plan,
        liveness,
        layout,
        graph,
        order,
    };
    let tables = (scene.as_ref().filter(|_| is_right))
        .map(|scene| subject.lower(scene, symbols, never))
        .transpose()?;
    Ok(Program {
        tables,
        ..subject.into_program(scene)
    })
}

/// Returns the reasons why blocks may jam. Allowed warnings count too.
fn jam_risks(diagnostics: &[Diagnostic]) -> Vec<JamRisk> {
    let of_code = |diagnostic: &Diagnostic| match diagnostic.code {
        Code::TightApproach => Some(JamRisk::TightApproach),
        Code::CrowdedCaptures => Some(JamRisk::CrowdedCaptures),
        _ => None,
    };
    let mut risks: Vec<JamRisk> = diagnostics.iter().filter_map(of_code).collect();
    risks.sort_unstable();
    risks.dedup();
    risks
}

/// Reports delays of releases that do not fit into event tables.
fn reject_long_delays(plan: &ExpandedProgram, scene: &Scene, diagnostics: &mut Vec<Diagnostic>) {
    let mut reported = None;
    for delay in &plan.delays {
        let ticks = delay.time.ticks(scene.tick);
        let is_new = reported.replace(delay.location) != Some(delay.location);
        if u32::try_from(ticks).is_err() && is_new {
            let diagnostic =
                Diagnostic::new(Code::WrongValue, "the delay of a release is too long")
                    .label(delay.location, format!("{ticks} ticks"))
                    .help(format!("write at most {} ticks", u32::MAX));
            diagnostics.push(diagnostic);
        }
    }
}
