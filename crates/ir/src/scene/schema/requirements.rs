//! Terms that require other terms.
use super::super::{Agitation, Scene, Strength, Turbulence};

/// Requirement of a clause.
#[derive(Debug)]
pub struct Requirement {
    /// Clause with the requirement.
    pub clause: &'static str,
    /// Clause that must be present too.
    pub needs: &'static str,
    /// Function that returns whether a scene with the clause violates the requirement.
    pub is_broken: fn(&Scene) -> bool,
    /// Title of the diagnostic.
    pub title: &'static str,
    /// Label of the clause.
    pub label: &'static str,
    /// Help of the diagnostic.
    pub help: &'static str,
}

const ADD_FLUID: &str = "add `fluid { density 1000 kg/m^3  viscosity 1 mPa s }`";

/// All requirements. For each clause, only the first violated one is reported.
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
        title: "Brownian motion needs a viscous fluid",
        label: "the scene has no `viscosity`",
        help: "add `fluid { viscosity 1 mPa s }`",
    },
    Requirement {
        clause: "agitation",
        needs: "fluid",
        is_broken: |s| s.fluid.is_none() && matches!(s.agitation, Some(Agitation::Turbulence(_))),
        title: "turbulence needs a fluid",
        label: "the scene has no `fluid`",
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
        title: "an intensity of turbulence needs a flow",
        label: "the scene has no `flow`",
        help: "add a `flow`, or write `speed` instead of `intensity`",
    },
    Requirement {
        clause: "fluid",
        needs: "fluid",
        is_broken: |s| {
            (s.fluid.as_ref()).is_some_and(|it| it.added_mass.is_some() && it.density.is_none())
        },
        title: "an added mass needs a density",
        label: "the fluid has no `density`",
        help: "add `density 1000 kg/m^3` to the `fluid`",
    },
    Requirement {
        clause: "flow",
        needs: "fluid",
        is_broken: |s| s.fluid.is_none() && s.flow.is_some(),
        title: "a flow needs a fluid",
        label: "the scene has no `fluid`",
        help: ADD_FLUID,
    },
];
