//! Programs in Python: diagnostics and compilation.
use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use stochc::compiler::emit::{built_structure, structure_text};
use stochc::compiler::{Changes, Checked, LintLevels, Program};
use stochc::diagnostics::{CheckDocument, drawn};
use stochc::exit::Failure;
use stochc::ir::Executable;
use stochc::ir::emit::{graph_text, table_text};
use stochc::operations::codes;
use stochc::operations::programs::{accept, is_readable, programs};
use stochc::operations::stored_source::StoredSource;
use stochc::operations::summary::status_lines;
use stochc::report::figures::structure;
use stochc::results::{EnsembleProgram, Manifest, Source};
use stochc::runtime::Settings;
use stochc::{SourceSettings, UnusedValues};

use super::call::call;
use super::host::WIDTH;
use super::settings::{LevelSetting, source_settings};

/// Compiled program, ready to run.
#[pyclass(frozen, name = "Program", module = "stochc._native")]
#[derive(Clone)]
pub struct PythonProgram(pub Arc<EnsembleProgram>);

impl From<EnsembleProgram> for PythonProgram {
    fn from(entry: EnsembleProgram) -> PythonProgram {
        PythonProgram(Arc::new(entry))
    }
}

/// Result of a check: JSON, text, whether there are errors, and the programs if there are none.
type CheckOutput = (String, String, bool, Vec<PythonProgram>);

/// Checks a file. If `name` is given, `source` is source text with this name.
#[pyfunction]
pub fn check(
    py: Python<'_>,
    source: String,
    name: Option<String>,
    level_settings: Vec<LevelSetting>,
    imports: Vec<PathBuf>,
    set: Vec<String>,
) -> PyResult<CheckOutput> {
    call(py, None, move |_| {
        let settings = source_settings(&level_settings, imports, &set)?;
        let checked = match name {
            Some(name) => check_text(&name, &source, &settings),
            None => {
                is_readable(&source)?;
                stochc::check_source(&source, &settings)
            }
        };
        if !checked.has_errors() {
            UnusedValues::check_used_by(&settings, &checked.programs)?;
        }
        let mut document = CheckDocument::default();
        let root = checked.sources.files().first();
        document.add(root.map_or("", |file| &file.name), &checked, "", |_| None);
        let mut drawn = drawn(&checked, false, WIDTH);
        if checked.has_errors() {
            return Ok((document.text(), drawn, true, Vec::new()));
        }
        let lines = (0..checked.programs.len()).map(|number| status_lines(&checked, number));
        drawn.extend(lines);
        Ok((document.text(), drawn, false, entries(checked, &settings)))
    })
}

/// Checks source text without imports. `name` is its file name in diagnostics.
fn check_text(name: &str, text: &str, settings: &SourceSettings) -> Checked {
    let values = settings.changes();
    stochc::check_texts(
        &[(name, text)],
        &settings.levels,
        Changes::everywhere(&values),
    )
}

/// Returns the programs of a file without errors, ready to run.
fn entries(checked: Checked, settings: &SourceSettings) -> Vec<PythonProgram> {
    // The messages have already been reported.
    let silent = super::host::Caller::default();
    let found = accept("", checked, settings, &silent).unwrap_or_default();
    found.into_iter().map(PythonProgram::from).collect()
}

/// Returns the programs of a file. If `name` is given, `source` is source text with this name.
#[pyfunction]
pub fn load(
    py: Python<'_>,
    source: String,
    name: Option<String>,
    level_settings: Vec<LevelSetting>,
    imports: Vec<PathBuf>,
    set: Vec<String>,
) -> PyResult<Vec<PythonProgram>> {
    call(py, None, move |host| {
        let settings = source_settings(&level_settings, imports, &set)?;
        let found = match name {
            Some(name) => {
                let checked = check_text(&name, &source, &settings);
                if !checked.has_errors() {
                    UnusedValues::check_used_by(&settings, &checked.programs)?;
                }
                accept(&name, checked, &settings, host)
            }
            None => programs(&[source], &settings, host),
        }?;
        Ok(found.into_iter().map(PythonProgram::from).collect())
    })
}

/// Returns the programs of source texts, each with its path. The first may import the others.
#[pyfunction]
pub fn load_texts(py: Python<'_>, texts: Vec<(String, String)>) -> PyResult<Vec<PythonProgram>> {
    call(py, None, move |host| {
        let texts: Vec<(&str, &str)> = (texts.iter())
            .map(|(path, text)| (path.as_str(), text.as_str()))
            .collect();
        let checked = stochc::check_texts(&texts, &LintLevels::default(), Changes::NONE);
        let name = texts.first().map_or("", |it| it.0);
        let found = accept(name, checked, &SourceSettings::default(), host)?;
        Ok(found.into_iter().map(PythonProgram::from).collect())
    })
}

/// Returns the page about a diagnostic code.
#[pyfunction]
pub fn explain(py: Python<'_>, code: String) -> PyResult<&'static str> {
    call(py, None, move |_| {
        codes::explain(&code).map_err(Failure::usage)
    })
}

#[pymethods]
impl PythonProgram {
    /// Returns the name of the program in tables.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Returns the name of the program's assembly or aggregate.
    #[getter]
    fn assembly(&self) -> &str {
        self.0.assembly()
    }

    /// Returns the name of the program's scene.
    #[getter]
    fn scene(&self) -> &str {
        &self.0.scene.name
    }

    /// Returns the length of a tick \[s\].
    #[getter]
    fn tick(&self) -> f64 {
        self.0.scene.tick
    }

    /// Returns the number of captures. For an aggregate, returns the number of blocks.
    #[getter]
    fn captures(&self) -> u64 {
        self.0.captures()
    }

    /// Returns the names of the program's phases.
    #[getter]
    fn phases(&self) -> Vec<String> {
        let phases = self.0.phases().iter();
        phases.map(|phase| phase.name.clone()).collect()
    }

    /// Returns the SHA-256 of the program's source, all imports, and its scene.
    #[getter]
    fn digest(&self) -> String {
        self.0.hash()
    }

    /// Returns the path and text of each source file.
    #[getter]
    fn sources(&self) -> Vec<(String, String)> {
        let sources = self.0.sources.iter();
        sources
            .map(|Source { path, text }| (path.clone(), text.clone()))
            .collect()
    }

    /// Returns the scene as JSON, in the form that a manifest uses.
    fn scene_json(&self) -> String {
        serde_json::json!(self.0.scene).to_string()
    }

    /// Returns a drawing of the structure as SVG. Returns `None` if the source is not available or
    /// there is no structure.
    fn structure_svg(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.with_checked(py, |program, checked| {
            let built = built_structure(&program.plan, &program.layout, &checked.symbols)?;
            Some(structure(&built).file())
        })
    }

    /// Returns the structure as text. Returns `None` if the source is not available.
    fn structure_text(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.with_checked(py, |program, _| {
            Some(structure_text(&program.plan, &program.layout).to_string())
        })
    }

    /// Returns the dependency graph as text.
    fn graph_text(&self, py: Python<'_>) -> PyResult<String> {
        let entry = self.0.clone();
        call(py, None, move |_| {
            Ok(graph_text(&entry.compiled.graph, entry.tables()).to_string())
        })
    }

    /// Returns the event tables as text.
    fn table_text(&self, py: Python<'_>) -> PyResult<String> {
        let entry = self.0.clone();
        call(
            py,
            None,
            move |_| Ok(table_text(entry.tables()).to_string()),
        )
    }

    /// Returns the program as the content of an executable file, for `stochc simulate`.
    fn executable<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let entry = self.0.clone();
        let bytes = call(py, None, move |_| {
            let executable = Executable {
                tables: entry.tables().clone(),
                scene: entry.scene.clone(),
                graph: entry.compiled.graph.clone(),
                jam_risks: entry.compiled.jam_risks.clone(),
            };
            let mut bytes = Vec::new();
            Executable::write_all(&[executable], &mut bytes).map_err(Failure::usage)?;
            Ok(bytes)
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Returns the complete program as JSON text, for [`from_json`](Program::from_json).
    fn to_json(&self, py: Python<'_>) -> PyResult<String> {
        let entry = self.0.clone();
        call(py, None, move |_| {
            Ok(Manifest::new(Settings::default(), 0, 1, vec![(*entry).clone()]).to_json())
        })
    }

    /// Returns the program in the output of [`to_json`](Program::to_json).
    #[staticmethod]
    fn from_json(py: Python<'_>, json: String) -> PyResult<PythonProgram> {
        call(py, None, move |_| {
            let manifest = Manifest::from_json(&json);
            let mut programs = manifest.map_err(Failure::usage)?.programs;
            let program = programs.pop();
            program
                .map(PythonProgram::from)
                .ok_or_else(|| Failure::usage("it contains no program"))
        })
    }
}

impl PythonProgram {
    /// Calls `say` with the compiled source and returns its result. Returns `None` if the source is
    /// not available.
    fn with_checked(
        &self,
        py: Python<'_>,
        say: impl FnOnce(&Program, &Checked) -> Option<String> + Send + 'static,
    ) -> PyResult<Option<String>> {
        let entry = self.0.clone();
        call(py, None, move |_| {
            let text = StoredSource::new(&entry, &LintLevels::default());
            let program = text.program();
            Ok(program.and_then(|program| say(program, &text.checked)))
        })
    }
}
