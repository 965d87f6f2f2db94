//! Manifest: everything needed to repeat an ensemble exactly.
mod chosen;
mod error;
mod stored;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use stochc_estimate::{LowerBoundReasons, ProgramParts, Rates};
use stochc_ir::graph::EventGraph;
use stochc_ir::scene::Scene;
use stochc_ir::table::{Phase, PhaseId, Role, RoleId, Tables};
use stochc_ir::{Executable, JamRisk, sha256};
use stochc_runtime::{Model, Settings};

pub use chosen::{ChosenSetting, InvalidSetting};
pub use error::ManifestError;

use super::build::this_build;

/// Version of the layout of a results folder. No other version is read.
pub const FORMAT: u32 = 1;

/// Everything that determines an ensemble: `manifest.json` in its folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifest {
    /// Version of `stochc`.
    pub stochc: String,
    /// Settings of the computation.
    pub settings: Settings,
    /// Seed of every draw, together with the run number.
    pub seed: u64,
    /// Runs of each program. May grow, so it is not part of the identity.
    pub runs: u64,
    /// Builds that made its runs ([`super::this_build`]), in order of first use. Not part of the
    /// identity.
    pub builds: Vec<String>,
    /// Programs in the order of the command line.
    pub programs: Vec<EnsembleProgram>,
}

/// Program of an ensemble.
#[derive(Clone, Debug, PartialEq)]
pub struct EnsembleProgram {
    /// Name in tables, unique within its manifest.
    pub name: String,
    /// Compiled program. Points of a sweep may share it.
    pub compiled: Arc<Compiled>,
    /// Scene of the program.
    pub scene: Scene,
    /// Scene parameters changed by a sweep, in its order. Empty if all are as in the source.
    pub varied: Vec<Varied>,
    /// Settings selected by a sweep. All others are those of the manifest.
    pub chosen: Vec<ChosenSetting>,
    /// The program's file, followed by all imported files. Empty for a program that was read in
    /// compiled form.
    pub sources: Vec<Source>,
}

/// Compiled program without its scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Compiled {
    /// Event tables.
    pub tables: Tables,
    /// Dependency graph.
    pub graph: EventGraph,
    /// Risks of jamming, which the rate model does not include.
    pub jam_risks: Vec<JamRisk>,
    /// SHA-256 of the tables, in hexadecimal.
    digest: String,
}

/// Scene parameter changed by a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Varied {
    /// Name, such as `bond.pull`.
    pub of: String,
    /// Value in SI units.
    pub value: f64,
    /// Value in `unit`, as given by the user.
    pub said: f64,
    /// Unit as given by the user. Empty without unit.
    pub unit: String,
}

/// Source file of a program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// Path as given. Not part of the identity.
    pub path: String,
    /// Content of the file.
    pub text: String,
}

/// Largest number of runs of each program.
pub const MAX_RUNS: u64 = 10_000_000;

/// Largest number of programs that are compared in pairs.
pub const MAX_PROGRAMS: usize = 1_000;

/// Part of a manifest that determines a run with a given number.
#[derive(Serialize)]
struct Identity<'a> {
    format: u32,
    stochc: &'a str,
    settings: Settings,
    seed: u64,
    programs: Vec<ProgramIdentity<'a>>,
}

#[derive(Serialize)]
struct ProgramIdentity<'a> {
    name: &'a str,
    tables: &'a str,
    scene: &'a Scene,
    varied: &'a [Varied],
    #[serde(skip_serializing_if = "<[ChosenSetting]>::is_empty")]
    chosen: &'a [ChosenSetting],
    texts: Vec<&'a str>,
}

impl Manifest {
    /// Returns a manifest of this version and build of `stochc`.
    ///
    /// Equal names of programs are distinguished by a number: `tower`, `tower (2)`.
    pub fn new(
        settings: Settings,
        seed: u64,
        runs: u64,
        programs: Vec<EnsembleProgram>,
    ) -> Manifest {
        let mut manifest = Manifest {
            stochc: env!("CARGO_PKG_VERSION").to_owned(),
            settings,
            seed,
            runs,
            builds: vec![this_build()],
            programs,
        };
        for i in 1..manifest.programs.len() {
            let (earlier, rest) = manifest.programs.split_at_mut(i);
            let taken = |name: &str| earlier.iter().any(|program| program.name == name);
            let name = rest[0].name.clone();
            let mut copy = 2;
            while taken(&rest[0].name) {
                rest[0].name = format!("{name} ({copy})");
                copy += 1;
            }
        }
        manifest
    }

    /// Returns the number of runs of all programs.
    pub fn total(&self) -> u64 {
        self.runs.saturating_mul(self.programs.len() as u64)
    }

    /// Returns the message for a run number out of range.
    pub fn no_such_run(&self, run: u64) -> String {
        match self.runs {
            1 => format!("run {run} is not there: the only run is 0"),
            runs => format!("run {run} is not among runs 0..{}", runs.saturating_sub(1)),
        }
    }

    /// Returns the SHA-256, in hexadecimal, of everything that determines a run.
    ///
    /// Excludes paths, the number of runs and the number of threads.
    pub fn identity(&self) -> String {
        let identity = Identity {
            format: FORMAT,
            stochc: &self.stochc,
            settings: self.settings.resolved(),
            seed: self.seed,
            programs: self
                .programs
                .iter()
                .map(EnsembleProgram::identity)
                .collect(),
        };
        sha256(&identity)
    }

    /// Returns the SHA-256, in hexadecimal, of everything that determines the runs of one program.
    ///
    /// Excludes equivalent changes of its source, its name in the ensemble, and other programs.
    /// Includes the names in its tables and of its scene.
    pub fn runs_identity(&self, program: &EnsembleProgram) -> String {
        sha256(&(
            &self.stochc,
            self.settings_of(program).resolved(),
            self.seed,
            program.compiled.digest(),
            &program.scene,
        ))
    }

    /// Returns the differences that prevent runs of `other` from being added to this ensemble.
    pub fn differences(&self, other: &Manifest) -> Vec<String> {
        let mut found = Vec::new();
        let mut compare = |what: &str, there: &str, here: &str| {
            if there != here {
                found.push(format!("{what} is `{there}` there and `{here}` here"));
            }
        };
        let number = |n: u64| n.to_string();
        compare("the version", &self.stochc, &other.stochc);
        compare("the seed", &number(self.seed), &number(other.seed));
        for (what, there, here) in self.settings.differences(&other.settings) {
            compare(what, &there, &here);
        }
        let names = |of: &Manifest| {
            let names: Vec<_> = of.programs.iter().map(|p| p.name.as_str()).collect();
            names.join(", ")
        };
        compare("the list of programs", &names(self), &names(other));
        for (there, here) in self.programs.iter().zip(&other.programs) {
            if there.name == here.name {
                found.extend(there.difference(here));
            }
        }
        found
    }

    /// Checks the limits of sizes.
    ///
    /// # Errors
    ///
    /// If there is nothing to run, or more than the limits allow.
    pub fn within_limits(&self) -> Result<(), ManifestError> {
        if self.programs.is_empty() || self.runs == 0 {
            return Err(ManifestError::Empty);
        }
        if self.runs > MAX_RUNS {
            return Err(ManifestError::TooManyRuns(self.runs));
        }
        let mut together: BTreeMap<String, usize> = BTreeMap::new();
        for program in &self.programs {
            *together.entry(program.point()).or_default() += 1;
        }
        match together.into_values().max() {
            Some(count) if count > MAX_PROGRAMS => Err(ManifestError::TooManyPrograms(count)),
            _ => Ok(()),
        }
    }

    /// Returns the settings of the runs of one of its programs.
    ///
    /// # Panics
    ///
    /// If the program has a setting that [`ChosenSetting::new`] rejects.
    pub fn settings_of(&self, program: &EnsembleProgram) -> Cow<'_, Settings> {
        if program.chosen.is_empty() {
            return Cow::Borrowed(&self.settings);
        }
        let mut settings = self.settings.clone();
        for chosen in &program.chosen {
            let applied = chosen.apply(&mut settings);
            applied.expect("settings are checked when they are chosen or read");
        }
        if settings.model != Model::Rate {
            settings.rates.clear();
        }
        Cow::Owned(settings)
    }

    /// Returns whether runs of some program use this model.
    pub fn uses(&self, model: Model) -> bool {
        let mut programs = self.programs.iter();
        programs.any(|program| self.settings_of(program).model == model)
    }

    /// Returns whether a sweep varies settings.
    pub fn varies_settings(&self) -> bool {
        self.programs.iter().any(|it| !it.chosen.is_empty())
    }

    /// Returns the axes of a sweep.
    pub fn swept(&self) -> SweepAxes<'_> {
        let mut settings: Vec<&str> = Vec::new();
        for chosen in self.programs.iter().flat_map(|program| &program.chosen) {
            if !settings.contains(&chosen.of()) {
                settings.push(chosen.of());
            }
        }
        SweepAxes {
            numbers: self.axes(),
            settings,
        }
    }

    /// Returns the scene parameters that a sweep varies, in its order. Empty without a sweep.
    pub fn axes(&self) -> &[Varied] {
        let mut programs = self.programs.iter().map(|program| &program.varied[..]);
        programs
            .find(|varied| !varied.is_empty())
            .unwrap_or_default()
    }
}

/// Axes of a sweep.
#[derive(Clone, Debug, Default)]
pub struct SweepAxes<'a> {
    /// Scene parameters that the sweep varies.
    pub numbers: &'a [Varied],
    /// Names of the settings that the sweep varies.
    pub settings: Vec<&'a str>,
}

impl Varied {
    /// Returns the value as given by the user, such as `4.5 N`.
    pub fn value(&self) -> String {
        match &*self.unit {
            "" => self.said.to_string(),
            unit => format!("{} {unit}", self.said),
        }
    }

    /// Returns name and value, such as `bond.pull=4.5 N`.
    pub fn text(&self) -> String {
        format!("{}={}", self.of, self.value())
    }

    /// Returns the name of its column in tables, such as `scene_bond_pull`.
    pub fn column(&self) -> String {
        format!("scene_{}", self.of.replace('.', "_"))
    }
}

impl EnsembleProgram {
    /// Returns the values of the program's point, as appended to its name: ` [free=50, tick=10
    /// ms]`.
    pub fn point(&self) -> String {
        let numbers = self.varied.iter().map(Varied::text);
        bracketed(numbers.chain(self.chosen.iter().map(ChosenSetting::text)))
    }

    /// Returns whether the program is a point of a sweep.
    pub fn is_point(&self) -> bool {
        !(self.varied.is_empty() && self.chosen.is_empty())
    }

    /// Returns the name without the scene parameters of its point.
    pub fn name_without_numbers(&self) -> String {
        let settings = bracketed(self.chosen.iter().map(ChosenSetting::text));
        self.name.replace(&self.point(), &settings)
    }

    /// Returns the name without the settings of its point.
    pub fn name_without_settings(&self) -> String {
        let numbers = bracketed(self.varied.iter().map(Varied::text));
        self.name.replace(&self.point(), &numbers)
    }

    /// Returns the program as a point with these settings.
    #[must_use]
    pub fn at(&self, chosen: &[ChosenSetting]) -> EnsembleProgram {
        let mut point = EnsembleProgram {
            chosen: chosen.to_vec(),
            ..self.clone()
        };
        point.name += &point.point();
        point
    }

    /// Returns the value of a setting that a sweep has selected.
    pub fn chosen_value(&self, of: &str) -> Option<&str> {
        let mut chosen = self.chosen.iter();
        chosen.find(|it| it.of() == of).map(ChosenSetting::value)
    }

    /// Returns the program's value on an axis of a sweep, in the unit of the axis. Returns `None`
    /// if the program is not a point of it.
    pub fn on_axis(&self, axis: &Varied) -> Option<f64> {
        let mut varied = self.varied.iter();
        let here = varied.find(|varied| varied.of == axis.of && varied.unit == axis.unit);
        here.map(|varied| varied.said)
    }

    /// Returns a compiled program. `sources` are its file and then all imports.
    pub fn new(name: &str, sources: Vec<Source>, executable: Executable) -> EnsembleProgram {
        let Executable {
            tables,
            scene,
            graph,
            jam_risks,
        } = executable;
        EnsembleProgram {
            name: name.to_owned(),
            compiled: Arc::new(Compiled::new(tables, graph, jam_risks)),
            scene,
            varied: Vec::new(),
            chosen: Vec::new(),
            sources,
        }
    }

    /// Returns the parts that the estimate requires.
    pub fn parts(&self) -> ProgramParts<'_> {
        ProgramParts {
            tables: &self.compiled.tables,
            graph: &self.compiled.graph,
            scene: &self.scene,
            jam_risks: &self.compiled.jam_risks,
        }
    }

    /// Returns the reasons why the program's times by the rate model are lower bounds.
    pub fn lower_bound(&self, rates: &Rates) -> LowerBoundReasons {
        let blocks = self.compiled.graph.largest_structure();
        LowerBoundReasons::new(&self.compiled.jam_risks, rates, blocks)
    }

    /// Returns the event tables.
    pub fn tables(&self) -> &Tables {
        &self.compiled.tables
    }

    /// Returns the name of its assembly.
    pub fn assembly(&self) -> &str {
        &self.tables().assembly
    }

    /// Returns the number of captures, or of blocks of an aggregate: the paper's "total units
    /// involved".
    pub fn captures(&self) -> u64 {
        let tables = self.tables();
        tables.aggregate.map_or(tables.captures() as u64, u64::from)
    }

    /// Returns the phases of the program, by [`PhaseId`].
    pub fn phases(&self) -> &[Phase] {
        &self.tables().phases
    }

    /// Returns the roles of the program, by [`RoleId`].
    pub fn roles(&self) -> &[Role] {
        &self.tables().roles
    }

    /// Returns the name of a phase, or `?` for an unknown one.
    pub fn phase(&self, phase: PhaseId) -> &str {
        self.phases()
            .get(phase.0 as usize)
            .map_or("?", |phase| &phase.name)
    }

    /// Returns whether a phase consists of pre-attached blocks.
    pub fn is_planted(&self, phase: PhaseId) -> bool {
        self.phases()
            .get(phase.0 as usize)
            .is_some_and(|phase| phase.planted)
    }

    /// Returns the name of a role, or `?` for an unknown one.
    pub fn role(&self, role: RoleId) -> &str {
        self.roles()
            .get(role.0 as usize)
            .map_or("?", |role| &role.name)
    }

    /// Returns the SHA-256, in hexadecimal, of its source, all imports, and its scene. Excludes
    /// paths and its name in tables.
    pub fn hash(&self) -> String {
        sha256(&ProgramIdentity {
            name: "",
            ..self.identity()
        })
    }

    fn identity(&self) -> ProgramIdentity<'_> {
        ProgramIdentity {
            name: &self.name,
            tables: &self.compiled.digest,
            scene: &self.scene,
            varied: &self.varied,
            chosen: &self.chosen,
            texts: self.sources.iter().map(|s| s.text.as_str()).collect(),
        }
    }

    fn difference(&self, other: &EnsembleProgram) -> Option<String> {
        let (there, here) = (self.identity(), other.identity());
        let what = if there.texts != here.texts {
            "the text"
        } else if there.scene != here.scene || there.varied != here.varied {
            "the scene"
        } else if there.chosen != here.chosen {
            "the setting"
        } else if self.assembly() != other.assembly() {
            "the assembly"
        } else if there.tables != here.tables {
            "what the compiler makes"
        } else {
            return None;
        };
        Some(format!("{what} of `{}` has changed", self.name))
    }
}

/// Returns the values of a point as appended to the name of its program.
fn bracketed(values: impl Iterator<Item = String>) -> String {
    let values: Vec<String> = values.collect();
    if values.is_empty() {
        String::new()
    } else {
        format!(" [{}]", values.join(", "))
    }
}

impl Compiled {
    /// Returns a compiled program from tables and graph.
    pub fn new(tables: Tables, graph: EventGraph, jam_risks: Vec<JamRisk>) -> Compiled {
        let digest = sha256(&tables);
        Compiled {
            tables,
            graph,
            jam_risks,
            digest,
        }
    }

    /// Returns the SHA-256 of the tables, in hexadecimal. Equal programs have equal digests.
    pub fn digest(&self) -> &str {
        &self.digest
    }
}
