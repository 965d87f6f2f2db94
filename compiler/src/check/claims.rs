//! Resolves the names of claims about runs.
use stochc_grammar::tree::{ItemKind, Tree};
use stochc_grammar::{Symbol, Symbols};
use stochc_ir::claim::{Claim, ClaimedEvent};
use stochc_ir::table::{PhaseId, RoleId};

use super::checked::Program;
use crate::SourceLocation;
use crate::diagnostic::{Code, Diagnostic, report, suggestion};
use crate::expanded::{ClaimKind, EventKind, ExpandedEventName, NameKey};

/// Returns the claims of a program without errors. Reports claims about unknown names, and claims
/// that no run can satisfy.
pub(super) fn check(
    program: &Program,
    tree: &Tree,
    symbols: &Symbols,
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<Claim> {
    let Some((scene, _)) = program.scene.as_ref().zip(program.tables.as_ref()) else {
        return Vec::new();
    };
    let mut resolver = Resolver {
        program,
        tree,
        symbols,
        diagnostics,
    };
    let claims = program.plan.claims.iter().filter_map(|claim| {
        Some(match &claim.kind {
            ClaimKind::Probability {
                event,
                within,
                relation,
                bound,
            } => Claim::Probability {
                event: resolver.event(event, claim.location)?,
                within: within.map(|within| within.exact_ticks(scene.tick)),
                relation: *relation,
                bound: *bound,
            },
            ClaimKind::Mean { relation, bound } => Claim::Mean {
                relation: *relation,
                bound: bound.exact_ticks(scene.tick),
            },
            ClaimKind::Faster { than, by } => Claim::Faster {
                than: resolver.other_program(*than)?,
                by: *by,
            },
        })
    });
    claims.collect()
}

struct Resolver<'a> {
    program: &'a Program,
    tree: &'a Tree,
    symbols: &'a Symbols,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl Resolver<'_> {
    fn event(
        &mut self,
        event: &ExpandedEventName,
        location: SourceLocation,
    ) -> Option<ClaimedEvent> {
        match event {
            ExpandedEventName::Completion => Some(ClaimedEvent::Completion),
            ExpandedEventName::Phase(name, location) => self.phase(name, *location),
            ExpandedEventName::Capture { block, by } => {
                let [block, by] = [*block, *by].map(|name| self.block(name));
                self.capture(block?, by?, location)
            }
        }
    }

    fn phase(&mut self, name: &str, location: SourceLocation) -> Option<ClaimedEvent> {
        let phases = &self.program.plan.phases;
        let number = phases.iter().position(|phase| phase.name == name);
        let Some(number) = number else {
            let known = phases.iter().map(|phase| &phase.name);
            let known = suggestion(self.diagnostics, name, known);
            let diagnostic =
                Diagnostic::about(Code::UnknownName, "cannot find phase `{}`", &[name])
                    .label(location, "the assembly has no such phase")
                    .suggest(location, known, || {
                        "write the name of a phase of this assembly".to_owned()
                    });
            report(self.diagnostics, diagnostic);
            return None;
        };
        Some(ClaimedEvent::Phase(PhaseId(number as u32)))
    }

    fn block(&mut self, (key, location): (NameKey, SourceLocation)) -> Option<RoleId> {
        let roles = &self.program.plan.roles;
        let role = roles.get(&key);
        if role.is_none() {
            let name = roles.name_of(key, self.symbols);
            let known = (0..roles.count().min(2_000)).map(|role| RoleId(role as u32));
            let known = known.map(|role| roles.name(role, self.symbols));
            let known = suggestion(self.diagnostics, &name, known);
            let diagnostic =
                Diagnostic::about(Code::UnknownName, "cannot find block `{}`", &[&name])
                    .label(location, "no seed or capture has this name")
                    .suggest(location, known, || {
                        "write the name of a block of this assembly".to_owned()
                    });
            report(self.diagnostics, diagnostic);
        }
        role
    }

    /// Returns the capture of a block by another one. Reports an error if no run contains it.
    fn capture(
        &mut self,
        block: RoleId,
        by: RoleId,
        location: SourceLocation,
    ) -> Option<ClaimedEvent> {
        let plan = &self.program.plan;
        let captures = plan.events.iter().filter_map(|event| match event.kind {
            EventKind::Capture { parent, .. } if parent == by => Some(event.role),
            _ => None,
        });
        let captures: Vec<RoleId> = captures.collect();
        let is_released = || {
            let mut events = plan.events.iter();
            events.any(|event| event.kind == EventKind::Release && event.role == block)
        };
        let mut captured = captures.iter();
        if captured.any(|&child| child == block) || !captures.is_empty() && is_released() {
            return Some(ClaimedEvent::Capture { block, by });
        }
        let [block, by] = [block, by].map(|role| plan.roles.name(role, self.symbols));
        let format = "`{}` never captures `{}`";
        let diagnostic = Diagnostic::about(Code::WrongClaim, format, &[&by, &block]).label(
            location,
            format!("`{block}` is not released, and no face of `{by}` captures it"),
        );
        let help = "name the capturing block after `by`";
        report(self.diagnostics, diagnostic.help(help));
        None
    }

    fn other_program(&mut self, (name, location): (Symbol, SourceLocation)) -> Option<String> {
        let word = self.symbols.word(name);
        if word == self.program.plan.name {
            let title = "an assembly cannot be faster than itself";
            let diagnostic = Diagnostic::new(Code::WrongClaim, title)
                .label(location, "the assembly of this claim")
                .help("name another assembly of this file");
            report(self.diagnostics, diagnostic);
            return None;
        }
        let programs = self.tree.items.iter().filter_map(|item| match &item.kind {
            ItemKind::Assembly(assembly) => Some(assembly.name.symbol),
            ItemKind::Aggregate(aggregate) => Some(aggregate.name.symbol),
            _ => None,
        });
        if programs.clone().any(|program| program == name) {
            return Some(word.to_owned());
        }
        let known = programs.map(|program| self.symbols.word(program));
        let known = suggestion(self.diagnostics, word, known);
        let diagnostic = Diagnostic::about(Code::UnknownName, "cannot find assembly `{}`", &[word])
            .label(location, "no assembly of this file has this name")
            .suggest(location, known, || {
                "move both assemblies into one file".to_owned()
            });
        report(self.diagnostics, diagnostic);
        None
    }
}
