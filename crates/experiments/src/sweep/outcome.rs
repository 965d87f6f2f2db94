//! Results of a sweep at each point.
use serde::Serialize;
use stochc_ir::record::{BondRecord, Origin, RunRecord};

use super::elasticity::{SweptElasticity, elasticities};
use crate::resampling::{Replicates, weights};
use crate::statistics::{Observation, TimeSample, share_interval};
use crate::{OutcomeCounts, Time, TimeUnit, completion_time, last_seen};
use stochc_results::{
    ChosenSetting, EnsembleProgram, Finished, JournalError, Manifest, Records, Varied,
};
use stochc_text::Tick;

/// Name of the unit of times if the ticks of all scenes have the same length.
const TICKS: &str = "ticks";

/// Results of a sweep: its parameters, and the times at each point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sweep {
    /// Scene parameters that the sweep varies, in the order of the command line.
    pub axes: Vec<SweptNumber>,
    /// Names of the settings that the sweep varies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub settings: Vec<String>,
    /// Unit of all times: ticks, or seconds if the ticks of the points differ in length.
    pub unit: &'static str,
    /// Points in the order of the manifest.
    pub points: Vec<SweepPoint>,
    /// Elasticity of the mean for each program and each axis with positive values.
    pub elasticities: Vec<SweptElasticity>,
}

/// Scene parameter that a sweep varies.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SweptNumber {
    /// Name of the parameter, such as `bond.pull`.
    pub name: String,
    /// Unit of the values. Empty if the parameter has no unit.
    pub unit: String,
}

/// Point of a sweep: a program with one value for each axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepPoint {
    /// Name of the program in the manifest, such as `line [free=50]`.
    pub name: String,
    /// Name of the program without the values of the point.
    pub program: String,
    /// Value of each scene parameter that the sweep varies.
    pub values: Vec<SweptValue>,
    /// Settings of the point that differ from the settings of the ensemble.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub chosen: Vec<ChosenSetting>,
    /// Length of a tick at this point \[s\].
    pub tick: f64,
    /// Number of requested runs.
    pub runs: u64,
    /// Number of completed runs.
    pub completed: usize,
    /// Number of runs that timed out in a phase. They never complete.
    pub timed_out: usize,
    /// Number of runs that reached the limit of ticks. Their times are right-censored.
    pub censored: usize,
    /// Number of runs whose computation failed, or whose structure broke. Failed computations are
    /// excluded from all times.
    pub failed: usize,
    /// Share of the finished runs that completed, 0 to 1. `None` if no run is finished.
    pub share: Option<f64>,
    /// 95 % interval of the share, by Wilson.
    pub share_interval: Option<(f64, f64)>,
    /// Completion time. `None` if no run has a time.
    pub time: Option<Time>,
    /// Number of captures in all runs that did not fail. Excludes pre-attached blocks.
    pub captures: u64,
    /// Fraction of captures whose block had been released before. `None` without captures.
    pub released: Option<f64>,
    /// Mean time per capture: total time of all runs that did not fail, divided by their number of
    /// captures.
    pub time_per_capture: Option<f64>,
}

/// Value of a scene parameter at a point of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SweptValue {
    /// Value in the unit of the axis.
    pub value: f64,
    /// Value in SI units.
    pub si: f64,
}

impl SweptNumber {
    /// Returns the label of the parameter's axis, such as `bond.pull [N]`.
    pub fn label(&self) -> String {
        match &*self.unit {
            "" => self.name.clone(),
            unit => format!("{} [{unit}]", self.name),
        }
    }

    /// Returns the parameter with a value, such as `bond.pull=4.5 N`.
    pub fn at(&self, value: SweptValue) -> String {
        let varied = Varied {
            name: self.name.clone(),
            value: value.si,
            given: value.value,
            unit: self.unit.clone(),
        };
        varied.text()
    }
}

/// Accumulator for the results of a sweep. Runs must be added in the order of program and number.
#[derive(Debug)]
pub struct SweepTally<'a> {
    manifest: &'a Manifest,
    axes: Vec<SweptNumber>,
    /// Whether the ticks of all scenes have the same length.
    is_one: bool,
    programs: Vec<PointTally>,
    /// Sum of the completion times of each program, in the unit of the sweep.
    sums: Vec<Replicates>,
}

impl<'a> SweepTally<'a> {
    /// Creates an accumulator for the sweep of a manifest. Returns `None` if the manifest has no
    /// sweep.
    pub fn new(manifest: &'a Manifest) -> Option<SweepTally<'a>> {
        let axes: Vec<SweptNumber> = manifest.axes().iter().map(dial).collect();
        if axes.is_empty() && !manifest.varies_settings() {
            return None;
        }
        let mut ticks = manifest.programs.iter().map(|program| program.scene.tick);
        let is_one = ticks.next().is_some_and(|tick| ticks.all(|it| it == tick));
        let unit = |program: &EnsembleProgram| if is_one { 1.0 } else { program.scene.tick };
        let programs = manifest.programs.iter();
        Some(SweepTally {
            manifest,
            axes,
            is_one,
            sums: vec![Replicates::default(); manifest.programs.len()],
            programs: programs.map(|it| PointTally::new(unit(it))).collect(),
        })
    }

    /// Adds a finished run.
    pub fn add(&mut self, done: &Finished) {
        let program = &self.manifest.programs[done.program];
        let point = &mut self.programs[done.program];
        point.add(program, &done.record);
        let time = completion_time(&done.record).and_then(Observation::completed_time);
        if let Some(time) = time.filter(|_| !self.axes.is_empty()) {
            let weights = weights(self.manifest.seed, done.record.run);
            self.sums[done.program].add(time * point.unit, &weights);
        }
    }

    /// Returns the results of the runs added so far.
    pub fn finish(self) -> Sweep {
        let (axes, settings) = (&self.axes, self.manifest.swept().settings);
        let last = self.programs.iter().map(PointTally::last_seen);
        let last = last.fold(0.0, f64::max);
        let tallies = self.programs.into_iter().zip(self.sums);
        let programs = self.manifest.programs.iter().zip(tallies);
        // A manifest that was edited by hand can contain other parameters.
        let same = programs
            .filter(|(program, _)| program.varied.iter().map(dial).eq(axes.iter().cloned()));
        let point = |(program, (tally, sum)): (&EnsembleProgram, (PointTally, Replicates))| {
            let values = program.varied.iter().map(|varied| SweptValue {
                value: varied.given,
                si: varied.value,
            });
            let names = (program.name.clone(), program.name_without_numbers());
            let point = tally.finish(
                names,
                values.collect(),
                self.manifest.runs,
                program.scene.tick,
                last,
            );
            let chosen = program.chosen.clone();
            (SweepPoint { chosen, ..point }, sum)
        };
        let (points, sums): (Vec<_>, Vec<_>) = same.map(point).unzip();
        Sweep {
            unit: if self.is_one { TICKS } else { "s" },
            elasticities: elasticities(axes, &points, &sums),
            points,
            axes: self.axes.clone(),
            settings: settings.into_iter().map(str::to_owned).collect(),
        }
    }
}

fn dial(varied: &Varied) -> SweptNumber {
    SweptNumber {
        name: varied.name.clone(),
        unit: varied.unit.clone(),
    }
}

impl Sweep {
    /// Returns the results of the sweep of a manifest. Returns `None` if the manifest has no sweep.
    ///
    /// # Errors
    ///
    /// If the runs cannot be read again.
    pub fn from_records(
        manifest: &Manifest,
        finished: &Records,
    ) -> Result<Option<Sweep>, JournalError> {
        let Some(mut tally) = SweepTally::new(manifest) else {
            return Ok(None);
        };
        finished.each(|done| tally.add(done))?;
        Ok(Some(tally.finish()))
    }

    /// Returns the sweep with all times in seconds.
    pub fn in_seconds(mut self) -> Sweep {
        if self.unit == TICKS {
            for point in &mut self.points {
                point.time.iter_mut().for_each(|it| it.scale(point.tick));
                let per_capture = point.time_per_capture.iter_mut();
                per_capture.for_each(|it| *it *= point.tick);
            }
            self.unit = TimeUnit::Seconds.unit();
        }
        self
    }

    /// Replaces the name of each point and of its program by the result of `label`.
    pub fn relabel(&mut self, label: impl Fn(&str) -> String) {
        for point in &mut self.points {
            point.name = label(&point.name);
            point.program = label(&point.program);
        }
        for of in &mut self.elasticities {
            of.program = label(&of.program);
        }
    }

    /// Returns the length of a tick at a point. Returns `None` if the times of the sweep are
    /// already in seconds.
    pub fn tick(&self, point: &SweepPoint) -> Option<Tick> {
        (self.unit == TICKS).then_some(Tick(point.tick))
    }

    /// Returns whether the points of every program are all combinations of the values of the axes.
    pub fn is_grid(&self) -> bool {
        let distinct = |axis: usize| {
            let values = self
                .points
                .iter()
                .filter_map(|point| point.values.get(axis));
            let mut values: Vec<u64> = values.map(|value| value.si.to_bits()).collect();
            values.sort_unstable();
            values.dedup();
            values.len()
        };
        let combinations: usize = (0..self.axes.len()).map(distinct).product();
        self.points.len() >= combinations * self.programs().len()
    }

    /// Returns the names of the programs in the sweep, without duplicates.
    pub fn programs(&self) -> Vec<&str> {
        programs(&self.points)
    }
}

/// Returns the names of the programs of points, without duplicates.
pub(super) fn programs(points: &[SweepPoint]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for point in points {
        if !names.contains(&&*point.program) {
            names.push(&point.program);
        }
    }
    names
}

/// Accumulator for the results at one point. Runs must be added in the order of their numbers.
#[derive(Clone, Debug, Default)]
pub struct PointTally {
    /// Length of a tick in the unit of the sweep.
    unit: f64,
    outcomes: OutcomeCounts,
    times: TimeSample,
    captures: u64,
    released: usize,
    spent: f64,
}

impl PointTally {
    /// Creates an accumulator. `unit` is the length of a tick in the unit of the sweep.
    pub fn new(unit: f64) -> PointTally {
        PointTally {
            unit,
            ..PointTally::default()
        }
    }

    /// Adds a run of a program.
    pub fn add(&mut self, program: &EnsembleProgram, record: &RunRecord) {
        self.outcomes.add(&record.outcome);
        let Some(mut time) = completion_time(record) else {
            return;
        };
        time.time *= self.unit;
        self.times.push(time);
        self.spent += time.time;
        // Pre-attached blocks are recorded but were not captured.
        let is_captured = |bond: &&BondRecord| !program.is_pre_attached(bond.phase);
        for bond in record.all_bonds().filter(is_captured) {
            self.captures += 1;
            self.released += usize::from(matches!(bond.origin, Origin::Released { .. }));
        }
    }

    /// Returns the latest observed time of all runs, in the unit of the sweep.
    pub fn last_seen(&self) -> f64 {
        last_seen(self.times.iter())
    }

    /// Returns the results of the point. The arguments are the names of the point and of its
    /// program, and its values. They also include the number of requested runs and the length of a
    /// tick \[s\]. `last` is the latest observed time at all points.
    pub fn finish(
        self,
        (name, program): (String, String),
        values: Vec<SweptValue>,
        runs: u64,
        tick: f64,
        last: f64,
    ) -> SweepPoint {
        let times = self.times.to_vec();
        let any = (self.captures > 0).then_some(self.captures as f64);
        let OutcomeCounts {
            completed,
            timed_out,
            censored,
            ..
        } = self.outcomes;
        let finished = self.outcomes.finished();
        SweepPoint {
            name,
            program,
            values,
            chosen: Vec::new(),
            tick,
            runs,
            completed,
            timed_out,
            censored,
            failed: self.outcomes.failed(),
            share: (finished > 0).then(|| completed as f64 / finished as f64),
            share_interval: share_interval(completed, finished),
            time: Time::beside(&times, last),
            captures: self.captures,
            released: any.map(|captures| self.released as f64 / captures),
            time_per_capture: any.map(|captures| self.spent / captures),
        }
    }
}

impl SweepPoint {
    /// Returns the number of finished runs.
    pub fn finished(&self) -> usize {
        self.completed + self.timed_out + self.censored + self.failed
    }
}
