//! Clauses of a scene: their kinds and fields, in the order of the reference.
use super::super::{
    Agitation, Anchor, Arrangement, Block, Bond, BondStrength, Contact, ContactLaw, Drag,
    Enclosure, Faults, Flow, Fluid, Free, Jets, Magnets, Measure, Messages, Mount, Planar, Pump,
    Reach, Scene, Stir, Strength, Turbulence,
};
use super::equations::*;
use super::numbers::*;
use super::{Absent, Either, FieldAlternative, FieldGroup, SchemaEntry, SchemaNumber, SchemaPart};
use Absent::{Example, NoTerm, NoTermWhere};

/// Placeholder for the value of a parameter that has not been read yet.
const UNSPECIFIED: f64 = f64::NAN;

/// Default of a parameter, as a value and as source text.
macro_rules! default {
    ($number:literal deg) => {
        (
            $number as f64 * (std::f64::consts::PI / 180.0),
            concat!($number, " deg"),
        )
    };
    ($number:literal) => {
        ($number, stringify!($number))
    };
}

const FACES: (u8, &str) = default!(1);
pub(in crate::scene) const TILT: (f64, &str) = default!(45 deg);
const VERTICAL: (u8, &str) = default!(1);
/// Defaults of `bond suction`, which [`Suction`](super::super::Suction) computes.
pub(super) const HALF_BLOCK: &str = "half of the block length";
pub(super) const NO_SUPPLY: &str = "0, a pump with a constant pressure";
pub(super) const ORIFICE: &str =
    "an orifice of this opening at the pressure `head`; requires `fluid`";
pub(super) const AS_VALVE: &str = "the same as `valve`";
pub(super) const CURTAIN: &str =
    "a quarter of the opening; the gap around the opening is then as large as the opening";
pub(super) const HALF_SEAL: &str = "`centres`, half of `seal`";
const UNSPECIFIED_REACH: Reach = Reach {
    force: UNSPECIFIED,
    within: UNSPECIFIED,
};
const UNSPECIFIED_BLOCK: Block = Block {
    side: UNSPECIFIED,
    mass: UNSPECIFIED,
    faces: FACES.0,
};
const UNSPECIFIED_ANCHOR: Anchor = Anchor {
    measure: Measure::Centres,
    within: UNSPECIFIED,
    tilt: TILT.0,
    sampled: false,
};

/// Returns an empty scene.
pub fn unspecified() -> Scene {
    Scene {
        name: String::new(),
        tick: UNSPECIFIED,
        block: UNSPECIFIED_BLOCK,
        free: Free {
            count: 0,
            arrangement: Arrangement::Uniform,
        },
        planar: None,
        mount: None,
        enclosure: None,
        gravity: None,
        fluid: None,
        flow: None,
        agitation: None,
        drag: None,
        contact: None,
        bond: None,
        messages: None,
        faults: None,
    }
}

const fn unspecified_eddies(strength: Strength) -> Turbulence {
    Turbulence {
        strength,
        length: UNSPECIFIED,
        time: None,
        vertical: VERTICAL.0 as f64,
    }
}

const fn unspecified_contact(law: ContactLaw) -> Contact {
    Contact {
        law,
        friction: UNSPECIFIED,
    }
}

/// Returns a field with one number. Its keyword is the last word of the number's name.
const fn field(number: &'static SchemaNumber, part: &'static [SchemaPart]) -> SchemaEntry {
    let name = number.names[0];
    let mut start = name.len();
    while start > 0 && name.as_bytes()[start - 1] != b'.' {
        start -= 1;
    }
    SchemaEntry::new(name.split_at(start).1, part)
}

macro_rules! field {
    ($number:ident) => {
        field(&$number, &[SchemaPart::Number(&$number)])
    };
}

/// Makes a keyword with fields in braces.
macro_rules! braces {
    ($word:literal [$($field:expr),* $(,)?]) => {
        braces!($word [$($field),*] FieldGroup::Free)
    };
    ($word:literal [$($field:expr),* $(,)?] $group:expr) => {
        SchemaEntry::new($word, &[SchemaPart::Fields(&[$($field),*], $group)])
    };
}

/// Makes a keyword with several kinds.
macro_rules! kinds {
    ($word:literal [$($kind:expr),* $(,)?]) => {
        SchemaEntry::new($word, &[SchemaPart::OneOf { noun: $word, of: &[$($kind),*] }])
    };
}

/// All clauses of a scene.
#[rustfmt::skip]
pub static CLAUSES: [SchemaEntry; 15] = [
    field!(TICK).absent(Example("tick 20ms")).equations(&[&TICKS]),
    SchemaEntry::new("block", &[
        SchemaPart::OneOf { noun: "cube", of: &[SchemaEntry::new("cube", &[]).is(|_| true).equations(&[&CUBES])] },
        SchemaPart::Fields(&[field!(BLOCK_SIDE), field!(BLOCK_MASS), field!(BLOCK_FACES).otherwise(FACES.1)], FieldGroup::Free),
    ])
    .absent(Example("block cube { side 20cm  mass 1kg  faces 1 }"))
    .make(|s| s.block = UNSPECIFIED_BLOCK),
    SchemaEntry::new("free", &[
        SchemaPart::Number(&FREE),
        SchemaPart::OneOf { noun: "arrangement", of: &[
            SchemaEntry::new("uniform", &[])
                .means("the blocks are evenly distributed")
                .is(|s| s.free.arrangement == Arrangement::Uniform)
                .make(|s| s.free.arrangement = Arrangement::Uniform)
                .equations(&[&UNIFORM]),
            field!(FREE_RING)
                .means("the blocks are placed evenly on a horizontal circle at half the height of the enclosure; the first block is in the east")
                .make(|s| s.free.arrangement = Arrangement::Ring { radius: UNSPECIFIED })
                .equations(&[&RING]),
        ] },
    ])
    .absent(Example("free 300 uniform")),
    kinds!("world" [
        SchemaEntry::new("planar", &[
            SchemaPart::Then(&field!(TABLE_FRICTION).otherwise("the table has no friction")),
        ])
            .means("blocks are squares that slide on a table and turn about the vertical axis; \
                    faces are `north`, `east`, `south` and `west`")
            .is(|s| s.planar.is_some())
            .make(|s| s.planar = Some(Planar { friction: None }))
            .equations(&[&PLANE, &TABLE]),
    ])
    .otherwise("blocks move and turn in space"),
    kinds!("mount" [
        SchemaEntry::new("wall", &[])
            .means("the plate is on a wall: gravity points to the south of the structure")
            .is(|s| s.mount == Some(Mount::Wall))
            .make(|s| s.mount = Some(Mount::Wall))
            .equations(&[&ON_WALL]),
        SchemaEntry::new("roof", &[])
            .means("the plate is on the roof: gravity points upward in the structure, and free blocks sink away from it")
            .is(|s| s.mount == Some(Mount::Roof))
            .make(|s| s.mount = Some(Mount::Roof))
            .equations(&[&ON_ROOF]),
        SchemaEntry::new("floor", &[])
            .means("the plate is on the floor, for a scene that is derived from another one")
            .is(|_| false)
            .make(|s| s.mount = None),
    ])
    .otherwise("the plate is on the floor"),
    kinds!("enclosure" [
        braces!("hemisphere" [field!(ENCLOSURE_RADIUS), field!(ENCLOSURE_WALL)])
            .means("a hemisphere on a solid floor, around the centre of the plate")
            .is(|s| matches!(s.enclosure, Some(Enclosure::Hemisphere { .. })))
            .make(|s| s.enclosure = Some(Enclosure::Hemisphere { radius: UNSPECIFIED, wall: UNSPECIFIED }))
            .equations(&[&HEMISPHERE]),
        braces!("sphere" [field!(ENCLOSURE_RADIUS), field!(ENCLOSURE_WALL)])
            .means("a sphere, cut off by the floor so that the plate just fits into the cut; without a plate, \
                    the sphere touches the floor")
            .is(|s| matches!(s.enclosure, Some(Enclosure::Sphere { .. })))
            .make(|s| s.enclosure = Some(Enclosure::Sphere { radius: UNSPECIFIED, wall: UNSPECIFIED }))
            .equations(&[&SPHERE]),
        braces!("box" [field!(ENCLOSURE_LENGTH), field!(ENCLOSURE_WIDTH), field!(ENCLOSURE_HEIGHT), field!(ENCLOSURE_WALL)])
            .means("a box with a lid on a solid floor; the centre of the plate is in the middle of the floor")
            .is(|s| matches!(s.enclosure, Some(Enclosure::Box { .. })))
            .make(|s| {
                let [length, width, height, wall] = [UNSPECIFIED; 4];
                s.enclosure = Some(Enclosure::Box { length, width, height, wall });
            })
            .equations(&[&BOX]),
        braces!("cylinder" [field!(ENCLOSURE_RADIUS), field!(ENCLOSURE_HEIGHT), field!(ENCLOSURE_WALL)])
            .means("a standing cylinder with a lid on a solid floor, around the centre of the plate; a flat one is a disc")
            .is(|s| matches!(s.enclosure, Some(Enclosure::Cylinder { .. })))
            .make(|s| {
                let [radius, height, wall] = [UNSPECIFIED; 3];
                s.enclosure = Some(Enclosure::Cylinder { radius, height, wall });
            })
            .equations(&[&CYLINDER]),
        braces!("disc" [field!(ENCLOSURE_RADIUS), field!(ENCLOSURE_WALL)])
            .means("a circle around the centre of the plate, in a planar world")
            .is(|s| matches!(s.enclosure, Some(Enclosure::Disc { .. })))
            .make(|s| s.enclosure = Some(Enclosure::Disc { radius: UNSPECIFIED, wall: UNSPECIFIED }))
            .equations(&[&DISC]),
        braces!("rectangle" [field!(ENCLOSURE_LENGTH), field!(ENCLOSURE_WIDTH), field!(ENCLOSURE_WALL)])
            .means("a rectangle around the centre of the plate, in a planar world")
            .is(|s| matches!(s.enclosure, Some(Enclosure::Rectangle { .. })))
            .make(|s| {
                let [length, width, wall] = [UNSPECIFIED; 3];
                s.enclosure = Some(Enclosure::Rectangle { length, width, wall });
            })
            .equations(&[&RECTANGLE]),
    ])
    .absent(Example("enclosure hemisphere { radius 5m  wall 25 N/m }")),
    field!(GRAVITY)
        .absent(NoTerm("blocks neither sink nor rise"))
        .make(|s| s.gravity = Some(UNSPECIFIED))
        .equations(&[&WEIGHT, &BUOYANCY, &PRESSING]),
    braces!("fluid" [
        field!(FLUID_DENSITY).otherwise("no buoyancy and no such drag"),
        field!(FLUID_VISCOSITY).otherwise("no such drag"),
        field!(FLUID_ADDED_MASS).otherwise("0"),
    ] FieldGroup::Any { needed: "viscosity", help: "add it, or `density`: a fluid with neither does nothing" })
        .means("fluid around the blocks; at least one field is needed")
        .absent(NoTerm("there is no fluid"))
        .make(|s| s.fluid = Some(Fluid { density: None, viscosity: None, added_mass: None }))
        .equations(&[&WAKE, &STOKES, &ADDED]),
    kinds!("flow" [
        braces!("stir" [
            field!(STIR_RADIUS),
            field!(STIR_RATE),
            field!(STIR_FORCE).otherwise("the power is not known"),
            field!(STIR_FOLLOW),
        ])
            .means("a ring of rods turns about the vertical axis and carries the fluid along; requires `fluid`")
            .make(|s| {
                let stir = Stir { radius: UNSPECIFIED, rate: UNSPECIFIED, force: None, follow: UNSPECIFIED };
                s.flow = Some(Flow::Stir(stir));
            })
            .equations(&[&STIR]),
        braces!("jets" [field!(JETS_COUNT), field!(JETS_FLOW), field!(JETS_NOZZLE)])
            .means("tubes at the wall blow fluid to the middle; they are evenly distributed, at half the height; requires `fluid`")
            .make(|s| s.flow = Some(Flow::Jets(Jets { count: 0, flow: UNSPECIFIED, nozzle: UNSPECIFIED })))
            .equations(&[&JETS]),
    ])
    .absent(NoTermWhere("the fluid is at rest on average", |s| s.fluid.is_some())),
    kinds!("agitation" [
        braces!("kicks" [field(&KICKS_MAX, &[SchemaPart::Range { low: &KICKS_MIN, high: &KICKS_MAX }])])
            .means("random impulses: each free block gets an impulse through its centre once per tick")
            .make(|s| s.agitation = Some(Agitation::Kicks { speed: (UNSPECIFIED, UNSPECIFIED) }))
            .equations(&[&KICKS]),
        braces!("turbulence" [
            field!(EDDY_SPEED).otherwise("needed, this or `intensity`"),
            field!(EDDY_INTENSITY).otherwise("needed, this or `speed`"),
            field!(EDDY_LENGTH),
            field!(EDDY_TIME).otherwise("length divided by speed"),
            field!(EDDY_VERTICAL).otherwise(VERTICAL.1),
        ] FieldGroup::Either(&STRENGTH))
            .means("eddies of the fluid, which carry blocks along; requires `fluid`")
            .equations(&[&EDDIES]),
        braces!("brownian" [field!(TEMPERATURE)])
            .means("thermal motion, which balances the viscous drag; requires `viscosity`")
            .make(|s| s.agitation = Some(Agitation::Brownian { temperature: UNSPECIFIED }))
            .equations(&[&HEAT]),
    ])
    .absent(NoTerm("no random motion")),
    braces!("drag" [field!(DRAG_RATE)])
        .means("slows down the translation of every free block")
        .absent(NoTermWhere("blocks keep their speed between collisions", |s| s.fluid.is_none()))
        .make(|s| s.drag = Some(Drag { rate: UNSPECIFIED }))
        .equations(&[&DRAG]),
    braces!("contact" [
        field!(CONTACT_RESTITUTION).otherwise("needed, this or `stiffness`"),
        field!(CONTACT_STIFFNESS).otherwise("needed, this or `restitution`"),
        field!(CONTACT_DAMPING).otherwise("no such force"),
        field!(CONTACT_FRICTION),
    ] FieldGroup::Either(&RIGIDITY))
        .means("collisions of blocks with each other, the structure and the floor")
        .absent(NoTerm("blocks pass through each other and the floor"))
        .equations(&[&RIGID, &COMPLIANT]),
    kinds!("bond" [
        braces!("attract" [
            field(&PULL, &[SchemaPart::Number(&PULL), SchemaPart::Then(&field!(PULL_WITHIN).absent(NO_REACH))]),
            field(&ALIGN, &[SchemaPart::Number(&ALIGN), SchemaPart::Then(&field!(ALIGN_WITHIN).absent(NO_REACH))])
                .absent(NoTerm("blocks are turned only by the pull"))
                .make(|s| if let Some(Bond::Attract { align, .. }) = &mut s.bond { *align = Some(UNSPECIFIED_REACH); }),
            field(&ANCHOR, &ANCHORING),
            strength(&BREAKING),
        ])
            .means("switched magnets: a face is switched on to pull and capture a block")
            .make(|s| {
                s.bond = Some(Bond::Attract { pull: UNSPECIFIED_REACH, align: None, anchor: UNSPECIFIED_ANCHOR, strength: None });
            })
            .equations(&[
                &PULLING, &ALIGNING, &ANCHOR_CENTRES, &ANCHOR_GAP, &ANCHOR_CORNERS, &ANCHOR_SAMPLED, &BREAKING_FORCE, &BREAKING_TORQUE,
            ]),
        braces!("reject" [field!(HOLD), field!(DEPTH), field!(REACH), field!(IMPULSE), field(&ANCHOR, &ANCHORING)])
            .means("permanent magnets: every face of every block attracts every other face, in each quarter turn")
            .make(|s| {
                let magnets = Magnets { hold: UNSPECIFIED, depth: UNSPECIFIED, within: UNSPECIFIED };
                s.bond = Some(Bond::Reject { magnets, anchor: UNSPECIFIED_ANCHOR, impulse: UNSPECIFIED });
            })
            .equations(&[&MAGNETS, &ANCHOR_CENTRES, &ANCHOR_GAP, &ANCHOR_CORNERS, &ANCHOR_SAMPLED, &REJECTION]),
        braces!("suction" [
            field!(HEAD),
            field!(OPENING).otherwise(HALF_BLOCK),
            field!(SUPPLY).otherwise(NO_SUPPLY),
            field!(VALVE).otherwise(ORIFICE),
            field!(PASSAGE).otherwise(AS_VALVE),
            field!(SEAL).otherwise(CURTAIN),
            field(&ANCHOR, &ANCHORING)
                .otherwise(HALF_SEAL)
                .make(|s| if let Some(Bond::Suction { anchor, .. }) = &mut s.bond { *anchor = Some(UNSPECIFIED_ANCHOR); }),
            strength(&BREAKING),
        ])
            .means("suction: an open face draws in fluid and blocks, and holds a block that closes it")
            .make(|s| {
                let pump = Pump { head: UNSPECIFIED, opening: None, supply: None, valve: None, passage: None };
                s.bond = Some(Bond::Suction { pump, seal: None, anchor: None, strength: None });
            })
            .equations(&[
                &PUMP, &OPENINGS, &SINK, &SEALING, &ANCHOR_CENTRES, &ANCHOR_GAP, &ANCHOR_CORNERS, &ANCHOR_SAMPLED,
                &BREAKING_FORCE, &BREAKING_TORQUE,
            ]),
    ])
    .absent(NoTerm("no block is ever captured")),
    braces!("messages" [field!(HOP), field!(LOSS).absent(NoTerm("no message is lost"))])
        .means("duration and loss of messages")
        .absent(NoTerm("a message arrives in the tick when it is sent"))
        .make(|s| s.messages = Some(Messages { hop: 0, loss: None }))
        .equations(&[&HOPS, &LOSSES]),
    braces!("faults" [
        field!(DEAD).otherwise("no block is dead"),
        field!(LATCH).otherwise("all latches hold"),
    ] FieldGroup::Any { needed: "dead", help: "add it, or `latch`: the probability of a fault" })
        .means("hardware faults of blocks; at least one field is needed")
        .absent(NoTerm("blocks and latches do not fail"))
        .make(|s| s.faults = Some(Faults { dead: None, latch: None }))
        .equations(&[&DEAD_BLOCKS, &LATCHES]),
];

const NO_REACH: Absent = Absent::Message {
    title: "the force has no reach",
    label: "`within` and a length must follow",
    help: "write its reach, such as `15 N within 20cm`",
};

/// Returns the field of the strength of bonds.
const fn strength(parts: &'static [SchemaPart]) -> SchemaEntry {
    SchemaEntry::new("strength", parts)
        .means(
            "bonds of the structure break under the weight of the blocks beyond them; requires `gravity`; \
             at least one field is needed",
        )
        .absent(NoTermWhere("bonds of the structure do not break", |s| {
            s.gravity.is_some() && s.planar.is_none()
        }))
        .is(|s| s.bond.as_ref().is_some_and(|bond| bond.strength().is_some()))
        .make(|s| {
            if let Some(strength) = s.bond.as_mut().and_then(Bond::strength_mut) {
                *strength = Some(BondStrength { force: None, torque: None });
            }
        })
}

#[rustfmt::skip]
static BREAKING: [SchemaPart; 1] = [SchemaPart::Fields(
    &[
        field!(STRENGTH_FORCE).otherwise("no force breaks a bond"),
        field!(STRENGTH_TORQUE).otherwise("no torque breaks a bond"),
    ],
    FieldGroup::Any { needed: "force", help: "add it, or `torque`: the load that a bond holds" },
)];

#[rustfmt::skip]
static ANCHORING: [SchemaPart; 4] = [
    SchemaPart::OneOf { noun: "measure of the anchoring distance", of: &[
        SchemaEntry::new("centres", &[])
            .means("measured between the centres of the two faces")
            .is(|s| is_measured(s, Measure::Centres)),
        SchemaEntry::new("gap", &[])
            .means("measured along the normal of the magnetized face; the lateral offset must be below half a block length")
            .is(|s| is_measured(s, Measure::Gap))
            .make(|s| if let Some(bond) = &mut s.bond { bond.anchor_mut().into_iter().for_each(|it| it.measure = Measure::Gap); }),
        SchemaEntry::new("corners", &[])
            .means("measured between each corner of the free face and the matching corner of the magnetized face")
            .is(|s| is_measured(s, Measure::Corners))
            .make(|s| if let Some(bond) = &mut s.bond { bond.anchor_mut().into_iter().for_each(|it| it.measure = Measure::Corners); }),
    ] },
    SchemaPart::Number(&ANCHOR),
    SchemaPart::Then(&field!(ANCHOR_TILT).otherwise(TILT.1)),
    SchemaPart::Then(&SchemaEntry::new("sampled", &[])
        .means("the distance is tested only at the end of each tick, so a fast block can pass without being anchored")
        .otherwise("the distance is tested along the whole path of each step")
        .is(|s| s.bond.as_ref().and_then(Bond::anchor).is_some_and(|anchor| anchor.sampled))
        .make(|s| if let Some(bond) = &mut s.bond { bond.anchor_mut().into_iter().for_each(|it| it.sampled = true); })),
];

#[rustfmt::skip]
static STRENGTH: Either = Either {
    of: [
        FieldAlternative {
            fields: &["speed"],
            label: "an absolute speed",
            missing: "add it, or `intensity` as a part of the speed of a `flow`",
            make: |s| s.agitation = Some(Agitation::Turbulence(unspecified_eddies(Strength::Speed(UNSPECIFIED)))),
        },
        FieldAlternative {
            fields: &["intensity"],
            label: "a part of the speed of the flow",
            missing: "add it",
            make: |s| s.agitation = Some(Agitation::Turbulence(unspecified_eddies(Strength::Intensity(UNSPECIFIED)))),
        },
    ],
    both: "turbulence has both a speed and an intensity",
    help: "remove one of them",
};

#[rustfmt::skip]
static RIGIDITY: Either = Either {
    of: [
        FieldAlternative {
            fields: &["restitution"],
            label: "makes it rigid",
            missing: "add it, or `stiffness` for a compliant contact",
            make: |s| s.contact = Some(unspecified_contact(ContactLaw::Rigid { restitution: UNSPECIFIED })),
        },
        FieldAlternative {
            fields: &["stiffness", "damping"],
            label: "makes it compliant",
            missing: "add how strongly it repels, such as `stiffness 25 N/m`",
            make: |s| {
                s.contact = Some(unspecified_contact(ContactLaw::Compliant { stiffness: UNSPECIFIED, damping: 0.0 }));
            },
        },
    ],
    both: "the contact is both rigid and compliant",
    help: "remove `restitution`, or `stiffness` and `damping`",
};
