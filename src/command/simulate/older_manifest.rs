//! Manifests of older layouts, which held texts instead of compiled programs.
use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use stochc_compiler::LintLevels;
use stochc_ensemble::{Manifest, Source, Varied};
use stochc_ir::scene::Scene;
use stochc_runtime::Settings;

use crate::exit::Failure;
use crate::host::Host;
use crate::operations::programs::{accept, recompile};

#[derive(Deserialize)]
struct OldManifest {
    model: String,
    substeps: u32,
    seed: u64,
    runs: u64,
    max_ticks: Option<u64>,
    settings: BTreeMap<String, String>,
    #[serde(default)]
    builds: Vec<String>,
    programs: Vec<OldProgram>,
}

#[derive(Deserialize)]
struct OldProgram {
    name: String,
    assembly: String,
    scene: Scene,
    #[serde(default)]
    varied: Vec<Varied>,
    phases: Vec<String>,
    sources: Vec<Source>,
}

/// Reads a manifest of an older layout, and compiles what it holds.
pub(super) fn read(
    format: u32,
    text: &str,
    path: &Path,
    levels: &LintLevels,
    host: &dyn Host,
) -> Result<Manifest, Failure> {
    let shown = path.display();
    let refuse = |reason: String| Failure::usage(format!("`{shown}`: {reason}"));
    let old: OldManifest = serde_json::from_str(text)
        .map_err(|error| refuse(format!("it is damaged (format {format}), {error}")))?;
    let settings = old.settings().map_err(refuse)?;
    let mut programs = Vec::new();
    for entry in old.programs {
        let checked = recompile(&entry.sources, &entry.varied, &entry.assembly, levels);
        let root = entry.sources.first().map_or("", |source| &source.path);
        let found = accept(root, checked, host)?;
        let same = found.into_iter().find(|program| {
            program.assembly() == entry.assembly
                && program.scene == entry.scene
                && entry.phases.len() == program.phases().len()
        });
        let Some(mut program) = same else {
            return Err(refuse(format!(
                "its sources do not give its assembly `{}` any more",
                entry.assembly
            )));
        };
        program.name = entry.name;
        program.varied = entry.varied;
        programs.push(program);
    }
    let mut manifest = Manifest::new(settings, old.seed, old.runs, programs);
    manifest.builds = old.builds;
    Ok(manifest)
}

impl OldManifest {
    /// The settings, most of which were texts by name.
    fn settings(&self) -> Result<Settings, String> {
        let mut value = serde_json::json!({
            "model": self.model,
            "substeps": self.substeps,
            "max_ticks": self.max_ticks,
        });
        for (name, text) in &self.settings {
            value[name] = match name.as_str() {
                "solver_iterations" => text.parse::<u32>().ok().filter(|&n| n > 0).into(),
                _ => text.replace('-', "_").into(),
            };
        }
        let settings: Settings = serde_json::from_value(value)
            .map_err(|error| format!("this version does not have its settings: {error}"))?;
        match settings.substeps {
            0 => Err("`substeps` is 0; at least 1 is needed".to_owned()),
            _ => Ok(settings.resolved()),
        }
    }
}
