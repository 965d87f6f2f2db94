//! Estimates, plans and trades in Python.
use std::path::PathBuf;
use std::time::Duration;

use pyo3::prelude::*;
use serde_json::json;
use stochc::exit::Failure;
use stochc::operations::claims::{ClaimOptions, tested_claims};
use stochc::operations::estimate::{Estimating, estimates};
use stochc::operations::plan::{
    Budget, LooseParts, Offset, PlanOptions, PlanScope, RunEnd, SeedPlate, plan as planned, read,
};
use stochc::operations::rates::{rates_for_scenes, read_rates_for};
use stochc::operations::trade::{MeasuredTrade, TradeSetup, manifest, measured};
use stochc::planner::{Objective, explanation};
use stochc::report::figures::{Figures, Medium, trade as trade_figure};
use stochc::report::tables::{ReportedClaim, claims_to_text, estimates_to_text, trade_to_text};
use stochc::results::EnsembleProgram;
use stochc::runtime::{Model, Settings};

use super::call::call;
use super::host::WIDTH;
use super::program::PythonProgram;
use super::settings::{folders, named};

/// Python arguments of an estimate and of a test: programs with their rates, and settings of runs.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct RatedPrograms {
    programs: Vec<Py<PythonProgram>>,
    rates: Vec<PathBuf>,
    max_ticks: u64,
    seed: u64,
    threads: Option<u16>,
}

impl RatedPrograms {
    fn programs(&self) -> Vec<EnsembleProgram> {
        let programs = self.programs.iter().map(|it| (*it.get().0).clone());
        programs.collect()
    }
}

/// Python arguments of an estimate.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct EstimateRequest {
    rated: RatedPrograms,
    runs: Option<u64>,
}

/// Returns estimates of completion times, as JSON and as text.
#[pyfunction]
pub fn estimate(
    py: Python<'_>,
    request: EstimateRequest,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    /// Number of captures that the text lists.
    const SHOWN: usize = 5;
    call(py, progress.as_ref(), move |host| {
        let EstimateRequest { rated, runs } = &request;
        let how = Estimating {
            rates: &rated.rates,
            runs: *runs,
            max_ticks: rated.max_ticks,
            seed: rated.seed,
            threads: rated.threads,
        };
        let found = estimates(rated.programs(), &how, host)?;
        Ok((
            json!(found).to_string(),
            estimates_to_text(&found, SHOWN, WIDTH),
        ))
    })
}

/// Python arguments of a test of claims.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct TestRequest {
    rated: RatedPrograms,
    alpha: f64,
    margin: f64,
    model: Option<String>,
    runs: u64,
}

/// Returns the verdicts about the claims of programs, as JSON and as text.
#[pyfunction]
pub fn test(
    py: Python<'_>,
    request: TestRequest,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(String, String)> {
    call(py, progress.as_ref(), move |host| {
        let rated = &request.rated;
        let programs = rated.programs();
        let model = request.model.as_ref();
        let model = model.map(|name| named("model", name, &Model::ALL, Model::name));
        let model = model.transpose()?;
        let mut settings = Settings {
            model: model.unwrap_or(Settings::default().model),
            max_ticks: Some(rated.max_ticks),
            ..Settings::default()
        }
        .resolved();
        let scenes = programs.iter().map(|program| &program.scene);
        let rates = read_rates_for(&rated.rates, scenes, host)?;
        if settings.model == Model::Rate {
            settings.rates = rates_for_scenes(&rates, &programs, rated.threads, host)?;
        }
        let how = ClaimOptions {
            alpha: request.alpha,
            margin: request.margin,
            tries_rates: model.is_none(),
            settings,
            rates,
            runs: request.runs,
            seed: rated.seed,
            threads: rated.threads,
        };
        let found = tested_claims(&programs, &how, host)?;
        let claims: Vec<_> = found.iter().map(ReportedClaim::to_json).collect();
        Ok((json!(claims).to_string(), claims_to_text(&found, WIDTH)))
    })
}

/// Python arguments of a plan.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct PlanRequest {
    target: String,
    completes: bool,
    run: Option<u64>,
    program: Option<String>,
    dead: Vec<String>,
    shape: Option<String>,
    model: Option<u32>,
    plate: Option<String>,
    offset: Option<String>,
    scene: Option<String>,
    free: Option<u32>,
    name: Option<String>,
    drops_loose: bool,
    adds_supports: bool,
    imports: Vec<PathBuf>,
    time: Option<f64>,
    tries: Option<u64>,
    is_p90: bool,
    seed: u64,
    keeps_scaffolds: bool,
    race: Option<u64>,
    rates: Vec<PathBuf>,
}

/// Result of a plan: sources by path, the program's own first; assembly name; plan as JSON; plan as
/// text.
type PlanOutput = (Vec<(String, String)>, String, String, String);

/// Plans a program and returns it.
#[pyfunction]
pub fn plan(
    py: Python<'_>,
    request: PlanRequest,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<PlanOutput> {
    call(py, progress.as_ref(), move |host| {
        let invalid =
            |what: &'static str| move |reason| Failure::usage(format!("{what}: {reason}"));
        let plate = request.plate.as_deref().map(SeedPlate::parse);
        let plate = plate.transpose().map_err(invalid("plate"))?;
        let offset = request.offset.as_deref().map(Offset::parse);
        let time = request.time.map(Duration::try_from_secs_f64).transpose();
        let time = time.map_err(Failure::usage)?;
        let imports = folders(request.imports)?;
        let options = PlanOptions {
            target: &request.target,
            extent: PlanScope::new(
                request.run.map(|run| RunEnd {
                    run,
                    program: request.program.as_deref(),
                    dead: &request.dead,
                }),
                request.completes,
            ),
            shape: request.shape.as_deref(),
            model: request.model,
            seed_plate: plate.as_ref(),
            offset: offset.transpose().map_err(invalid("offset"))?,
            scene: request.scene.as_deref(),
            free: request.free,
            name: request.name.as_deref(),
            loose: LooseParts::new(request.drops_loose, request.adds_supports),
            imports: &imports,
            budget: (time.map(Budget::Time)).or(request.tries.map(Budget::Tries)),
            objective: if request.is_p90 {
                Objective::P90
            } else {
                Objective::Mean
            },
            seed: request.seed,
            keeps_scaffolds: request.keeps_scaffolds,
            race: request.race,
            rates: &request.rates,
        };
        let read = read(&options, host).map_err(Failure::from)?;
        let found = planned(&read, &options, host).map_err(Failure::from)?;
        let explained = explanation(&found.plan);
        let plan = json!(found.plan).to_string();
        let own = std::iter::once((found.name, found.text));
        let texts = own.chain(found.imported).collect();
        Ok((texts, found.assembly, plan, explained))
    })
}

/// Python arguments of a trade.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct TradeRequest {
    programs: Vec<Py<PythonProgram>>,
    runs: Option<u64>,
    time: Option<f64>,
    until: Option<f64>,
    seed: u64,
    max_ticks: u64,
    finest: u32,
    threads: Option<u16>,
    out: Option<PathBuf>,
    resume: bool,
}

/// Measures a trade. Returns it as JSON, as text and as a figure.
#[pyfunction]
pub fn trade(
    py: Python<'_>,
    request: TradeRequest,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(String, String, String)> {
    call(py, progress.as_ref(), move |host| {
        let programs = request.programs.iter().map(|it| (*it.get().0).clone());
        let time = request.time.map(Duration::try_from_secs_f64).transpose();
        let setup = TradeSetup {
            runs: request.runs,
            time: time.map_err(Failure::usage)?,
            until: request.until,
            finest: request.finest,
            max_ticks: request.max_ticks,
            seed: request.seed,
            threads: request.threads,
            out: request.out.as_deref(),
            resume: request.resume,
            figures: &Figures::default(),
        };
        let manifest = manifest(programs.collect(), &setup, host)?;
        let MeasuredTrade {
            manifest, trade, ..
        } = measured(manifest, &setup, host)?;
        let (text, picture) = (
            trade_to_text(&trade, WIDTH, false),
            trade_figure(Medium::Screen, &trade),
        );
        Ok((trade.to_json(&manifest), text, picture.file()))
    })
}
