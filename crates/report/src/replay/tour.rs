//! What decided how long a run took, as steps that a page goes through.
use serde_json::{Value, json};
use stochc_ir::record::RunRecord;
use stochc_results::EnsembleProgram;

use crate::analysis::events::Events;
use crate::analysis::reported_program::FinishedRun;
use crate::ensemble_report::narrative::{NarrativeContext, item};

/// Steps of a tour, at most: of a longer path those that took longest.
const MAX: usize = 200;

/// `[{ from, to, cell, html }]`: the waits that met end to end, in ticks, where each happened, and the sentence of a report that tells
/// it.
pub fn tour(program: &EnsembleProgram, record: &RunRecord) -> Value {
    let events = Events::new(program);
    let run = FinishedRun::from_record(&events, record);
    let context = NarrativeContext {
        program,
        events: &events,
        replay: None,
    };
    let mut lengths: Vec<u64> = run
        .critical_path
        .iter()
        .map(|segment| segment.ticks())
        .collect();
    lengths.sort_unstable_by(|a, b| b.cmp(a));
    // What took no time is told by what waited for it.
    let least = lengths.get(MAX).map_or(1, |&ticks| ticks + 1);
    let told = run
        .critical_path
        .iter()
        .filter(|segment| segment.ticks() >= least);
    let steps = told.map(|segment| {
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
