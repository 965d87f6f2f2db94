//! What the terms of a scene make a runtime compute, in the symbols of their numbers.
use super::super::groups::rms_of_range;
use super::super::quantity::QuantityKind;
use super::super::{
    Agitation, Anchor, BOLTZMANN, Flow, Fluid, Jets, Measure, Scene, Stir, Turbulence,
};
use super::number::Number;
use super::numbers::*;
use Symbol::{Derived as From, Number as Of};

/// One thing that a term does.
#[derive(Debug)]
pub struct Equation {
    /// In words.
    pub meaning: &'static str,
    /// In the symbols of the values, in plain text; `None`: there is nothing to compute.
    pub formula: Option<&'static str>,
    /// What stands in it; a scene that does not say the first has no such equation.
    pub symbols: &'static [Symbol],
    /// In which scenes it holds.
    pub holds: fn(&Scene) -> bool,
}

/// What stands in an equation.
#[derive(Debug)]
pub enum Symbol {
    /// A number of the scene.
    Number(&'static Number),
    /// What follows from several.
    Derived(Derived),
}

/// A value that follows from numbers of a scene.
#[derive(Debug)]
pub struct Derived {
    /// What it is one of.
    pub kind: QuantityKind,
    /// What equations call it.
    pub symbol: &'static str,
    /// What it is.
    pub label: &'static str,
    /// Its value in SI units; `None`: the scene does not say enough.
    pub of: fn(&Scene) -> Option<f64>,
}

const fn equation(
    meaning: &'static str,
    formula: Option<&'static str>,
    symbols: &'static [Symbol],
) -> Equation {
    Equation {
        meaning,
        formula,
        symbols,
        holds: |_| true,
    }
}

impl Equation {
    const fn holds(self, holds: fn(&Scene) -> bool) -> Equation {
        Equation { holds, ..self }
    }
}

const fn derived(
    kind: QuantityKind,
    symbol: &'static str,
    label: &'static str,
    of: fn(&Scene) -> Option<f64>,
) -> Symbol {
    From(Derived {
        kind,
        symbol,
        label,
        of,
    })
}

fn stir(scene: &Scene) -> Option<&Stir> {
    match scene.flow.as_ref()? {
        Flow::Stir(stir) => Some(stir),
        Flow::Jets(_) => None,
    }
}

fn jets(scene: &Scene) -> Option<&Jets> {
    match scene.flow.as_ref()? {
        Flow::Jets(jets) => Some(jets),
        Flow::Stir(_) => None,
    }
}

/// The eddies of a scene, and their speed.
fn eddies(scene: &Scene) -> Option<(&Turbulence, f64)> {
    match scene.agitation.as_ref()? {
        Agitation::Turbulence(eddies) => Some((eddies, eddies.speed(scene.flow.as_ref()))),
        Agitation::Kicks { .. } | Agitation::Brownian { .. } => None,
    }
}

fn density(scene: &Scene) -> Option<f64> {
    scene.fluid.as_ref()?.density
}

pub(super) fn is_measured(scene: &Scene, measured: Measure) -> bool {
    let anchor = scene.bond.as_ref().map(super::super::Bond::anchor);
    anchor.is_some_and(|&Anchor { measure, .. }| measure == measured)
}

pub static TICKS: Equation = equation(
    "the clock: kicks fall, messages travel and times are told once a tick",
    None,
    &[Of(&TICK)],
);

pub static CUBES: Equation = equation(
    "the blocks are cubes, their mass spread evenly",
    Some("I = m a² / 6 about every axis"),
    &[
        Of(&BLOCK_SIDE),
        Of(&BLOCK_MASS),
        derived(QuantityKind::INERTIA, "I", "moment of inertia", |s| {
            Some(s.block.mass * s.block.side * s.block.side / 6.0)
        }),
        Of(&BLOCK_FACES),
    ],
);

pub static UNIFORM: Equation = equation(
    "at the beginning blocks are at rest on a cubic lattice in the enclosure",
    None,
    &[Of(&FREE)],
);

pub static RING: Equation = equation(
    "at the beginning blocks are at rest, evenly on a level circle halfway up",
    None,
    &[Of(&FREE), Of(&FREE_RING)],
);

pub static HEMISPHERE: Equation = equation(
    "an elastic shell over the floor z = 0, felt by the centre of a block",
    Some("outside R, m v' = -k (|x| - R) x / |x|"),
    &[Of(&ENCLOSURE_RADIUS), Of(&ENCLOSURE_WALL)],
);

pub static SPHERE: Equation = equation(
    "an elastic ball, cut off by the floor z = 0 where the plate just fills the cut; felt by the ball in a block",
    Some("y = x - c; beyond R, m v' = -k (|y| + a / 2 - R) y / |y|"),
    &[Of(&ENCLOSURE_RADIUS), Of(&ENCLOSURE_WALL)],
);

pub static WEIGHT: Equation = equation(
    "pulls every free block down",
    Some("v' = -g z"),
    &[Of(&GRAVITY)],
)
.holds(|s| density(s).is_none());

pub static BUOYANCY: Equation = equation(
    "pulls every free block down, and its fluid bears it up",
    Some("v' = -(1 - ρ a³ / m) g z"),
    &[
        Of(&GRAVITY),
        derived(
            QuantityKind::NUMBER,
            "ρ a³ / m",
            "borne by the fluid",
            |s| Some(density(s)? * s.block.side.powi(3) / s.block.mass),
        ),
    ],
)
.holds(|s| density(s).is_some());

pub static WAKE: Equation = equation(
    "drag of a wake, on the motion relative to the fluid",
    Some("m v' = -ρ a² |v - u| (v - u) / 2; I ω' = -ρ a⁵ |ω - w| (ω - w) / 32"),
    &[Of(&FLUID_DENSITY)],
);

pub static STOKES: Equation = equation(
    "Stokes' drag of a cube, on the motion relative to the fluid",
    Some("m v' = -6 π η 0.6607 a (v - u); I ω' = -6 η a³ (ω - w)"),
    &[Of(&FLUID_VISCOSITY)],
);

pub static STIR: Equation = equation(
    "the fluid turns about the vertical axis: as a whole within the ring, without vorticity outside",
    Some("u = f Ω s, beyond r f Ω r² / s; its pressure keeps it on the circle"),
    &[
        Of(&STIR_RADIUS),
        Of(&STIR_RATE),
        derived(QuantityKind::NUMBER, "Ω / 2π", "turns a second", |s| {
            Some(stir(s)?.rate / std::f64::consts::TAU)
        }),
        Of(&STIR_FOLLOW),
        Of(&STIR_FORCE),
        derived(QuantityKind::POWER, "P", "power, F r Ω", |s| {
            stir(s)?.power()
        }),
    ],
);

pub static JETS: Equation = equation(
    "round turbulent jets from the wall to the middle, evenly around",
    Some("u = U min(1, 6.2 D / s) exp(-ln 2 (q / max(0.094 s, D / 2))²)"),
    &[
        Of(&JETS_COUNT),
        Of(&JETS_FLOW),
        Of(&JETS_NOZZLE),
        derived(QuantityKind::SPEED, "U", "speed at a tube", |s| {
            jets(s).map(Jets::speed)
        }),
    ],
);

pub static KICKS: Equation = equation(
    "an impulse through the centre of every free block, once a tick",
    Some("v += s n, s uniform in [u, w], n isotropic; j² = (u² + u w + w²) / 3"),
    &[
        Of(&KICKS_LEAST),
        Of(&KICKS_MOST),
        derived(QuantityKind::SPEED, "j", "rms change of speed", |s| {
            let Some(Agitation::Kicks { speed: (low, high) }) = s.agitation else {
                return None;
            };
            Some(rms_of_range(low, high))
        }),
    ],
);

pub static EDDIES: Equation = equation(
    "the fluid moves in eddies without sources, which come and go by chance",
    Some("<u(x, t) u(x, t + s)> = σ² exp(-s / T), wave length 2 ℓ, Gaussian"),
    &[
        derived(
            QuantityKind::SPEED,
            "σ",
            "rms speed in a level direction",
            |s| Some(eddies(s)?.1),
        ),
        Of(&EDDY_LENGTH),
        Of(&EDDY_VERTICAL),
        derived(QuantityKind::TIME, "T", "time of an eddy", |s| {
            let (eddies, speed) = eddies(s)?;
            (speed > 0.0).then(|| eddies.time(speed))
        }),
    ],
);

pub static HEAT: Equation = equation(
    "fluctuations that balance the viscous drag, of place and of orientation",
    Some("<x²> = 2 D t with D = k T / (6 π η 0.6607 a), Einstein's relation"),
    &[
        Of(&TEMPERATURE),
        derived(QuantityKind::DIFFUSION, "D", "diffusion coefficient", |s| {
            let temperature = TEMPERATURE.get(s)?;
            let viscosity = s.fluid.as_ref()?.viscosity?;
            Some(BOLTZMANN * temperature / Fluid::friction(viscosity, s.block.side))
        }),
    ],
);

pub static DRAG: Equation = equation(
    "slows the centre of every free block",
    Some("v' = -γ v, by v *= exp(-γ dt) in each step"),
    &[Of(&DRAG_RATE)],
);

pub static RIGID: Equation = equation(
    "blocks, structure and floor do not overlap; they collide, and rub",
    Some("along the normal u -> -e u; across it at most μ times that impulse"),
    &[Of(&CONTACT_RESTITUTION), Of(&CONTACT_FRICTION)],
);

pub static COMPLIANT: Equation = equation(
    "blocks, structure and floor repel where they overlap by a depth d, and rub",
    Some(
        "f = max(0, k d + c d') along the normal, shared in proportion to depth; across it at most μ f",
    ),
    &[
        Of(&CONTACT_STIFFNESS),
        Of(&CONTACT_DAMPING),
        Of(&CONTACT_FRICTION),
    ],
);

pub static PULLING: Equation = equation(
    "pulls the nearest face of every free block in reach of a magnetized face",
    Some("|f| = F on the centre of that face, towards the magnetized one's"),
    &[Of(&PULL), Of(&PULL_WITHIN)],
);

pub static ALIGNING: Equation = equation(
    "turns that face, once closer, into the nearest quarter turn",
    Some("|f| = f on each of its four corners, towards its counterpart"),
    &[Of(&ALIGN), Of(&ALIGN_WITHIN)],
);

pub static MAGNETS: Equation = equation(
    "faces always attract each other, by four pairs of dipoles at half of the way from the middle to the corners",
    Some("f = F / 4 (1 + d / δ)⁻⁴ between two of a pair at the distance d"),
    &[Of(&HOLD), Of(&DEPTH), Of(&REACH)],
);

pub static REJECTION: Equation = equation(
    "a block that is rejected leaves along the normal of the face",
    Some("v = J / m"),
    &[Of(&IMPULSE)],
);

pub static PUMP: Equation = equation(
    "open faces share the pump through the tree of blocks; every flow is laminar",
    Some("Δp = R Q on each way, flows into a chamber sum to none"),
    &[Of(&HEAD), Of(&SUPPLY), Of(&VALVE), Of(&PASSAGE)],
);

pub static SINK: Equation = equation(
    "an open face is a sink before a wall, whose flow takes blocks along",
    Some("u = Q / (2 π d²) towards the face"),
    &[],
);

pub static SEALING: Equation = equation(
    "a block that is close feels the pressure drop on its face",
    Some("within s, |f| = Δp a², half on the centre, the rest on the corners"),
    &[Of(&SEAL)],
);

const ANCHORED: &str = "then the block is anchored, snaps onto the lattice and is fixed";

static DISTANCE_AND_TILT: [Symbol; 2] = [Of(&ANCHOR), Of(&ANCHOR_TILT)];

pub static ANCHOR_CENTRES: Equation = equation(
    ANCHORED,
    Some("centres of the two faces < d, normals < α from opposite"),
    &DISTANCE_AND_TILT,
)
.holds(|s| is_measured(s, Measure::Centres));

pub static ANCHOR_GAP: Equation = equation(
    ANCHORED,
    Some("gap along the normal < d, aside < a / 2, normals < α from opposite"),
    &DISTANCE_AND_TILT,
)
.holds(|s| is_measured(s, Measure::Gap));

pub static HOPS: Equation = equation(
    "a message needs this long from a block to its parent or child",
    None,
    &[Of(&HOP)],
);

pub static LOSSES: Equation = equation(
    "a hop may be lost, and so may its acknowledgement; without one the sender sends again",
    Some("a hop arrives with probability 1 - p; again after 2 h + 1 ticks"),
    &[Of(&LOSS)],
);
