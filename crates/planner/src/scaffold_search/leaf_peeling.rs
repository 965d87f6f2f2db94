//! Disassembly of a target with masts, from the leaves of its tree.
use std::collections::BTreeSet;

use crate::disassembly::Disassembly;
use crate::space::free_space::{AccessPath, FreeSpace};
use crate::space::sites::{NONE, Sites};

/// Disassembles a target. Repeatedly removes a block that holds no others, the latest in `times`
/// first. Prefers blocks with a wide access path.
///
/// `holders` are the parents at capture, [`NONE`] for the plate. `times` are approximate capture
/// times. Returns `None` if no remaining block can be removed.
pub fn peel_leaves(
    sites: &Sites<'_>,
    mut spaces: [FreeSpace; 2],
    holders: &[u32],
    times: &[f32],
) -> Option<Disassembly> {
    let count = sites.len();
    let mut holds = vec![0u32; count];
    for &holder in holders.iter().filter(|&&holder| holder != NONE) {
        holds[holder as usize] += 1;
    }
    // Positive numbers sort like their bits.
    let urgency = |site: u32| (times[site as usize].to_bits(), site);
    let mut ends: BTreeSet<(u32, u32)> = (0..count as u32)
        .filter(|&site| holds[site as usize] == 0)
        .map(urgency)
        .collect();
    let mut stands = vec![true; count];
    let mut order = Vec::with_capacity(count);
    let mut access_path = vec![Some(AccessPath::Inside); count];
    while order.len() < count {
        let stood = |site: u32| stands[site as usize];
        let removable = |space: &FreeSpace| {
            let mut ends = ends.iter().rev().copied();
            ends.find(|&(_, site)| space.access_path(sites, site, &stood).is_some())
        };
        let (_, site) = removable(&spaces[0]).or_else(|| {
            let narrow = removable(&spaces[1])?;
            access_path[narrow.1 as usize] = None;
            Some(narrow)
        })?;
        ends.remove(&urgency(site));
        stands[site as usize] = false;
        order.push(site);
        let holder = holders[site as usize];
        if holder != NONE {
            holds[holder as usize] -= 1;
            if holds[holder as usize] == 0 {
                ends.insert(urgency(holder));
            }
        }
        for space in &mut spaces {
            space.open(sites, site, &|site| stands[site as usize], &mut |_| {});
        }
    }
    order.reverse();
    let mut rank = vec![0; count];
    for (i, &site) in order.iter().enumerate() {
        rank[site as usize] = i as u32;
    }
    // Depth in the tree from the plate.
    let mut level = vec![1; count];
    for &site in &order {
        if let Some(&below) = level.get(holders[site as usize] as usize) {
            level[site as usize] = below + 1;
        }
    }
    Some(Disassembly {
        order,
        rank,
        access_path,
        level,
        spaces,
    })
}
