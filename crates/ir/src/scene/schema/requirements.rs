//! Terms that mean nothing without another one.
use super::super::{Agitation, Scene, Strength, Turbulence};

/// What a clause needs of another.
#[derive(Debug)]
pub struct Requirement {
    /// The clause.
    pub clause: &'static str,
    /// The one that it needs.
    pub needs: &'static str,
    /// Whether a scene that has the clause does not fulfil it.
    pub is_broken: fn(&Scene) -> bool,
    /// What is wrong then, as a title.
    pub title: &'static str,
    /// Beside the clause.
    pub label: &'static str,
    /// What to do about it.
    pub help: &'static str,
}

const ADD_FLUID: &str =
    "add `fluid { density 1000 kg/m^3  viscosity 1 mPa s }`, which takes the blocks along";

/// All of them; of those of one clause, the first that is broken is told.
pub const REQUIREMENTS: [Requirement; 5] = [
    Requirement {
        clause: "agitation",
        needs: "fluid",
        is_broken: |s| {
            let is_brownian = matches!(s.agitation, Some(Agitation::Brownian { .. }));
            is_brownian
                && s.fluid
                    .as_ref()
                    .is_none_or(|fluid| fluid.viscosity.is_none())
        },
        title: "Brownian motion without a viscous fluid",
        label: "the molecules of what?",
        help: "add `fluid { viscosity 1 mPa s }`, whose drag the fluctuations balance",
    },
    Requirement {
        clause: "agitation",
        needs: "fluid",
        is_broken: |s| s.fluid.is_none() && matches!(s.agitation, Some(Agitation::Turbulence(_))),
        title: "turbulence without a fluid",
        label: "moves nothing",
        help: ADD_FLUID,
    },
    Requirement {
        clause: "agitation",
        needs: "flow",
        is_broken: |s| {
            let is_part = matches!(
                s.agitation,
                Some(Agitation::Turbulence(Turbulence {
                    strength: Strength::Intensity(_),
                    ..
                }))
            );
            is_part && s.flow.is_none()
        },
        title: "an intensity of turbulence without a flow",
        label: "a part of which speed?",
        help: "add a `flow`, or say `speed` instead of `intensity`",
    },
    Requirement {
        clause: "fluid",
        needs: "fluid",
        is_broken: |s| {
            (s.fluid.as_ref()).is_some_and(|it| it.added_mass.is_some() && it.density.is_none())
        },
        title: "an added mass without a density",
        label: "the mass of the displaced fluid is unknown",
        help: "add `density 1000 kg/m^3` to the `fluid`",
    },
    Requirement {
        clause: "flow",
        needs: "fluid",
        is_broken: |s| s.fluid.is_none() && s.flow.is_some(),
        title: "a flow without a fluid",
        label: "moves nothing",
        help: ADD_FLUID,
    },
];
