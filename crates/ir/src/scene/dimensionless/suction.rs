//! Dimensionless numbers of suction.
use super::all::Push;
use super::number::{AdvisedRange, DimensionlessNumber};
use super::{BlockUnits, speed};
use crate::scene::{Enclosure, Scene, Suction};

/// Adds the numbers of suction, for a single open face of the plate.
pub(super) fn suction(scene: &Scene, push: Push, out: &mut Vec<DimensionlessNumber>) {
    let Some(suction) = Suction::from_scene(scene) else {
        return;
    };
    let Some((flow, valve)) = suction.flow().zip(suction.valve) else {
        return;
    };
    let units = BlockUnits::from_scene(scene);
    // Jets come from the wall, and are slower at the structure.
    let away = scene.enclosure.as_ref().map_or(0.0, Enclosure::radius);
    let force = flow * valve * scene.block.side.powi(2);
    let in_block_units = units.force(force);
    out.push(push.anchoring(in_block_units, units.length(suction.anchor.within)));
    let fluid = scene.fluid.as_ref();
    let kinds = fluid.and_then(|fluid| fluid.density.zip(fluid.viscosity));
    if let Some(((density, viscosity), speed)) = kinds.zip(suction.speed()) {
        out.push(DimensionlessNumber::new(
            "ρ U D / η",
            "Reynolds number of the flow through the opening of a face",
            density * speed * suction.opening / viscosity,
        ));
    }
    let speed = speed::impact(scene, away).filter(|&speed| speed > 0.0);
    if let Some(distance) = speed.and_then(|speed| suction.distance(speed)) {
        out.push(DimensionlessNumber::new(
            "√(Q / (2 π v)) / a",
            "block lengths to where the flow of an open face is as fast as a block",
            units.length(distance),
        ));
    }
    let drag = speed::flow_force(scene, away);
    if drag > 0.0 {
        out.push(
            DimensionlessNumber::new(
                "Δp a² / F, suction",
                "force of an open face on a block against the drag of the flow",
                force / drag,
            )
            .advised(AdvisedRange::Least(1.0)),
        );
    }
}
