//! Tour of a replay page: the critical path of a run, step by step.
use serde_json::{Value, json};
use stochc_ir::record::RunRecord;
use stochc_results::EnsembleProgram;

use crate::analysis::events::Events;
use crate::analysis::reported_program::FinishedRun;
use crate::ensemble_report::narrative::{NarrativeContext, item};

/// Largest number of steps. Longer tours are reduced to the longest segments.
const MAX: usize = 200;

/// Returns `[{ from, to, cell, html }]`: the waits on the critical path. Each has its ticks, its
/// cell, and its description as in a report.
pub fn tour(program: &EnsembleProgram, record: &RunRecord) -> Value {
    let events = Events::new(program);
    let run = FinishedRun::from_record(&events, record);
    let context = NarrativeContext {
        program,
        events: &events,
        replay: None,
        is_measured: false,
    };
    let mut lengths: Vec<u64> = run
        .critical_path
        .iter()
        .map(|segment| segment.ticks())
        .collect();
    lengths.sort_unstable_by(|a, b| b.cmp(a));
    // The description of the waiting event mentions segments without duration.
    let least = lengths.get(MAX).map_or(1, |&ticks| ticks + 1);
    let longest = run
        .critical_path
        .iter()
        .filter(|segment| segment.ticks() >= least);
    let steps = longest.map(|segment| {
        let cell = segment.event().and_then(|event| {
            let event = &events.events[event];
            let graph = &program.compiled.graph;
            let same = graph.events_of(event.phase).map(|id| graph.event(id));
            let mut same = same.filter(|it| it.action == event.action);
            same.next().and_then(|it| it.cell)
        });
        json!({ "from": segment.from, "to": segment.to, "cell": cell, "html": item(&context, &run, segment) })
    });
    Value::Array(steps.collect())
}
