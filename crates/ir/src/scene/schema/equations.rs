//! Physical laws of a scene's terms, in the symbols of their parameters.
use super::super::dimensionless::rms_of_range;
use super::super::quantity::QuantityKind;
use super::super::{
    Agitation, Anchor, BOLTZMANN, Bond, Flow, Fluid, Jets, Measure, Scene, Stir, Suction,
    Turbulence,
};
use super::clauses::{AS_VALVE, CURTAIN, HALF_BLOCK, HALF_SEAL, NO_SUPPLY, ORIFICE, TILT};
use super::number::SchemaNumber;
use super::numbers::*;
use EquationSymbol::{Default as Or, Derived as D, Number as N};

/// Physical law of a term.
#[derive(Debug)]
pub struct Equation {
    /// Description of the law.
    pub meaning: &'static str,
    /// Formula in the symbols of the values, in plain text. `None` if the law has no formula.
    pub formula: Option<&'static str>,
    /// Symbols in the law. A scene without the first symbol does not have the law.
    pub symbols: &'static [EquationSymbol],
    /// Function that returns whether a scene has the law.
    pub holds: fn(&Scene) -> bool,
}

/// Symbol in a law.
#[derive(Debug)]
pub enum EquationSymbol {
    /// Scene parameter.
    Number(&'static SchemaNumber),
    /// Scene parameter with a computed default.
    Default(&'static SchemaNumber, &'static ComputedDefault),
    /// Derived value.
    Derived(&'static Derived),
}

/// Default that depends on other scene parameters.
#[derive(Debug)]
pub struct ComputedDefault {
    /// Origin of the value.
    pub source: &'static str,
    /// Function that computes the value in SI units. Returns `None` if no law needs the value.
    pub of: fn(&Scene) -> Option<f64>,
}

/// Value derived from scene parameters.
#[derive(Debug)]
pub struct Derived {
    /// Kind of quantity.
    pub kind: QuantityKind,
    /// Symbol in equations.
    pub symbol: &'static str,
    /// Name of the quantity.
    pub label: &'static str,
    /// Function that computes the value in SI units. Returns `None` if the scene lacks a parameter.
    pub of: fn(&Scene) -> Option<f64>,
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

/// Returns the turbulence of a scene, and its speed. Returns `None` without turbulence.
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
    let anchor = scene.bond.as_ref().and_then(Bond::anchor);
    anchor.is_some_and(|&Anchor { measure, .. }| measure == measured)
}

/// Returns the condition of a capture, or the default.
fn anchor(scene: &Scene) -> Option<Anchor> {
    match Suction::from_scene(scene) {
        Some(suction) => Some(suction.anchor),
        None => scene.bond.as_ref()?.anchor().cloned(),
    }
}

fn anchors_by(scene: &Scene, measured: Measure) -> bool {
    anchor(scene).is_some_and(|anchor| anchor.measure == measured)
}

/// Returns the opening of a face with suction if another default depends on it.
fn opening(scene: &Scene) -> Option<f64> {
    let Some(Bond::Suction { pump, seal, .. }) = &scene.bond else {
        return None;
    };
    let is_used = pump.valve.is_none() || seal.is_none();
    is_used.then_some(Suction::from_scene(scene)?.opening)
}

fn has_orifice(scene: &Scene) -> bool {
    matches!(&scene.bond, Some(Bond::Suction { pump, .. }) if pump.valve.is_none())
}

macro_rules! defaults {
    ($($name:ident $source:expr, $of:expr;)*) => {
        $(static $name: ComputedDefault = ComputedDefault { source: $source, of: $of };)*
    };
}

// Origin; value in a scene.
defaults! {
    BY_BLOCK HALF_BLOCK, opening;
    WITHOUT_SUPPLY NO_SUPPLY, |s| Some(Suction::from_scene(s)?.supply);
    BY_ORIFICE ORIFICE, |s| Suction::from_scene(s)?.valve;
    BY_VALVE AS_VALVE, |s| Suction::from_scene(s)?.passage;
    BY_OPENING CURTAIN, |s| Some(Suction::from_scene(s)?.seal);
    BY_SEAL HALF_SEAL, |s| Some(anchor(s)?.within);
    BY_TILT TILT.1, |s| Some(anchor(s)?.tilt);
}

macro_rules! derived {
    ($($name:ident $kind:ident $symbol:literal $label:literal: $of:expr;)*) => {
        $(static $name: Derived = Derived {
            kind: QuantityKind::$kind,
            symbol: $symbol,
            label: $label,
            of: $of,
        };)*
    };
}

// Kind, symbol and label; value in a scene.
derived! {
    INERTIA INERTIA "I" "moment of inertia": |s| Some(s.block.mass * s.block.side * s.block.side / 6.0);
    BORNE NUMBER "ρ a³ / m" "borne by the fluid": |s| Some(density(s)? * s.block.side.powi(3) / s.block.mass);
    INERTIAL MASS "m + C ρ a³" "inertial mass": |s| Some(s.inertial_mass());
    REVOLUTIONS NUMBER "Ω / 2π" "turns a second": |s| Some(stir(s)?.rate / std::f64::consts::TAU);
    STIR_POWER POWER "P" "power, F r Ω": |s| stir(s)?.power();
    JET_SPEED SPEED "U" "speed at a tube": |s| jets(s).map(Jets::speed);
    DRAWN FLOW "Q" "flow through one open face of the plate": |s| Suction::from_scene(s)?.flow();
    DRAWN_SPEED SPEED "" "speed in its opening": |s| Suction::from_scene(s)?.speed().filter(|_| opening(s).is_some() || OPENING.get(s).is_some());
    KICKS_RMS SPEED "j" "rms change of speed": |s| Some(rms_of_range(KICKS_MIN.get(s)?, KICKS_MAX.get(s)?));
    EDDY_RMS SPEED "σ" "rms speed in a level direction": |s| Some(eddies(s)?.1);
    EDDY_LIFE TIME "T" "time of an eddy": |s| {
        let (eddies, speed) = eddies(s)?;
        (speed > 0.0).then(|| eddies.time(speed))
    };
    DIFFUSION DIFFUSION "D" "diffusion coefficient": |s| {
        let friction = Fluid::friction(s.fluid.as_ref()?.viscosity?, s.block.side);
        Some(BOLTZMANN * TEMPERATURE.get(s)? / friction)
    };
}

macro_rules! equations {
    ($($name:ident $meaning:literal $formula:expr; [$($symbol:expr),*] $(if $holds:expr)?;)*) => {
        $(#[doc = $meaning] pub static $name: Equation = Equation {
            meaning: $meaning,
            formula: $formula,
            symbols: &[$($symbol),*],
            holds: equations!(@ $($holds)?),
        };)*
    };
    (@) => { |_| true };
    (@ $holds:expr) => { $holds };
}

// Meaning; formula; symbols; condition on the scene.
equations! {
    TICKS "the clock: kicks fall, messages travel and times advance once per tick"
        None; [N(&TICK)];
    CUBES "the blocks are cubes, their mass spread evenly"
        Some("I = m a² / 6 about every axis"); [N(&BLOCK_SIDE), N(&BLOCK_MASS), D(&INERTIA), N(&BLOCK_FACES)];
    UNIFORM "at the beginning blocks are at rest on a cubic lattice in the enclosure"
        None; [N(&FREE)];
    RING "at the beginning blocks are at rest, evenly on a level circle halfway up"
        None; [N(&FREE), N(&FREE_RING)];
    HEMISPHERE "an elastic wall over the floor z = 0, felt by the centre of a block"
        Some("outside R, m v' = -k (|x| - R) x / |x|"); [N(&ENCLOSURE_RADIUS), N(&ENCLOSURE_WALL)];
    SPHERE "an elastic ball, cut off by the floor z = 0 where the plate just fills the cut; felt by the ball in a block"
        Some("y = x - c; beyond R, m v' = -k (|y| + a / 2 - R) y / |y|"); [N(&ENCLOSURE_RADIUS), N(&ENCLOSURE_WALL)];
    BOX "an elastic box on the floor z = 0, felt by the ball in a block; without a contact, the floor is elastic too"
        Some("d = |x| + a / 2 - L / 2, likewise y and z; m v' = -k d"); [N(&ENCLOSURE_LENGTH), N(&ENCLOSURE_WIDTH), N(&ENCLOSURE_HEIGHT), N(&ENCLOSURE_WALL)];
    CYLINDER "an elastic cylinder on the floor z = 0, felt by the ball in a block; without a contact, the floor is elastic too"
        Some("d = √(x² + y²) + a / 2 - R, likewise z; m v' = -k d"); [N(&ENCLOSURE_RADIUS), N(&ENCLOSURE_HEIGHT), N(&ENCLOSURE_WALL)];
    DISC "an elastic circle, felt by the circle in a block"
        Some("d = √(x² + y²) + a / 2 - R; m v' = -k d"); [N(&ENCLOSURE_RADIUS), N(&ENCLOSURE_WALL)];
    RECTANGLE "an elastic rectangle, felt by the circle in a block"
        Some("d = |x| + a / 2 - L / 2, likewise y; m v' = -k d"); [N(&ENCLOSURE_LENGTH), N(&ENCLOSURE_WIDTH), N(&ENCLOSURE_WALL)];
    PLANE "blocks are on a table: no force, impulse or torque acts out of the plane"
        Some("z = a / 2; ω = (0, 0, ω)"); [];
    TABLE "the table slows sliding and turning together, and holds blocks at rest"
        Some("m v' = -μ_t m g v / s, I ω' = -μ_t m g c² ω / s; s² = v² + c² ω², c = 0.3826 a"); [N(&TABLE_FRICTION)];
    ON_WALL "the structure's frame, with the enclosure, lies on its side: its floor is a wall of the room"
        Some("v' = -g y instead of -g z"); [];
    ON_ROOF "the structure's frame, with the enclosure, is upside down: its floor is the roof of the room"
        Some("v' = g z instead of -g z"); [];
    WEIGHT "pulls every free block down"
        Some("v' = -g z"); [N(&GRAVITY)] if |s| density(s).is_none() && s.planar.is_none();
    BUOYANCY "pulls every free block down, and its fluid bears it up"
        Some("v' = -(1 - ρ a³ / m) g z"); [N(&GRAVITY), D(&BORNE)] if |s| density(s).is_some() && s.planar.is_none();
    PRESSING "presses every block on the table; a fluid with a density bears a part"
        Some("m g, with a fluid (m - ρ a³) g"); [N(&GRAVITY)] if |s| s.planar.is_some();
    WAKE "drag of a wake, on the motion relative to the fluid"
        Some("m v' = -ρ a² |v - u| (v - u) / 2; I ω' = -ρ a⁵ |ω - w| (ω - w) / 32"); [N(&FLUID_DENSITY)];
    STOKES "Stokes' drag of a cube, on the motion relative to the fluid"
        Some("m v' = -6 π η 0.675 a (v - u); I ω' = -8.07 η a³ (ω - w)"); [N(&FLUID_VISCOSITY)];
    ADDED "blocks accelerate as if they were heavier; weight and buoyancy stay"
        Some("m + C ρ a³ in place of m in every m v' and m ω', and in the pressure of the flow (1 + C) ρ a³"); [N(&FLUID_ADDED_MASS), D(&INERTIAL)] if |s| s.fluid.as_ref().is_some_and(|fluid| fluid.added_mass.is_some());
    STIR "the fluid turns about the vertical axis: as a whole within the ring, without vorticity outside"
        Some("u = f Ω s, beyond r f Ω r² / s; its pressure keeps it on the circle"); [N(&STIR_RADIUS), N(&STIR_RATE), D(&REVOLUTIONS), N(&STIR_FOLLOW), N(&STIR_FORCE), D(&STIR_POWER)];
    JETS "round turbulent jets from the wall to the middle, evenly around"
        Some("u = U min(1, 6.2 D / s) exp(-ln 2 (q / max(0.094 s, D / 2))²)"); [N(&JETS_COUNT), N(&JETS_FLOW), N(&JETS_NOZZLE), D(&JET_SPEED)];
    KICKS "an impulse through the centre of every free block, once a tick"
        Some("v += s n, s uniform in [u, w], n isotropic; j² = (u² + u w + w²) / 3"); [N(&KICKS_MIN), N(&KICKS_MAX), D(&KICKS_RMS)];
    EDDIES "the fluid moves in eddies without sources, which come and go by chance"
        Some("<u(x, t) u(x, t + s)> = σ² exp(-s / T), wave length 2 ℓ, Gaussian"); [D(&EDDY_RMS), N(&EDDY_LENGTH), N(&EDDY_VERTICAL), D(&EDDY_LIFE)];
    HEAT "fluctuations that balance the viscous drag, of place and of orientation"
        Some("<x²> = 2 D t with D = k T / (6 π η 0.675 a), Einstein's relation"); [N(&TEMPERATURE), D(&DIFFUSION)];
    DRAG "slows the centre of every free block"
        Some("v' = -γ v, by v *= exp(-γ dt) in each step"); [N(&DRAG_RATE)];
    RIGID "blocks, structure and floor do not overlap; they collide, and rub"
        Some("along the normal u -> -e u; across it at most μ times that impulse"); [N(&CONTACT_RESTITUTION), N(&CONTACT_FRICTION)];
    COMPLIANT "blocks, structure and floor repel if they overlap by a depth d, and rub"
        Some("f = max(0, k d + c d') along the normal, at the deepest point; across it at most μ f"); [N(&CONTACT_STIFFNESS), N(&CONTACT_DAMPING), N(&CONTACT_FRICTION)];
    PULLING "pulls the nearest face of every free block in reach of a magnetized face"
        Some("|f| = F on the centre of that face, towards the magnetized one's"); [N(&PULL), N(&PULL_WITHIN)];
    ALIGNING "turns that face, once closer, into the nearest quarter turn"
        Some("|f| = f on each of its four corners, towards its counterpart"); [N(&ALIGN), N(&ALIGN_WITHIN)];
    MAGNETS "faces always attract each other, by four pairs of dipoles at half of the way from the middle to the corners"
        Some("f = F / 4 (1 + d / δ)⁻⁴ between two of a pair at the distance d"); [N(&HOLD), N(&DEPTH), N(&REACH)];
    REJECTION "a block that is rejected leaves along the normal of the face"
        Some("v = J / m"); [N(&IMPULSE)];
    PUMP "open faces share the pump through the tree of blocks; resistances do not depend on the flow"
        Some("Δp = R Q on each way, flows into a chamber sum to none"); [N(&HEAD), Or(&OPENING, &BY_BLOCK), Or(&SUPPLY, &WITHOUT_SUPPLY), Or(&VALVE, &BY_ORIFICE), Or(&PASSAGE, &BY_VALVE)];
    OPENINGS "without `valve`, an open face is an orifice"
        Some("R_v = 24 η / D³ + 22.2 ρ Q / (π² D⁴)"); [] if has_orifice;
    SINK "an open face is a sink before a wall, whose flow takes blocks along"
        Some("u = Q / (2 π d²) towards the face"); [D(&DRAWN), D(&DRAWN_SPEED)];
    SEALING "a block that is close feels the pressure drop on its face"
        Some("within s, |f| = Δp a², half on the centre, the rest on the corners"); [Or(&SEAL, &BY_OPENING)];
    BREAKING_FORCE "a bond breaks if n blocks beyond it pull or shear with more than this force; the run ends"
        Some("n |m - ρ a³| g > B; no force if they press on their parent"); [N(&STRENGTH_FORCE)];
    BREAKING_TORQUE "a bond breaks if the blocks beyond it turn it with more than this torque; the run ends"
        Some("|Σ r × (m - ρ a³) g| > T_b; blocks that press with N on their parent bear N a / 2"); [N(&STRENGTH_TORQUE)];
    HOPS "a message needs this long from a block to its parent or child"
        None; [N(&HOP)];
    LOSSES "a hop may be lost, and so may its acknowledgement; without one the sender sends again"
        Some("a hop arrives with probability 1 - p; again after 2 h + 1 ticks"); [N(&LOSS)];
    DEAD_BLOCKS "a dead block bonds, does nothing, and leaves when its face is switched off"
        Some("each free block is dead with probability q, in the whole run"); [N(&DEAD)] if |s| s.faults.as_ref().is_some_and(|it| it.dead.is_some());
    LATCHES "a latch may fail: the block is released at once, and the face stays on"
        Some("a capture fails with probability ε"); [N(&LATCH)] if |s| s.faults.as_ref().is_some_and(|it| it.latch.is_some());
    ANCHOR_CENTRES "then the block is anchored, snaps onto the lattice and is fixed"
        Some("centres of the two faces < d, normals < α from opposite"); [Or(&ANCHOR, &BY_SEAL), Or(&ANCHOR_TILT, &BY_TILT)] if |s| anchors_by(s, Measure::Centres);
    ANCHOR_GAP "then the block is anchored, snaps onto the lattice and is fixed"
        Some("gap along the normal < d, aside < a / 2, normals < α from opposite"); [Or(&ANCHOR, &BY_SEAL), Or(&ANCHOR_TILT, &BY_TILT)] if |s| anchors_by(s, Measure::Gap);
    ANCHOR_CORNERS "then the block is anchored, snaps onto the lattice and is fixed"
        Some("each corner < d from its counterpart, normals < α from opposite"); [Or(&ANCHOR, &BY_SEAL), Or(&ANCHOR_TILT, &BY_TILT)] if |s| anchors_by(s, Measure::Corners);
    ANCHOR_SAMPLED "anchoring is tested at the end of each tick, not along the way"
        None; [] if |s| anchor(s).is_some_and(|anchor| anchor.sampled);
}
