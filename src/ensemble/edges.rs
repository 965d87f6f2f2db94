//! What the captures of a program have in common: one row for each edge from parent to child.
use std::collections::BTreeMap;

use serde::Serialize;
use stochc_compiler::table::{PLANTED, PhaseId, RoleId};
use stochc_runtime::record::{BondRecord, Origin, Outcome};

use super::layout::Layout;
use super::table::ticks;
use super::{Finished, Manifest};
use crate::statistics::Summary;

/// The captures of one role by another in one phase, in all runs that did not fail.
///
/// A capture that a timeout prevented is not among them, so that the waits of a program with
/// censored runs are too short on average.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Edge {
    /// The phase's name.
    pub phase: String,
    /// The role that magnetized a face.
    pub parent: String,
    /// The role that was given.
    pub child: String,
    /// Captures.
    pub n: usize,
    /// Ticks from the magnetizing of the face to the docking, on average.
    pub wait: f64,
    /// Half the width of the 95 % confidence interval of `wait`; `None` for a single capture.
    pub wait_half_width: Option<f64>,
    /// Coefficient of variation of the waits, 1 if they are exponential; `None` for a single one.
    pub wait_cv: Option<f64>,
    /// Entries of blocks into the reach of the pull for each capture, on average.
    pub entries: f64,
    /// Ticks from the captured block's last entry to its docking, on average.
    pub docking: f64,
    /// Entries per tick of waiting: of all captures together; `None`: nobody waited.
    pub entry_rate: Option<f64>,
    /// How many captured blocks had held which role before, sorted by role; the others were free.
    pub released: Vec<(String, usize)>,
}

/// Sums up the captures of the manifest's program number `program`, sorted by phase and roles.
pub fn edges(manifest: &Manifest, finished: &[Finished], program: usize) -> Vec<Edge> {
    let mut captures = BTreeMap::<(PhaseId, RoleId, RoleId), Vec<&BondRecord>>::new();
    // What is attached by hand was not waited for.
    let is_planted = |phase| manifest.programs[program].phase(phase) == PLANTED;
    for done in finished {
        if done.program == program && !matches!(done.record.outcome, Outcome::Failed { .. }) {
            for bond in (done.record.bonds.iter()).filter(|bond| !is_planted(bond.phase)) {
                let key = (bond.phase, bond.parent, bond.child);
                captures.entry(key).or_default().push(bond);
            }
        }
    }
    let program = &manifest.programs[program];
    captures
        .into_iter()
        .map(|((phase, parent, child), bonds)| {
            let values = |of: fn(&BondRecord) -> f64| {
                let values: Vec<f64> = bonds.iter().map(|bond| of(bond)).collect();
                Summary::of(&values).expect("an edge has a capture")
            };
            let wait = values(|bond| bond.docked.saturating_sub(bond.magnetized) as f64);
            let entries = values(|bond| bond.entries.into());
            let mut released = BTreeMap::<RoleId, usize>::new();
            for bond in &bonds {
                if let Origin::Released { role, .. } = bond.origin {
                    *released.entry(role).or_default() += 1;
                }
            }
            Edge {
                phase: program.phase(phase).to_owned(),
                parent: program.role(parent).to_owned(),
                child: program.role(child).to_owned(),
                n: bonds.len(),
                wait: wait.mean,
                wait_half_width: wait.half_width,
                wait_cv: wait.cv(),
                entries: entries.mean,
                docking: values(|bond| bond.docking as f64).mean,
                entry_rate: (wait.mean > 0.0).then(|| entries.mean / wait.mean),
                released: released
                    .into_iter()
                    .map(|(role, n)| (program.role(role).to_owned(), n))
                    .collect(),
            }
        })
        .collect()
}

/// The edges as a table of plain text; `width` is that of the terminal, in characters.
pub fn edges_to_text(edges: &[Edge], width: usize) -> String {
    const NONE: &str = "-";
    let column = |header: &str, cell: &dyn Fn(&Edge) -> String| {
        (header.to_owned(), edges.iter().map(cell).collect())
    };
    let layout = Layout {
        labels: edges
            .iter()
            .map(|edge| format!("{}: {} -> {}", edge.phase, edge.parent, edge.child))
            .collect(),
        columns: vec![
            column("n", &|edge| edge.n.to_string()),
            column("wait", &|edge| match edge.wait_half_width {
                Some(half_width) => format!("{} ± {}", ticks(edge.wait), ticks(half_width)),
                None => ticks(edge.wait),
            }),
            column("CV", &|edge| {
                edge.wait_cv.map_or(NONE.into(), |cv| format!("{cv:.2}"))
            }),
            column("entries", &|edge| format!("{:.1}", edge.entries)),
            column("docking", &|edge| ticks(edge.docking)),
            column("released before", &|edge| {
                let share = |&(ref role, n): &(String, usize)| {
                    format!("{role} {:.0} %", 100.0 * n as f64 / edge.n as f64)
                };
                let shares: Vec<_> = edge.released.iter().map(share).collect();
                shares.join(", ")
            }),
        ],
    };
    layout.text(width)
}
