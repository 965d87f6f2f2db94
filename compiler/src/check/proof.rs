//! The proof of a program. docs/concepts/proofs.md has the arguments.
use std::fmt;

use serde::Serialize;
use stochc_ir::scene::Scene;
use stochc_text::series;

use crate::blocks::block_demand::scarce_phase;
use crate::check::checked::{Checked, Program};
use crate::diagnostic::{Code, Diagnostic};
use crate::reach::Plane;

/// Properties of a program in every order of its captures and releases.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Proof {
    /// Whether every order completes, if no timeout, dead block or broken bond ends the run.
    pub completes: bool,
    /// Whether every captured cell stays accessible until its block is captured.
    pub no_cell_blocked: bool,
    /// Whether no two blocks share a cell.
    pub no_cell_used_twice: bool,
    /// The shapes that phases claim and build, in program order.
    pub shapes: Vec<String>,
    /// Whether a phase has a timeout.
    pub has_timeout: bool,
    /// Whether the scene has dead blocks.
    pub has_dead_blocks: bool,
    /// Whether bonds of the structure can break.
    pub has_breaking_bonds: bool,
    /// Reasons why a property is not proved, as clauses.
    pub unproved: Vec<String>,
}

impl Checked {
    /// Returns the proof of the program with this index in [`Checked::programs`].
    ///
    /// Returns `None` if the file has errors, or for an aggregate, which grows at random.
    pub fn proof(&self, number: usize) -> Option<Proof> {
        let program = self.programs.get(number)?;
        if self.has_errors() || program.plan.aggregate.is_some() {
            return None;
        }
        let allowed = self.allowed.iter().map(|allowed| &allowed.diagnostic);
        let found = self.diagnostics.iter().chain(allowed);
        let found = found.filter(|diagnostic| diagnostic.programs.contains(&number));
        let (overload, found): (Vec<_>, Vec<_>) =
            found.partition(|diagnostic| diagnostic.code == Code::OverloadedBond);
        let undecided = found.into_iter().filter_map(undecided);
        let mut unproved: Vec<String> = undecided.chain(ignored_walls(program)).collect();
        unproved.sort_unstable();
        unproved.dedup();
        let no_cell_blocked = unproved.is_empty();
        unproved.extend(scarcity(program));
        if let Some(diagnostic) = overload.first() {
            unproved.push(format!("a bond breaks ({})", diagnostic.code));
        }
        Some(Proof {
            completes: unproved.is_empty(),
            no_cell_blocked,
            no_cell_used_twice: true,
            shapes: self.shapes(program),
            has_timeout: (program.plan.phases.iter()).any(|phase| phase.timeout.is_some()),
            has_dead_blocks: has_dead_blocks(program),
            has_breaking_bonds: (program.scene.as_ref()).is_some_and(Scene::has_breaking_bonds),
            unproved,
        })
    }

    /// Returns the names of the shapes that a program claims, each once. A wrong claim is an error.
    fn shapes(&self, program: &Program) -> Vec<String> {
        let claims = program.plan.phases.iter().flat_map(|phase| &phase.claims);
        let mut names: Vec<String> = Vec::new();
        for claim in claims {
            let name = self.symbols.word(claim.shape);
            if !names.iter().any(|known| known == name) {
                names.push(name.to_owned());
            }
        }
        names
    }
}

/// Returns the reason why a diagnostic leaves the accessibility of a cell undecided. Returns `None`
/// for all other diagnostics.
fn undecided(diagnostic: &Diagnostic) -> Option<String> {
    let reason = match diagnostic.code {
        Code::ReachUndecided => "the search for access paths reached its limit",
        Code::BlockedRelease => "a released block may stay in its cell",
        Code::TooManyWarnings => "not all warnings were kept",
        _ => return None,
    };
    Some(format!("{reason} ({})", diagnostic.code))
}

/// Returns the reason why walls may close cells. Returns `None` if the proof considers all walls.
fn ignored_walls(program: &Program) -> Option<String> {
    let Program { plan, layout, .. } = program;
    let plane = Plane::new(program.scene.as_ref()?, plan, layout)?;
    plane.ignores_walls().then(|| {
        "no side of the structure has room for two rows of blocks, so the proof ignores walls"
            .to_owned()
    })
}

/// Returns the reason why all free blocks may be bound before a release. Returns `None` if no order
/// does this.
fn scarcity(program: &Program) -> Option<String> {
    let free = program.scene.as_ref()?.free.count;
    let phase = scarce_phase(&program.plan, &program.layout, &program.graph, free)?;
    Some(format!(
        "phase `{}` may need more than the {free} free blocks of the scene before its releases",
        phase.name
    ))
}

fn has_dead_blocks(program: &Program) -> bool {
    let faults = program
        .scene
        .as_ref()
        .and_then(|scene| scene.faults.as_ref());
    faults
        .and_then(|faults| faults.dead)
        .is_some_and(|dead| dead > 0.0)
}

impl fmt::Display for Proof {
    /// Writes one line per property: `proved: ...`, or `not proved: ...` with the reason.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.completes {
            let exceptions = [
                (self.has_dead_blocks, "it captures a dead block"),
                (self.has_breaking_bonds, "a bond breaks"),
                (self.has_timeout, "a phase times out"),
            ];
            let exceptions = exceptions.into_iter().filter(|(applies, _)| *applies);
            let exceptions: Vec<&str> = exceptions.map(|(_, exception)| exception).collect();
            let unless = if exceptions.is_empty() {
                ""
            } else {
                " unless "
            };
            let exceptions = series(&exceptions, "or");
            writeln!(f, "proved: completes in every order{unless}{exceptions}")?;
        }
        let cells = if self.no_cell_blocked {
            "no cell is blocked or used twice"
        } else {
            "no cell is used twice"
        };
        writeln!(f, "proved: {cells}")?;
        if !self.shapes.is_empty() {
            let shapes = self.shapes.iter().map(|shape| format!("`{shape}`"));
            let shapes: Vec<String> = shapes.collect();
            writeln!(f, "proved: builds {}", series(&shapes, "and"))?;
        }
        if !self.completes {
            writeln!(f, "not proved: completes in every order")?;
            for reason in &self.unproved {
                writeln!(f, "  because {reason}")?;
            }
        }
        Ok(())
    }
}
