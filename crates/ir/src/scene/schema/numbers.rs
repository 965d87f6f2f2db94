//! Rows of the schema: every scene parameter.
use super::super::quantity::QuantityKind;
use super::super::{
    Agitation, Arrangement, Bond, ContactLaw, Enclosure, Flow, Strength, Turbulence,
};
use super::number::{Accessor, Range, SchemaNumber};
use Accessor::{High, Low, Optional, Term};
use Range::{Acute, AtLeast, Between, Positive, Whole};

/// Expands to the location of a value in one variant of an enum. `None` if the enum has another
/// variant.
macro_rules! of {
    ($it:expr, $variant:pat => $target:expr) => {
        match $it {
            $variant => Some($target.into()),
            #[allow(unreachable_patterns, reason = "all enclosures have a wall")]
            _ => None,
        }
    };
}

macro_rules! numbers {
    ($($name:ident [$($names:literal)+] $kind:ident $range:expr, $symbol:literal $label:literal: $meaning:literal, $at:expr;)*) => {
        $(#[doc = $meaning] pub static $name: SchemaNumber = SchemaNumber {
            names: &[$($names),+],
            kind: QuantityKind::$kind,
            range: $range,
            symbol: $symbol,
            label: $label,
            meaning: $meaning,
            at: $at,
        };)*
    };
}

// Names; kind and range; symbol and label of a value; meaning; location in a scene.
numbers! {
    TICK ["tick"] TIME Positive, "τ" "tick": "clock of the scene; random impulses act once per tick, and times are counted in ticks", |s| Some((&mut s.tick).into());

    BLOCK_SIDE ["block.side"] LENGTH Positive, "a" "side": "length of an edge", |s| Some((&mut s.block.side).into());
    BLOCK_MASS ["block.mass"] MASS Positive, "m" "mass": "mass of a cube, evenly distributed", |s| Some((&mut s.block.mass).into());
    BLOCK_FACES ["block.faces"] NUMBER Whole(1, 5), "" "faces magnetized at a time": "number of faces that a block can magnetize at the same time", |s| Some((&mut s.block.faces).into());

    FREE ["free"] NUMBER Whole(0, 10_000_000), "N" "free blocks": "number of free blocks at the beginning", |s| Some((&mut s.free.count).into());
    FREE_RING ["free.ring"] LENGTH Positive, "s" "radius of the circle": "radius of the circle through the centres of the blocks", |s| of!(&mut s.free.arrangement, Arrangement::Ring { radius } => radius);

    TABLE_FRICTION ["world.friction"] NUMBER AtLeast(0.0), "μ_t" "friction of the table": "Coulomb's coefficient of friction with the table; requires `gravity`", |s| Some(Term(&mut s.planar.as_mut()?.friction));

    ENCLOSURE_RADIUS ["enclosure.radius"] LENGTH Positive, "R" "radius": "radius of the enclosure", |s| of!(s.enclosure.as_mut()?, Enclosure::Hemisphere { radius, .. } | Enclosure::Sphere { radius, .. } | Enclosure::Cylinder { radius, .. } | Enclosure::Disc { radius, .. } => radius);
    ENCLOSURE_LENGTH ["enclosure.length"] LENGTH Positive, "L" "length": "distance of the walls in the west and the east", |s| of!(s.enclosure.as_mut()?, Enclosure::Box { length, .. } | Enclosure::Rectangle { length, .. } => length);
    ENCLOSURE_WIDTH ["enclosure.width"] LENGTH Positive, "W" "width": "distance of the walls in the south and the north", |s| of!(s.enclosure.as_mut()?, Enclosure::Box { width, .. } | Enclosure::Rectangle { width, .. } => width);
    ENCLOSURE_HEIGHT ["enclosure.height"] LENGTH Positive, "H" "height": "distance of the floor and the lid", |s| of!(s.enclosure.as_mut()?, Enclosure::Box { height, .. } | Enclosure::Cylinder { height, .. } => height);
    ENCLOSURE_WALL ["enclosure.wall"] STIFFNESS Positive, "k" "wall": "stiffness of the elastic wall, force per depth", |s| of!(s.enclosure.as_mut()?, Enclosure::Hemisphere { wall, .. } | Enclosure::Sphere { wall, .. } | Enclosure::Box { wall, .. } | Enclosure::Cylinder { wall, .. } | Enclosure::Disc { wall, .. } | Enclosure::Rectangle { wall, .. } => wall);

    GRAVITY ["gravity"] ACCELERATION Positive, "g" "gravity": "acceleration downward; a fluid with a density also causes buoyancy", |s| Some(s.gravity.as_mut()?.into());

    FLUID_DENSITY ["fluid.density"] DENSITY Positive, "ρ" "density": "density of the fluid; causes buoyancy, and drag that grows with the square of the speed", |s| Some(Term(&mut s.fluid.as_mut()?.density));
    FLUID_VISCOSITY ["fluid.viscosity"] VISCOSITY Positive, "η" "viscosity": "viscosity of the fluid; causes drag that grows with the speed", |s| Some(Term(&mut s.fluid.as_mut()?.viscosity));
    FLUID_ADDED_MASS ["fluid.added_mass"] NUMBER AtLeast(0.0), "C" "added mass": "mass of fluid that an accelerating block carries along, divided by the displaced mass; 0.64 for a cube; requires `density`", |s| Some(Term(&mut s.fluid.as_mut()?.added_mass));

    STIR_RADIUS ["flow.radius"] LENGTH Positive, "r" "radius of the ring": "radius of the ring", |s| of!(s.flow.as_mut()?, Flow::Stir(stir) => &mut stir.radius);
    STIR_RATE ["flow.rate" "flow"] TURNS AtLeast(0.0), "Ω" "rate of the ring": "rotation of the ring, counterclockwise seen from above", |s| of!(s.flow.as_mut()?, Flow::Stir(stir) => &mut stir.rate);
    STIR_FORCE ["flow.force"] FORCE Positive, "F" "force on the ring": "force on the ring along its path; it only determines the reported power, F r Ω", |s| of!(s.flow.as_mut()?, Flow::Stir(stir) => Term(&mut stir.force));
    STIR_FOLLOW ["flow.follow"] NUMBER Between(0.0, 1.0), "f" "part of it that the fluid takes": "speed of the fluid at the ring, divided by the speed of the ring", |s| of!(s.flow.as_mut()?, Flow::Stir(stir) => &mut stir.follow);
    JETS_COUNT ["flow.count"] NUMBER Whole(1, 64), "J" "jets": "number of tubes", |s| of!(s.flow.as_mut()?, Flow::Jets(jets) => &mut jets.count);
    JETS_FLOW ["flow.flow" "flow"] FLOW Positive, "Q" "flow through all": "flow through all tubes together", |s| of!(s.flow.as_mut()?, Flow::Jets(jets) => &mut jets.flow);
    JETS_NOZZLE ["flow.nozzle"] LENGTH Positive, "D" "diameter of a tube": "diameter of a tube", |s| of!(s.flow.as_mut()?, Flow::Jets(jets) => &mut jets.nozzle);

    KICKS_MAX ["agitation.speed" "agitation"] SPEED AtLeast(0.0), "w" "most change of speed": "size of the change of velocity in each tick: a single value, or drawn evenly from this range; its direction is random", |s| of!(s.agitation.as_mut()?, Agitation::Kicks { speed } => High(speed));
    KICKS_MIN ["agitation.speed.low"] SPEED AtLeast(0.0), "u" "least change of speed": "the lower end of the range", |s| of!(s.agitation.as_mut()?, Agitation::Kicks { speed } => Low(speed));
    EDDY_SPEED ["agitation.speed" "agitation"] SPEED Positive, "σ" "rms speed in a level direction": "rms speed in each horizontal direction", |s| of!(s.agitation.as_mut()?, Agitation::Turbulence(Turbulence { strength: Strength::Speed(speed), .. }) => speed);
    EDDY_INTENSITY ["agitation.intensity" "agitation"] NUMBER AtLeast(0.0), "" "part of the speed of the flow": "rms speed, divided by the speed of the `flow` (speed of the ring, or speed at the end of a tube)", |s| of!(s.agitation.as_mut()?, Agitation::Turbulence(Turbulence { strength: Strength::Intensity(part), .. }) => part);
    EDDY_LENGTH ["agitation.length"] LENGTH Positive, "ℓ" "size of an eddy": "size of an eddy, half a wavelength", |s| of!(s.agitation.as_mut()?, Agitation::Turbulence(eddies) => &mut eddies.length);
    EDDY_TIME ["agitation.time"] TIME Positive, "T" "time of an eddy": "correlation time of an eddy", |s| of!(s.agitation.as_mut()?, Agitation::Turbulence(eddies) => Optional(&mut eddies.time));
    EDDY_VERTICAL ["agitation.vertical"] NUMBER Between(0.01, 100.0), "α" "vertical over level speed": "vertical rms speed, divided by the horizontal rms speed", |s| of!(s.agitation.as_mut()?, Agitation::Turbulence(eddies) => &mut eddies.vertical);
    TEMPERATURE ["agitation.temperature" "agitation"] TEMPERATURE Positive, "T" "temperature": "temperature of the fluid", |s| of!(s.agitation.as_mut()?, Agitation::Brownian { temperature } => temperature);

    DRAG_RATE ["drag.rate" "drag"] RATE Positive, "γ" "rate": "rate γ of v' = -γ v", |s| Some((&mut s.drag.as_mut()?.rate).into());

    CONTACT_RESTITUTION ["contact.restitution"] NUMBER Between(0.0, 1.0), "e" "restitution": "restitution of a rigid contact; 0 is inelastic, 1 is elastic", |s| of!(&mut s.contact.as_mut()?.law, ContactLaw::Rigid { restitution } => restitution);
    CONTACT_STIFFNESS ["contact.stiffness"] STIFFNESS Positive, "k" "stiffness": "stiffness of a compliant contact, force per depth of overlap", |s| of!(&mut s.contact.as_mut()?.law, ContactLaw::Compliant { stiffness, .. } => stiffness);
    CONTACT_DAMPING ["contact.damping"] DAMPING AtLeast(0.0), "c" "damping": "damping of a compliant contact, force per speed of overlap; requires `stiffness`", |s| of!(&mut s.contact.as_mut()?.law, ContactLaw::Compliant { damping, .. } => damping);
    CONTACT_FRICTION ["contact.friction"] NUMBER AtLeast(0.0), "μ" "friction": "Coulomb's coefficient of friction", |s| Some((&mut s.contact.as_mut()?.friction).into());

    PULL ["bond.pull"] FORCE AtLeast(0.0), "F" "pull": "force on the nearest face of each free block in reach of a magnetized face", |s| of!(s.bond.as_mut()?, Bond::Attract { pull, .. } => &mut pull.force);
    PULL_WITHIN ["bond.pull.within"] LENGTH Positive, "r" "its reach": "largest distance of the centres of the two faces; there is no force beyond it", |s| of!(s.bond.as_mut()?, Bond::Attract { pull, .. } => &mut pull.within);
    ALIGN ["bond.align"] FORCE AtLeast(0.0), "f" "align": "force on each corner of the nearest face, towards the matching corner of the magnetized face", |s| of!(s.bond.as_mut()?, Bond::Attract { align: Some(align), .. } => &mut align.force);
    ALIGN_WITHIN ["bond.align.within"] LENGTH Positive, "q" "its reach": "largest distance of the centres of the two faces; there is no force beyond it", |s| of!(s.bond.as_mut()?, Bond::Attract { align: Some(align), .. } => &mut align.within);
    HOLD ["bond.hold"] FORCE Positive, "F" "hold": "force between two faces that touch", |s| of!(s.bond.as_mut()?, Bond::Reject { magnets, .. } => &mut magnets.hold);
    DEPTH ["bond.depth"] LENGTH Positive, "δ" "depth": "distance of opposite magnets when their faces touch; at twice this distance, the force is a sixteenth", |s| of!(s.bond.as_mut()?, Bond::Reject { magnets, .. } => &mut magnets.depth);
    REACH ["bond.within"] LENGTH Positive, "r" "reach": "largest distance of the centres of two faces; there is no force beyond it", |s| of!(s.bond.as_mut()?, Bond::Reject { magnets, .. } => &mut magnets.within);
    IMPULSE ["bond.impulse"] IMPULSE AtLeast(0.0), "J" "impulse": "impulse of a rejected block along the normal of the face", |s| of!(s.bond.as_mut()?, Bond::Reject { impulse, .. } => impulse);
    HEAD ["bond.head"] PRESSURE Positive, "H" "head": "largest pressure of the pump", |s| of!(s.bond.as_mut()?, Bond::Suction { pump, .. } => &mut pump.head);
    OPENING ["bond.opening"] LENGTH Positive, "D" "opening": "diameter of the opening in a face", |s| of!(s.bond.as_mut()?, Bond::Suction { pump, .. } => Optional(&mut pump.opening));
    SUPPLY ["bond.supply"] RESISTANCE AtLeast(0.0), "R_s" "supply": "resistance from the plate to the pump", |s| of!(s.bond.as_mut()?, Bond::Suction { pump, .. } => Optional(&mut pump.supply));
    VALVE ["bond.valve"] RESISTANCE Positive, "R_v" "valve": "resistance of an open face", |s| of!(s.bond.as_mut()?, Bond::Suction { pump, .. } => Optional(&mut pump.valve));
    PASSAGE ["bond.passage"] RESISTANCE AtLeast(0.0), "R_p" "passage": "resistance from a block to its parent", |s| of!(s.bond.as_mut()?, Bond::Suction { pump, .. } => Optional(&mut pump.passage));
    SEAL ["bond.seal"] LENGTH Positive, "s" "seal": "distance of the centres of two faces; at a smaller distance, the pressure acts on the face of the block", |s| of!(s.bond.as_mut()?, Bond::Suction { seal, .. } => Optional(seal));
    ANCHOR ["bond.anchor"] LENGTH Positive, "d" "anchoring distance": "largest distance of the two faces at anchoring", |s| Some((&mut s.bond.as_mut()?.anchor_mut()?.within).into());
    ANCHOR_TILT ["bond.anchor.tilt"] ANGLE Acute, "α" "tilt": "largest angle between the two faces at anchoring", |s| Some((&mut s.bond.as_mut()?.anchor_mut()?.tilt).into());

    STRENGTH_FORCE ["bond.strength.force"] FORCE Positive, "B" "strength, force": "largest tension or shear of a bond", |s| Some(Optional(&mut s.bond.as_mut()?.strength_mut()?.as_mut()?.force));
    STRENGTH_TORQUE ["bond.strength.torque"] TORQUE Positive, "T_b" "strength, torque": "largest torque of a bond about the centre of its faces", |s| Some(Optional(&mut s.bond.as_mut()?.strength_mut()?.as_mut()?.torque));

    HOP ["messages.hop" "messages"] TICKS Whole(0, 1_000_000), "h" "hop": "duration of a hop from a block to its parent or child", |s| Some((&mut s.messages.as_mut()?.hop).into());
    LOSS ["messages.loss"] NUMBER Between(0.0, 0.99), "p" "loss": "probability that a hop loses a message or its acknowledgement; the sender repeats the message after 2 h + 1 ticks", |s| Some(Optional(&mut s.messages.as_mut()?.loss));

    DEAD ["faults.dead"] NUMBER Between(0.0, 1.0), "q" "dead": "probability that a block is dead during the whole run; a dead block bonds, but neither acts nor answers", |s| Some(Optional(&mut s.faults.as_mut()?.dead));
    LATCH ["faults.latch"] NUMBER Between(0.0, 0.99), "ε" "latch": "probability that a captured block is released at once because the latch fails; the face stays on", |s| Some(Optional(&mut s.faults.as_mut()?.latch));
}
