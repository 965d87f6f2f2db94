//! Loads of the structure's bonds under the weight and the buoyancy of its blocks.
//!
//! The bonds of a structure form a tree, whose root is the plate. The load of a bond is the weight
//! of all blocks beyond it. Contacts between blocks without a bond carry nothing. The floor carries
//! sinking blocks of the lowest layer, and everything beyond them.
use serde::{Deserialize, Serialize};

use super::{BondStrength, Scene};
use crate::table::RoleId;
use crate::{Cell, Face};

/// Layer of the blocks whose lower faces are level with the floor.
const LOWEST: i32 = 1;

/// Blocks beyond a bond: their number, and the sum of their cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlocksBeyond {
    /// Number of blocks.
    pub count: i64,
    sum: [i64; 3],
}

impl BlocksBeyond {
    fn one(cell: Cell) -> BlocksBeyond {
        BlocksBeyond {
            count: 1,
            sum: [cell.x, cell.y, cell.z].map(i64::from),
        }
    }

    /// Adds blocks, or removes them if `sign` is -1.
    pub fn add(&mut self, more: BlocksBeyond, sign: i64) {
        self.count += sign * more.count;
        self.sum = [0, 1, 2].map(|axis| self.sum[axis] + sign * more.sum[axis]);
    }
}

/// Load of a bond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BondLoad {
    /// Number of blocks that the bond carries.
    pub blocks: i64,
    /// Tension or shear \[N\]. 0 if the blocks press on their parent.
    pub force: f64,
    /// Torque about the centre of the faces \[N m\], without the part that the pressure of the faces
    /// bears.
    pub torque: f64,
    /// Load divided by the strength: the larger ratio of force and torque. The bond breaks if this
    /// is more than 1.
    pub share: f64,
}

/// Bond law of a scene whose bonds break.
#[derive(Clone, Debug)]
pub struct BreakingBonds {
    /// Weight of a block minus its buoyancy \[N\].
    weight: f64,
    /// Block length \[m\].
    side: f64,
    /// Direction of gravity in the frame of the structure.
    down: [i32; 3],
    has_floor: bool,
    strength: BondStrength,
}

impl BreakingBonds {
    /// Returns the law of a scene. Returns `None` if bonds do not break.
    pub fn from_scene(scene: &Scene) -> Option<BreakingBonds> {
        let strength = scene.bond.as_ref()?.strength()?.clone();
        let side = scene.block.side;
        let density = scene.fluid.as_ref().and_then(|fluid| fluid.density);
        let displaced = density.unwrap_or(0.0) * side.powi(3);
        Some(BreakingBonds {
            weight: (scene.block.mass - displaced) * scene.gravity?,
            side,
            down: scene.gravity_direction(),
            has_floor: scene.contact.is_some(),
            strength,
        })
    }

    /// Returns the blocks that the bond of a block carries. `held` are the blocks that the bonds of
    /// its children carry. The floor may carry all of them.
    pub fn beyond(&self, cell: Cell, held: BlocksBeyond) -> BlocksBeyond {
        if self.stands(cell) {
            return BlocksBeyond::default();
        }
        let mut all = BlocksBeyond::one(cell);
        all.add(held, 1);
        all
    }

    /// Returns whether the floor carries a block.
    fn stands(&self, cell: Cell) -> bool {
        self.has_floor && self.weight * f64::from(self.down[2]) < 0.0 && cell.z == LOWEST
    }

    /// Returns the load of the bond between a block and its parent. `face` is the face of the
    /// parent, in the frame of the structure.
    pub fn load(&self, face: Face, cell: Cell, beyond: BlocksBeyond) -> BondLoad {
        let normal = face.normal();
        let force = beyond.count as f64 * self.weight;
        // Positive if the blocks press on their parent.
        let along: i32 = (0..3).map(|axis| normal[axis] * self.down[axis]).sum();
        let pressing = -force * f64::from(along);
        let borne = pressing.max(0.0) * self.side / 2.0;
        let cell = [cell.x, cell.y, cell.z];
        let torque = [0, 1, 2].map(|axis| {
            // Arms along gravity have no torque.
            if self.down[axis] != 0 {
                return 0.0;
            }
            // The joint is half a block length from the block's centre.
            let joint = 2 * i64::from(cell[axis]) - i64::from(normal[axis]);
            let arm = (2 * beyond.sum[axis] - beyond.count * joint) as f64 / 2.0;
            ((arm * self.side * self.weight).abs() - borne).max(0.0)
        });
        let force = if pressing > 0.0 { 0.0 } else { force.abs() };
        let torque = torque.into_iter().fold(0.0, f64::hypot);
        let part = |load: f64, strength: Option<f64>| strength.map_or(0.0, |most| load / most);
        BondLoad {
            blocks: beyond.count,
            force,
            torque,
            share: part(force, self.strength.force).max(part(torque, self.strength.torque)),
        }
    }

    /// Returns the load and the strength as text: `12 blocks, 0.5 N of 0.4 N, 0.1 N m of 0.3 N m`.
    pub fn describe(&self, load: &BondLoad) -> String {
        let of = |load: f64, strength: Option<f64>, unit: &str| {
            let short = super::warnings::short;
            strength.map(|most| format!("{} {unit} of {} {unit}", short(load), short(most)))
        };
        let blocks = stochc_text::counted(load.blocks as usize, "block");
        let force = of(load.force, self.strength.force, "N");
        let torque = of(load.torque, self.strength.torque, "N m");
        let parts = [Some(blocks), force, torque].into_iter().flatten();
        parts.collect::<Vec<_>>().join(", ")
    }
}

/// Bond of an attached block.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct LoadedBond {
    parent: RoleId,
    face: Face,
    cell: Cell,
    /// Blocks that the bond carries.
    beyond: BlocksBeyond,
}

/// Loads of all bonds of a growing structure.
#[derive(Clone, Debug)]
pub struct StructureLoads {
    law: BreakingBonds,
    /// Bond of each role's block to its parent.
    bonds: Vec<Option<LoadedBond>>,
    /// First block whose bond broke, with a description of the load.
    broken: Option<(RoleId, String)>,
}

crate::state! {
    () StructureLoads;
    values: bonds, broken;
    parts: ;
    same: law
}

impl StructureLoads {
    /// Returns the loads of a structure of seeds. Returns `None` if bonds do not break.
    pub fn new(scene: &Scene) -> Option<StructureLoads> {
        Some(StructureLoads {
            law: BreakingBonds::from_scene(scene)?,
            bonds: Vec::new(),
            broken: None,
        })
    }

    /// Returns the first broken bond: the block and a description of the load.
    pub fn broken(&self) -> Option<(RoleId, &str)> {
        let (role, load) = self.broken.as_ref()?;
        Some((*role, load))
    }

    /// Adds a captured block.
    pub fn capture(&mut self, parent: RoleId, face: Face, child: RoleId, cell: Cell) {
        let index = child.0 as usize;
        if self.bonds.len() <= index {
            self.bonds.resize(index + 1, None);
        }
        self.bonds[index] = Some(LoadedBond {
            parent,
            face,
            cell,
            beyond: BlocksBeyond::default(),
        });
        self.change(child, BlocksBeyond::one(cell), 1);
    }

    /// Removes a released block, and unloads the bonds that carried it. Its descendants must be
    /// released next.
    pub fn release(&mut self, child: RoleId) {
        let bond = self.bonds.get_mut(child.0 as usize).and_then(Option::take);
        if let Some(bond) = bond {
            self.change(bond.parent, bond.beyond, -1);
        }
    }

    /// Changes the load of a block's bond, and of all bonds between the block and the plate.
    fn change(&mut self, mut block: RoleId, change: BlocksBeyond, sign: i64) {
        while let Some(Some(bond)) = self.bonds.get_mut(block.0 as usize) {
            if self.law.stands(bond.cell) {
                return;
            }
            bond.beyond.add(change, sign);
            let load = self.law.load(bond.face, bond.cell, bond.beyond);
            if load.share > 1.0 && self.broken.is_none() {
                self.broken = Some((block, self.law.describe(&load)));
            }
            block = bond.parent;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(weight: f64, has_floor: bool) -> BreakingBonds {
        BreakingBonds {
            weight,
            side: 0.1,
            down: [0, 0, -1],
            has_floor,
            strength: BondStrength {
                force: Some(1.0),
                torque: Some(0.5),
            },
        }
    }

    fn blocks(cells: &[[i32; 3]]) -> BlocksBeyond {
        let mut all = BlocksBeyond::default();
        for &[x, y, z] in cells {
            all.add(BlocksBeyond::one(Cell { x, y, z }), 1);
        }
        all
    }

    const CELL: Cell = Cell { x: 1, y: 0, z: 3 };

    /// Checks a horizontal cantilever of n blocks: shear n w, torque n² w a / 2.
    #[test]
    fn a_cantilever_has_the_torque_of_its_length() {
        let arm = blocks(&[[1, 0, 3], [2, 0, 3], [3, 0, 3]]);
        for weight in [0.2, -0.2] {
            let load = law(weight, true).load(Face::East, CELL, arm);
            assert!((load.force - 0.6).abs() < 1e-12, "{load:?}");
            assert!((load.torque - 0.09).abs() < 1e-12, "{load:?}");
            assert!((load.share - 0.6).abs() < 1e-12, "{load:?}");
        }
    }

    /// Checks that blocks press on their parent, or pull at it, and that pressure bears torque.
    #[test]
    fn a_vertical_bond_carries_tension_but_no_pressure() {
        let column = blocks(&[[1, 0, 3], [1, 0, 4]]);
        for (weight, face, force) in [
            (0.2, Face::Up, 0.0),
            (-0.2, Face::Up, 0.4),
            (0.2, Face::Down, 0.4),
            (-0.2, Face::Down, 0.0),
        ] {
            let load = law(weight, true).load(face, CELL, column);
            assert!((load.force - force).abs() < 1e-12, "{weight} {face:?}");
            assert!(load.torque.abs() < 1e-12);
        }
        // A column with an arm of two blocks. The torque is 3 w a, and 4 w press with an arm a/2.
        let crane = blocks(&[[1, 0, 3], [1, 0, 4], [2, 0, 4], [3, 0, 4]]);
        let load = |weight| law(weight, true).load(Face::Up, CELL, crane).torque;
        assert!((load(0.2) - 0.02).abs() < 1e-12);
        assert!((load(-0.2) - 0.06).abs() < 1e-12);
    }

    /// Checks that a plate on a wall turns all loads with it, and one on the roof reverses them.
    #[test]
    fn loads_turn_with_the_plate() {
        let shape = blocks(&[[1, 0, 3], [1, 1, 4], [2, 1, 4], [3, 1, 4]]);
        let mounted = |down, face| {
            BreakingBonds {
                down,
                ..law(0.2, true)
            }
            .load(face, CELL, shape)
        };
        for face in Face::ALL {
            let rising = law(-0.2, true).load(face, CELL, shape);
            assert_eq!(mounted([0, 0, 1], face), rising, "{face:?}");
        }
        // The arms of the four blocks add up to 5 in x and to 3 in z.
        let load = mounted([0, -1, 0], Face::East);
        assert!((load.force - 0.8).abs() < 1e-12);
        let torque = 0.02 * 5.0_f64.hypot(3.0);
        assert!((load.torque - torque).abs() < 1e-12, "{load:?}");
        assert_eq!(mounted([0, -1, 0], Face::North).force, 0.0);
        let cell = Cell { x: 4, y: 0, z: 1 };
        let one = |weight, down| {
            let law = BreakingBonds {
                down,
                ..law(weight, true)
            };
            law.beyond(cell, BlocksBeyond::default()).count
        };
        assert_eq!((one(0.2, [0, 0, 1]), one(-0.2, [0, 0, 1])), (1, 0));
        assert_eq!((one(0.2, [0, -1, 0]), one(-0.2, [0, -1, 0])), (1, 1));
    }

    #[test]
    fn the_floor_carries_sinking_blocks_of_the_lowest_layer() {
        let cell = Cell { x: 4, y: 0, z: 1 };
        for (weight, has_floor, count) in [(0.2, true, 0), (-0.2, true, 4), (0.2, false, 4)] {
            let held = blocks(&[[5, 0, 2], [6, 0, 2], [7, 0, 2]]);
            assert_eq!(law(weight, has_floor).beyond(cell, held).count, count);
        }
    }

    /// Checks that loads that are added up event by event equal those of the remaining blocks.
    #[test]
    fn captures_and_releases_add_up() {
        let mut loads = StructureLoads {
            law: law(0.2, false),
            bonds: Vec::new(),
            broken: None,
        };
        let cell = |x: i32, y: i32| Cell { x, y, z: 2 };
        let role = RoleId;
        for x in 1..=4 {
            let parent = role(x - 1);
            loads.capture(parent, Face::East, role(x), cell(x as i32, 0));
        }
        loads.capture(role(2), Face::North, role(7), cell(2, 1));
        let beyond = |loads: &StructureLoads, i: usize| loads.bonds[i].map(|bond| bond.beyond);
        let all = blocks(&[[1, 0, 2], [2, 0, 2], [3, 0, 2], [4, 0, 2], [2, 1, 2]]);
        assert_eq!(beyond(&loads, 1), Some(all));
        assert_eq!(loads.broken(), None);
        loads.release(role(3));
        loads.release(role(4));
        let left = blocks(&[[1, 0, 2], [2, 0, 2], [2, 1, 2]]);
        assert_eq!(beyond(&loads, 1), Some(left));
        assert_eq!(beyond(&loads, 4), None);
        // Six blocks shear with 1.2 N.
        for x in 3..=5 {
            let parent = role(x - 1);
            loads.capture(parent, Face::East, role(x), cell(x as i32, 0));
        }
        let (broken, load) = loads.broken().unwrap();
        assert_eq!(broken, role(1));
        assert_eq!(load, "6 blocks, 1.2 N of 1 N, 0.2807 N m of 0.5 N m");
    }
}
