//! Captures, releases and other events of blocks.
use stochc_ir::Face;
use stochc_ir::graph::{EventAction, EventId};
use stochc_ir::record::{AbortRecord, BondRecord, Origin, ReleaseRecord, UnplannedRecord};
use stochc_ir::table::RoleId;

use super::{Happened, Holder, RunBuilder};
use crate::experiment_log::error::RowError;
use crate::experiment_log::rows::Row;

impl RunBuilder<'_> {
    pub(super) fn open(&mut self, row: &Row) -> Result<(), RowError> {
        let id = self.expected(self.capture_of(row)?)?;
        self.ready(id, false)?;
        self.has_opened = true;
        self.opened[id.0 as usize] = Some(self.tick);
        Ok(())
    }

    pub(super) fn capture(&mut self, row: &Row) -> Result<(), RowError> {
        let action = self.capture_of(row)?;
        let id = self.expected(action)?;
        self.ready(id, true)?;
        let opened = self.opened[id.0 as usize];
        let magnetized = match opened {
            Some(tick) => tick,
            None => self.ready(id, false)?,
        };
        let body = self.take_body(row.body)?;
        let event = self.log.graph.event(id);
        let (parent, child) = (action.actor(), action.child());
        let Some(face) = action.face() else {
            return Ok(());
        };
        self.record.bonds.push(BondRecord {
            phase: self.phase,
            parent,
            face,
            child,
            cell: event.cell.unwrap_or_default(),
            magnetized,
            docked: self.tick,
            entries: 0,
            docking: 0,
            body,
            origin: self.released.get(&body).cloned().unwrap_or(Origin::Free),
        });
        self.holders.insert(child, Holder { body, parent });
        self.happen(id);
        Ok(())
    }

    pub(super) fn release(&mut self, row: &Row) -> Result<(), RowError> {
        let child = self.log.role(&row.block)?;
        let action = EventAction::Release { child };
        let id = if self.is_aborting {
            None
        } else {
            Some(self.expected(action)?)
        };
        if let Some(id) = id {
            self.ready(id, true)?;
        }
        let captured_in = |abort: &AbortRecord| abort.bonds.iter().any(|bond| bond.child == child);
        let is_undone = self.record.aborts.last().is_some_and(captured_in);
        let holder = self.holders.get(&child).copied();
        let Some(Holder { body, parent }) = holder.filter(|_| id.is_some() || is_undone) else {
            return Err(RowError::NoEvent {
                event: self.log.describe(action),
                instead: None,
            });
        };
        self.check_parent(row, parent)?;
        let release = ReleaseRecord {
            phase: self.phase,
            parent,
            child,
            tick: self.tick,
            body,
        };
        match (id, self.record.aborts.last_mut()) {
            (None, Some(abort)) => abort.releases.push(release),
            _ => self.record.releases.push(release),
        }
        self.holders.remove(&child);
        self.attached.remove(&body);
        let origin = Origin::Released {
            role: child,
            tick: self.tick,
        };
        self.released.insert(body, origin);
        if let Some(id) = id {
            self.happen(id);
        }
        Ok(())
    }

    /// Checks that a row names no other parent. The name may be followed by a face.
    fn check_parent(&self, row: &Row, parent: RoleId) -> Result<(), RowError> {
        let found = match self.log.face(&row.by) {
            _ if row.by.is_empty() => return Ok(()),
            Ok((role, _)) => role,
            Err(_) => self.log.role(&row.by)?,
        };
        if found == parent {
            return Ok(());
        }
        Err(RowError::Parent {
            child: row.block.clone(),
            parent: self.log.tables.name(parent).to_owned(),
            found: row.by.clone(),
        })
    }

    pub(super) fn reject(&mut self, row: &Row) -> Result<(), RowError> {
        self.pass_phases();
        let (parent, face) = self.face_of(row)?;
        let body = self.take_body(row.body)?;
        self.attached.remove(&body);
        self.record.unplanned += 1;
        self.record.unplanned_bonds.push(UnplannedRecord {
            phase: self.phase,
            parent,
            face,
            tick: self.tick,
            body,
        });
        Ok(())
    }

    fn face_of(&self, row: &Row) -> Result<(RoleId, Face), RowError> {
        match row.by.as_str() {
            "" => Err(RowError::Missing("by")),
            by => self.log.face(by),
        }
    }

    /// Returns the capture that a row describes.
    fn capture_of(&self, row: &Row) -> Result<EventAction, RowError> {
        let (parent, face) = self.face_of(row)?;
        let child = match row.block.as_str() {
            "" => return Err(RowError::Missing("block")),
            block => self.log.role(block)?,
        };
        Ok(EventAction::Capture {
            parent,
            face,
            child,
        })
    }

    fn happen(&mut self, id: EventId) {
        let (tick, line) = (self.tick, self.line.unwrap_or(0));
        self.happened[id.0 as usize] = Some(Happened { tick, line });
        self.left -= 1;
        self.last_event = tick;
    }

    /// Returns the number of a captured block. Without a number in the log, prefers blocks that have
    /// never been captured.
    fn take_body(&mut self, given: Option<u32>) -> Result<u32, RowError> {
        let blocks = self.log.blocks;
        let is_known =
            |body: &u32| self.attached.contains(body) || self.released.contains_key(body);
        let body = match given {
            Some(body) => body,
            None => {
                while self.next_body < blocks && is_known(&self.next_body) {
                    self.next_body += 1;
                }
                let released = self
                    .released
                    .keys()
                    .filter(|body| !self.attached.contains(body));
                let released = released.min().copied();
                let unused = (self.next_body < blocks).then_some(self.next_body);
                (unused.or(released)).ok_or(RowError::NoFreeBlock(blocks))?
            }
        };
        if body >= blocks {
            return Err(RowError::NoSuchBody { body, blocks });
        }
        if !self.attached.insert(body) {
            return Err(RowError::Attached(body));
        }
        Ok(body)
    }
}
