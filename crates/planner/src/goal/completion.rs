//! A program that is written in part: a phase claims a shape that does not stand yet, and what is missing is planned.
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::plan::build_plan::plan;
use crate::{ExistingBlock, Hardware, PlanSearch, RateLaw, Target, TargetError, continuation};
use stochc_compiler::diagnostic::Code;
use stochc_compiler::placed_blocks::placed_blocks;
use stochc_compiler::plan::EventKind;
use stochc_compiler::{
    Checked, DeclaredShapes, FileId, LintLevels, Program, SourceLocation, shape_cells,
};
use stochc_estimate::Rates;
use stochc_grammar::tree::{Item, ItemKind, Name};
use stochc_grammar::{format, is_comment};
use stochc_ir::Cell;
use stochc_ir::scene::Scene;
use stochc_ir::table::RoleId;

use super::{Planned, Unplanned, estimate};
use stochc_compiler::check_texts;

/// What is missing in a program.
#[derive(Debug)]
pub struct Completion {
    /// The texts of the program and of what it imports, with their names, its own first.
    texts: Vec<(String, String)>,
    target: Target,
    hardware: Hardware,
    scene: Scene,
    /// What the program calls the blocks that can capture.
    names: BTreeMap<Cell, String>,
    /// What no block of it is called.
    word: String,
    /// Claims that are not true, this one included.
    untrue: usize,
    /// The program that is completed, and the number of the phase in which it is, once that is written.
    assembly: String,
    phase: usize,
    change: Change,
}

/// Where what is planned is written.
#[derive(Debug)]
struct Change {
    /// What of the text goes.
    removed: Range<usize>,
    /// Where the rest is written, as the text is.
    at: usize,
    /// What stands around it.
    around: [String; 2],
}

/// Why a program cannot be completed.
#[derive(Debug)]
pub enum NotCompleted {
    /// It is wrong in other ways.
    Wrong,
    /// Nothing is missing, or it cannot be written down there, in words.
    Refused(String),
    /// What is missing cannot be built.
    Impossible(TargetError),
}

/// A claim of a phase that is not true.
struct Claim<'a> {
    program: &'a Program,
    phase: usize,
    name: &'a str,
    location: SourceLocation,
    /// What it claims.
    cells: Vec<Cell>,
    /// What stands there instead.
    there: Vec<(ExistingBlock, RoleId)>,
}

impl Claim<'_> {
    /// Returns whether nothing happens in its phase, so that the rest is written there, and not in
    /// a phase behind.
    fn fills_phase(&self) -> bool {
        self.program.plan.phases[self.phase].events.is_empty()
    }
}

impl Completion {
    /// Of the first phase that claims a shape, or the one of this name, and does not build it.
    ///
    /// # Errors
    /// If there is none, or it cannot be completed there.
    pub fn new(checked: &Checked, shape: Option<&str>) -> Result<Completion, NotCompleted> {
        let untrue = untrue_claims(checked).ok_or(NotCompleted::Wrong)?;
        let claim = unbuilt(checked, shape)?;
        let (program, symbols) = (claim.program, &checked.symbols);
        let mut there = claim.there.clone();
        // What has no name that can be written captures nothing.
        let mut nameless = None;
        for (block, role) in &mut there {
            if let Some(pattern) = program.plan.roles.nameless(*role, symbols) {
                block.can_capture = false;
                nameless = Some(pattern);
            }
        }
        let wanted: BTreeSet<Cell> = claim.cells.iter().copied().collect();
        let surplus = there
            .iter()
            .find(|(block, _)| !wanted.contains(&block.cell));
        if let Some((block, role)) = surplus {
            let role = program.plan.roles.name(*role, symbols);
            return Err(NotCompleted::Refused(format!(
                "`{}` has no block at {}, where `{role}` stands: release it in this phase or before",
                claim.name, block.cell
            )));
        }
        let Some(scene) = program.scene.clone() else {
            return Err(NotCompleted::Wrong);
        };
        let seeds = &program.plan.seeds;
        let mut names: BTreeMap<Cell, String> = BTreeMap::new();
        let called = there.iter().map(|(block, role)| (block.cell, *role));
        for (cell, role) in called.chain(seeds.iter().map(|seed| (seed.cell, seed.role))) {
            names.insert(cell, program.plan.roles.name(role, symbols));
        }
        let hardware = Hardware::from_scene(&scene);
        let target = Target::with_existing(
            claim.cells.clone(),
            (
                there.into_iter().map(|(block, _)| block).collect(),
                Vec::new(),
            ),
            program.plan.plate.clone(),
            Some(
                seeds
                    .iter()
                    .map(|seed| (seed.cell.x, seed.cell.y))
                    .collect(),
            ),
            hardware.free,
        );
        let mut target = target.map_err(|error| match (&error, nameless) {
            (TargetError::Loose(_), Some(pattern)) => NotCompleted::Refused(format!(
                "what stands has no name by which it could hold the rest: name the instances of `{pattern}`, such as `{pattern}(A) as a`"
            )),
            _ => NotCompleted::Impossible(error),
        })?;
        let phases = &program.plan.phases;
        let phase = claim.phase + usize::from(!claim.fills_phase());
        if phases[..phase]
            .iter()
            .any(|it| !it.planted && !it.events.is_empty())
        {
            target = target.behind_others();
        }
        let is_new = |word: &String| symbols.get(word).is_none();
        let new = |plain: &str| {
            let others = (2..).map(|number| format!("{plain}{number}"));
            let mut words = std::iter::once(plain.to_owned()).chain(others);
            words.find(is_new).expect("the words of a text are finite")
        };
        let files = checked.sources.files().iter();
        Ok(Completion {
            change: change(checked, &claim, &new("rest"))?,
            texts: files
                .map(|file| (file.name.clone(), file.text.to_string()))
                .collect(),
            word: new("B"),
            untrue,
            assembly: program.plan.name.clone(),
            phase,
            target,
            hardware,
            scene,
            names,
        })
    }

    /// How many blocks are missing.
    pub fn missing(&self) -> usize {
        self.target.cells().len() - self.target.existing().len()
    }

    /// Returns the scene that it is built in.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Plans what is missing, and writes it into the program.
    ///
    /// # Errors
    /// If it cannot be built, or the program is wrong with it in other ways than by other claims that are not true yet.
    pub fn plan(&self, rates: &[Rates], search: PlanSearch<'_>) -> Result<Planned, Unplanned> {
        let law = RateLaw::for_scene(&self.scene, rates);
        let found = plan(&self.target, self.hardware, &law, search).map_err(Unplanned::Refused)?;
        let mut plan = found.plain;
        let name = |cell: Cell| self.names.get(&cell).cloned();
        let rest = continuation(&plan, &self.word, name);
        let (_, text) = &self.texts[0];
        let Change {
            removed,
            at,
            around: [before, after],
        } = &self.change;
        let (kept, gone) = (&text[..removed.start], &text[removed.end..]);
        let rest = format!("{before}{rest}{after}");
        let whole = if *at >= removed.end {
            let (between, end) = gone.split_at(at - removed.end);
            format!("{kept}{between}{rest}{end}")
        } else {
            format!("{kept}{rest}{gone}")
        };
        let text = format(&whole).unwrap_or(whole);
        let others = self.texts[1..].iter();
        // The diagnostics are about a text that the user does not have.
        let name = format!("{} (completed)", self.texts[0].0);
        let texts: Vec<(&str, &str)> = std::iter::once((name.as_str(), text.as_str()))
            .chain(others.map(|(name, text)| (name.as_str(), text.as_str())))
            .collect();
        let checked = check_texts(&texts, &LintLevels::default(), "", &[]);
        let untrue = untrue_claims(&checked).filter(|untrue| *untrue < self.untrue);
        let Some(untrue) = untrue else {
            return Err(Unplanned::Wrong(Box::new(checked)));
        };
        let mut programs = checked.programs.iter();
        let program = programs.find(|it| it.plan.name == self.assembly);
        let cost = program.and_then(|program| program.estimate(law.rates()));
        let times = cost.and_then(|cost| cost.phases.get(self.phase)?.times);
        plan.estimate = estimate(times, &law, plan.estimate);
        Ok(Planned {
            plan,
            text,
            name,
            assembly: self.assembly.clone(),
            scene: self.scene.name.clone(),
            imported: self.texts[1..].to_vec(),
            untrue,
        })
    }
}

/// How many claims are not true. `None` means something else is wrong.
pub fn untrue_claims(checked: &Checked) -> Option<usize> {
    let mut errors = checked.diagnostics.iter().filter(|it| it.is_error());
    errors.try_fold(0, |count, it| {
        (it.code == Code::ShapeMismatch).then_some(count + 1)
    })
}

/// Returns the first claim that is not true.
fn unbuilt<'a>(checked: &'a Checked, shape: Option<&str>) -> Result<Claim<'a>, NotCompleted> {
    let shapes = DeclaredShapes::new(checked);
    let mut is_claimed = false;
    for program in &checked.programs {
        for (number, phase) in program.plan.phases.iter().enumerate() {
            for &(symbol, location) in &phase.claims {
                let name = checked.symbols.word(symbol);
                let known = shapes.seen_from(&program.plan, name);
                let Some(declared) = known.filter(|_| shape.is_none_or(|shape| shape == name))
                else {
                    continue;
                };
                is_claimed = true;
                let cells = shape_cells(declared.shape, declared.file, &mut Vec::new());
                let mut cells = cells.ok_or(NotCompleted::Wrong)?;
                cells.sort_unstable();
                cells.dedup();
                let there = existing(program, number);
                if !there
                    .iter()
                    .map(|(block, _)| block.cell)
                    .eq(cells.iter().copied())
                {
                    return Ok(Claim {
                        program,
                        phase: number,
                        name,
                        location,
                        cells,
                        there,
                    });
                }
            }
        }
    }
    let shape = shape.map_or("a shape".to_owned(), |shape| format!("`{shape}`"));
    Err(NotCompleted::Refused(if is_claimed {
        format!("every phase that claims {shape} builds it")
    } else {
        format!("no phase claims {shape}: say what is to stand, `phase rest {{ yields NAME }}`")
    }))
}

/// What stands at the end of a phase, sorted by cell, with what it is called.
pub(super) fn existing(program: &Program, last: usize) -> Vec<(ExistingBlock, RoleId)> {
    let (plan, layout) = (&program.plan, &program.layout);
    // What hung on a block that goes later would be adrift.
    let later = plan.phases[last + 1..].iter();
    let released_later: BTreeSet<RoleId> = later
        .flat_map(|phase| plan.events_of(phase))
        .map(|id| plan.event(id))
        .filter(|event| event.kind == EventKind::Release)
        .map(|event| event.role)
        .collect();
    let placed = placed_blocks(plan, layout).nth(last).unwrap_or_default();
    let blocks = placed.into_iter().filter_map(|placed| {
        let block = ExistingBlock {
            cell: placed.cell,
            way: layout.parents[placed.capture.0 as usize]?.face,
            can_capture: !released_later.contains(&placed.role),
        };
        Some((block, placed.role))
    });
    blocks.collect()
}

/// Where the rest is written: before the claim of a phase in which nothing happens, and otherwise in a phase behind, which takes the claim.
fn change(checked: &Checked, claim: &Claim<'_>, new: &str) -> Result<Change, NotCompleted> {
    let elsewhere = || {
        NotCompleted::Refused(format!(
            "the phase that claims `{}` is imported or stands in a loop: only a phase of the assembly itself can be completed",
            claim.name
        ))
    };
    if claim.location.file != FileId(0) {
        return Err(elsewhere());
    }
    // Spans in trees are all equal; locations are not.
    let is_claim = |name: &Name| {
        let file = FileId(0);
        let span = name.span;
        SourceLocation { file, span } == claim.location
    };
    let claims = |item: &&Item| matches!(&item.kind, ItemKind::Yields(name) if is_claim(name));
    let bodies = checked
        .tree
        .items
        .iter()
        .filter_map(|item| match &item.kind {
            ItemKind::Assembly(assembly) => Some(&assembly.body),
            _ => None,
        });
    let found = bodies.flatten().find_map(|item| match &item.kind {
        ItemKind::Phase(phase) => Some((item, phase.body.iter().find(claims)?)),
        _ => None,
    });
    let (phase, yields) = found.ok_or_else(elsewhere)?;
    let text = &checked.sources.file(FileId(0)).text;
    let written = yields.span.start as usize..yields.span.end as usize;
    let docs = yields.docs.0.iter().flat_map(|lines| lines.iter());
    let start = with_docs(text, written.start, docs.count());
    Ok(if claim.fills_phase() {
        Change {
            removed: start..start,
            at: start,
            around: [String::new(), String::new()],
        }
    } else {
        Change {
            removed: start..written.end,
            at: behind(text, phase.span.end as usize),
            around: [
                format!("\nphase {new} {{\n"),
                format!("{}yields {}\n}}\n", &text[start..written.start], claim.name),
            ],
        }
    })
}

/// Where the comment begins, of so many lines, that belongs to a statement.
fn with_docs(text: &str, statement: usize, mut lines: usize) -> usize {
    let (mut start, mut at) = (statement, statement);
    for line in text[..statement].split_inclusive('\n').rev() {
        at -= line.len();
        if lines == 0 {
            break;
        }
        if let Some(doc) = comment(line).filter(|&doc| is_doc(&line[doc..])) {
            (start, lines) = (at + doc, lines - 1);
        }
    }
    start
}

/// Returns the place behind one, or behind the comment with which its line ends.
fn behind(text: &str, at: usize) -> usize {
    let line = text[at..].split('\n').next().unwrap_or_default();
    // A comment with three strokes belongs to what comes behind it.
    if is_comment(line.trim_start().as_bytes()) {
        at + line.len()
    } else {
        at
    }
}

/// Where in a line a comment begins.
fn comment(line: &str) -> Option<usize> {
    let mut is_quoted = false;
    line.char_indices().find_map(|(at, sign)| {
        is_quoted ^= sign == '"';
        (!is_quoted && line[at..].starts_with("//")).then_some(at)
    })
}

/// Returns whether a comment is one that belongs to a statement.
fn is_doc(comment: &str) -> bool {
    comment.starts_with("///") && !is_comment(comment.as_bytes())
}
