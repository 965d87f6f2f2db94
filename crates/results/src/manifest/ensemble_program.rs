//! Programs of an ensemble.
use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use stochc_estimate::{LowerBoundReasons, ProgramParts, Rates};
use stochc_ir::claim::Claim;
use stochc_ir::graph::EventGraph;
use stochc_ir::scene::Scene;
use stochc_ir::table::{Phase, PhaseId, Role, RoleId, Tables};
use stochc_ir::{Executable, JamRisk, sha256};

use super::chosen::ChosenSetting;
use super::varied::Varied;

/// Program of an ensemble.
#[derive(Clone, Debug, PartialEq)]
pub struct EnsembleProgram {
    /// Name in tables, unique within its manifest.
    pub name: String,
    /// Compiled program. Points of a sweep may share it.
    pub compiled: Arc<Compiled>,
    /// Scene of the program.
    pub scene: Scene,
    /// Parameters of the program with their values.
    pub parameters: BTreeMap<String, i64>,
    /// Parameters of the program or scene that the user has set, equal at all points of a sweep.
    pub set: Vec<Varied>,
    /// Parameters of the program or scene that a sweep has changed, in the order of the command
    /// line. Empty if all are as in the source.
    pub varied: Vec<Varied>,
    /// Settings that a sweep has chosen for this program. All other settings are in the manifest.
    pub chosen: Vec<ChosenSetting>,
    /// The program's file, followed by all imported files. Empty for a program that was read in
    /// compiled form.
    pub sources: Vec<Source>,
    /// Claims about the runs. Empty for a program that was read from a folder or in compiled form.
    pub claims: Vec<Claim>,
}

/// Compiled program without its scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Compiled {
    /// Event tables.
    pub tables: Tables,
    /// Dependency graph.
    pub graph: EventGraph,
    /// Risks of jamming that the rate model ignores.
    pub jam_risks: Vec<JamRisk>,
    /// SHA-256 of the tables, in hexadecimal.
    pub(super) digest: String,
}

/// Source file of a program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// Path as the user wrote it. Not part of the identity.
    pub path: String,
    /// Content of the file.
    pub text: String,
}

#[derive(Serialize)]
pub(super) struct ProgramIdentity<'a> {
    pub(super) name: &'a str,
    pub(super) tables: &'a str,
    pub(super) scene: &'a Scene,
    pub(super) varied: &'a [Varied],
    #[serde(skip_serializing_if = "<[ChosenSetting]>::is_empty")]
    pub(super) chosen: &'a [ChosenSetting],
    pub(super) texts: Vec<&'a str>,
}

impl EnsembleProgram {
    /// Returns the values that the user has set, and those of the program's point in a sweep. They
    /// are appended to its name: ` [free=50, tick=10 ms]`.
    pub fn point(&self) -> String {
        let numbers = self.changes().map(Varied::text);
        bracketed(numbers.chain(self.chosen.iter().map(ChosenSetting::text)))
    }

    /// Returns all parameters that differ from the source: the set ones, then the varied ones.
    pub fn changes(&self) -> impl Iterator<Item = &Varied> {
        self.set.iter().chain(&self.varied)
    }

    /// Returns whether the program is a point of a sweep.
    pub fn is_point(&self) -> bool {
        !(self.varied.is_empty() && self.chosen.is_empty())
    }

    /// Returns the program's name without the values of scene parameters that a sweep appended.
    /// Values of settings remain.
    pub fn name_without_numbers(&self) -> String {
        let set = self.set.iter().map(Varied::text);
        let settings = bracketed(set.chain(self.chosen.iter().map(ChosenSetting::text)));
        self.name.replace(&self.point(), &settings)
    }

    /// Returns the program's name without the values of settings that a sweep appended. Values of
    /// scene parameters remain.
    pub fn name_without_settings(&self) -> String {
        let numbers = bracketed(self.changes().map(Varied::text));
        self.name.replace(&self.point(), &numbers)
    }

    /// Returns the program with the settings `chosen`, as a point of a sweep. Appends the values to
    /// its name.
    #[must_use]
    pub fn at(&self, chosen: &[ChosenSetting]) -> EnsembleProgram {
        let mut point = EnsembleProgram {
            chosen: chosen.to_vec(),
            ..self.clone()
        };
        point.name += &point.point();
        point
    }

    /// Returns the value that a sweep has chosen for a setting. Returns `None` if the setting is
    /// not varied.
    pub fn chosen_value(&self, name: &str) -> Option<&str> {
        let mut chosen = self.chosen.iter();
        chosen
            .find(|it| it.name() == name)
            .map(ChosenSetting::value)
    }

    /// Returns the program's value on an axis of a sweep, in the unit of the axis. Returns `None`
    /// if the program is not a point on this axis.
    pub fn on_axis(&self, axis: &Varied) -> Option<f64> {
        let mut varied = self.varied.iter();
        let here = varied.find(|varied| varied.name == axis.name && varied.unit == axis.unit);
        here.map(|varied| varied.given)
    }

    /// Creates a program of an ensemble. `sources` are its file, then all imported files.
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
            parameters: BTreeMap::new(),
            set: Vec::new(),
            varied: Vec::new(),
            chosen: Vec::new(),
            sources,
            claims: Vec::new(),
        }
    }

    /// Returns references to the parts of the program that an estimate requires.
    pub fn parts(&self) -> ProgramParts<'_> {
        ProgramParts {
            tables: &self.compiled.tables,
            graph: &self.compiled.graph,
            scene: &self.scene,
            jam_risks: &self.compiled.jam_risks,
        }
    }

    /// Returns the reasons why the rate model gives only lower bounds of the program's times.
    pub fn lower_bound(&self, rates: &Rates) -> LowerBoundReasons {
        let blocks = self.compiled.graph.largest_structure();
        LowerBoundReasons::new(&self.compiled.jam_risks, rates, blocks)
    }

    /// Returns the event tables.
    pub fn tables(&self) -> &Tables {
        &self.compiled.tables
    }

    /// Returns the name of the program's assembly.
    pub fn assembly(&self) -> &str {
        &self.tables().assembly
    }

    /// Returns the number of captures. For an aggregate, returns the number of blocks. Papers call
    /// it "total units involved".
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
    pub fn is_pre_attached(&self, phase: PhaseId) -> bool {
        self.phases()
            .get(phase.0 as usize)
            .is_some_and(|phase| phase.pre_attached)
    }

    /// Returns the name of a role, or `?` for an unknown one.
    pub fn role(&self, role: RoleId) -> &str {
        self.roles()
            .get(role.0 as usize)
            .map_or("?", |role| &role.name)
    }

    /// Returns the SHA-256, in hexadecimal, of the program's source, all imports, and its scene.
    /// Paths and the program's name do not affect it.
    pub fn hash(&self) -> String {
        sha256(&ProgramIdentity {
            name: "",
            ..self.identity()
        })
    }

    pub(super) fn identity(&self) -> ProgramIdentity<'_> {
        ProgramIdentity {
            name: &self.name,
            tables: &self.compiled.digest,
            scene: &self.scene,
            varied: &self.varied,
            chosen: &self.chosen,
            texts: self.sources.iter().map(|s| s.text.as_str()).collect(),
        }
    }

    pub(super) fn difference(&self, other: &EnsembleProgram) -> Option<String> {
        let (there, here) = (self.identity(), other.identity());
        let what = if there.texts != here.texts {
            "the text"
        } else if self.set != other.set {
            "a parameter"
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

/// Returns values in brackets, as a sweep appends them to the name of a program.
fn bracketed(values: impl Iterator<Item = String>) -> String {
    let values: Vec<String> = values.collect();
    if values.is_empty() {
        String::new()
    } else {
        format!(" [{}]", values.join(", "))
    }
}

impl Compiled {
    /// Creates a compiled program from its tables and graph.
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
