//! What has to be known to rerun an ensemble exactly.
use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use stochc_compiler::{Checked, Levels, Limits, check_changed};
use stochc_ir::scene::Scene;
use stochc_ir::scene::scalars::Change;
use stochc_ir::table::{Action, PLANTED, PhaseId, RoleId, Tables};

use super::build::this_build;

/// Version of the layout of a results folder; another one is not read.
///
/// In 1 a run left nothing of the waits under way when it ended, of its releases and of its unplanned bonds.
pub const FORMAT: u32 = 2;

/// The oldest layout whose manifest says all that is needed to make the runs again.
const OLDEST: u32 = 1;

/// Everything that an ensemble depends on; `manifest.json` in its folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Of the folder: [`FORMAT`], or an older one.
    pub format: u32,
    /// Version of the `stochc` that simulates.
    pub stochc: String,
    /// The physical model, such as `rapier`.
    pub model: String,
    /// Substeps of the engine within one tick.
    pub substeps: u32,
    /// The seed of every draw; the number of the run and of the program's scene do the rest.
    pub seed: u64,
    /// Runs of each program; may grow, so that it is no part of the identity.
    pub runs: u64,
    /// Ticks after which a run is stopped and its time censored; `None`: never.
    pub max_ticks: Option<u64>,
    /// Further settings that results depend on, by name.
    pub settings: BTreeMap<String, String>,
    /// The builds that made its runs ([`super::this_build`]), the first one first; empty: it is older than
    /// such notes. No part of the identity.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub builds: Vec<String>,
    /// The programs, in the order of the command line.
    pub programs: Vec<Program>,
}

/// One program of an ensemble.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Program {
    /// What tables call it; unique within its manifest.
    pub name: String,
    /// The name of its assembly.
    pub assembly: String,
    /// Captures in the program, or blocks of an aggregate: the paper's "total units involved".
    pub captures: u64,
    /// The world it runs in.
    pub scene: Scene,
    /// The numbers of this world that are not those of the sources, in the order of the sweep that
    /// chose them; empty: all are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub varied: Vec<Varied>,
    /// The names of its phases, by [`PhaseId`].
    pub phases: Vec<String>,
    /// The names of its roles, by [`RoleId`].
    pub roles: Vec<String>,
    /// Its file, followed by every file that it imports.
    pub sources: Vec<Source>,
}

/// A number of a scene that a sweep has chosen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Varied {
    /// Its name, such as `bond.pull`.
    pub of: String,
    /// Its value in SI units.
    pub value: f64,
    /// Its value in `unit`.
    pub said: f64,
    /// The unit that the user has given it in; empty: none.
    pub unit: String,
}

/// A file that a program was read from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// As it was given; no part of the identity.
    pub path: String,
    /// All of it.
    pub text: String,
}

/// The part of a manifest that decides what a run with a given number does.
#[derive(Serialize)]
struct Identity<'a> {
    format: u32,
    stochc: &'a str,
    model: &'a str,
    substeps: u32,
    seed: u64,
    max_ticks: Option<u64>,
    settings: &'a BTreeMap<String, String>,
    programs: Vec<ProgramIdentity<'a>>,
}

#[derive(Serialize)]
struct ProgramIdentity<'a> {
    name: &'a str,
    assembly: &'a str,
    captures: u64,
    scene: &'a Scene,
    phases: &'a [String],
    roles: &'a [String],
    texts: Vec<&'a str>,
}

impl Manifest {
    /// A manifest of this version of `stochc`, with one substep and no limit, for others to fill in.
    ///
    /// Programs of the same name are told apart by a number: `tower`, `tower (2)`.
    pub fn new(model: &str, seed: u64, runs: u64, programs: Vec<Program>) -> Manifest {
        let mut manifest = Manifest {
            format: FORMAT,
            stochc: env!("CARGO_PKG_VERSION").to_owned(),
            model: model.to_owned(),
            substeps: 1,
            seed,
            runs,
            max_ticks: None,
            settings: BTreeMap::new(),
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

    /// Runs of all programs together.
    pub fn total(&self) -> u64 {
        self.runs.saturating_mul(self.programs.len() as u64)
    }

    /// What is told to somebody who asks for a run that is not asked for here.
    pub fn no_such_run(&self, run: u64) -> String {
        match self.runs {
            1 => format!("run {run} is not there: the only run is 0"),
            runs => format!("run {run} is not among runs 0..{}", runs.saturating_sub(1)),
        }
    }

    /// SHA-256, in hexadecimal, of all that decides what a run does.
    ///
    /// Paths, the number of runs and the number of threads are no part of it.
    pub fn identity(&self) -> String {
        let identity = Identity {
            format: self.format,
            stochc: &self.stochc,
            model: &self.model,
            substeps: self.substeps,
            seed: self.seed,
            max_ticks: self.max_ticks,
            settings: &self.settings,
            programs: self.programs.iter().map(Program::identity).collect(),
        };
        sha256(&identity)
    }

    /// What keeps runs of `other` from going on in an ensemble of `self`, in words; empty: nothing.
    pub fn differences(&self, other: &Manifest) -> Vec<String> {
        let mut found = Vec::new();
        let mut compare = |what: &str, there: &str, here: &str| {
            if there != here {
                found.push(format!("{what} is `{there}` there and `{here}` here"));
            }
        };
        let limit = |ticks: Option<u64>| ticks.map_or("none".to_owned(), |n| n.to_string());
        let number = |n: u64| n.to_string();
        compare("the version", &self.stochc, &other.stochc);
        compare("the model", &self.model, &other.model);
        compare("the seed", &number(self.seed), &number(other.seed));
        compare(
            "the number of substeps",
            &number(self.substeps.into()),
            &number(other.substeps.into()),
        );
        compare(
            "the limit of ticks",
            &limit(self.max_ticks),
            &limit(other.max_ticks),
        );
        let names: BTreeMap<_, _> = self.settings.iter().chain(&other.settings).collect();
        for name in names.into_keys() {
            let value = |of: &Manifest| of.settings.get(name).cloned().unwrap_or("unset".into());
            compare(&format!("`{name}`"), &value(self), &value(other));
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

    /// The text of `manifest.json`, which ends in a line break.
    pub fn to_json(&self) -> String {
        let mut json = serde_json::to_string_pretty(self).expect("a manifest is plain data");
        json.push('\n');
        json
    }

    /// Reads the text of a `manifest.json`, also of an older [`FORMAT`]: it still says all that is needed to
    /// make the runs again, though not how to read what they left.
    ///
    /// # Errors
    /// In words, when it is no manifest or one of an unknown format.
    pub fn from_json(json: &str) -> Result<Manifest, String> {
        #[derive(Deserialize)]
        struct Version {
            format: u32,
        }
        let Version { format } =
            serde_json::from_str(json).map_err(|_| "it is not the manifest of an ensemble")?;
        if !(OLDEST..=FORMAT).contains(&format) {
            return Err(format!("its format is {format}, and this is {FORMAT}"));
        }
        serde_json::from_str(json).map_err(|error| format!("it is damaged, {error}"))
    }

    /// The numbers of the scene that a sweep varies, in its order; empty: it is no sweep.
    pub fn axes(&self) -> &[Varied] {
        let mut programs = self.programs.iter().map(|program| &program.varied[..]);
        programs
            .find(|varied| !varied.is_empty())
            .unwrap_or_default()
    }
}

impl Varied {
    /// Its value as the user has given it, such as `4.5 N`.
    pub fn value(&self) -> String {
        match &*self.unit {
            "" => self.said.to_string(),
            unit => format!("{} {unit}", self.said),
        }
    }

    /// Name and value, such as `bond.pull=4.5 N`.
    pub fn text(&self) -> String {
        format!("{}={}", self.of, self.value())
    }
}

impl Program {
    /// What a sweep has chosen, as it is told behind the program's name: ` [free=50, tick=10 ms]`.
    pub fn point(&self) -> String {
        let values: Vec<String> = self.varied.iter().map(Varied::text).collect();
        match values.is_empty() {
            true => String::new(),
            false => format!(" [{}]", values.join(", ")),
        }
    }

    /// Compiles the sources again, with the numbers that are varied, and tells the path of the first.
    pub fn recompile(&self, levels: &Levels) -> (&str, Checked) {
        let mut reader = |path: &str| {
            let source = self.sources.iter().find(|source| source.path == path);
            source
                .map(|source| source.text.as_bytes().to_vec())
                .ok_or("not in the manifest".to_owned())
        };
        let root = self.sources.first().map_or("", |source| &source.path);
        let changes: Vec<Change> = (self.varied.iter())
            .map(|varied| Change {
                of: varied.of.clone(),
                value: varied.value,
            })
            .collect();
        let limits = Limits::default();
        let mut checked =
            check_changed(root, &mut reader, limits, levels, &self.assembly, &changes);
        crate::orders::try_out(&mut checked);
        (root, checked)
    }

    /// Whether a compiled program is the one that is described here.
    pub fn describes(&self, tables: &Tables, scene: &Scene) -> bool {
        tables.assembly == self.assembly
            && *scene == self.scene
            && (tables.phases.iter().map(|phase| &phase.name)).eq(&self.phases)
            && (tables.roles.iter().map(|role| &role.name)).eq(&self.roles)
    }

    /// Describes a compiled program: its file first among `sources`, then all that it imports.
    pub fn new(name: &str, sources: Vec<Source>, scene: Scene, tables: &Tables) -> Program {
        let captures = tables
            .duties()
            .flat_map(|duty| duty.rules())
            .filter(|rule| matches!(rule.then, Action::Magnetize { .. }))
            .count();
        Program {
            name: name.to_owned(),
            assembly: tables.assembly.clone(),
            captures: tables.aggregate.map_or(captures as u64, u64::from),
            scene,
            varied: Vec::new(),
            phases: tables.phases.iter().map(|p| p.name.clone()).collect(),
            roles: tables.roles.iter().map(|r| r.name.clone()).collect(),
            sources,
        }
    }

    /// The name of a phase; `?` for one that the program does not have.
    pub fn phase(&self, phase: PhaseId) -> &str {
        self.phases.get(phase.0 as usize).map_or("?", |name| name)
    }

    /// Whether the blocks of a phase are attached by hand before the first tick.
    pub fn is_planted(&self, phase: PhaseId) -> bool {
        self.phase(phase) == PLANTED
    }

    /// The name of a role; `?` for one that the program does not have.
    pub fn role(&self, role: RoleId) -> &str {
        self.roles.get(role.0 as usize).map_or("?", |name| name)
    }

    /// SHA-256, in hexadecimal, of its text, all that it imports, and its scene; paths, and what
    /// tables call it, are no part of it.
    pub fn hash(&self) -> String {
        sha256(&ProgramIdentity {
            name: "",
            ..self.identity()
        })
    }

    fn identity(&self) -> ProgramIdentity<'_> {
        ProgramIdentity {
            name: &self.name,
            assembly: &self.assembly,
            captures: self.captures,
            scene: &self.scene,
            phases: &self.phases,
            roles: &self.roles,
            texts: self.sources.iter().map(|s| s.text.as_str()).collect(),
        }
    }

    fn difference(&self, other: &Program) -> Option<String> {
        let (there, here) = (self.identity(), other.identity());
        let what = if there.texts != here.texts {
            "the text"
        } else if there.scene != here.scene {
            "the scene"
        } else if there.assembly != here.assembly {
            "the assembly"
        } else if (there.captures, there.phases, there.roles)
            != (here.captures, here.phases, here.roles)
        {
            "what the compiler makes"
        } else {
            return None;
        };
        Some(format!("{what} of `{}` has changed", self.name))
    }
}

pub(super) fn sha256(data: &impl Serialize) -> String {
    let json = serde_json::to_vec(data).expect("a manifest is plain data");
    let mut hexadecimal = String::with_capacity(64);
    for byte in Sha256::digest(&json) {
        write!(hexadecimal, "{byte:02x}").expect("a string takes everything");
    }
    hexadecimal
}
