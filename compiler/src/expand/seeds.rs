//! Expands the seed plate.
use stochc_grammar::Span;
use stochc_grammar::tree::{Expr, Item, ItemKind, Seat};
use stochc_ir::Cell;
use stochc_ir::table::{PRE_ATTACHED, Plate};

use super::duplicate;
use super::expander::{Expander, Pass, Seeding};
use crate::SourceLocation;
use crate::diagnostic::{Code, Diagnostic};
use crate::expanded::{ExpandedPhase, ExpandedSeed};

/// Returns whether the statements contain such an item. The parser bounds the depth of loops.
fn contains(items: &[Item], is_wanted: fn(&ItemKind) -> bool) -> bool {
    (items.iter()).any(|item| {
        is_wanted(&item.kind) || item.is_transparent() && contains(item.body(), is_wanted)
    })
}

/// Returns the advice for a seed outside a plate of this width and depth.
fn larger_plate((x, y): (i64, i64), (width, depth): (u32, u32)) -> String {
    let needed = |value: i64, edge: u32| i64::from(edge).max(value.saturating_add(1));
    let (east, north) = (needed(x, width), needed(y, depth));
    if x < 0 || y < 0 || east > MAX_EDGE || north > MAX_EDGE {
        "move the seed onto the plate".to_owned()
    } else {
        format!("move the seed, or write `seed plate {east} x {north}`")
    }
}

/// Largest number of blocks along an edge of a plate.
const MAX_EDGE: i64 = Plate::LONGEST as i64;

impl<'a> Expander<'a, '_> {
    pub fn seed_plate(&mut self, seed: &'a stochc_grammar::tree::Seed, span: Span) {
        // A plate inside a phase has been reported.
        if self.in_phase {
            return;
        }
        let location = SourceLocation {
            file: self.file,
            span: Span::new(span.start, span.start + "seed".len() as u32),
        };
        if let Some(old) = self.plate.replace(location) {
            self.diagnostics.push(
                Diagnostic::new(Code::DuplicateName, "the assembly has two seed plates")
                    .label(location, "second plate")
                    .label(old, "first plate")
                    .help("move all seeds to the first plate"),
            );
            return;
        }
        if let Some(phase) = self.plan.phases.first() {
            let diagnostic = Diagnostic::new(Code::Misplaced, "the seed plate comes after a phase")
                .label(location, "the plate must come first")
                .label(phase.location, "first phase")
                .help("move the plate to the beginning of the assembly");
            self.diagnostics.push(diagnostic);
            return;
        }
        let width = self.edge(&seed.size.0);
        let depth = self.edge(&seed.size.1);
        self.plan.plate = Plate {
            width: width.unwrap_or(u32::MAX),
            depth: depth.unwrap_or(u32::MAX),
        };
        let outer = self.seeding.replace(Seeding::Seats);
        // Instances without names have the same numbers in each pass. Instances in phases occur in
        // the last pass only, so their numbers come after all others.
        let anonymous = self.anonymous;
        self.items(&seed.body);
        self.anonymous_in_phases = self.anonymous;
        let has_instances = contains(&seed.body, |it| matches!(it, ItemKind::Instance(_)));
        if has_instances || contains(&seed.body, |it| matches!(it, ItemKind::Chain(_))) {
            self.anonymous = anonymous;
            self.seeding = Some(Seeding::Captures);
            self.pre_attached(seed, location);
        }
        if has_instances {
            self.anonymous = anonymous;
            self.seeding = Some(Seeding::Phases);
            self.items(&seed.body);
            self.anonymous = self.anonymous_in_phases;
        }
        self.seeding = outer;
    }

    /// Expands pre-attached blocks as a phase before the first one.
    fn pre_attached(&mut self, seed: &'a stochc_grammar::tree::Seed, location: SourceLocation) {
        let start = self.grown.events;
        self.in_phase = true;
        self.items(&seed.body);
        self.in_phase = false;
        let end = self.grown.events;
        if start == end {
            return;
        }
        self.push_phase(ExpandedPhase {
            name: PRE_ATTACHED.to_owned(),
            location,
            timeout: None,
            events: start as u32..end as u32,
            pre_attached: true,
            claims: Vec::new(),
            recovery: None,
            waits: Vec::new(),
        });
    }

    fn edge(&mut self, expr: &Expr) -> Option<u32> {
        let value = self.evaluate(expr)?;
        if (1..=MAX_EDGE).contains(&value) {
            return u32::try_from(value).ok();
        }
        self.diagnostics.push(
            Diagnostic::about(
                Code::WrongValue,
                "the edge of a plate cannot have {} blocks",
                &[&value.to_string()],
            )
            .label(
                self.location(expr.span),
                format!("must be from 1 to {MAX_EDGE}"),
            ),
        );
        None
    }

    /// Expands one seed.
    pub fn seat(&mut self, seat: &'a Seat, item: &Item) {
        let location = self.location(seat.place.span);
        let key = self.single_key(&seat.place);
        let (x, y) = (self.evaluate(&seat.at.0), self.evaluate(&seat.at.1));
        let (Some(key), Some(x), Some(y)) = (key, x, y) else {
            return self.mark_uncertain(&seat.place);
        };
        let (x, y) = self.frame.position((x, y));
        self.probe
            .note(self.file, &seat.place.path, [key].into_iter());
        let Plate { width, depth } = self.plan.plate;
        // A seed outside of every plate has been reported.
        if width == 0 {
            return;
        }
        let inside = |value: i64, edge: u32| (0..i64::from(edge)).contains(&value);
        if !(inside(x, width) && inside(y, depth)) {
            let at = self.location(seat.at.0.span.to(seat.at.1.span));
            let diagnostic = Diagnostic::about(
                Code::SeedOutsidePlate,
                "position {} is not on the plate",
                &[&format!("({x}, {y})")],
            )
            .label(
                at,
                format!("positions go from (0, 0) to ({}, {})", width - 1, depth - 1),
            )
            .help(larger_plate((x, y), (width, depth)));
            self.diagnostics.push(self.in_instance(diagnostic));
        }
        // A seed outside of the plate can still capture, so that it causes no further errors.
        let near = |value: i64| value.clamp(-MAX_EDGE, MAX_EDGE) as i32;
        let cell = Cell::new(near(x), near(y), 0);
        self.grown.seeds += 1;
        if self.pass == Pass::Counting {
            return;
        }
        let role = self.role(key);
        // Seeds are interned first, so a new one has the next number.
        if (role.0 as usize) < self.plan.seeds.len() {
            let old = self.plan.seeds[role.0 as usize].location;
            let name = self.plan.roles.name(role, self.symbols);
            self.diagnostics
                .push(duplicate(&name, old, location, "a seed", self.symbols));
            return;
        }
        // A misplaced statement may come first. It has been reported.
        if role.0 as usize == self.plan.seeds.len() {
            let statement = item.docs.0.is_none().then(|| self.location(item.span));
            self.plan.seeds.push(ExpandedSeed {
                role,
                cell,
                location,
                statement,
            });
        }
    }
}
