//! How a run is computed: the model and its accuracy, which are never the scene's.
use serde::{Deserialize, Serialize};
use stochc_ir::scene::warnings::Stepping;
use stochc_ir::scene::{Scene, Substeps};
use stochc_ir::sha256;
use stochc_rates::Rates;

/// Everything about a run that is neither in the program nor in the scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Settings {
    /// What moves the blocks.
    pub model: Model,
    /// Steps of the model per tick, at least 1; default [`Substeps::DEFAULT`].
    ///
    /// More resolve contacts and docking better and cost proportionally more.
    ///
    /// With `away`, those of blocks near magnetized faces.
    pub substeps: u32,
    /// Steps per tick of blocks that are not near a magnetized face, of which `substeps` is a multiple; `None`: as many
    /// as near one. For `rigid` only: `rapier` takes the short steps everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub away: Option<u32>,
    /// How hard contacts are worked on in a substep; `None`: [`Settings::iterations`] of the model.
    ///
    /// For `rapier` that is its `num_solver_iterations`, internal steps that also make contacts
    /// stiffer; for `rigid` the most rounds over contacts that still change.
    pub solver_iterations: Option<u32>,
    /// Digits of the physics; `rapier` has single precision only.
    #[serde(default, skip_serializing_if = "Precision::is_single")]
    pub precision: Precision,
    /// What `rigid` leaves out, though the scene has it; `None`: nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduction: Option<Reduction>,
    /// Of [`Model::Rate`], what was measured of the scenes, but for those of which [`Rates::built_in`] are meant.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rates: Vec<Rates>,
    /// Ticks after which a run is given up; `None`, the default: never.
    pub max_ticks: Option<u64>,
}

/// Rounds over contacts that `rigid` makes at most, if nothing else is said.
pub(crate) const ROUNDS: u32 = 10;

/// What moves the blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// Full rigid bodies by a kernel of our own for dilute suspensions; the default.
    Rigid,
    /// The same by the engine Rapier, in single precision: a second opinion.
    Rapier,
    /// No motion: waits are drawn by rates that were measured with `rigid`.
    Rate,
    /// No physics: one random capture a tick. It tests protocols; its times mean nothing.
    Shuffle,
}

/// What may be said of how runs are computed, and not every model has a use for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// [`Settings::steps`].
    Steps,
    /// [`Settings::solver_iterations`].
    SolverIterations,
    /// [`Settings::precision`].
    Precision,
    /// [`Settings::reduction`].
    Reduction,
    /// [`Settings::rates`].
    Rates,
}

/// Digits of the physics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// 24 bits.
    #[default]
    Single,
    /// 53 bits.
    Double,
}

/// A term that a scene has and a cheaper model leaves out, to see what it is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reduction {
    /// Blocks never turn.
    NoRotation,
    /// Blocks touch as balls whose diameter is the side of a block.
    Spheres,
    /// Contacts do not hold sideways.
    NoFriction,
    /// Free blocks pass through each other, though not through structure and ground.
    NoBlockContact,
}

impl Model {
    /// All of them, the default first.
    pub const ALL: [Model; 4] = [Model::Rigid, Model::Rapier, Model::Rate, Model::Shuffle];

    /// Whether blocks have places, and move.
    pub const fn has_places(self) -> bool {
        matches!(self, Model::Rigid | Model::Rapier)
    }

    /// Whether the state of a run can be saved and restored. The engine of `rapier` would restore it without validation.
    pub const fn has_state(self) -> bool {
        !matches!(self, Model::Rapier)
    }

    /// Its name on the command line and in a manifest.
    pub const fn name(self) -> &'static str {
        match self {
            Model::Rapier => "rapier",
            Model::Rigid => "rigid",
            Model::Rate => "rate",
            Model::Shuffle => "shuffle",
        }
    }

    /// What it is, in a line.
    pub const fn meaning(self) -> &'static str {
        match self {
            Model::Rapier => "Rigid bodies by the general engine Rapier",
            Model::Rigid => {
                "Rigid bodies by our own kernel, fast for many blocks that rarely touch"
            }
            Model::Rate => {
                "No motion: waits drawn by rates that were measured with `rigid`, thousands of times faster"
            }
            Model::Shuffle => {
                "No physics: one random capture in each tick, to try out event tables"
            }
        }
    }

    /// Whether a setting changes anything for it.
    pub const fn uses(self, setting: Setting) -> bool {
        match self {
            Model::Rigid => !matches!(setting, Setting::Rates),
            Model::Rapier => matches!(setting, Setting::Steps | Setting::SolverIterations),
            Model::Rate => matches!(setting, Setting::Rates),
            Model::Shuffle => false,
        }
    }

    /// The first of these settings of which it has no use.
    pub fn unused(self, given: impl IntoIterator<Item = Setting>) -> Option<Setting> {
        given.into_iter().find(|&setting| !self.uses(setting))
    }
}

impl Reduction {
    /// Its name on the command line and in a manifest.
    pub const fn name(self) -> &'static str {
        match self {
            Reduction::NoRotation => "no-rotation",
            Reduction::Spheres => "spheres",
            Reduction::NoFriction => "no-friction",
            Reduction::NoBlockContact => "no-block-contact",
        }
    }

    /// What is left out, in a line.
    pub const fn meaning(self) -> &'static str {
        match self {
            Reduction::NoRotation => "Blocks never turn",
            Reduction::Spheres => "Blocks collide as spheres",
            Reduction::NoFriction => "Contacts have no friction",
            Reduction::NoBlockContact => "Free blocks pass through each other",
        }
    }

    /// All of them.
    pub const ALL: [Reduction; 4] = [
        Reduction::NoRotation,
        Reduction::Spheres,
        Reduction::NoFriction,
        Reduction::NoBlockContact,
    ];
}

impl Precision {
    /// Both of them.
    pub const ALL: [Precision; 2] = [Precision::Single, Precision::Double];

    /// Its name on the command line and in a manifest.
    pub const fn name(self) -> &'static str {
        match self {
            Precision::Single => "single",
            Precision::Double => "double",
        }
    }

    /// What it is, in a line.
    pub const fn meaning(self) -> &'static str {
        match self {
            Precision::Single => "32-bit floating point",
            Precision::Double => "64-bit floating point",
        }
    }

    /// Whether it is what is not written down.
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "called by serde")]
    fn is_single(&self) -> bool {
        *self == Precision::Single
    }
}

impl Settings {
    /// So many steps per tick of a model, and nothing else out of the ordinary.
    pub const fn new(model: Model, substeps: u32) -> Settings {
        Settings {
            model,
            substeps,
            away: None,
            solver_iterations: None,
            precision: Precision::Single,
            reduction: None,
            rates: Vec::new(),
            max_ticks: None,
        }
    }

    /// The same with so many steps per tick.
    #[must_use]
    pub fn with_steps(self, Substeps { near, away }: Substeps) -> Settings {
        Settings {
            substeps: near,
            away,
            ..self
        }
    }

    /// The steps per tick that blocks of a scene take.
    pub fn steps_in(&self, scene: &Scene) -> Substeps {
        let steps = self.steps();
        match self.model {
            Model::Rigid => steps.in_scene(scene),
            _ => Substeps {
                away: None,
                ..steps
            },
        }
    }

    /// The steps and digits of runs with physics. `None`: the model has none.
    pub fn stepping(&self) -> Option<Stepping> {
        let steps = match self.model {
            Model::Rigid => self.steps(),
            _ => Substeps {
                away: None,
                ..self.steps()
            },
        };
        let smallest_turn = match (self.model, self.precision) {
            (Model::Rapier, _) => Stepping::RAPIER,
            (_, Precision::Single) => Stepping::SINGLE,
            (_, Precision::Double) => 0.0,
        };
        self.model.has_places().then_some(Stepping {
            steps,
            smallest_turn,
        })
    }

    /// The steps per tick that are asked for.
    pub fn steps(&self) -> Substeps {
        Substeps {
            near: self.substeps,
            away: self.away,
        }
    }

    /// Those that are not as usual.
    pub fn chosen(&self) -> impl Iterator<Item = Setting> {
        let chosen = [
            (Setting::Steps, self.steps() != Substeps::DEFAULT),
            (Setting::SolverIterations, self.solver_iterations.is_some()),
            (Setting::Precision, self.precision != Precision::default()),
            (Setting::Reduction, self.reduction.is_some()),
            (Setting::Rates, !self.rates.is_empty()),
        ];
        let chosen = chosen.into_iter().filter(|&(_, is_chosen)| is_chosen);
        chosen.map(|(setting, _)| setting)
    }

    /// How hard contacts are worked on: 4 for `rapier`, its own default, and 10 for `rigid`.
    pub fn iterations(&self) -> u32 {
        let usual = match self.model {
            Model::Rapier => 4,
            Model::Rigid | Model::Rate | Model::Shuffle => ROUNDS,
        };
        self.solver_iterations.unwrap_or(usual).max(1)
    }

    /// The same, with everything said that goes without saying: two settings compute the same if these are equal.
    #[must_use]
    pub fn resolved(&self) -> Settings {
        let local = |&away: &u32| away != self.substeps && self.model == Model::Rigid;
        Settings {
            away: self.away.filter(local),
            solver_iterations: Some(self.iterations()),
            ..self.clone()
        }
    }

    /// What is set otherwise in `other`: what it is, and its values here and there, in words.
    pub fn differences(&self, other: &Settings) -> Vec<(&'static str, String, String)> {
        let limit = |of: &Settings| of.max_ticks.map_or("none".to_owned(), |n| n.to_string());
        let reduction = |of: &Settings| of.reduction.map_or("none", Reduction::name).to_owned();
        let rates = |of: &Settings| match of.rates.as_slice() {
            [] => "none".to_owned(),
            rates => sha256(&rates)[..8].to_owned(),
        };
        let values = |of: &Settings| {
            [
                (None, "the model", of.model.name().to_owned()),
                (
                    Some(Setting::Steps),
                    "the number of substeps",
                    of.steps().to_string(),
                ),
                (None, "the limit of ticks", limit(of)),
                (
                    Some(Setting::SolverIterations),
                    "`solver-iterations`",
                    of.iterations().to_string(),
                ),
                (
                    Some(Setting::Precision),
                    "`precision`",
                    of.precision.name().to_owned(),
                ),
                (Some(Setting::Reduction), "`reduce`", reduction(of)),
                (
                    Some(Setting::Rates),
                    "the fingerprint of the rates",
                    rates(of),
                ),
            ]
        };
        // What only one of two models has a use for comes with the model; the rest every model uses.
        let is_same = self.model == other.model;
        let uses = |setting| self.model.uses(setting) && other.model.uses(setting);
        let counts = |setting: Option<Setting>| is_same || setting.is_none_or(uses);
        let pairs = values(self).into_iter().zip(values(other));
        let differ =
            pairs.filter(|((setting, _, here), (_, _, there))| counts(*setting) && here != there);
        differ
            .map(|((_, what, here), (_, _, there))| (what, here, there))
            .collect()
    }
}

impl Default for Settings {
    fn default() -> Settings {
        Settings::new(Model::Rigid, 1).with_steps(Substeps::DEFAULT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_of_other_models_differ_in_what_both_use() {
        let of = |model: Model| {
            Settings {
                model,
                ..Settings::default()
            }
            .resolved()
        };
        let named = |one: Model, other: Model| -> Vec<&str> {
            let found = of(one).differences(&of(other));
            found.iter().map(|(what, _, _)| *what).collect()
        };
        assert_eq!(named(Model::Rigid, Model::Shuffle), ["the model"]);
        assert_eq!(named(Model::Rigid, Model::Rate), ["the model"]);
        let both = ["the model", "the number of substeps", "`solver-iterations`"];
        assert_eq!(named(Model::Rigid, Model::Rapier), both);
        let double = Settings {
            precision: Precision::Double,
            ..of(Model::Shuffle)
        };
        let found = of(Model::Shuffle).differences(&double);
        assert_eq!(
            found.len(),
            1,
            "it is an ensemble of its own, and that is said"
        );
    }
}
