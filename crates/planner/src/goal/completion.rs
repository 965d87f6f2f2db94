//! Completes a partial program: a phase claims a shape that the captures do not build yet, and the
//! missing captures are planned.
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use crate::plan::build_plan::plan;
use crate::{ExistingBlock, Hardware, PlanSearch, RateLaw, Target, TargetError, continuation};
use stochc_compiler::diagnostic::Code;
use stochc_compiler::expanded::EventKind;
use stochc_compiler::placed_blocks::placed_blocks;
use stochc_compiler::{
    Checked, DeclaredShapes, FileId, LintLevels, Program, SourceLocation, shape_cells,
};
use stochc_estimate::Rates;
use stochc_grammar::tree::{Item, ItemKind, Name};
use stochc_grammar::{PartKind, format, is_comment, parts};
use stochc_ir::Cell;
use stochc_ir::scene::Scene;
use stochc_ir::table::RoleId;

use super::price::estimate;
use super::{Planned, Unplanned};
use stochc_compiler::{Changes, check_texts};

/// A partial program with the shape to complete.
#[derive(Debug)]
pub struct Completion {
    /// Names and sources of all files: the program first, then its imports.
    texts: Vec<(String, String)>,
    target: Target,
    hardware: Hardware,
    scene: Scene,
    /// Names of the existing blocks that can capture, by cell.
    names: BTreeMap<Cell, String>,
    /// Word for new block names. The program does not use it.
    word: String,
    /// Number of false claims in the program, including the claim to complete.
    untrue: usize,
    assembly: String,
    /// Index of the phase with the new captures.
    phase: usize,
    change: Change,
}

/// Position of the new captures in the source.
#[derive(Debug)]
struct Change {
    /// Part of the source to remove.
    removed: Range<usize>,
    /// Position of the new text in the old source.
    at: usize,
    /// Text to insert before the new captures, and text to insert after them.
    around: [String; 2],
}

/// Reason why a program cannot be completed.
#[derive(Debug)]
pub enum NotCompleted {
    /// The program has other errors.
    Wrong,
    /// Nothing is missing, or the captures cannot be added there. The text is the message.
    Refused(String),
    /// The missing part cannot be built.
    Impossible(TargetError),
}

/// A false claim of a phase.
struct Claim<'a> {
    program: &'a Program,
    phase: usize,
    name: &'a str,
    location: SourceLocation,
    /// Cells of the claimed shape.
    cells: Vec<Cell>,
    /// Blocks at the end of the phase, with their roles.
    there: Vec<(ExistingBlock, RoleId)>,
}

impl Claim<'_> {
    /// Returns whether the phase has no events. If so, new captures are added to this phase.
    /// Otherwise, they are added to a new phase after it.
    fn fills_phase(&self) -> bool {
        self.program.plan.phases[self.phase].events.is_empty()
    }
}

impl Completion {
    /// Prepares the completion of the first phase with a false claim. `shape` restricts the choice
    /// to claims of this shape.
    ///
    /// # Errors
    /// If there is no false claim, or its phase cannot be completed.
    pub fn new(checked: &Checked, shape: Option<&str>) -> Result<Completion, NotCompleted> {
        let untrue = untrue_claims(checked).ok_or(NotCompleted::Wrong)?;
        let claim = unbuilt(checked, shape)?;
        let (program, symbols) = (claim.program, &checked.symbols);
        let mut there = claim.there.clone();
        // A block without a name that can be written must not capture.
        let mut nameless = None;
        for (block, role) in &mut there {
            if let Some(pattern) = program.plan.roles.nameless(*role, symbols) {
                block.can_capture = false;
                nameless = Some(pattern);
            }
        }
        let requested: BTreeSet<Cell> = claim.cells.iter().copied().collect();
        let surplus = there
            .iter()
            .find(|(block, _)| !requested.contains(&block.cell));
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
        if scene.planar.is_some() {
            let reason = "in a planar world, only whole shapes can be planned";
            return Err(NotCompleted::Refused(reason.to_owned()));
        }
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
                "existing blocks need names to hold the rest: name the instances of `{pattern}`, such as `{pattern}(A) as a`"
            )),
            _ => NotCompleted::Impossible(error),
        })?;
        let phases = &program.plan.phases;
        let phase = claim.phase + usize::from(!claim.fills_phase());
        if phases[..phase]
            .iter()
            .any(|it| !it.pre_attached && !it.events.is_empty())
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

    /// Returns the number of missing blocks.
    pub fn missing(&self) -> usize {
        self.target.cells().len() - self.target.existing().len()
    }

    /// Returns the scene of the program.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Plans the missing captures and adds them to the program.
    ///
    /// # Errors
    /// If the missing part cannot be built, or the result has errors other than remaining false
    /// claims.
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
        let (head, removed_text) = (&text[..removed.start], &text[removed.end..]);
        let rest = format!("{before}{rest}{after}");
        let whole = if *at >= removed.end {
            let (between, end) = removed_text.split_at(at - removed.end);
            format!("{head}{between}{rest}{end}")
        } else {
            format!("{head}{rest}{removed_text}")
        };
        let text = format(&whole).unwrap_or(whole);
        let others = self.texts[1..].iter();
        // The name marks diagnostics about a source that the user does not have.
        let name = format!("{} (completed)", self.texts[0].0);
        let texts: Vec<(&str, &str)> = std::iter::once((name.as_str(), text.as_str()))
            .chain(others.map(|(name, text)| (name.as_str(), text.as_str())))
            .collect();
        let checked = check_texts(&texts, &LintLevels::default(), Changes::NONE);
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

/// Returns the number of false claims. Returns `None` if there are other errors.
pub fn untrue_claims(checked: &Checked) -> Option<usize> {
    let mut errors = checked.diagnostics.iter().filter(|it| it.is_error());
    errors.try_fold(0, |count, it| {
        (it.code == Code::ShapeMismatch).then_some(count + 1)
    })
}

/// Returns the first false claim.
fn unbuilt<'a>(checked: &'a Checked, shape: Option<&str>) -> Result<Claim<'a>, NotCompleted> {
    let shapes = DeclaredShapes::new(checked);
    let mut is_claimed = false;
    for program in &checked.programs {
        for (number, phase) in program.plan.phases.iter().enumerate() {
            for &claim in &phase.claims {
                let (name, location) = (checked.symbols.word(claim.shape), claim.location);
                let known = shapes.seen_from(&program.plan, name);
                let Some(declared) = known.filter(|_| shape.is_none_or(|shape| shape == name))
                else {
                    continue;
                };
                is_claimed = true;
                let cells = shape_cells(declared.shape, declared.file, &mut Vec::new());
                let mut cells = cells.ok_or(NotCompleted::Wrong)?;
                let there = existing(program, number);
                if claim.at_least {
                    cells.extend(there.iter().map(|(block, _)| block.cell));
                }
                cells.sort_unstable();
                cells.dedup();
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
        format!(
            "no phase claims {shape}: state the final shape with `phase rest {{ yields NAME }}`"
        )
    }))
}

/// Returns the blocks at the end of a phase with their roles, sorted by cell.
pub(super) fn existing(program: &Program, last: usize) -> Vec<(ExistingBlock, RoleId)> {
    let (plan, layout) = (&program.plan, &program.layout);
    // A block that is released later must not capture. Its children would be detached.
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
            direction: layout.parents[placed.capture.0 as usize]?.face,
            can_capture: !released_later.contains(&placed.role),
        };
        Some((block, placed.role))
    });
    blocks.collect()
}

/// Returns the position of the new captures. In a phase without events, the captures stand before
/// the claim. Otherwise the captures and the claim move to a new phase.
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
    // Spans of tree nodes always compare equal, so this compares locations.
    let is_claim = |name: &Name| {
        let file = FileId(0);
        let span = name.span;
        SourceLocation { file, span } == claim.location
    };
    let claims = |item: &&Item| matches!(&item.kind, ItemKind::Yields(it) if is_claim(&it.shape));
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
            at: after(text, phase.span.end as usize),
            around: [
                format!("\nphase {new} {{\n"),
                format!("{}\n}}\n", &text[start..written.end]),
            ],
        }
    })
}

/// Returns the start of a statement with its documentation comment, which has `lines` lines.
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

/// Returns the end of the comment that follows `at` on the same line. Returns `at` if there is
/// none.
fn after(text: &str, at: usize) -> usize {
    let line = text[at..].split('\n').next().unwrap_or_default();
    // A `///` comment documents the following item and is not skipped.
    if is_comment(line.trim_start().as_bytes()) {
        at + line.len()
    } else {
        at
    }
}

/// Returns the position of a comment in a line. Returns `None` if there is none.
fn comment(line: &str) -> Option<usize> {
    let comment = parts(line).find(|part| part.kind == PartKind::Comment);
    comment.map(|part| part.range.start)
}

fn is_doc(comment: &str) -> bool {
    comment.starts_with("///") && !is_comment(comment.as_bytes())
}
