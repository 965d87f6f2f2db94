//! Pump pressure shared by the faces of a structure.
//!
//! Every block has a chamber. An open face admits fluid through a valve. A passage joins the
//! chambers of a held block and its holder. All blocks of the plate share one chamber, joined
//! to the pump by its supply. All resistances are constant, so the tree is solved in two passes:
//! from the leaves to the pump, then back.
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::world::parameters::Suction;
use crate::world::{BlockFace, Body};

/// Underpressure by chamber \[1 / tick^2\]. Chambers without a connection to the pump are absent.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Pressures {
    plate: f64,
    chambers: BTreeMap<u32, f64>,
}

#[derive(Clone, Debug, Default)]
struct Chamber {
    open: u32,
    children: Vec<u32>,
}

impl Pressures {
    pub fn new(
        suction: &Suction,
        open: impl Iterator<Item = BlockFace>,
        holds: &BTreeMap<BlockFace, u32>,
    ) -> Pressures {
        // The key `None` is the chamber of the plate.
        let mut chambers: BTreeMap<Option<u32>, Chamber> = BTreeMap::new();
        let key = |body: Body| match body {
            Body::Seed(_) => None,
            Body::Free(id) => Some(id),
        };
        for block_face in open {
            chambers.entry(key(block_face.body)).or_default().open += 1;
        }
        for (block_face, &child) in holds {
            let chamber = chambers.entry(key(block_face.body)).or_default();
            chamber.children.push(child);
        }
        // From the plate outwards. In reverse, children come before their holders.
        let mut order: Vec<Option<u32>> = vec![None];
        let mut next = 0;
        while let Some(&at) = order.get(next) {
            next += 1;
            if let Some(chamber) = chambers.get(&at) {
                order.extend(chamber.children.iter().map(|&child| Some(child)));
            }
        }
        let mut conductance: BTreeMap<Option<u32>, f64> = BTreeMap::new();
        for &at in order.iter().rev() {
            let Some(chamber) = chambers.get(&at) else {
                continue;
            };
            let open = f64::from(chamber.open) / suction.valve;
            let through = (chamber.children.iter())
                .filter_map(|&child| conductance.get(&Some(child)))
                .map(|&own| own / (1.0 + suction.passage * own));
            conductance.insert(at, open + through.sum::<f64>());
        }
        let of = |at: Option<u32>| conductance.get(&at).copied().unwrap_or(0.0);
        let plate = suction.head / (1.0 + suction.supply * of(None));
        let mut pressures = Pressures {
            plate,
            chambers: BTreeMap::new(),
        };
        for &at in &order {
            let pressure = pressures.chamber(at);
            let Some(chamber) = chambers.get(&at) else {
                continue;
            };
            for &child in &chamber.children {
                let below = pressure / (1.0 + suction.passage * of(Some(child)));
                pressures.chambers.insert(child, below);
            }
        }
        pressures
    }

    fn chamber(&self, at: Option<u32>) -> f64 {
        match at {
            None => self.plate,
            Some(id) => self.chambers.get(&id).copied().unwrap_or(0.0),
        }
    }

    /// Returns the underpressure in the chamber of a block.
    pub fn at(&self, body: Body) -> f64 {
        match body {
            Body::Seed(_) => self.plate,
            Body::Free(id) => self.chamber(Some(id)),
        }
    }
}

#[cfg(test)]
mod tests {
    use stochc_ir::{Cell, Face};

    use super::*;

    const SUCTION: Suction = Suction {
        head: 6.0,
        supply: 1.0,
        valve: 2.0,
        passage: 0.5,
        seal: 0.1,
    };

    fn seed(face: Face) -> BlockFace {
        let cell = Cell { x: 0, y: 0, z: 0 };
        let body = Body::Seed(cell);
        BlockFace { body, face }
    }

    fn free(id: u32, face: Face) -> BlockFace {
        let body = Body::Free(id);
        BlockFace { body, face }
    }

    fn pressures(open: &[BlockFace], holds: &[(BlockFace, u32)]) -> Pressures {
        let holds = holds.iter().copied().collect();
        Pressures::new(&SUCTION, open.iter().copied(), &holds)
    }

    #[test]
    fn closed_faces_have_the_full_head() {
        let closed = pressures(&[], &[(seed(Face::Up), 4)]);
        assert_eq!(closed.at(seed(Face::Up).body), 6.0);
        assert_eq!(closed.at(Body::Free(4)), 6.0);
        assert_eq!(closed.at(Body::Free(5)), 0.0);
    }

    #[test]
    fn resistances_add_in_a_row() {
        // Pump, supply 1, two passages of 0.5 and valve 2 make 4.
        let row = pressures(
            &[free(1, Face::East)],
            &[(seed(Face::Up), 0), (free(0, Face::Up), 1)],
        );
        let flow = 6.0 / 4.0;
        assert!((row.at(Body::Free(1)) / SUCTION.valve - flow).abs() < 1e-12);
        assert!((row.at(Body::Free(0)) - (6.0 - 1.5 * flow)).abs() < 1e-12);
        assert!((row.at(seed(Face::Up).body) - (6.0 - flow)).abs() < 1e-12);
    }

    #[test]
    fn adjacent_open_faces_share_the_flow() {
        // n valves in parallel on one block make 2 / n, after 1.5 of supply and passage.
        let faces = [Face::East, Face::West, Face::North, Face::South];
        let mut before = f64::INFINITY;
        for n in 1..=4 {
            let open: Vec<BlockFace> = faces[..n].iter().map(|&face| free(0, face)).collect();
            let shared = pressures(&open, &[(seed(Face::Up), 0)]);
            let each = shared.at(Body::Free(0)) / SUCTION.valve;
            let expected = 6.0 / (1.5 + 2.0 / n as f64) / n as f64;
            assert!((each - expected).abs() < 1e-12, "{n}: {each} {expected}");
            assert!(each < before);
            before = each;
        }
    }

    #[test]
    fn a_chain_of_a_hundred_thousand_is_solved() {
        let holds: Vec<(BlockFace, u32)> = (0..100_000)
            .map(|i| match i {
                0 => (seed(Face::Up), 0),
                i => (free(i - 1, Face::Up), i),
            })
            .collect();
        let long = pressures(&[free(99_999, Face::Up)], &holds);
        let flow = 6.0 / (1.0 + 0.5 * 1e5 + 2.0);
        assert!((long.at(Body::Free(99_999)) / 2.0 / flow - 1.0).abs() < 1e-9);
    }
}
