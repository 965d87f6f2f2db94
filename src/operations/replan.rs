//! Runs whose rest is planned anew where nothing docks for long.
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use stochc_compiler::LintLevels;
use stochc_ensemble::statistics::Observation;
use stochc_ensemble::{EnsembleProgram, Manifest, completion_time};
use stochc_ir::record::RunRecord;
use stochc_planner::PlanSearch;
use stochc_rates::Rates;
use stochc_report::replanning::Replanning;

use super::in_memory::{all_runs, stopped};
use super::kept_text::KeptText;
use super::plan::refuse_aggregate;
use super::rates::of_files;
use crate::check_text;
use crate::exit::Failure;
use crate::host::Host;
use crate::planning::{ExistingStructure, Goal};

/// When and how the rest of a run is planned.
#[derive(Clone, Copy, Debug)]
pub struct Replan {
    /// Ticks without a docking or a release.
    pub after: u64,
    /// Runs at the same time; `None`: as many as there are cores.
    pub threads: Option<u16>,
}

/// What comes of it when it is stopped.
const NOTHING: &str = "nothing was compared";

/// Plans of one run, at most; then it goes on as it is.
const MOST_PLANS: u64 = 100;

/// Plans that are tried for one rest.
const TRIES: u64 = 50;

/// A run with plans, as far as it has come.
struct ReplannedRun {
    run: u64,
    /// Ticks of the programs before.
    elapsed: u64,
    plans: u64,
}

/// What came of the runs of a program.
#[derive(Default)]
struct Outcomes {
    plain: BTreeMap<u64, Observation>,
    replanned: BTreeMap<u64, Observation>,
    plans: u64,
    not_planned: u64,
}

/// Makes all runs of a manifest, and makes each again with plans from where nothing docked for too long.
///
/// # Errors
/// If the text of a program is not at hand, its end cannot be planned at all, or it is stopped.
pub fn replan(
    manifest: Manifest,
    how: Replan,
    rates: &[PathBuf],
    host: &dyn Host,
) -> Result<Vec<Replanning>, Failure> {
    let rates = of_files(rates)?;
    let ends: Result<Vec<Goal>, Failure> = manifest.programs.iter().map(end).collect();
    let ends = ends?;
    let Manifest { settings, seed, .. } = &manifest;
    let alone = |programs, seed, runs| Manifest::new(settings.clone(), seed, runs, programs);
    let mut results = Vec::new();
    for (number, (program, mut goal)) in (0u64..).zip(manifest.programs.iter().zip(ends)) {
        let mut outcomes = Outcomes::default();
        // Every program and every round of plans has seeds of its own.
        let seed = |round: u64| seed.wrapping_add((number << 48) + (round << 32));
        let first = alone(vec![program.clone()], seed(0), manifest.runs);
        let mut chains: Vec<ReplannedRun> = (0..manifest.runs)
            .map(|run| ReplannedRun {
                run,
                elapsed: 0,
                plans: 0,
            })
            .collect();
        let mut made = made(&first, how, host)?;
        let mut programs = first.programs;
        for round in 1.. {
            let mut next = Vec::new();
            let mut waiting = Vec::new();
            for (chain, (entry, record)) in chains.into_iter().zip(made) {
                if host.stop().load(Ordering::Relaxed) {
                    return Err(stopped(NOTHING));
                }
                if let Some(rest) = outcomes.follow(
                    chain,
                    &programs[entry],
                    &record,
                    how,
                    |structure| planned(&mut goal, structure, &rates),
                    settings.max_ticks,
                ) {
                    waiting.push(rest.0);
                    next.push(rest.1);
                }
            }
            if next.is_empty() {
                break;
            }
            let rest = alone(next, seed(round), 1);
            made = self::made(&rest, how, host)?;
            (chains, programs) = (waiting, rest.programs);
        }
        results.push(outcomes.summary(program, how.after));
    }
    Ok(results)
}

/// All runs, each with the index of its program, by program and number.
fn made(
    manifest: &Manifest,
    how: Replan,
    host: &dyn Host,
) -> Result<Vec<(usize, RunRecord)>, Failure> {
    let results = all_runs(manifest, how.threads, NOTHING, host)?;
    let finished = results.finished.to_vec().map_err(Failure::usage)?;
    let mut records: Vec<_> = finished
        .into_iter()
        .map(|it| (it.program, it.record))
        .collect();
    records.sort_by_key(|(program, record)| (*program, record.run));
    Ok(records)
}

/// What a program builds in the end.
fn end(program: &EnsembleProgram) -> Result<Goal, Failure> {
    refuse_aggregate(program)?;
    let text = KeptText::of(program, &LintLevels::default());
    let plan = text.program().ok_or_else(|| {
        Failure::usage(format!(
            "the rest of `{}` cannot be planned: it is compiled, and its text is not at hand",
            program.name
        ))
    })?;
    Goal::of_end(&text.checked, plan, None)
        .map_err(|reason| Failure::invalid_program(format!("`{}`: {reason}", program.name)))
}

/// The program of the rest, where a structure stands; `None`: there is none.
fn planned(
    goal: &mut Goal,
    structure: &ExistingStructure,
    rates: &[Rates],
) -> Option<EnsembleProgram> {
    goal.stand_on(structure, &BTreeSet::new()).ok()?;
    let search = PlanSearch {
        rounds: TRIES,
        ..PlanSearch::default()
    };
    let planned = goal.plan(rates, search).ok()?;
    let mut programs = crate::compile(check_text("rest.sa", &planned.text)).ok()?;
    let executable = programs.pop()?;
    Some(EnsembleProgram::new("rest", Vec::new(), executable))
}

/// The tick in which nothing has happened for so long for the first time.
fn stall(record: &RunRecord, after: u64) -> Option<u64> {
    let docked = record.bonds.iter().map(|bond| bond.docked);
    let mut ticks: Vec<u64> = docked
        .chain(record.releases.iter().map(|it| it.tick))
        .collect();
    ticks.push(record.ticks);
    ticks.sort_unstable();
    let mut last = 0;
    for tick in ticks {
        if tick - last > after {
            return Some(last + after);
        }
        last = tick;
    }
    None
}

impl Outcomes {
    /// Takes in a run of a program, of a chain: the chain and the program with which it goes on, if it does.
    fn follow(
        &mut self,
        chain: ReplannedRun,
        program: &EnsembleProgram,
        record: &RunRecord,
        how: Replan,
        planned: impl FnOnce(&ExistingStructure) -> Option<EnsembleProgram>,
        max_ticks: Option<u64>,
    ) -> Option<(ReplannedRun, EnsembleProgram)> {
        let ReplannedRun {
            run,
            elapsed,
            plans,
        } = chain;
        let limit = max_ticks.unwrap_or(u64::MAX);
        let Some(Observation { time, status }) = completion_time(record) else {
            // Its physics has failed.
            self.plain.remove(&run);
            return None;
        };
        let end = elapsed.saturating_add(time as u64);
        let whole = match end <= limit {
            true => Observation {
                time: end as f64,
                status,
            },
            false => Observation::censored(limit as f64),
        };
        if plans == 0 {
            self.plain.insert(run, whole);
        }
        let stalled = stall(record, how.after);
        let stop = stalled.filter(|stop| plans < MOST_PLANS && elapsed + stop < limit);
        let Some(stop) = stop else {
            self.replanned.insert(run, whole);
            return None;
        };
        let structure = ExistingStructure::of(program.tables(), &until(record, stop));
        let Some(rest) = planned(&structure) else {
            self.not_planned += 1;
            self.replanned.insert(run, whole);
            return None;
        };
        self.plans += 1;
        let chain = ReplannedRun {
            run,
            elapsed: elapsed + stop,
            plans: plans + 1,
        };
        Some((chain, rest))
    }

    fn summary(&self, program: &EnsembleProgram, after: u64) -> Replanning {
        let both = self.plain.iter().filter_map(|(run, plain)| {
            let replanned = self.replanned.get(run)?;
            Some((*run, [*plain, *replanned]))
        });
        let times: Vec<_> = both.collect();
        let events = &program.compiled.graph.events;
        let releases = events.iter().filter(|event| !event.action.is_capture());
        let plans = (self.plans, self.not_planned);
        Replanning::of(&program.name, after, &times, plans, releases.count())
    }
}

/// What a run had done by a tick.
fn until(record: &RunRecord, tick: u64) -> RunRecord {
    let mut record = record.clone();
    record.bonds.retain(|bond| bond.docked <= tick);
    record.releases.retain(|release| release.tick <= tick);
    record
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compile;
    use std::ops::ControlFlow;
    use stochc_runtime::{Model, Settings, run};

    const LINE: &str =
        "assembly line { seed plate 1 x 1 { M at (0, 0) } phase grow { M.up ->> T[1..4] } }";

    fn line() -> (EnsembleProgram, RunRecord) {
        let executable = compile(check_text("line.sa", LINE))
            .expect("it is right")
            .remove(0);
        let settings = Settings::of(Model::Rate, 1);
        let mut watch = |_, _| ControlFlow::Continue(());
        let (tables, scene) = (&executable.tables, &executable.scene);
        let record = run(tables, scene, &settings, 1, 0, &mut watch).expect("it runs");
        (EnsembleProgram::new("line", Vec::new(), executable), record)
    }

    #[test]
    fn a_stall_is_the_first_wait_that_is_too_long() {
        let (_, record) = line();
        let docked: Vec<u64> = record.bonds.iter().map(|bond| bond.docked).collect();
        let waits: Vec<u64> = docked.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert_eq!(stall(&record, record.ticks), None);
        assert_eq!(stall(&record, 1), Some(1));
        let longest = *waits.iter().max().expect("it waits").max(&docked[0]);
        assert_eq!(stall(&record, longest), None);
        let stop = stall(&record, longest - 1).expect("one is longer");
        let left = until(&record, stop);
        assert_eq!(
            stop,
            left.bonds.last().map_or(0, |bond| bond.docked) + longest - 1
        );
    }

    #[test]
    fn times_of_a_chain_are_added_up_to_the_limit() {
        let (program, record) = line();
        let how = Replan {
            after: 1,
            threads: None,
        };
        let mut outcomes = Outcomes::default();
        let chain = |elapsed, plans| ReplannedRun {
            run: 7,
            elapsed,
            plans,
        };
        let limit = Some(record.ticks + 100);
        let none = |_: &ExistingStructure| None;
        let again = |_: &ExistingStructure| Some(line().0);
        let (next, _) = (outcomes.follow(chain(0, 0), &program, &record, how, again, limit))
            .expect("it goes on with a plan");
        assert_eq!((next.elapsed, next.plans), (1, 1));
        let whole = Observation::completed(record.ticks as f64);
        assert_eq!(outcomes.plain.get(&7), Some(&whole));
        // Without a plan, it goes on as it is.
        assert!(
            outcomes
                .follow(chain(100, 1), &program, &record, how, none, limit)
                .is_none()
        );
        let later = Observation::completed((record.ticks + 100) as f64);
        assert_eq!(outcomes.replanned.get(&7), Some(&later));
        assert!(
            outcomes
                .follow(chain(101, 1), &program, &record, how, none, limit)
                .is_none()
        );
        let late = Observation::censored((record.ticks + 100) as f64);
        assert_eq!(outcomes.replanned.get(&7), Some(&late));
        assert_eq!((outcomes.plans, outcomes.not_planned), (1, 2));
    }
}
