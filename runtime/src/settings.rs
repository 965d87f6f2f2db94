//! Settings of the computation: the model and its accuracy, which are not part of the scene.
use serde::{Deserialize, Serialize};
use stochc_estimate::Rates;
use stochc_ir::scene::warnings::Stepping;
use stochc_ir::scene::{Scene, Substeps};
use stochc_ir::sha256;

/// Settings of a run that are neither in the program nor in the scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Settings {
    /// Model of block motion.
    pub model: Model,
    /// Steps of the model per tick, at least 1. The default is [`Substeps::DEFAULT`].
    ///
    /// More steps resolve contacts and captures better, at proportional cost.
    ///
    /// If `away` is set, applies only to blocks near open faces.
    pub substeps: u32,
    /// Steps per tick of blocks away from open faces. `None` if equal to `substeps`.
    ///
    /// `substeps` must be a multiple of this number. Only `rigid` uses this setting; `rapier` takes
    /// the short steps everywhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub away: Option<u32>,
    /// Effort of the contact solver per substep. `None` selects [`Settings::iterations`] of the
    /// model.
    ///
    /// For `rapier`, this is the engine's `num_solver_iterations`: the number of internal steps.
    /// More internal steps also make contacts stiffer. For `rigid`, this is the largest number of
    /// solver rounds. A round visits the contacts whose impulses may still change.
    pub solver_iterations: Option<u32>,
    /// Floating-point precision. `rapier` has single precision only.
    #[serde(default, skip_serializing_if = "Precision::is_single")]
    pub precision: Precision,
    /// Term that `rigid` leaves out although the scene has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reduction: Option<Reduction>,
    /// Calibrated rates for [`Model::Rate`]. Scenes not listed use [`Rates::built_in`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rates: Vec<Rates>,
    /// Ticks after which a run is right-censored. `None`, the default, sets no limit.
    pub max_ticks: Option<u64>,
}

/// Default limit of solver rounds in model `rigid`.
pub(crate) const ROUNDS: u32 = 10;

/// Model of block motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    /// Rigid bodies by a custom kernel for dilute suspensions. The default.
    Rigid,
    /// Rigid bodies by the engine Rapier, in single precision. An independent check.
    Rapier,
    /// No motion: waiting times are drawn from rates calibrated with `rigid`.
    Rate,
    /// No physics: one random capture per tick. For testing protocols; its times are meaningless.
    Shuffle,
    /// No model: the runs were measured in an experiment.
    Measured,
}

/// Setting that only some models use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// The setting [`Settings::steps`].
    Steps,
    /// The setting [`Settings::solver_iterations`].
    SolverIterations,
    /// The setting [`Settings::precision`].
    Precision,
    /// The setting [`Settings::reduction`].
    Reduction,
    /// The setting [`Settings::rates`].
    Rates,
}

/// Floating-point precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Precision {
    /// 24-bit significand.
    #[default]
    Single,
    /// 53-bit significand.
    Double,
}

/// Physical term to leave out, to measure its effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reduction {
    /// Blocks never rotate.
    Rotation,
    /// Blocks collide as spheres whose diameter is the block length.
    Corners,
    /// Contacts have no friction.
    Friction,
    /// Free blocks pass through each other, but not through the structure and the ground.
    BlockContact,
}

impl Model {
    /// All models that can simulate runs. The default comes first.
    pub const ALL: [Model; 4] = [Model::Rigid, Model::Rapier, Model::Rate, Model::Shuffle];

    /// Returns whether blocks have positions.
    pub const fn has_places(self) -> bool {
        matches!(self, Model::Rigid | Model::Rapier)
    }

    /// Returns whether the state of a run can be saved and restored. The engine of `rapier` would
    /// restore it without validation.
    pub const fn has_state(self) -> bool {
        !matches!(self, Model::Rapier)
    }

    /// Returns the name on the command line and in manifests.
    pub const fn name(self) -> &'static str {
        match self {
            Model::Rapier => "rapier",
            Model::Rigid => "rigid",
            Model::Rate => "rate",
            Model::Shuffle => "shuffle",
            Model::Measured => "measured",
        }
    }

    /// Returns a one-line description.
    pub const fn meaning(self) -> &'static str {
        match self {
            Model::Rapier => "Rigid bodies, computed by the physics engine Rapier",
            Model::Rigid => {
                "Rigid bodies, computed by stochc. Fast for many blocks that rarely touch"
            }
            Model::Rate => {
                "No motion. Waiting times are drawn from rates that were measured with `rigid`. Thousands of times faster"
            }
            Model::Shuffle => "No physics. Each tick has one random capture, to test event tables",
            Model::Measured => "No model. The runs were measured in an experiment",
        }
    }

    /// Returns whether a setting affects this model.
    pub const fn uses(self, setting: Setting) -> bool {
        match self {
            Model::Rigid => !matches!(setting, Setting::Rates),
            Model::Rapier => matches!(setting, Setting::Steps | Setting::SolverIterations),
            Model::Rate => matches!(setting, Setting::Rates),
            Model::Shuffle | Model::Measured => false,
        }
    }

    /// Returns the first of these settings that this model does not use.
    pub fn unused(self, given: impl IntoIterator<Item = Setting>) -> Option<Setting> {
        given.into_iter().find(|&setting| !self.uses(setting))
    }
}

impl Reduction {
    /// Returns the name on the command line and in manifests.
    pub const fn name(self) -> &'static str {
        match self {
            Reduction::Rotation => "rotation",
            Reduction::Corners => "corners",
            Reduction::Friction => "friction",
            Reduction::BlockContact => "block-contact",
        }
    }

    /// Returns a one-line description.
    pub const fn meaning(self) -> &'static str {
        match self {
            Reduction::Rotation => "Blocks never turn",
            Reduction::Corners => "Blocks collide as spheres",
            Reduction::Friction => "Contacts have no friction",
            Reduction::BlockContact => "Free blocks pass through each other",
        }
    }

    /// All reductions.
    pub const ALL: [Reduction; 4] = [
        Reduction::Rotation,
        Reduction::Corners,
        Reduction::Friction,
        Reduction::BlockContact,
    ];
}

impl Precision {
    /// All precisions.
    pub const ALL: [Precision; 2] = [Precision::Single, Precision::Double];

    /// Returns the name on the command line and in manifests.
    pub const fn name(self) -> &'static str {
        match self {
            Precision::Single => "single",
            Precision::Double => "double",
        }
    }

    /// Returns a one-line description.
    pub const fn meaning(self) -> &'static str {
        match self {
            Precision::Single => "32-bit floating point",
            Precision::Double => "64-bit floating point",
        }
    }

    /// Returns whether this is the default, which is not serialized.
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "called by serde")]
    fn is_single(&self) -> bool {
        *self == Precision::Single
    }
}

impl Settings {
    /// Returns default settings for a model with this number of steps per tick.
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

    /// Returns the settings with this number of steps per tick.
    #[must_use]
    pub fn with_steps(self, Substeps { near, away }: Substeps) -> Settings {
        Settings {
            substeps: near,
            away,
            ..self
        }
    }

    /// Returns the numbers of steps per tick that the model uses for a scene.
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

    /// Returns the steps per tick and the precision, or `None` for models without physics.
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

    /// Returns the requested steps per tick.
    pub fn steps(&self) -> Substeps {
        Substeps {
            near: self.substeps,
            away: self.away,
        }
    }

    /// Returns the settings that differ from their defaults.
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

    /// Returns the solver iterations: by default 4 for `rapier`, as in that engine, and 10 for
    /// `rigid`.
    pub fn iterations(&self) -> u32 {
        let usual = match self.model {
            Model::Rapier => 4,
            Model::Rigid | Model::Rate | Model::Shuffle | Model::Measured => ROUNDS,
        };
        self.solver_iterations.unwrap_or(usual).max(1)
    }

    /// Returns the settings with all defaults filled in. Two settings give the same runs if the
    /// results of this function are equal.
    #[must_use]
    pub fn resolved(&self) -> Settings {
        let local = |&away: &u32| away != self.substeps && self.model == Model::Rigid;
        Settings {
            away: self.away.filter(local),
            solver_iterations: Some(self.iterations()),
            ..self.clone()
        }
    }

    /// Returns the differences to `other`: the name of each setting and its two values, as text.
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
                (Some(Setting::Reduction), "`without`", reduction(of)),
                (
                    Some(Setting::Rates),
                    "the fingerprint of the rates",
                    rates(of),
                ),
            ]
        };
        // If the models differ, compare only settings that both models use.
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
    fn only_shared_settings_are_compared_between_models() {
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
