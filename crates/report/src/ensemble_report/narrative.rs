//! Description of the critical path of a run in sentences.
use stochc_ir::graph::Dependency;
use stochc_ir::record::{Limit, Origin, Outcome};
use stochc_results::EnsembleProgram;
use stochc_text::{Tick, escaped, number, whole_percent};

use super::html::{code, name};
use crate::analysis::critical_path::{CriticalPathSegment, SegmentKind};
use crate::analysis::events::Events;
use crate::analysis::reported_program::FinishedRun;

/// Program and replay that the description of a run refers to.
pub(crate) struct NarrativeContext<'a> {
    pub program: &'a EnsembleProgram,
    pub events: &'a Events,
    /// Address of the replay of the run. `None` if there is no replay.
    pub replay: Option<String>,
    /// Whether the run was measured in an experiment.
    pub is_measured: bool,
}

impl NarrativeContext<'_> {
    fn tick(&self) -> Tick {
        Tick(self.program.scene.tick)
    }

    /// Returns a tick of the run as HTML. It is a link if there is a replay.
    fn at(&self, tick: u64) -> String {
        tick_of(self.replay.as_deref(), tick)
    }
}

/// Returns a tick of a run as HTML. It is a link if `replay` is an address.
pub(super) fn tick_of(replay: Option<&str>, tick: u64) -> String {
    let text = number(tick as f64);
    match replay {
        Some(address) => format!("<a href=\"{}#tick={tick}\">{text}</a>", escaped(address)),
        None => text,
    }
}

/// Largest number of described segments. A longer path is reduced to its longest segments.
const MAX_SEGMENTS: usize = 12;

/// Returns the heading of a run as HTML: its number, its description and its time.
pub(super) fn heading(of: &NarrativeContext, what: &str, run: &FinishedRun) -> String {
    let record = &run.record;
    let end = match &record.outcome {
        Outcome::Completed => String::new(),
        Outcome::TimedOut { phase, by } => {
            let end = match by {
                Limit::Timeout => "stopped by its timeout",
                Limit::MaxTicks if of.is_measured => "in progress or stopped",
                Limit::MaxTicks => "stopped by <code>--max-ticks</code>",
            };
            let phase = code(of.program.phase(*phase));
            format!(", {end} in phase {phase}")
        }
        Outcome::Failed { .. } => ", failed".to_owned(),
    };
    // The heading names the last tick.
    let unit = if record.ticks == 1 { "tick" } else { "ticks" };
    format!(
        "Run {}, the {what}: {} {unit}{}{end}",
        record.run,
        of.at(record.ticks),
        of.tick().beside(record.ticks as f64)
    )
}

/// Returns the critical path of a run as list items of HTML.
pub(super) fn narrative(of: &NarrativeContext, run: &FinishedRun) -> Vec<String> {
    let mut longest: Vec<u64> = run
        .critical_path
        .iter()
        .map(CriticalPathSegment::ticks)
        .collect();
    // Segments without duration are left out first.
    longest.retain(|&ticks| ticks > 0);
    longest.sort_unstable_by(|a, b| b.cmp(a));
    let least = longest.get(MAX_SEGMENTS).copied();
    let is_long = |segment: &&CriticalPathSegment| match least {
        None => true,
        // Segments of equal length are treated alike. A sequence of short waits is described as one
        // item.
        Some(least) => segment.ticks() > least,
    };
    let mut items = Vec::new();
    let mut passed: Vec<&CriticalPathSegment> = Vec::new();
    for segment in &run.critical_path {
        if is_long(&segment) {
            items.extend(between(of, &passed));
            passed.clear();
            items.push(item(of, run, segment));
        } else {
            passed.push(segment);
        }
    }
    items.extend(between(of, &passed));
    items
}

/// Returns a sentence of HTML about the longest wait. Returns `None` if this wait does not dominate
/// the run.
pub(super) fn lead(of: &NarrativeContext, run: &FinishedRun) -> Option<String> {
    let total = run.record.ticks;
    let longest = run
        .critical_path
        .iter()
        .max_by_key(|segment| segment.ticks())?;
    let share = longest.ticks() as f64 / total.max(1) as f64;
    let text = |event: usize| code(&of.events.events[event].text(of.program));
    let subject = match (longest.kind, longest.since) {
        (SegmentKind::Notification, Some((first, _))) => {
            format!("The message about {}", text(first))
        }
        _ => text(longest.event()?),
    };
    (share >= 0.25).then(|| {
        format!(
            "{subject} alone took {} of this time.",
            whole_percent(share)
        )
    })
}

/// Returns the times when the largest group of an aggregate reached each size, as list items of
/// HTML.
pub(super) fn sizes(of: &NarrativeContext, run: &FinishedRun) -> Vec<String> {
    let mut tick: u64 = 0;
    let phases = of.program.phases().iter().zip(&run.record.phase_ticks);
    let reached = phases.map(|(phase, ticks)| {
        tick = tick.saturating_add(*ticks);
        format!(
            "A group of {} blocks at tick {}.",
            name(&phase.name),
            of.at(tick)
        )
    });
    reached.collect()
}

fn between(of: &NarrativeContext, passed: &[&CriticalPathSegment]) -> Option<String> {
    let waits: Vec<u64> = passed.iter().map(|segment| segment.ticks()).collect();
    let spent = waits
        .iter()
        .fold(0, |spent: u64, wait| spent.saturating_add(*wait));
    let longest = waits.iter().copied().max().unwrap_or(0);
    // These releases were immediate. The description of the next segment mentions them.
    if longest == 0 {
        return None;
    }
    let (first, last) = (passed.first()?, passed.last()?);
    Some(format!(
        "{} waits of at most {} followed one after the other. Together they took {}, from tick {} to {}.",
        waits.iter().filter(|wait| **wait > 0).count(),
        ticks(of, longest),
        ticks(of, spent),
        of.at(first.from),
        of.at(last.to)
    ))
}

pub(crate) fn item(
    of: &NarrativeContext,
    run: &FinishedRun,
    segment: &CriticalPathSegment,
) -> String {
    let share = segment.ticks() as f64 / run.record.ticks.max(1) as f64;
    // Duration of the segment in seconds, and its share of the run.
    let seconds = of.tick().seconds(segment.ticks() as f64);
    let share = match share {
        share if share >= 0.005 => format!(" ({seconds}, {})", whole_percent(share)),
        _ => format!(" ({seconds})"),
    };
    match segment.kind {
        SegmentKind::Reports => format!(
            "Then the reports took {}{share} to reach the plate, from tick {} on.",
            count(segment.ticks()),
            of.at(segment.from)
        ),
        SegmentKind::Wait => format!(
            "The <code>wait</code> of the phase took {}{share}, from tick {} on.",
            count(segment.ticks()),
            of.at(segment.from)
        ),
        SegmentKind::Aborted => format!(
            "Attempts at the phase that timed out took {}{share}, from tick {} on.",
            count(segment.ticks()),
            of.at(segment.from)
        ),
        SegmentKind::Notification => format!(
            "Then the message about it took {}{share} to reach the block that waited for it, from tick {} on.",
            count(segment.ticks()),
            of.at(segment.from)
        ),
        SegmentKind::Pending { event } => {
            let text = of.events.events[event].text(of.program);
            format!(
                "{} had waited <strong>{}</strong>{share} when the run was stopped. It waited from tick {}, {}.",
                code(&text),
                count(segment.ticks()),
                of.at(segment.from),
                reason(of, segment)
            )
        }
        SegmentKind::Event { event, bond } => {
            let text = of.events.events[event].text(of.program);
            let Some(bond) = bond.map(|i| &run.record.bonds[i]) else {
                let waited = match segment.ticks() {
                    0 => String::new(),
                    n => format!(" after {}", ticks(of, n)),
                };
                return format!(
                    "{}{waited}, at tick {}, {}.",
                    code(&text),
                    of.at(segment.to),
                    reason(of, segment)
                );
            };
            let origin = match &bond.origin {
                Origin::Free => String::new(),
                Origin::Released { role, tick } => format!(
                    "; it was the former {}, released at tick {}",
                    code(of.program.role(*role)),
                    of.at(*tick)
                ),
            };
            let docked = |entries: &str| {
                let docking = ticks(of, bond.docking);
                format!(": {entries} took {docking} to dock")
            };
            let entries = match bond.entries {
                // The blocks do not move in this model.
                0 => String::new(),
                1 => docked("1 block entered the field and"),
                n => docked(&format!(
                    "blocks entered the field {} times, and the one that stayed",
                    number(f64::from(n))
                )),
            };
            format!(
                "{} waited <strong>{}</strong>{share}, from tick {}, {}{entries}{origin}.",
                code(&text),
                count(segment.ticks()),
                of.at(segment.from),
                reason(of, segment),
            )
        }
    }
}

/// Returns the reason why a wait began, as the end of a sentence.
fn reason(of: &NarrativeContext, segment: &CriticalPathSegment) -> String {
    let Some((first, why)) = segment.since else {
        let phase = name(of.program.phase(segment.phase));
        return format!("the beginning of phase <code>{phase}</code>");
    };
    let first = code(&of.events.events[first].text(of.program));
    match why {
        Dependency::Anchored => format!("when {first} had anchored its block"),
        Dependency::Face { .. } => format!("when {first} had left its block a face to magnetize"),
        Dependency::After => format!("because the program puts it after {first}"),
        Dependency::Emptied => format!("when {first} had let the last of its children go"),
        Dependency::Vacated => format!("when {first} had emptied the cell"),
        Dependency::Freed => format!("when {first} had made the name free"),
    }
}

/// Returns a number of ticks, followed by the same time in seconds.
fn ticks(of: &NarrativeContext, n: u64) -> String {
    count(n) + &of.tick().beside(n as f64)
}

fn count(n: u64) -> String {
    match n {
        1 => "1 tick".to_owned(),
        n => format!("{} ticks", number(n as f64)),
    }
}
