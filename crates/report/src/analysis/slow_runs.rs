//! Comparison of the slowest and the fastest runs of a program.
use super::critical_path::SegmentKind;
use super::decisive_events::DecisiveEvents;
use super::events::Events;
use super::reported_program::FinishedRun;

/// Smallest number of runs with a comparison: the tenths then have two runs each.
pub const MIN_RUNS: usize = 20;

/// Slowest and fastest tenth of the runs of a program.
#[derive(Clone, Debug)]
pub(crate) struct SlowRuns {
    slowest: DecisiveEvents,
    fastest: DecisiveEvents,
    /// For each event, its largest time on the critical path of a slow run \[ticks\], and this run.
    longest: Vec<(u64, u64)>,
    /// For each event, its docking times on critical paths of slow runs, minus those of fast runs
    /// \[ticks\].
    docking: Vec<f64>,
    /// Number of runs in each tenth.
    pub runs: usize,
    /// Number of unplanned bonds in the slowest and in the fastest tenth.
    pub unplanned: [u64; 2],
}

impl SlowRuns {
    pub fn new(events: &Events, runs: usize) -> SlowRuns {
        SlowRuns {
            slowest: DecisiveEvents::new(events),
            fastest: DecisiveEvents::new(events),
            longest: vec![(0, 0); events.events.len()],
            docking: vec![0.0; events.events.len()],
            runs,
            unplanned: [0; 2],
        }
    }

    pub fn add_fast(&mut self, run: &FinishedRun) {
        self.fastest.add(run.record.ticks, &run.critical_path);
        self.unplanned[1] += run.record.unplanned;
        self.add_docking(run, -1.0);
    }

    pub fn add_slow(&mut self, run: &FinishedRun) {
        self.slowest.add(run.record.ticks, &run.critical_path);
        self.unplanned[0] += run.record.unplanned;
        self.add_docking(run, 1.0);
        for segment in &run.critical_path {
            if let Some(event) = segment.event() {
                let longest = &mut self.longest[event];
                *longest = (*longest).max((segment.ticks(), run.record.run));
            }
        }
    }

    /// Adds the docking times on the critical path of a run, multiplied by `sign`.
    fn add_docking(&mut self, run: &FinishedRun, sign: f64) {
        for segment in &run.critical_path {
            if let SegmentKind::Event {
                event,
                bond: Some(bond),
            } = segment.kind
            {
                let docking = run.record.bonds[bond].docking.min(segment.ticks());
                self.docking[event] += sign * docking as f64;
            }
        }
    }

    /// Returns the part of [`SlowRuns::difference`] after the last entry of the captured block
    /// \[ticks\]. It is large if blocks jam at the face.
    pub fn docking(&self, event: usize) -> f64 {
        self.docking[event] / self.runs as f64
    }

    /// Returns the [difference](SlowRuns::difference) for the `wait` of a phase \[ticks\].
    pub fn difference_of_wait(&self, phase: usize) -> f64 {
        (self.slowest.waits[phase].spent - self.fastest.waits[phase].spent) / self.runs as f64
    }

    /// Returns the mean time of an event on the critical path of slow runs, minus that of fast runs
    /// \[ticks\].
    pub fn difference(&self, event: usize) -> f64 {
        (self.slowest.spent[event] - self.fastest.spent[event]) / self.runs as f64
    }

    /// Returns the slow run with the largest time of an event on its critical path. Returns `None`
    /// if the event is on none of these paths.
    pub fn run_to_watch(&self, event: usize) -> Option<u64> {
        let (ticks, run) = self.longest[event];
        (ticks > 0).then_some(run)
    }
}
