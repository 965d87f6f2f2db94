//! Writes event tables from the dependency graph: the rules that make each block respect the order.
use petgraph::Direction::{Incoming, Outgoing};
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use stochc_grammar::{Cancellation, Cancelled, Symbols};
use stochc_ir::scene::{BondKind, Scene};
use stochc_ir::table::{
    Action, Condition, Notification, Phase, PhaseId, Recovery, Role, RoleId, Tables, Trigger,
};

use crate::blocks::liveness::{Holder, Liveness};
use crate::dependencies::graph::{DependencyGraph, LocatedDependency};
use crate::expanded::{EventId, EventKind, ExpandedProgram};
use crate::shapes::layout::Layout;

/// Lowers a program without errors.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn lower(
    plan: &ExpandedProgram,
    liveness: &Liveness,
    layout: &Layout,
    graph: &DependencyGraph,
    scene: &Scene,
    symbols: &Symbols,
    cancellation: Cancellation<'_>,
) -> Result<Tables, Cancelled> {
    let mut lowering = Lowering {
        plan,
        liveness,
        layout,
        graph,
        tick: scene.tick,
        rules: Vec::with_capacity(plan.events.len() * 2),
        conditions: Vec::new(),
        reports: vec![0; plan.phases.len()],
        duties: busy(plan, graph),
    };
    for (number, phase) in plan.phases.iter().enumerate() {
        for id in plan.events_of(phase) {
            cancellation.check()?;
            lowering.event(id, PhaseId(number as u32));
        }
    }
    cancellation.check()?;
    Ok(lowering.finish(scene, symbols))
}

/// Returns, for each event, whether its block acts later in the same phase.
fn busy(plan: &ExpandedProgram, graph: &DependencyGraph) -> Vec<bool> {
    let mut busy = vec![false; plan.events.len()];
    for edge in graph.raw_edges() {
        if edge.weight == LocatedDependency::Anchored {
            busy[edge.source().index()] = true;
        }
    }
    busy
}

/// A rule that is not yet part of a duty. A duty contains the rules of one role in one phase for
/// one trigger.
struct UnassignedRule {
    role: RoleId,
    phase: PhaseId,
    trigger: Trigger,
    /// Range of its conditions in `Lowering::conditions`.
    when: (u32, u32),
    then: Action,
}

struct Lowering<'a> {
    plan: &'a ExpandedProgram,
    liveness: &'a Liveness,
    layout: &'a Layout,
    graph: &'a DependencyGraph,
    /// Length of a tick \[s\].
    tick: f64,
    rules: Vec<UnassignedRule>,
    conditions: Vec<Condition>,
    reports: Vec<u32>,
    duties: Vec<bool>,
}

impl Lowering<'_> {
    fn event(&mut self, id: EventId, phase: PhaseId) {
        let event = *self.plan.event(id);
        let actor = self.liveness.actor(self.plan, id);
        match event.kind {
            EventKind::Capture { face, .. } => {
                let Some(cell) = self.layout.cells[id.0 as usize] else {
                    return;
                };
                let when = self.conditions_of(id, actor);
                let action = Action::Magnetize {
                    face,
                    child: event.role,
                    cell,
                };
                self.push(actor, phase, when, action);
                // A terminal block has nothing more to do and reports so, unless it is
                // pre-attached.
                let is_pre_attached = self.plan.phases[phase.0 as usize].pre_attached;
                if !self.duties[id.0 as usize] && !is_pre_attached {
                    self.reports[phase.0 as usize] += 1;
                    self.push(Holder::captured(event.role, id), phase, [], Action::Report);
                }
            }
            EventKind::Release => {
                let Some(on) = self.layout.parents[id.0 as usize] else {
                    return;
                };
                let when = self.conditions_of(id, actor);
                let ask = match self.plan.delay(id, self.tick) {
                    Some(ticks) => Action::AskReleaseLater(ticks),
                    None => Action::AskRelease,
                };
                self.push(actor, phase, when, ask);
                let parent = self.witness(id);
                let off = Action::SwitchOff {
                    face: on.face,
                    child: event.role,
                };
                self.push(parent, phase, [Condition::Asked(event.role)], off);
                let node = NodeIndex::new(id.0 as usize);
                let has_next = (self.graph.edges_directed(node, Outgoing))
                    .any(|edge| *edge.weight() == LocatedDependency::Emptied);
                if !has_next {
                    self.reports[phase.0 as usize] += 1;
                    self.push(parent, phase, [self.seen(id)], Action::Report);
                }
            }
        }
        self.notify(id, phase);
    }

    /// Returns the conditions of an event from the point of view of the acting block.
    fn conditions_of(&self, id: EventId, actor: Holder) -> Vec<Condition> {
        let node = NodeIndex::new(id.0 as usize);
        let mut conditions: Vec<Condition> = (self.graph.edges_directed(node, Incoming))
            .filter_map(|edge| {
                let first = self.graph[edge.source()];
                match edge.weight() {
                    // The duty begins when the block is anchored.
                    LocatedDependency::Anchored => None,
                    // Physics ensures it, except for a face that is switched off and on again.
                    LocatedDependency::Vacated => {
                        (self.witness(first) == actor).then(|| self.seen(first))
                    }
                    LocatedDependency::Face { needed, of } if needed < of => {
                        Some(Condition::Turn(*needed))
                    }
                    LocatedDependency::Face { .. } | LocatedDependency::Emptied => {
                        Some(self.seen(first))
                    }
                    LocatedDependency::After(_) | LocatedDependency::Freed
                        if self.witness(first) == actor =>
                    {
                        Some(self.seen(first))
                    }
                    LocatedDependency::After(_) | LocatedDependency::Freed => (actor.since
                        != Some(first))
                    .then(|| Condition::Notified(self.notification(first))),
                }
            })
            .collect();
        conditions.sort_unstable();
        conditions.dedup();
        conditions
    }

    /// Returns the block that sees an event at its own face.
    fn witness(&self, id: EventId) -> Holder {
        if let EventKind::Capture { .. } = self.plan.event(id).kind {
            return self.liveness.actor(self.plan, id);
        }
        match self.liveness.contexts[id.0 as usize].anchored_by {
            Some(capture) => self.liveness.actor(self.plan, capture),
            None => {
                let on = self.layout.parents[id.0 as usize];
                let role = on.map_or(self.plan.event(id).role, |on| on.parent);
                Holder::existing(role)
            }
        }
    }

    fn seen(&self, id: EventId) -> Condition {
        let event = self.plan.event(id);
        match event.kind {
            EventKind::Capture { .. } => Condition::Docked(event.role),
            EventKind::Release => Condition::Released(event.role),
        }
    }

    fn notification(&self, id: EventId) -> Notification {
        let event = self.plan.event(id);
        match event.kind {
            EventKind::Capture { .. } => Notification::Anchored(event.role),
            EventKind::Release => Notification::Released(event.role),
        }
    }

    /// Adds rules that report an event to waiting blocks elsewhere.
    fn notify(&mut self, id: EventId, phase: PhaseId) {
        let event = *self.plan.event(id);
        let node = NodeIndex::new(id.0 as usize);
        let witness = self.witness(id);
        let mut receivers: Vec<RoleId> = (self.graph.edges_directed(node, Outgoing))
            .filter(|edge| edge.weight().needs_message())
            .map(|edge| self.liveness.actor(self.plan, self.graph[edge.target()]))
            // A block notices its own capture without a message.
            .filter(|actor| *actor != witness && actor.since != Some(id))
            .map(|actor| actor.role)
            .collect();
        receivers.sort_unstable();
        receivers.dedup();
        for to in receivers {
            let action = Action::Notify {
                to,
                notification: self.notification(id),
            };
            match event.kind {
                EventKind::Capture { .. } => {
                    self.push(Holder::captured(event.role, id), phase, [], action)
                }
                EventKind::Release => self.push(witness, phase, [self.seen(id)], action),
            }
        }
    }

    fn push(
        &mut self,
        block: Holder,
        phase: PhaseId,
        when: impl IntoIterator<Item = Condition>,
        then: Action,
    ) {
        let start = self.conditions.len() as u32;
        self.conditions.extend(when);
        let when = (start, self.conditions.len() as u32);
        self.rules.push(UnassignedRule {
            role: block.role,
            phase,
            trigger: block.trigger(),
            when,
            then,
        });
    }

    fn finish(mut self, scene: &Scene, symbols: &Symbols) -> Tables {
        // A stable sort keeps the rules of a duty in source order.
        self.rules
            .sort_by_key(|rule| (rule.role, rule.phase, rule.trigger));
        let bond = BondKind::from_scene(scene);
        let phases = (self.plan.phases.iter().zip(&self.reports)).map(|(phase, &reports)| Phase {
            name: phase.name.clone(),
            timeout: phase.timeout.map(|timeout| timeout.ticks(scene.tick)),
            reports,
            wait: (phase.waits.iter())
                .map(|wait| wait.ticks(scene.tick))
                .max()
                .unwrap_or(0),
            recovery: phase.recovery.map(|recovery| Recovery {
                retries: recovery.retries,
                reports: 0,
                pause: recovery.pause.map_or(0, |pause| pause.ticks(scene.tick)),
            }),
            pre_attached: phase.pre_attached,
        });
        let roles = (0..self.plan.roles.count() as u32).map(|role| Role {
            name: self.plan.roles.name(RoleId(role), symbols),
            seed: self.plan.seeds.get(role as usize).map(|seed| seed.cell),
        });
        let (name, plate) = (self.plan.name.clone(), self.plan.plate.clone());
        let faces = bond.faces(scene.block.faces);
        let mut tables = Tables::new(name, faces, plate, phases.collect(), roles.collect());
        tables.bond = bond;
        tables.aggregate = self.plan.aggregate;
        tables.reserve(self.rules.len(), self.conditions.len());
        let mut open = None;
        for rule in &self.rules {
            let key = (rule.role, rule.phase, rule.trigger);
            if open != Some(key) {
                tables.begin_duty(rule.role, rule.phase, rule.trigger);
                open = Some(key);
            }
            let when = &self.conditions[rule.when.0 as usize..rule.when.1 as usize];
            tables.push_rule(when.iter().copied(), rule.then);
        }
        let captors = tables.captors_at_start();
        for (phase, captors) in tables.phases.iter_mut().zip(captors) {
            if let Some(recovery) = &mut phase.recovery {
                recovery.reports = captors;
            }
        }
        tables
    }
}
