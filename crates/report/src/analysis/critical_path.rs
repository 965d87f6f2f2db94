//! Critical path of a run: the consecutive waits that determine its completion time.
//!
//! A run ends with its last phase, and a phase ends with its last event. This event began to wait
//! when the last event that it depends on happened. Following these last events back to the start
//! of the run gives the critical path. No other wait of the run affected its completion time.
use std::collections::{HashMap, VecDeque};

use stochc_ir::graph::{Dependency, EventAction};
use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::PhaseId;

use super::events::{Events, OrderedEvent, awaited, captured};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CriticalPathSegment {
    pub phase: PhaseId,
    pub kind: SegmentKind,
    /// First tick of the segment in the run.
    pub from: u64,
    pub to: u64,
    /// Event that caused the start of this segment, and the kind of the dependency on this event.
    /// `None` at the beginning of a phase.
    pub since: Option<(usize, Dependency)>,
}

/// Cause of the duration of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SegmentKind {
    /// Wait for event number `event`. For a capture, `bond` is its index among the captures of the
    /// record. For a release, `bond` is `None`.
    Event { event: usize, bond: Option<usize> },
    /// Wait for capture number `event`, which had not happened when the run was stopped.
    Pending { event: usize },
    /// Transfer of messages from a dependency to the block of the event that waits for it.
    Notification,
    /// Transfer of messages to the plate. The messages report the events of a phase.
    Reports,
    /// Shortest duration of a phase. All its events happened earlier.
    Wait,
    /// Attempts at a phase that reached their timeouts, with the releases and pauses after them.
    Aborted,
}

/// Tick when an event of a run became possible, and tick of the event.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct EventTiming {
    /// Tick when the face was switched on or the release was requested. `None` if that never
    /// happened.
    pub ready: Option<u64>,
    /// Tick of the capture or release. `None` if it never happened.
    pub done: Option<u64>,
    /// Index of the capture in the record. `None` for a release or a missing capture.
    pub bond: Option<usize>,
}

impl CriticalPathSegment {
    pub fn ticks(&self) -> u64 {
        self.to.saturating_sub(self.from)
    }

    pub fn event(&self) -> Option<usize> {
        match self.kind {
            SegmentKind::Event { event, .. } | SegmentKind::Pending { event } => Some(event),
            SegmentKind::Notification
            | SegmentKind::Reports
            | SegmentKind::Wait
            | SegmentKind::Aborted => None,
        }
    }
}

/// Returns the timing of every event of a run, taken from its record. A release becomes possible as
/// soon as all its dependencies have happened.
pub(crate) fn moments(events: &Events, record: &RunRecord) -> Vec<EventTiming> {
    let mut recorded = recorded(record);
    let begins = attempts(record);
    let mut moments: Vec<EventTiming> = (events.events.iter())
        .map(|event| {
            let queue = recorded.get_mut(&(event.phase, event.action));
            queue.and_then(VecDeque::pop_front).unwrap_or_default()
        })
        .collect();
    for (number, event) in events.events.iter().enumerate() {
        if event.action.is_capture() {
            continue;
        }
        let begin = begins.get(event.phase.0 as usize);
        let ready = met(event, &moments)
            .map(|(_, _, done)| done)
            .chain([begin.copied()])
            .try_fold(0, |last, done| Some(last.max(done?)));
        moments[number].ready = ready;
    }
    moments
}

/// Returns the dependencies of an event: index and kind of each predecessor, and the tick when it
/// happened. The tick is `None` if the predecessor has not happened.
///
/// If a block must capture `needed` of several blocks first, only the capture that reaches this
/// number is returned.
fn met<'a>(
    event: &'a OrderedEvent,
    moments: &'a [EventTiming],
) -> impl Iterator<Item = (usize, Dependency, Option<u64>)> + 'a {
    let done = |first: usize| moments.get(first).and_then(|moment| moment.done);
    let mut faces: Vec<_> = (event.waits_for.iter())
        .filter_map(|&(first, why)| match why {
            Dependency::Face { needed, .. } => {
                Some((done(first).unwrap_or(u64::MAX), first, needed, why))
            }
            _ => None,
        })
        .collect();
    faces.sort_unstable();
    let face = faces
        .first()
        .map_or(0, |&(_, _, needed, _)| usize::from(needed));
    let face = face.checked_sub(1).and_then(|last| faces.get(last));
    let face = face.map(|&(_, first, _, why)| (first, why, done(first)));
    let others = event.waits_for.iter().copied();
    let others = others.filter(|(_, why)| !matches!(why, Dependency::Face { .. }));
    let others = others.map(move |(first, why)| (first, why, done(first)));
    others.chain(face)
}

/// Returns the timings that the record contains for each action in each phase, in the order of
/// repetitions.
fn recorded(record: &RunRecord) -> HashMap<(PhaseId, EventAction), VecDeque<EventTiming>> {
    let mut recorded: HashMap<_, VecDeque<EventTiming>> = HashMap::new();
    let mut add = |phase, action, moment| {
        recorded
            .entry((phase, action))
            .or_default()
            .push_back(moment);
    };
    for (i, bond) in record.bonds.iter().enumerate() {
        let moment = EventTiming {
            ready: Some(bond.magnetized),
            done: Some(bond.docked),
            bond: Some(i),
        };
        add(bond.phase, captured(bond), moment);
    }
    for wait in &record.waiting {
        let moment = EventTiming {
            ready: Some(wait.magnetized),
            ..EventTiming::default()
        };
        add(wait.phase, awaited(wait), moment);
    }
    for release in &record.releases {
        let moment = EventTiming {
            done: Some(release.tick),
            ..EventTiming::default()
        };
        let child = release.child;
        add(release.phase, EventAction::Release { child }, moment);
    }
    recorded
}

/// Returns the first tick of each phase that began.
fn begins(record: &RunRecord) -> Vec<u64> {
    let mut begins = vec![0];
    for ticks in &record.phase_ticks {
        let last = begins.last().copied().unwrap_or(0);
        // The journal may have been edited, so avoid overflow.
        begins.push(u64::saturating_add(last, *ticks));
    }
    begins
}

/// Returns the start of the last attempt at each phase that began.
fn attempts(record: &RunRecord) -> Vec<u64> {
    let begins = (0..).map(PhaseId).zip(begins(record));
    begins
        .map(|(phase, began)| record.last_retry(phase).unwrap_or(began))
        .collect()
}

/// Returns the critical path of a run, in order of time. Returns an empty path if the run failed.
pub(crate) fn critical_path(
    events: &Events,
    record: &RunRecord,
    moments: &[EventTiming],
) -> Vec<CriticalPathSegment> {
    if matches!(record.outcome, Outcome::Failed { .. }) {
        return Vec::new();
    }
    let (begins, attempts) = (begins(record), attempts(record));
    let mut segments = Vec::new();
    if let Outcome::TimedOut { phase, .. } = record.outcome {
        unfinished(events, record, moments, phase, &mut segments);
        let began = begins.get(phase.0 as usize);
        add_aborted(record, phase, began.copied().unwrap_or(0), &mut segments);
    }
    for (number, _) in record.phase_ticks.iter().enumerate().rev() {
        let (phase, end) = (PhaseId(number as u32), begins[number + 1]);
        let wait = events.waits.get(number).copied().unwrap_or(0);
        if wait > 0 && attempts[number].saturating_add(wait) == end {
            segments.push(CriticalPathSegment {
                phase,
                kind: SegmentKind::Wait,
                from: attempts[number],
                to: end,
                since: None,
            });
            add_aborted(record, phase, begins[number], &mut segments);
            continue;
        }
        let done = |&(i, _): &(usize, _)| moments[i].done;
        // If several events happened in the last tick, take the first one.
        let last = events.of_phase(number).rev().max_by_key(done);
        let Some((last, event)) = last else {
            continue;
        };
        let Some(tick) = moments[last].done else {
            continue;
        };
        if tick < end {
            segments.push(CriticalPathSegment {
                phase: event.phase,
                kind: SegmentKind::Reports,
                from: tick,
                to: end,
                since: None,
            });
        }
        back(events, moments, last, &mut segments);
        add_aborted(record, event.phase, begins[number], &mut segments);
    }
    segments.reverse();
    segments
}

/// Adds the aborted attempts at a phase that began at the tick `from`.
fn add_aborted(
    record: &RunRecord,
    phase: PhaseId,
    from: u64,
    segments: &mut Vec<CriticalPathSegment>,
) {
    let last = record.aborts.iter().rfind(|abort| abort.phase == phase);
    if let Some(last) = last {
        segments.push(CriticalPathSegment {
            phase,
            kind: SegmentKind::Aborted,
            from,
            to: last.retried.unwrap_or(record.ticks),
            since: None,
        });
    }
}

/// Adds the path of an unfinished phase, which ends with the pending event that has waited longest.
fn unfinished(
    events: &Events,
    record: &RunRecord,
    moments: &[EventTiming],
    phase: PhaseId,
    segments: &mut Vec<CriticalPathSegment>,
) {
    let here = || events.of_phase(phase.0 as usize);
    let waiting = here().filter(|(i, _)| moments[*i].done.is_none() && moments[*i].ready.is_some());
    match waiting.min_by_key(|&(i, _)| moments[i].ready) {
        Some((event, _)) => {
            let since = since(events, moments, event);
            let from = moments[event].ready.unwrap_or(0);
            segments.push(CriticalPathSegment {
                phase,
                kind: SegmentKind::Pending { event },
                from,
                to: record.ticks,
                since,
            });
            if let Some((first, _)) = since {
                add_notification(moments, phase, since, from, segments);
                back(events, moments, first, segments);
            }
        }
        // All events have happened, but the phase has a longer `wait`, or the plate has not received
        // all reports yet.
        None => {
            let number = phase.0 as usize;
            let wait = events.waits.get(number).copied().unwrap_or(0);
            let attempt = attempts(record).get(number).copied().unwrap_or(0);
            if record.ticks.saturating_sub(attempt) < wait {
                segments.push(CriticalPathSegment {
                    phase,
                    kind: SegmentKind::Wait,
                    from: attempt,
                    to: record.ticks,
                    since: None,
                });
                return;
            }
            let done = here().filter(|&(i, _)| moments[i].done.is_some());
            if let Some((last, _)) = done.max_by_key(|&(i, _)| moments[i].done) {
                segments.push(CriticalPathSegment {
                    phase,
                    kind: SegmentKind::Reports,
                    from: moments[last].done.unwrap_or(0),
                    to: record.ticks,
                    since: None,
                });
                back(events, moments, last, segments);
            }
        }
    }
}

/// Adds an event and the chain of its last dependencies within the phase, in reverse order.
fn back(
    events: &Events,
    moments: &[EventTiming],
    last: usize,
    segments: &mut Vec<CriticalPathSegment>,
) {
    let mut next = Some(last);
    // Dependencies happen earlier, so the chain is at most as long as the list of events.
    for _ in 0..events.events.len() {
        let Some(event) = next else { return };
        let moment = moments[event];
        let (Some(ready), Some(done)) = (moment.ready, moment.done) else {
            return;
        };
        let since = since(events, moments, event);
        // The cell may have become empty only after the face was switched on.
        let freed = since.and_then(|(first, _)| moments[first].done);
        let (phase, from) = (
            events.events[event].phase,
            ready.max(freed.unwrap_or(0)).min(done),
        );
        segments.push(CriticalPathSegment {
            phase,
            kind: SegmentKind::Event {
                event,
                bond: moment.bond,
            },
            from,
            to: done,
            since,
        });
        add_notification(moments, phase, since, from, segments);
        next = since.map(|(first, _)| first);
    }
}

/// Adds the transfer of messages from a dependency to the event. Adds nothing if messages take no
/// time.
fn add_notification(
    moments: &[EventTiming],
    phase: PhaseId,
    since: Option<(usize, Dependency)>,
    began: u64,
    segments: &mut Vec<CriticalPathSegment>,
) {
    let happened = since.and_then(|(first, _)| moments[first].done);
    if let Some(happened) = happened.filter(|&happened| happened < began) {
        segments.push(CriticalPathSegment {
            phase,
            kind: SegmentKind::Notification,
            from: happened,
            to: began,
            since,
        });
    }
}

/// Returns the last fulfilled dependency of an event.
fn since(events: &Events, moments: &[EventTiming], event: usize) -> Option<(usize, Dependency)> {
    let done = met(&events.events[event], moments).filter(|(_, _, done)| done.is_some());
    let last = done.max_by_key(|&(_, _, done)| done);
    last.map(|(first, why, _)| (first, why))
}

#[cfg(test)]
mod tests {
    use stochc_ir::record::{AbortRecord, BondRecord, Limit, Origin, ReleaseRecord, WaitRecord};
    use stochc_ir::table::RoleId;
    use stochc_ir::{Cell, Face};

    use super::*;

    fn capture(parent: u32, child: u32) -> EventAction {
        EventAction::Capture {
            parent: RoleId(parent),
            face: Face::Up,
            child: RoleId(child),
        }
    }

    fn event(phase: u32, action: EventAction, waits_for: &[(usize, Dependency)]) -> OrderedEvent {
        OrderedEvent {
            phase: PhaseId(phase),
            action,
            waits_for: waits_for.to_vec(),
        }
    }

    fn bond(phase: u32, parent: u32, child: u32, magnetized: u64, docked: u64) -> BondRecord {
        BondRecord {
            phase: PhaseId(phase),
            parent: RoleId(parent),
            face: Face::Up,
            child: RoleId(child),
            cell: Cell::new(0, 0, 1),
            magnetized,
            docked,
            entries: 1,
            docking: 0,
            body: child,
            origin: Origin::Free,
        }
    }

    fn record(outcome: Outcome, ticks: u64, phases: &[u64], bonds: Vec<BondRecord>) -> RunRecord {
        RunRecord {
            phase_ticks: phases.to_vec(),
            bonds,
            ..RunRecord::without_bonds(0, outcome, ticks)
        }
    }

    /// Returns the record of a release of E by its parent C.
    fn release(tick: u64) -> ReleaseRecord {
        ReleaseRecord {
            phase: PhaseId(1),
            parent: RoleId(2),
            child: RoleId(4),
            tick,
            body: 4,
        }
    }

    /// Returns a program with two phases. Phase 0: A -> C -> E, in parallel with B -> D. Phase 1:
    /// release of E, then A -> F.
    fn program() -> Events {
        Events {
            waits: Vec::new(),
            events: vec![
                event(0, capture(0, 2), &[]),
                event(0, capture(2, 4), &[(0, Dependency::Anchored)]),
                event(0, capture(1, 3), &[]),
                event(1, EventAction::Release { child: RoleId(4) }, &[]),
                event(1, capture(2, 5), &[(3, Dependency::Vacated)]),
            ],
        }
    }

    fn summary(segments: &[CriticalPathSegment]) -> Vec<(Option<usize>, u64, u64)> {
        let parts = segments
            .iter()
            .map(|segment| (segment.event(), segment.from, segment.to));
        parts.collect()
    }

    #[test]
    fn the_path_of_a_message_is_a_segment() {
        let bonds = vec![
            bond(0, 1, 3, 0, 10),
            bond(0, 0, 2, 0, 30),
            bond(0, 2, 4, 80, 100),
        ];
        let completed = record(Outcome::Completed, 100, &[100], bonds.clone());
        let events = program();
        let segments = |record| critical_path(&events, record, &moments(&events, record));
        let links = segments(&completed);
        let expected = [(Some(0), 0, 30), (None, 30, 80), (Some(1), 80, 100)];
        assert_eq!(summary(&links), expected);
        assert_eq!(links[1].kind, SegmentKind::Notification);
        // The path of a stopped run is the same.
        let (phase, by) = (PhaseId(0), Limit::MaxTicks);
        let mut stopped = record(
            Outcome::TimedOut { phase, by },
            95,
            &[],
            bonds[..2].to_vec(),
        );
        stopped.waiting.push(WaitRecord {
            phase,
            parent: RoleId(2),
            face: Face::Up,
            child: RoleId(4),
            cell: Cell::new(0, 0, 0),
            magnetized: 80,
            entries: 0,
        });
        let links = segments(&stopped);
        assert_eq!(summary(&links)[1..], [(None, 30, 80), (Some(1), 80, 95)]);
    }

    #[test]
    fn aborted_attempts_are_a_segment() {
        let bonds = vec![
            bond(0, 1, 3, 60, 70),
            bond(0, 0, 2, 60, 80),
            bond(0, 2, 4, 80, 100),
        ];
        let mut retried = record(Outcome::Completed, 100, &[100], bonds);
        retried.aborts.push(AbortRecord {
            phase: PhaseId(0),
            began: 0,
            tick: 50,
            retried: Some(60),
            bonds: vec![bond(0, 1, 3, 0, 20)],
            waiting: Vec::new(),
            releases: Vec::new(),
        });
        let events = program();
        let links = critical_path(&events, &retried, &moments(&events, &retried));
        let expected = [(None, 0, 60), (Some(0), 60, 80), (Some(1), 80, 100)];
        assert_eq!(summary(&links), expected);
        assert_eq!(links[0].kind, SegmentKind::Aborted);
    }

    #[test]
    fn the_path_follows_the_last_dependency() {
        let bonds = vec![
            bond(0, 1, 3, 0, 40),
            bond(0, 0, 2, 0, 30),
            bond(0, 2, 4, 30, 100),
            bond(1, 2, 5, 100, 160),
        ];
        let mut record = record(Outcome::Completed, 160, &[100, 60], bonds);
        record.releases.push(release(100));
        let events = program();
        let segments = critical_path(&events, &record, &moments(&events, &record));
        let expected = [
            (Some(0), 0, 30),
            (Some(1), 30, 100),
            (Some(3), 100, 100),
            (Some(4), 100, 160),
        ];
        assert_eq!(summary(&segments), expected);
        assert_eq!(segments[1].since, Some((0, Dependency::Anchored)));
        // The waits are consecutive and cover the run.
        assert_eq!(
            segments.iter().map(CriticalPathSegment::ticks).sum::<u64>(),
            record.ticks
        );
    }

    #[test]
    fn another_branch_may_decide() {
        let bonds = vec![
            bond(0, 0, 2, 0, 30),
            bond(0, 2, 4, 30, 60),
            bond(0, 1, 3, 0, 90),
            bond(1, 2, 5, 95, 100),
        ];
        // The last five ticks are for the reports.
        let mut record = record(Outcome::Completed, 100, &[95, 5], bonds);
        record.releases.push(release(95));
        let events = program();
        let segments = critical_path(&events, &record, &moments(&events, &record));
        let expected = [
            (Some(2), 0, 90),
            (None, 90, 95),
            (Some(3), 95, 95),
            (Some(4), 95, 100),
        ];
        assert_eq!(summary(&segments), expected);
    }

    #[test]
    fn a_capture_with_a_choice_waits_for_the_first_free_face() {
        // At most two faces are on at a time, so the third capture waits for one of the first two.
        let face = Dependency::Face { needed: 1, of: 2 };
        let events = Events {
            waits: Vec::new(),
            events: vec![
                event(0, capture(0, 1), &[]),
                event(0, capture(0, 2), &[]),
                event(0, capture(0, 3), &[(0, face), (1, face)]),
                event(
                    0,
                    capture(0, 4),
                    &[
                        (0, Dependency::Face { needed: 2, of: 3 }),
                        (1, Dependency::Face { needed: 2, of: 3 }),
                        (2, Dependency::Face { needed: 2, of: 3 }),
                    ],
                ),
            ],
        };
        let bonds = vec![
            bond(0, 0, 2, 0, 20),
            bond(0, 0, 3, 20, 50),
            bond(0, 0, 4, 50, 90),
            bond(0, 0, 1, 0, 60),
        ];
        let record = record(Outcome::Completed, 90, &[90], bonds);
        let segments = critical_path(&events, &record, &moments(&events, &record));
        let expected = [(Some(1), 0, 20), (Some(2), 20, 50), (Some(3), 50, 90)];
        assert_eq!(summary(&segments), expected);
    }

    #[test]
    fn a_censored_run_ends_with_its_unfinished_wait() {
        let bonds = vec![bond(0, 0, 2, 0, 30), bond(0, 1, 3, 0, 90)];
        let outcome = Outcome::TimedOut {
            phase: PhaseId(0),
            by: Limit::Timeout,
        };
        let mut record = record(outcome, 500, &[], bonds);
        record.waiting.push(WaitRecord {
            phase: PhaseId(0),
            parent: RoleId(2),
            face: Face::Up,
            child: RoleId(4),
            cell: Cell::new(0, 0, 1),
            magnetized: 30,
            entries: 0,
        });
        let events = program();
        let segments = critical_path(&events, &record, &moments(&events, &record));
        assert_eq!(summary(&segments), [(Some(0), 0, 30), (Some(1), 30, 500)]);
        assert_eq!(segments[1].kind, SegmentKind::Pending { event: 1 });
    }

    #[test]
    fn a_stopped_run_can_wait_for_a_release_or_a_time() {
        let outcome = |phase| Outcome::TimedOut {
            phase: PhaseId(phase),
            by: Limit::MaxTicks,
        };
        let first = || {
            vec![
                bond(0, 1, 3, 0, 10),
                bond(0, 0, 2, 0, 30),
                bond(0, 2, 4, 30, 40),
            ]
        };
        let stopped = record(outcome(1), 500, &[40], first());
        let events = program();
        let segments = critical_path(&events, &stopped, &moments(&events, &stopped));
        let last = segments.last().unwrap();
        assert_eq!(last.kind, SegmentKind::Pending { event: 3 });
        assert_eq!((last.from, last.to), (40, 500));
        let events = Events {
            waits: vec![1000, 0],
            ..program()
        };
        let stopped = record(outcome(0), 500, &[], first());
        let segments = critical_path(&events, &stopped, &moments(&events, &stopped));
        assert_eq!(segments.len(), 1);
        assert_eq!(segments[0].kind, SegmentKind::Wait);
        assert_eq!((segments[0].from, segments[0].to), (0, 500));
    }

    #[test]
    fn a_failed_run_has_no_critical_path() {
        let events = program();
        let failed = Outcome::Failed {
            phase: PhaseId(0),
            reason: String::new(),
            is_broken: false,
        };
        let failed = record(failed, 50, &[], Vec::new());
        assert!(critical_path(&events, &failed, &moments(&events, &failed)).is_empty());
    }
}
