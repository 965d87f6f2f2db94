//! Tests of the claims of programs.
use std::sync::LazyLock;

use stochc_experiments::{
    ClaimTesting, ModelError, TestedClaim, Verdict, decide_claims, test_claims,
};
use stochc_ir::claim::{Claim, ClaimedEvent};
use stochc_report::figures::Figures;
use stochc_report::tables::ReportedClaim;
use stochc_results::recording::EVERY;
use stochc_results::{EnsembleProgram, Interval, Manifest, Records, Resume};
use stochc_runtime::rates::Rates;
use stochc_runtime::{Model, Settings};

use super::ensemble::EnsembleOptions;
use super::in_memory::stopped;
use super::precision::make_in_rounds;
use super::rates::{matching, rates_for_scenes, supported};
use super::runs::try_out_all;
use crate::exit::Failure;
use crate::host::Host;

/// Largest relative error of mean times in the rate model, in all scenes of
/// docs/validation/rates.md.
const RATE_ERROR: f64 = 0.25;

/// Options of tests of claims.
#[derive(Clone, Debug)]
pub struct ClaimOptions {
    /// Largest probability that any decision is wrong.
    pub alpha: f64,
    /// Half-width of the range around the bound of a probability within which any decision is
    /// allowed.
    pub margin: f64,
    /// Settings of the runs.
    pub settings: Settings,
    /// Whether claims are first tested with the rate model, if its errors cannot change the
    /// verdict.
    pub tries_rates: bool,
    /// Rates of scenes, in addition to built-in rates.
    pub rates: Vec<Rates>,
    /// Largest number of runs of each program.
    pub runs: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of threads. `None` means one per core.
    pub threads: Option<u16>,
}

/// Tests the claims of all programs. All decisions together are wrong with a probability of at most
/// [`ClaimOptions::alpha`].
///
/// # Errors
/// If the programs have no claims, a scene cannot be set up, or the user interrupts.
pub fn tested_claims(
    programs: &[EnsembleProgram],
    options: &ClaimOptions,
    host: &dyn Host,
) -> Result<Vec<ReportedClaim>, Failure> {
    let number: usize = programs.iter().map(|program| program.claims.len()).sum();
    if number == 0 {
        return Err(Failure::usage(
            "the programs contain no claims; write one into an assembly, such as `expect complete within 8000 ticks with probability >= 0.95`",
        ));
    }
    let mut reported = Vec::new();
    for program in programs.iter().filter(|program| !program.claims.is_empty()) {
        let testing = ClaimTesting {
            alpha: options.alpha / number as f64,
            margin: options.margin,
            error: ModelError::NONE,
        };
        reported.extend(test_program(program, programs, testing, options, host)?);
    }
    Ok(reported)
}

/// Tests the claims of one program.
fn test_program(
    program: &EnsembleProgram,
    programs: &[EnsembleProgram],
    mut testing: ClaimTesting,
    options: &ClaimOptions,
    host: &dyn Host,
) -> Result<Vec<ReportedClaim>, Failure> {
    let mut entries = vec![program.clone()];
    entries.extend(programs.iter().filter(|it| is_named(it, program)).cloned());
    let mut decided: Vec<Option<ReportedClaim>> = vec![None; program.claims.len()];
    if let Some(error) = rate_error(&entries, options) {
        // Each model may decide wrongly.
        testing.alpha /= 2.0;
        let settings = Settings {
            max_ticks: options.settings.max_ticks,
            rates: rates_for_scenes(&options.rates, &entries, options.threads, host)?,
            ..Settings::new(Model::Rate, 1)
        };
        let testing = ClaimTesting { error, ..testing };
        add(&mut decided, &entries, &settings, testing, options, host)?;
    }
    add(
        &mut decided,
        &entries,
        &options.settings,
        testing,
        options,
        host,
    )?;
    Ok(decided.into_iter().flatten().collect())
}

/// Returns whether a claim compares `program` with `other`.
fn is_named(other: &EnsembleProgram, program: &EnsembleProgram) -> bool {
    other.sources == program.sources
        && (program.claims.iter())
            .any(|claim| matches!(claim, Claim::Faster { than, .. } if than == other.assembly()))
}

/// Returns the error of the rate model. Returns `None` if the claims are not tested with the rate
/// model first.
fn rate_error(entries: &[EnsembleProgram], options: &ClaimOptions) -> Option<ModelError> {
    let rates = entries
        .iter()
        .map(|program| matching(&options.rates, &program.scene));
    let rates: Option<Vec<&Rates>> = rates.collect();
    // A timeout turns an error of a time into an infinite time.
    let has_timeout = (entries.iter()).any(|it| {
        it.tables()
            .phases
            .iter()
            .any(|phase| phase.timeout.is_some())
    });
    let is_supported = entries.iter().all(|program| supported(program).is_ok());
    let rates = rates.filter(|_| options.tries_rates && is_supported && !has_timeout)?;
    // The error of other scenes was validated in too few of them.
    if rates.iter().any(|rates| rates.held_out.is_some()) {
        return None;
    }
    let mut programs = entries.iter().zip(rates);
    let is_complete = programs.all(|(program, rates)| program.lower_bound(rates).is_empty());
    Some(ModelError {
        shortest: 1.0 / (1.0 + RATE_ERROR),
        longest: if is_complete {
            1.0 / (1.0 - RATE_ERROR)
        } else {
            f64::INFINITY
        },
    })
}

/// Tests the claims that are not decided yet, and adds their results.
fn add(
    decided: &mut [Option<ReportedClaim>],
    entries: &[EnsembleProgram],
    settings: &Settings,
    testing: ClaimTesting,
    options: &ClaimOptions,
    host: &dyn Host,
) -> Result<(), Failure> {
    let has_error = testing.error != ModelError::NONE;
    let is_open = |claim: &Option<ReportedClaim>| {
        (claim.as_ref()).is_none_or(|it| it.tested.verdict == Verdict::Undecided)
    };
    let program = &entries[0];
    let numbers = (0..decided.len()).filter(|&number| {
        // The error of captures in the rate model is unknown.
        is_open(&decided[number]) && (!has_error || !is_capture(&program.claims[number]))
    });
    let mut numbers: Vec<usize> = numbers.collect();
    let report = |number: usize, tested: TestedClaim| ReportedClaim {
        program: program.name.clone(),
        file: program.sources.first().map(|file| file.path.clone()),
        claim: program.claims[number].describe(program.tables()),
        tested,
        model: settings.model,
    };
    // Without a model error, the model was chosen for runs.
    if settings.model == Model::Rate && has_error {
        let without_runs = decide_without_runs(entries, &settings.rates, testing.error, host);
        numbers.retain(|&number| {
            let tested = without_runs[number].clone();
            let needs_runs = tested.is_none();
            if let Some(tested) = tested {
                decided[number] = Some(report(number, tested));
            }
            needs_runs
        });
    }
    if numbers.is_empty() {
        return Ok(());
    }
    let claims: Vec<Claim> = (numbers.iter())
        .map(|&number| program.claims[number].clone())
        .collect();
    let test = |finished: &Records| {
        test_claims(&claims, entries, finished, testing).map_err(Failure::usage)
    };
    let manifest = Manifest::new(
        settings.clone(),
        options.seed,
        options.runs,
        entries.to_vec(),
    );
    manifest.within_limits().map_err(Failure::usage)?;
    try_out_all(&manifest)?;
    let more = |manifest: &Manifest, finished: &Records| {
        let tested = test(finished)?;
        let is_open = tested.iter().any(|it| it.verdict == Verdict::Undecided);
        Ok(is_open.then_some(manifest.runs + manifest.runs / 2 + 1))
    };
    let (_, made) = make_in_rounds(manifest, &how(options.threads), host, more)?;
    if !made.results.complete {
        return Err(stopped("not all claims were tested"));
    }
    let tested = test(&made.results.finished)?;
    for (number, tested) in numbers.into_iter().zip(tested) {
        decided[number] = Some(report(number, tested));
    }
    Ok(())
}

/// Decides claims of the first program without simulating it, if this is possible.
fn decide_without_runs(
    entries: &[EnsembleProgram],
    rates: &[Rates],
    error: ModelError,
    host: &dyn Host,
) -> Vec<Option<TestedClaim>> {
    let claims = &entries[0].claims;
    let supported = entries.iter().map(|it| {
        let rates = Rates::known(rates, &it.scene);
        rates.filter(|_| supported(it).is_ok())
    });
    let rates: Option<Vec<&Rates>> = supported.collect();
    rates.map_or_else(
        || vec![None; claims.len()],
        |rates| decide_claims(claims, entries, &rates, error, host.stop()),
    )
}

fn is_capture(claim: &Claim) -> bool {
    let Claim::Probability { event, .. } = claim else {
        return false;
    };
    matches!(event, ClaimedEvent::Capture { .. })
}

/// Returns the options of runs that stay in memory.
fn how(threads: Option<u16>) -> EnsembleOptions<'static> {
    static FIGURES: LazyLock<Figures> = LazyLock::new(Figures::default);
    EnsembleOptions {
        out: None,
        resume: Resume::No,
        record: None,
        record_every: EVERY,
        checkpoints: Interval::Never,
        threads,
        has_warned_of_build: false,
        continues: true,
        measures_cpu: true,
        figures: &FIGURES,
        watch: false,
        time_limit: None,
    }
}
