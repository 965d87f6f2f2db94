//! What came of a sweep, point by point.
use serde::Serialize;
use stochc_ir::record::{BondRecord, Origin, RunRecord};

use crate::statistics::{Status, TimeSample, share_interval};
use crate::{Time, TimeUnit, completion_time, last_seen};
use stochc_results::{
    ChosenSetting, EnsembleProgram, Finished, JournalError, Manifest, Records, Varied,
};
use stochc_text::Tick;

/// The unit of times where all scenes have ticks of one length.
const TICKS: &str = "ticks";

/// Numbers of a scene that were varied, and what became of the times.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sweep {
    /// The numbers, in the order of the command line.
    pub axes: Vec<SweptNumber>,
    /// Names of the settings that were varied.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub settings: Vec<String>,
    /// The unit of all times: ticks, or seconds where the points differ in the length of a tick.
    pub unit: &'static str,
    /// In the order of the manifest.
    pub points: Vec<SweepPoint>,
}

/// A number that was varied.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SweptNumber {
    /// Its name, such as `bond.pull`.
    pub of: String,
    /// The unit of its values; empty: none.
    pub unit: String,
}

/// A program at one value of each number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepPoint {
    /// The program's name in the manifest, such as `line [free=50]`.
    pub name: String,
    /// The name without the values of the scene.
    pub program: String,
    /// One for each axis.
    pub values: Vec<SweptValue>,
    /// The settings that were chosen for it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub chosen: Vec<ChosenSetting>,
    /// Length of a tick of its scene \[s\].
    pub tick: f64,
    /// Runs asked for.
    pub runs: u64,
    /// Runs that completed.
    pub completed: usize,
    /// Runs that a timeout of the program has ended: they never complete.
    pub timed_out: usize,
    /// Runs that reached the limit of ticks: their times are right-censored.
    pub censored: usize,
    /// Runs whose physics broke down, which no time counts.
    pub failed: usize,
    /// The part of the finished runs that completed, 0 to 1; `None`: none is finished.
    pub share: Option<f64>,
    /// Its 95 % interval, by Wilson.
    pub share_interval: Option<(f64, f64)>,
    /// The time to completion.
    pub time: Option<Time>,
    /// Captures that were made, in all runs that did not fail; blocks attached by hand are none.
    pub captures: u64,
    /// The part of them that took a block which had been released before, 0 to 1.
    pub released: Option<f64>,
    /// The time of all runs that did not fail over the captures that they made.
    pub time_per_capture: Option<f64>,
}

/// A value of a number that was varied.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SweptValue {
    /// In the unit of its axis.
    pub value: f64,
    /// In SI units.
    pub si: f64,
}

impl SweptNumber {
    /// As an axis says it: `bond.pull [N]`.
    pub fn label(&self) -> String {
        match &*self.unit {
            "" => self.of.clone(),
            unit => format!("{} [{unit}]", self.of),
        }
    }

    /// One of its values, such as `bond.pull=4.5 N`.
    pub fn at(&self, value: SweptValue) -> String {
        let varied = Varied {
            of: self.of.clone(),
            value: value.si,
            said: value.value,
            unit: self.unit.clone(),
        };
        varied.text()
    }
}

/// A sweep while runs are told, sorted by program and run.
#[derive(Debug)]
pub struct SweepTally<'a> {
    manifest: &'a Manifest,
    axes: Vec<SweptNumber>,
    /// Whether all scenes have ticks of one length.
    is_one: bool,
    programs: Vec<PointTally>,
}

impl<'a> SweepTally<'a> {
    /// Before the first run of the sweep that a manifest asks for; `None`: it asks for none.
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
            programs: programs.map(|it| PointTally::new(unit(it))).collect(),
        })
    }

    /// Adds a run.
    pub fn add(&mut self, done: &Finished) {
        let program = &self.manifest.programs[done.program];
        self.programs[done.program].add(program, &done.record);
    }

    /// What came of it.
    pub fn finish(self) -> Sweep {
        let (axes, settings) = (&self.axes, self.manifest.swept().settings);
        let last = self.programs.iter().map(PointTally::last_seen);
        let last = last.fold(0.0, f64::max);
        let programs = self.manifest.programs.iter().zip(self.programs);
        // A manifest that somebody has edited may hold others.
        let same = programs
            .filter(|(program, _)| program.varied.iter().map(dial).eq(axes.iter().cloned()));
        let point = |(program, tally): (&EnsembleProgram, PointTally)| {
            let values = program.varied.iter().map(|varied| SweptValue {
                value: varied.said,
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
            SweepPoint {
                chosen: program.chosen.clone(),
                ..point
            }
        };
        Sweep {
            unit: if self.is_one { TICKS } else { "s" },
            points: same.map(point).collect(),
            axes: self.axes.clone(),
            settings: settings.into_iter().map(str::to_owned).collect(),
        }
    }
}

fn dial(varied: &Varied) -> SweptNumber {
    SweptNumber {
        of: varied.of.clone(),
        unit: varied.unit.clone(),
    }
}

impl Sweep {
    /// What came of the sweep that a manifest asks for; `None`: it asks for none.
    ///
    /// # Errors
    /// Where the runs cannot be read again.
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

    /// Converts all times to seconds.
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

    /// Gives each point and its program the name that `label` returns for its own.
    pub fn relabel(&mut self, label: impl Fn(&str) -> String) {
        for point in &mut self.points {
            point.name = label(&point.name);
            point.program = label(&point.program);
        }
    }

    /// The clock of a point, where times are in ticks; `None`: they are in seconds.
    pub fn tick(&self, point: &SweepPoint) -> Option<Tick> {
        (self.unit == TICKS).then_some(Tick(point.tick))
    }

    /// The names of the programs that were swept, each once.
    pub fn programs(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for point in &self.points {
            if !names.contains(&&*point.program) {
                names.push(&point.program);
            }
        }
        names
    }
}

/// A point while its runs are told, by number.
#[derive(Clone, Debug, Default)]
pub struct PointTally {
    /// Of a tick in the unit of the sweep.
    unit: f64,
    finished: usize,
    times: TimeSample,
    captures: u64,
    released: usize,
    spent: f64,
}

impl PointTally {
    /// Before the first run, in whose scene a tick has so many units of the sweep.
    pub fn new(unit: f64) -> PointTally {
        PointTally {
            unit,
            ..PointTally::default()
        }
    }

    /// Adds a run of a program.
    pub fn add(&mut self, program: &EnsembleProgram, record: &RunRecord) {
        self.finished += 1;
        let Some(mut time) = completion_time(record) else {
            return;
        };
        time.time *= self.unit;
        self.times.push(time);
        self.spent += time.time;
        // What is attached by hand was not captured.
        let is_captured = |bond: &&BondRecord| !program.is_planted(bond.phase);
        for bond in record.bonds.iter().filter(is_captured) {
            self.captures += 1;
            self.released += usize::from(matches!(bond.origin, Origin::Released { .. }));
        }
    }

    /// The last time that was seen of any of its runs, in the unit of the sweep.
    pub fn last_seen(&self) -> f64 {
        last_seen(self.times.iter())
    }

    /// What became of the point, whose name is given with its values and without; `runs` were asked for, and a tick has so
    /// many seconds. The last time that was seen at any point is `last`.
    pub fn finish(
        self,
        (name, program): (String, String),
        values: Vec<SweptValue>,
        runs: u64,
        tick: f64,
        last: f64,
    ) -> SweepPoint {
        let times = self.times.to_vec();
        let count = |status| times.iter().filter(|time| time.status == status).count();
        let completed = count(Status::Completed);
        let any = (self.captures > 0).then_some(self.captures as f64);
        let finished = self.finished;
        SweepPoint {
            name,
            program,
            values,
            chosen: Vec::new(),
            tick,
            runs,
            completed,
            timed_out: count(Status::Competing),
            censored: count(Status::Censored),
            failed: finished - times.len(),
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
    /// Finished runs.
    pub fn finished(&self) -> usize {
        self.completed + self.timed_out + self.censored + self.failed
    }
}
