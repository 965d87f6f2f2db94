//! Terms that require other terms.
use super::super::{Agitation, Bond, Enclosure, Mount, Scene, Strength, Suction, Turbulence};

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
pub const REQUIREMENTS: [Requirement; 15] = [
    Requirement {
        clause: "world",
        needs: "gravity",
        is_broken: |s| {
            let friction = s.planar.as_ref().and_then(|planar| planar.friction);
            friction.is_some() && s.gravity.is_none()
        },
        title: "friction with the table needs gravity",
        label: "the scene has no `gravity`",
        help: "add `gravity 9.81 m/s^2`",
    },
    Requirement {
        clause: "enclosure",
        needs: "world",
        is_broken: |s| s.planar.is_some() && s.enclosure.as_ref().is_some_and(|it| !it.is_flat()),
        title: "a planar world needs a flat enclosure",
        label: "the enclosure of this scene has a height",
        help: "write `enclosure disc { radius 1m  wall 25 N/m }`, or a `rectangle`",
    },
    Requirement {
        clause: "enclosure",
        needs: "world",
        is_broken: |s| s.planar.is_none() && s.enclosure.as_ref().is_some_and(Enclosure::is_flat),
        title: "a flat enclosure needs a planar world",
        label: "the scene has no `world planar`",
        help: "add `world planar`, or write `cylinder` or `box`",
    },
    Requirement {
        clause: "bond",
        needs: "world",
        is_broken: |s| {
            let is_switched = matches!(s.bond, None | Some(Bond::Attract { .. }));
            s.planar.is_some() && !is_switched
        },
        title: "this bond is not supported in a planar world",
        label: "its forces are defined in space only",
        help: "write `bond attract`, or remove `world planar`",
    },
    Requirement {
        clause: "mount",
        needs: "world",
        is_broken: |s| s.planar.is_some() && s.mount.is_some(),
        title: "a planar world has no walls and no roof for a plate",
        label: "the plate is level with the table",
        help: "remove `mount`, or `world planar`",
    },
    Requirement {
        clause: "mount",
        needs: "gravity",
        is_broken: |s| s.gravity.is_none() && s.mount.is_some(),
        title: "the position of the plate needs gravity",
        label: "without `gravity`, floor, walls and roof are the same",
        help: "add `gravity 9.81 m/s^2`, or remove `mount`",
    },
    Requirement {
        clause: "mount",
        needs: "flow",
        is_broken: |s| s.flow.is_some() && s.mount == Some(Mount::Wall),
        title: "a plate on a wall is not supported with a flow",
        label: "the flow turns about the vertical axis of the structure, which is level here",
        help: "remove `flow`, or write `mount roof`",
    },
    Requirement {
        clause: "bond",
        needs: "world",
        is_broken: |s| s.planar.is_some() && s.has_breaking_bonds(),
        title: "bonds do not break in a planar world",
        label: "the table carries the weight of all blocks",
        help: "remove `strength`, or `world planar`",
    },
    Requirement {
        clause: "bond",
        needs: "gravity",
        is_broken: |s| s.gravity.is_none() && s.has_breaking_bonds(),
        title: "the strength of bonds needs gravity",
        label: "the scene has no `gravity`, so bonds carry no load",
        help: "add `gravity 9.81 m/s^2`, or remove `strength`",
    },
    Requirement {
        clause: "bond",
        needs: "fluid",
        is_broken: |s| Suction::from_scene(s).is_some_and(|it| it.valve.is_none()),
        title: "suction without `valve` needs a fluid",
        label: "the resistance of an open face follows from the fluid",
        help: "add `fluid { density 1000 kg/m^3  viscosity 1 mPa s }`, or `valve` and its resistance",
    },
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
