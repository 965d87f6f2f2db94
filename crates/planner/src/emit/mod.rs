//! Program text of a plan.
mod dismantling;
mod existing;
mod loop_nest;
mod repetition;
mod shape;
mod statement;
#[cfg(test)]
mod tests;

use std::fmt::Write as _;

use stochc_grammar::{FormatError as Unreadable, format};
use stochc_ir::Cell;
use stochc_text::counted;

use crate::plan::build_plan::BuildPlan;
use crate::plan::capture::Capture;
use crate::target::error::listed_cells;
use crate::target::structure::Target;
use crate::timing::precedence::Why;
use existing::{name_of, pre_attached, seeds_among_cells, write_releases};
use repetition::{Repeated, repeated};
pub use shape::declaration;
use statement::{NameWords, Statement, statements};

/// Names and declarations for the written program.
#[derive(Clone, Copy, Debug)]
pub struct Naming<'a> {
    /// Name of the assembly.
    pub assembly: &'a str,
    /// Name of the program's scene. `None` for the default scene.
    pub scene: Option<&'a str>,
    /// Name of the program's shape. `None` if the shape is too large to declare.
    pub shape: Option<&'a str>,
    /// Declarations of the scene and the shape, as text.
    pub declarations: &'a str,
    /// Allowed warnings, each with a reason.
    pub allowed: &'a [(&'a str, String)],
}

/// Sentence that every planned program contains. It identifies the file as planned.
pub const PLANNED_MARK: &str =
    "A block is called by its cell, and a block of the plate by its place there.";

/// Largest number of statements with individual explanations.
const MAX_EXPLAINED: usize = 200;

/// Returns the formatted program of a plan.
///
/// # Errors
///
/// If the names or declarations are invalid.
pub fn program(
    target: &Target,
    plan: &BuildPlan,
    naming: Naming<'_>,
) -> Result<String, Unreadable> {
    format(&draft(target, plan, naming))
}

/// Returns the program without formatting. Formatting takes longer than all other steps.
pub fn draft(target: &Target, plan: &BuildPlan, naming: Naming<'_>) -> String {
    let pre_attached = pre_attached(target);
    let there = statements(&pre_attached, |_| None);
    let first = statements(&plan.captures, |cell| name_of(target, cell));
    let later = plan.dismantling.as_ref().map(dismantling::captures);
    let second = later.as_deref().map(|later| statements(later, |_| None));
    let mut out = String::new();
    let Naming {
        assembly,
        scene,
        shape,
        declarations,
        allowed,
    } = naming;
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{declarations}");
    let _ = writeln!(
        out,
        "/// {}, up to {} open at the same time: {}.\n\
         /// {PLANNED_MARK}",
        counted(
            plan.captures.len() + later.as_ref().map_or(0, Vec::len),
            "capture"
        ),
        counted(plan.widest, "face"),
        plan.estimate.in_words(", in"),
    );
    let scene = scene.map_or(String::new(), |scene| format!(" in {scene}"));
    let _ = writeln!(out, "assembly {assembly}{scene} {{");
    for (code, reason) in allowed {
        let _ = writeln!(out, "allow {code} \"{reason}\"");
    }
    let plate = target.plate();
    let _ = writeln!(out, "seed plate {} x {} {{", plate.width, plate.depth);
    let all: Vec<Statement> = there
        .iter()
        .chain(&first)
        .chain(second.iter().flatten())
        .cloned()
        .collect();
    let among_cells = seeds_among_cells(target);
    for seat in repetition::seats(&all, &among_cells) {
        seat.write(&mut out, |out, at| {
            let _ = write!(
                out,
                "P[{}, {}] at ({}, {})",
                at.x(0),
                at.y(0),
                at.x(0),
                at.y(0)
            );
        });
    }
    for Repeated { first, nest } in &repeated(&there) {
        nest.write(&mut out, |out, at| first.write(out, at, NameWords::OWN));
    }
    write_releases(target, &mut out);
    out.push_str("}\nphase grow {\n");
    let mut explained = ExplainedComments::default();
    explained.write(&first, &plan.captures, NameWords::OWN, &mut out);
    if let (Some(dismantling), Some(later), Some(second)) = (&plan.dismantling, &later, &second) {
        out.push_str("}\nphase hand_over {\n");
        dismantling::write_releases(dismantling, &mut out);
        explained.write(second, later, NameWords::OWN, &mut out);
    }
    if let Some(shape) = shape {
        let _ = writeln!(out, "yields {shape}");
    }
    out.push_str("}\n}\n");
    out
}

/// Returns the captures of a plan as statements for a later phase of another program.
///
/// `name` returns the name that a block of the plate or of the existing structure has in the other
/// program. `word` is a name that the other program does not use.
pub fn continuation(plan: &BuildPlan, word: &str, name: impl Fn(Cell) -> Option<String>) -> String {
    let words = NameWords {
        block: word,
        ..NameWords::OWN
    };
    let mut out = String::new();
    let statements = statements(&plan.captures, name);
    ExplainedComments::default().write(&statements, &plan.captures, words, &mut out);
    out
}

/// Explanations that the program already contains. Each one is written only once.
#[derive(Default)]
struct ExplainedComments {
    grows: bool,
    mast: bool,
    near: bool,
    both: bool,
}

impl ExplainedComments {
    /// Writes the statements of a phase with their conditions.
    fn write(
        &mut self,
        statements: &[Statement],
        captures: &[Capture],
        words: NameWords<'_>,
        out: &mut String,
    ) {
        let repeated = repeated(statements);
        let is_explained = repeated.len() <= MAX_EXPLAINED;
        for Repeated { first, nest } in &repeated {
            let first: &Statement = first;
            if is_explained {
                self.explain(first, captures, nest.is_loop(), out);
            }
            nest.write(out, |out, at| first.write(out, at, words));
        }
    }

    /// Explains the conditions of a statement.
    fn explain(
        &mut self,
        statement: &Statement,
        captures: &[Capture],
        is_loop: bool,
        out: &mut String,
    ) {
        let after = &captures[statement.first()].after;
        let path_cells: Vec<Cell> = after
            .iter()
            .filter(|(_, why)| *why == Why::AccessPath)
            .map(|&(cell, _)| cell)
            .collect();
        let turns = after.len() - path_cells.len();
        let comment = match (path_cells.len(), turns) {
            (0, 0) if captures[statement.first()].is_temporary => {
                if std::mem::replace(&mut self.mast, true) {
                    return;
                }
                "Masts: parts of the shape on them grow in parallel with the rest, and they guide blocks to adjacent growth.".to_owned()
            }
            (0, 0) => {
                if std::mem::replace(&mut self.grows, true) {
                    return;
                }
                "Begins at once.".to_owned()
            }
            (0, _) => {
                if std::mem::replace(&mut self.near, true) {
                    return;
                }
                "Waits for its turn: blocks jam between faces that are open side by side."
                    .to_owned()
            }
            (_, _) if is_loop => {
                if std::mem::replace(&mut self.both, true) {
                    return;
                }
                "Comes later, because it is on the access path of the blocks that it waits for."
                    .to_owned()
            }
            (1, 0) => format!(
                "Comes later, because it is on the access path to {}.",
                path_cells[0]
            ),
            (n, _) => {
                let listed = listed_cells(&path_cells);
                let verb = if n == 1 { "is" } else { "are" };
                format!("Comes later, because {listed} {verb} reached through here.")
            }
        };
        let _ = writeln!(out, "/// {comment}");
    }
}
