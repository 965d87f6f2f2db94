//! Membership of blocks in the structure over time, and queries of positions before their capture.
use std::collections::BTreeMap;

use stochc_ir::Cell;
use stochc_ir::record::RunRecord;

/// Times before a capture \[ticks\]. Maps show the positions of captured blocks at these times.
pub(crate) const AGES: [u64; 3] = [50, 200, 1000];

/// Time intervals that each block spends in the structure.
pub(super) struct StructureMembership {
    /// For each block, the intervals from its captures to its releases, in order of time.
    stretches: BTreeMap<u32, Vec<(u64, u64)>>,
}

impl StructureMembership {
    pub fn from_record(record: &RunRecord) -> StructureMembership {
        let mut stretches: BTreeMap<u32, Vec<(u64, u64)>> = BTreeMap::new();
        for bond in record.all_bonds() {
            let all = stretches.entry(bond.body).or_default();
            all.push((bond.docked, u64::MAX));
        }
        for release in record.all_releases() {
            let all = stretches.entry(release.body).or_default();
            let open = all
                .iter_mut()
                .find(|(docked, end)| *docked <= release.tick && *end == u64::MAX);
            if let Some((_, end)) = open {
                *end = release.tick;
            }
        }
        StructureMembership { stretches }
    }

    pub fn is_held(&self, body: u32, tick: u64) -> bool {
        let all = self.stretches.get(&body);
        all.is_some_and(|all| all.iter().any(|(from, to)| (*from..*to).contains(&tick)))
    }
}

/// Query for the position of a block at a time before its capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PlaceQuery {
    pub tick: u64,
    /// Index in [`AGES`] of the time before the capture.
    pub age: usize,
    pub body: u32,
    /// Cell of the later capture of the block.
    pub cell: Cell,
}

/// Returns the position queries for all captures of a run, latest first. Omits a query if the block
/// was part of the structure at the queried tick.
pub(super) fn queries(record: &RunRecord, held: &StructureMembership) -> Vec<PlaceQuery> {
    let mut queries = Vec::new();
    for bond in &record.bonds {
        for (age, ago) in AGES.iter().enumerate() {
            let Some(tick) = bond.docked.checked_sub(*ago) else {
                continue;
            };
            if !held.is_held(bond.body, tick) {
                let (body, cell) = (bond.body, bond.cell);
                queries.push(PlaceQuery {
                    tick,
                    age,
                    body,
                    cell,
                });
            }
        }
    }
    queries.sort_by_key(|it| std::cmp::Reverse(it.tick));
    queries
}

#[cfg(test)]
mod tests {
    use stochc_ir::Face;
    use stochc_ir::record::{BondRecord, Origin, Outcome, ReleaseRecord};
    use stochc_ir::table::{PhaseId, RoleId};

    use super::*;

    /// Checks a block that is captured at tick 300, released at 500 and captured again at 1200.
    #[test]
    fn blocks_are_found_where_they_were_free() {
        let bond = |docked| BondRecord {
            phase: PhaseId(0),
            parent: RoleId(0),
            face: Face::Up,
            child: RoleId(1),
            cell: Cell::new(0, 0, 1),
            magnetized: 0,
            docked,
            entries: 1,
            docking: 1,
            body: 7,
            origin: Origin::Free,
        };
        let record = RunRecord {
            phase_ticks: vec![1200],
            blocks_used: 1,
            bonds: vec![bond(300), bond(1200)],
            releases: vec![ReleaseRecord {
                phase: PhaseId(0),
                parent: RoleId(0),
                child: RoleId(1),
                tick: 500,
                body: 7,
            }],
            ..RunRecord::without_bonds(0, Outcome::Completed, 1200)
        };
        let held = StructureMembership::from_record(&record);
        let ticks = [299, 300, 499, 500, 1199, 1200];
        let expected = [false, true, true, false, false, true];
        assert_eq!(ticks.map(|tick| held.is_held(7, tick)), expected);
        assert!(!held.is_held(6, 400));
        // 1000 ticks before the first capture, the run had not begun. 1000 ticks before the second
        // one, the block was free.
        let mut found: Vec<(u64, u64)> = (queries(&record, &held).iter())
            .map(|it| (it.tick, AGES[it.age]))
            .collect();
        found.reverse();
        let all = [(100, 200), (200, 1000), (250, 50), (1000, 200), (1150, 50)];
        assert_eq!(found, all);
    }
}
