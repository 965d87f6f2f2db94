//! Events as JSON arrays: `[tick, kind, ...]`.
//!
//! A free block is given by its number, a seed by -1 minus the number of its role.
use std::collections::BTreeMap;

use serde_json::value::RawValue;
use serde_json::{Value, json};
use stochc_ir::table::{PhaseId, RoleId, Tables};
use stochc_ir::{Cell, Face};

use super::{MessageContent, ObservedEvent};
use crate::world::{Body, FreeBond};

/// Event with its tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimedEvent {
    /// Tick of the event.
    pub tick: u64,
    /// The event.
    pub event: ObservedEvent,
}

/// Converter between events and rows. Contains the seeds of a program, by cell and by number.
#[derive(Clone, Debug, Default)]
pub struct EventRows {
    roles: BTreeMap<Cell, u32>,
    cells: BTreeMap<u32, Cell>,
}

impl EventRows {
    /// Creates the converter for a program.
    pub fn new(tables: &Tables) -> EventRows {
        let roles: BTreeMap<_, _> = tables.seeds().map(|(role, cell)| (cell, role.0)).collect();
        let cells = roles.iter().map(|(&cell, &role)| (role, cell)).collect();
        EventRows { roles, cells }
    }

    /// Returns the number that stands for a block in rows. It is negative for seeds.
    pub fn number(&self, body: Body) -> i64 {
        match body {
            Body::Free(id) => id.into(),
            // Only seeds with a role have events.
            Body::Seed(cell) => -1 - i64::from(self.roles.get(&cell).copied().unwrap_or(0)),
        }
    }

    fn body(&self, number: i64) -> Option<Body> {
        match u32::try_from(number) {
            Ok(id) => Some(Body::Free(id)),
            Err(_) => {
                let role = u32::try_from(-1 - number).ok()?;
                self.cells.get(&role).map(|&cell| Body::Seed(cell))
            }
        }
    }

    /// Returns the JSON array that describes an event.
    pub fn row(&self, tick: u64, event: &ObservedEvent) -> Value {
        let n = |body: Body| self.number(body);
        match *event {
            ObservedEvent::Phase(phase) => json!([tick, "phase", phase]),
            ObservedEvent::Magnetized {
                body,
                by,
                face,
                child,
                cell,
            } => json!([tick, "on", n(body), face, by, child, cell]),
            ObservedEvent::Entered { body, of, face } => json!([tick, "in", body, n(of), face]),
            ObservedEvent::Left { body, of, face } => json!([tick, "out", body, n(of), face]),
            ObservedEvent::Captured {
                body,
                on,
                face,
                role,
                cell,
            } => json!([tick, "dock", body, n(on), face, role, cell]),
            ObservedEvent::Unplanned { body, on, face, by } => {
                json!([tick, "shed", body, n(on), face, by])
            }
            ObservedEvent::Bonded { bond, size } => {
                let ([a, b], [face, other]) = (bond.bodies, bond.faces);
                json!([tick, "bond", a, b, face, other, size])
            }
            ObservedEvent::Unbonded { bond, sizes } => {
                let ([a, b], [face, other]) = (bond.bodies, bond.faces);
                json!([tick, "unbond", a, b, face, other, sizes[0], sizes[1]])
            }
            ObservedEvent::Released { body, role, by } => json!([tick, "free", body, role, by]),
            ObservedEvent::Sent { from, to, content } => {
                let (what, role) = match content {
                    MessageContent::Report(role) => ("report", role),
                    MessageContent::Ask(role) => ("ask", role),
                    MessageContent::Anchored(role) => ("anchored", role),
                    MessageContent::Released(role) => ("released", role),
                };
                json!([tick, "say", n(from), n(to), what, role])
            }
            ObservedEvent::Reported { by } => json!([tick, "report", by]),
        }
    }

    /// Returns the event that a JSON array describes, or `None` if the array is invalid.
    pub fn event(&self, row: &RawValue) -> Option<TimedEvent> {
        let row: Vec<Value> = serde_json::from_str(row.get()).ok()?;
        let tick = row.first()?.as_u64()?;
        let number = |i: usize| u32::try_from(row.get(i)?.as_u64()?).ok();
        let body = |i: usize| self.body(row.get(i)?.as_i64()?);
        let role = |i: usize| number(i).map(RoleId);
        let face = |i: usize| serde_json::from_value::<Face>(row.get(i)?.clone()).ok();
        let cell = |i: usize| serde_json::from_value::<Cell>(row.get(i)?.clone()).ok();
        let bond = || {
            Some(FreeBond {
                bodies: [number(2)?, number(3)?],
                faces: [face(4)?, face(5)?],
            })
        };
        let event = match row.get(1)?.as_str()? {
            "phase" => ObservedEvent::Phase(PhaseId(number(2)?)),
            "on" => ObservedEvent::Magnetized {
                body: body(2)?,
                face: face(3)?,
                by: role(4)?,
                child: role(5)?,
                cell: cell(6)?,
            },
            "in" => ObservedEvent::Entered {
                body: number(2)?,
                of: body(3)?,
                face: face(4)?,
            },
            "out" => ObservedEvent::Left {
                body: number(2)?,
                of: body(3)?,
                face: face(4)?,
            },
            "dock" => ObservedEvent::Captured {
                body: number(2)?,
                on: body(3)?,
                face: face(4)?,
                role: role(5)?,
                cell: cell(6)?,
            },
            "shed" => ObservedEvent::Unplanned {
                body: number(2)?,
                on: body(3)?,
                face: face(4)?,
                by: role(5)?,
            },
            "bond" => ObservedEvent::Bonded {
                bond: bond()?,
                size: number(6)?,
            },
            "unbond" => ObservedEvent::Unbonded {
                bond: bond()?,
                sizes: [number(6)?, number(7)?],
            },
            "free" => ObservedEvent::Released {
                body: number(2)?,
                role: role(3)?,
                by: role(4)?,
            },
            "say" => {
                let role = role(5)?;
                ObservedEvent::Sent {
                    from: body(2)?,
                    to: body(3)?,
                    content: match row.get(4)?.as_str()? {
                        "report" => MessageContent::Report(role),
                        "ask" => MessageContent::Ask(role),
                        "anchored" => MessageContent::Anchored(role),
                        "released" => MessageContent::Released(role),
                        _ => return None,
                    },
                }
            }
            "report" => ObservedEvent::Reported { by: role(2)? },
            _ => return None,
        };
        Some(TimedEvent { tick, event })
    }
}
