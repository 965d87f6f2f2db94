//! Loads of the bonds of a group.
use nalgebra::Vector3;

use super::group::{BlockGroup, connected};
use super::rigid_motion::RigidMotion;
use crate::world::blocks::Motion;
use crate::world::external_forces::Response;
use crate::world::unit_cube::INVERSE_INERTIA;

/// Returns the index of the bond with the highest load, and the load \[block lengths / tick^2\].
/// Returns `None` if the group has no bonds.
///
/// A bond divides its group. It transmits the force that the blocks on the side of its second block
/// need to move with the group. The load is T + M / (1/2 block length), with the tension T and the
/// tipping moment M. Two faces with attraction F separate if the load exceeds F. The pattern of the
/// faces resists shear and twist.
pub(super) fn worst(
    group: &BlockGroup,
    before: &[Motion],
    compound: &RigidMotion,
    response: Response,
    dt: f64,
) -> Option<(usize, f64)> {
    let at = |id: u32| (group.members).binary_search_by_key(&id, |member| member.id);
    let mut worst: Option<(usize, f64)> = None;
    for (bond, &(a, b)) in group.bonds.iter().enumerate() {
        let (Ok(first), Ok(second)) = (at(a), at(b)) else {
            continue;
        };
        let joint = (before[first].position + before[second].position) / 2.0;
        let direction = (before[second].position - before[first].position).normalize();
        let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
        for id in behind(group, bond) {
            let Ok(member) = at(id) else { continue };
            let motion = &before[member];
            let (velocity, spin) = compound.at(motion.position);
            let arm = motion.position - compound.middle;
            let push = (velocity - motion.velocity) / (dt * response.linear)
                + compound.spin.cross(&compound.spin.cross(&arm));
            let turn = (spin - motion.spin) / (dt * response.angular * INVERSE_INERTIA);
            force += push;
            moment += (motion.position - joint).cross(&push) + turn;
        }
        let tension = -force.dot(&direction);
        let bending = (moment - direction * moment.dot(&direction)).norm();
        let load = tension + 2.0 * bending;
        if worst.is_none_or(|(_, most)| load > most) {
            worst = Some((bond, load));
        }
    }
    worst
}

/// Returns the members on the second block's side of a bond.
fn behind(group: &BlockGroup, bond: usize) -> Vec<u32> {
    let mut others = group.bonds.clone();
    let (_, second) = others.remove(bond);
    connected(second, &others)
}
