//! Finds the blocks that a source location names, and their events.
use rustc_hash::FxHashMap;
use stochc_grammar::tree::ItemKind;
use stochc_grammar::{Cancellation, Cancelled};
use stochc_ir::table::RoleId;

use crate::check::program::declarations;
use crate::dependencies::graph::anchored_by;
use crate::expand::{ExpansionSettings, Limits, Probe, expand_probed};
use crate::expanded::{EventId, EventKind};
use crate::names::{Keep, Names};
use crate::{Checked, FileId, Program};

/// Blocks of one assembly that a name at a location means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Located {
    /// Index of the assembly in [`Checked::programs`].
    pub program: usize,
    /// The blocks in the order of expansion, at most 64.
    pub roles: Vec<RoleId>,
}

/// Returns the blocks that the name at a byte of a file means, for each assembly.
///
/// In a loop or a pattern, one name means many blocks, so the programs are expanded again.
///
/// # Errors
///
/// Returns [`Cancelled`] if the search was cancelled.
pub fn blocks_at(
    checked: &Checked,
    (file, at): (FileId, u32),
    limits: Limits,
    cancellation: Cancellation<'_>,
) -> Result<Vec<Located>, Cancelled> {
    let mut located = Vec::new();
    let mut symbols = checked.symbols.clone();
    // Errors have been reported.
    let mut diagnostics = Vec::new();
    let names = Names::from_trees(checked.trees(), Keep::Declarations, cancellation)?;
    let declarations = declarations(checked.trees(), &names, &symbols, &mut diagnostics);
    let assemblies = checked
        .tree
        .items
        .iter()
        .filter_map(|item| match &item.kind {
            ItemKind::Assembly(assembly) => Some(Some(assembly)),
            // Aggregates have no named blocks.
            ItemKind::Aggregate(_) => Some(None),
            _ => None,
        });
    for (program, assembly) in assemblies.enumerate() {
        let Some(assembly) = assembly else { continue };
        let Some(known) = checked.programs.get(program) else {
            break;
        };
        let mut probe = Probe {
            at: Some((file, at)),
            keys: Vec::new(),
        };
        diagnostics.clear();
        expand_probed(
            &declarations,
            (known.plan.location.file, assembly),
            &checked.sources,
            &mut symbols,
            ExpansionSettings {
                limits,
                parameters: &[],
                cancellation,
            },
            &mut diagnostics,
            &mut probe,
        )?;
        let keys = probe.keys.iter();
        let roles: Vec<RoleId> = keys.filter_map(|key| known.plan.roles.get(key)).collect();
        if !roles.is_empty() {
            located.push(Located { program, roles });
        }
    }
    Ok(located)
}

/// Ancestors of blocks: follows the captures of a block and its parents to the plate.
pub struct Ancestry<'a> {
    program: &'a Program,
    captures: FxHashMap<RoleId, Vec<EventId>>,
}

impl<'a> Ancestry<'a> {
    /// Collects the captures of a program.
    pub fn new(program: &'a Program) -> Ancestry<'a> {
        let mut captures: FxHashMap<RoleId, Vec<EventId>> = FxHashMap::default();
        for (number, event) in program.plan.events.iter().enumerate() {
            if event.valid && matches!(event.kind, EventKind::Capture { .. }) {
                let id = EventId(number as u32);
                captures.entry(event.role).or_default().push(id);
            }
        }
        Ancestry { program, captures }
    }

    /// Returns the captures of a block in source order. There are several after releases.
    pub fn captures(&self, role: RoleId) -> &[EventId] {
        self.captures.get(&role).map_or(&[], Vec::as_slice)
    }

    /// Returns the number of captures from the plate to a block. Returns `None` if one of these
    /// captures is invalid.
    pub fn depth(&self, capture: EventId) -> Option<u32> {
        let plan = &self.program.plan;
        let mut at = capture;
        let mut depth = 0;
        loop {
            depth += 1;
            let EventKind::Capture { parent, .. } = plan.event(at).kind else {
                return None;
            };
            // More steps than captures are a cycle.
            if !plan.event(at).valid || depth as usize > plan.events.len() {
                return None;
            }
            if plan.seeds.iter().any(|seed| seed.role == parent) {
                return Some(depth);
            }
            at = self.anchoring(at, parent)?;
        }
    }

    /// Returns the capture that anchors `parent`, the capturing block of `capture`. It is in the
    /// same phase, or it is the last capture of `parent` in an earlier phase. Returns `None` for a
    /// parent on the plate.
    fn anchoring(&self, capture: EventId, parent: RoleId) -> Option<EventId> {
        let here = anchored_by(&self.program.graph, capture);
        if here.is_some() {
            return here;
        }
        let plan = &self.program.plan;
        let start = plan.phases[plan.phase_of(capture)?].events.start;
        let earlier = self.captures(parent).iter().rev();
        earlier.copied().find(|id| id.0 < start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check;

    const TEXT: &str = "pattern tower(base, height) {
    base.up ->> T[1..height]
}
assembly a {
    seed plate 2 x 1 { A at (0, 0) B at (1, 0) }
    phase p {
        tower(A, 2) as left
        tower(B, 1) as right
    }
    phase q {
        left.T[2].up -> Top.up -> Tip
        right.T[1].up -> R
    }
    phase r {
        release Tip
        Top.up -> Tip
    }
}";

    fn checked() -> Checked {
        let mut reader = |_: &str| Ok(TEXT.as_bytes().to_vec());
        let checked = check("a.sa", &mut reader, Limits::default());
        assert_eq!(checked.diagnostics, []);
        checked
    }

    /// Returns the names of the blocks at the end of the first occurrence of a text.
    fn names(checked: &Checked, behind: &str) -> Vec<String> {
        let at = TEXT.find(behind).unwrap() + behind.len();
        let place = (FileId(0), at as u32);
        let located = blocks_at(checked, place, Limits::default(), Cancellation::NEVER).unwrap();
        let names = located.iter().flat_map(|located| {
            let plan = &checked.programs[located.program].plan;
            let roles = located.roles.iter();
            roles.map(|&role| plan.roles.name(role, &checked.symbols))
        });
        names.collect()
    }

    #[test]
    fn a_location_maps_to_its_blocks() {
        let checked = checked();
        assert_eq!(names(&checked, "tower(A"), ["A"]);
        assert_eq!(names(&checked, "{ A"), ["A"]);
        assert_eq!(names(&checked, "left.T"), ["left.T[2]"]);
        assert_eq!(names(&checked, "    left"), [""; 0]);
        assert_eq!(names(&checked, "-> Top"), ["Top"]);
        assert_eq!(names(&checked, "release Tip"), ["Tip"]);
        // In a pattern, the blocks of all its instances.
        assert_eq!(
            names(&checked, "->> T"),
            ["left.T[1]", "left.T[2]", "right.T[1]"]
        );
        assert_eq!(names(&checked, "    base"), ["A", "B"]);
        assert_eq!(names(&checked, "phase"), [""; 0]);
    }

    #[test]
    fn depth_is_counted_from_the_plate() {
        let checked = checked();
        let program = &checked.programs[0];
        let ancestry = Ancestry::new(program);
        let depths: Vec<_> = (0..program.plan.events.len() as u32)
            .map(|id| ancestry.depth(EventId(id)))
            .collect();
        let expected = [
            Some(1),
            Some(2),
            Some(1),
            Some(3),
            Some(4),
            Some(2),
            None,
            Some(4),
        ];
        assert_eq!(depths, expected);
    }
}
