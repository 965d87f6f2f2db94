//! Form of a manifest in `manifest.json`. Shared tables and sources are stored only once.
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use stochc_ir::JamRisk;
use stochc_ir::graph::EventGraph;
use stochc_ir::scene::Scene;
use stochc_ir::table::Tables;
use stochc_runtime::Settings;

use super::{
    ChosenSetting, Compiled, EnsembleProgram, FORMAT, Manifest, ManifestError, Source, Varied,
};

#[derive(Serialize, Deserialize)]
struct StoredManifest {
    format: u32,
    stochc: String,
    builds: Vec<String>,
    settings: Settings,
    seed: u64,
    runs: u64,
    programs: Vec<StoredProgram>,
    sources: Vec<Source>,
    /// Tables and graph of each compiled program, as JSON.
    compiled: Vec<Box<RawValue>>,
}

#[derive(Serialize, Deserialize)]
struct StoredProgram {
    name: String,
    /// Index of the program's tables in the list `compiled`.
    compiled: usize,
    scene: Scene,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    parameters: BTreeMap<String, i64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    set: Vec<Varied>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    varied: Vec<Varied>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    chosen: Vec<ChosenSetting>,
    /// Indices of the program's files in the list `sources`.
    sources: Vec<usize>,
}

#[derive(Serialize)]
struct CompiledRef<'a> {
    tables: &'a Tables,
    graph: &'a EventGraph,
    #[serde(skip_serializing_if = "<[JamRisk]>::is_empty")]
    jam_risks: &'a [JamRisk],
}

#[derive(Deserialize)]
struct StoredCompiled {
    tables: Tables,
    graph: EventGraph,
    #[serde(default)]
    jam_risks: Vec<JamRisk>,
}

/// Returns the index of a key in a list of unique keys, and whether the key is new. Adds a new key
/// to the list.
fn number<K: Eq + std::hash::Hash>(known: &mut HashMap<K, usize>, key: K) -> (usize, bool) {
    let next = known.len();
    let number = *known.entry(key).or_insert(next);
    (number, number == next)
}

impl Manifest {
    /// Returns the text of `manifest.json`, with a final line break.
    pub fn to_json(&self) -> String {
        let (mut sources, mut compiled) = (Vec::new(), Vec::new());
        let (mut known_sources, mut known_compiled) = (HashMap::new(), HashMap::new());
        let programs = self.programs.iter().map(|program| {
            let (index, is_new) = number(&mut known_compiled, Arc::as_ptr(&program.compiled));
            if is_new {
                let Compiled {
                    tables,
                    graph,
                    jam_risks,
                    ..
                } = &*program.compiled;
                let raw = serde_json::value::to_raw_value(&CompiledRef {
                    tables,
                    graph,
                    jam_risks,
                });
                compiled.push(raw.expect("tables are plain data"));
            }
            let texts = program.sources.iter().map(|source| {
                let (index, is_new) = number(&mut known_sources, (&source.path, &source.text));
                if is_new {
                    sources.push(source.clone());
                }
                index
            });
            StoredProgram {
                name: program.name.clone(),
                compiled: index,
                scene: program.scene.clone(),
                parameters: program.parameters.clone(),
                set: program.set.clone(),
                varied: program.varied.clone(),
                chosen: program.chosen.clone(),
                sources: texts.collect(),
            }
        });
        let programs = programs.collect();
        let stored = StoredManifest {
            format: FORMAT,
            stochc: self.stochc.clone(),
            builds: self.builds.clone(),
            settings: self.settings.clone(),
            seed: self.seed,
            runs: self.runs,
            programs,
            sources,
            compiled,
        };
        let mut json = serde_json::to_string_pretty(&stored).expect("a manifest is plain data");
        json.push('\n');
        json
    }

    /// Reads the text of a `manifest.json`.
    ///
    /// # Errors
    ///
    /// If it is invalid, has another format, or is corrupted.
    pub fn from_json(json: &str) -> Result<Manifest, ManifestError> {
        let format = Manifest::format(json)?;
        if format != FORMAT {
            return Err(ManifestError::OtherFormat(format));
        }
        let corrupted = |error: &dyn std::fmt::Display| ManifestError::Corrupted(error.to_string());
        let stored: StoredManifest =
            serde_json::from_str(json).map_err(|error| corrupted(&error))?;
        if !stored.settings.steps().are_valid() || stored.settings.solver_iterations == Some(0) {
            return Err(corrupted(&"it has no steps"));
        }
        let compiled = stored.compiled.iter().map(|raw| {
            let StoredCompiled {
                tables,
                graph,
                jam_risks,
            } = serde_json::from_str(raw.get()).map_err(|error| corrupted(&error))?;
            graph
                .validate(&tables)
                .map_err(|reason| corrupted(&reason))?;
            Ok(Arc::new(Compiled::new(tables, graph, jam_risks)))
        });
        let compiled: Vec<Arc<Compiled>> = compiled.collect::<Result<_, ManifestError>>()?;
        let programs = stored.programs.into_iter().map(|program| {
            let missing = || corrupted(&"a part of it is missing");
            let sources = program.sources.iter();
            let sources = sources.map(|&index| stored.sources.get(index).cloned());
            let (scene, name) = (program.scene, program.name);
            scene.validate().map_err(|reason| corrupted(&reason))?;
            let mut chosen = program.chosen.iter();
            let is_known = |it: &ChosenSetting| ChosenSetting::new(it.name(), it.value()).map(drop);
            (chosen.try_for_each(is_known)).map_err(|reason| corrupted(&reason))?;
            let compiled = compiled.get(program.compiled).cloned();
            let compiled = compiled.ok_or_else(missing)?;
            let fits = compiled.tables.validate_in(&scene);
            fits.map_err(|reason| corrupted(&reason))?;
            Ok(EnsembleProgram {
                name,
                compiled,
                scene,
                parameters: program.parameters,
                set: program.set,
                varied: program.varied,
                chosen: program.chosen,
                sources: sources.collect::<Option<_>>().ok_or_else(missing)?,
                claims: Vec::new(),
            })
        });
        let manifest = Manifest {
            stochc: stored.stochc,
            settings: stored.settings,
            seed: stored.seed,
            runs: stored.runs,
            builds: stored.builds,
            programs: programs.collect::<Result<_, ManifestError>>()?,
        };
        manifest.within_limits().map(|()| manifest)
    }

    /// Returns the format of the text of a `manifest.json`, which may differ from [`FORMAT`].
    fn format(json: &str) -> Result<u32, ManifestError> {
        #[derive(Deserialize)]
        struct ManifestVersion {
            format: u32,
        }
        let version: ManifestVersion =
            serde_json::from_str(json).map_err(|_| ManifestError::NotAManifest)?;
        Ok(version.format)
    }
}
