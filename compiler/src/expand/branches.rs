//! Branches of conditions that are taken, for diagnostics about their statements.
use std::collections::BTreeMap;

use stochc_grammar::tree::{Expr, ExprKind, If, Name};
use stochc_grammar::{Span, Symbol, Symbols};
use stochc_text::series;

use super::expander::{Expander, Pass};
use super::scope::BoundValue;
use crate::diagnostic::{Diagnostic, Label};
use crate::{FileId, SourceLocation};

/// Largest number of values that a message lists for a name.
const MAX_VALUES: usize = 3;

/// Largest number of nested branches in a message.
const MAX_NESTED: usize = 3;

/// Branches that a program takes, by file and first byte.
#[derive(Clone, Debug, Default)]
pub struct Branches(BTreeMap<(FileId, u32), Branch>);

/// A branch that is taken at least once.
#[derive(Clone, Debug)]
struct Branch {
    /// Its condition, or its `else`.
    head: SourceLocation,
    /// Location behind its last byte.
    end: u32,
    /// Names in the evaluated conditions, with their different values.
    values: Vec<(Symbol, Vec<i64>)>,
}

impl Branches {
    /// Adds a label for each branch around a diagnostic, the innermost first.
    pub(crate) fn explain(&self, diagnostic: &mut Diagnostic, symbols: &Symbols) {
        let Some((file, at)) = diagnostic.place() else {
            return;
        };
        let before = self.0.range((file, 0)..(file, at)).rev();
        let around = before.filter(|(_, branch)| branch.head.span.end <= at && at < branch.end);
        for (_, branch) in around.take(MAX_NESTED) {
            diagnostic.labels.push(Label {
                location: branch.head,
                text: branch.reason(symbols),
            });
        }
    }
}

impl Branch {
    /// Returns why the branch is taken: "this branch is taken because `n` is 3".
    fn reason(&self, symbols: &Symbols) -> String {
        let values = self.values.iter().map(|(name, values)| {
            let mut listed: Vec<String> = values.iter().map(i64::to_string).collect();
            if listed.len() > MAX_VALUES {
                listed[MAX_VALUES] = "another number".to_owned();
            }
            format!("`{}` is {}", symbols.word(*name), series(&listed, "or"))
        });
        let is_constant = self.values.iter().all(|(_, values)| values.len() == 1);
        let link = if is_constant { "because" } else { "when" };
        let values = series(&values.collect::<Vec<_>>(), "and");
        format!("this branch is taken {link} {values}")
    }

    /// Adds the values of one more use of the branch.
    fn add(&mut self, values: &[(Symbol, i64)]) {
        for (name, value) in values {
            match self.values.iter_mut().find(|(known, _)| known == name) {
                Some((_, known)) if known.len() > MAX_VALUES || known.contains(value) => {}
                Some((_, known)) => known.push(*value),
                None => self.values.push((*name, vec![*value])),
            }
        }
    }
}

impl<'a> Expander<'a, '_> {
    /// Expands the statements of an `if` or `else` if its condition is the first true one.
    pub(super) fn branch(&mut self, block: &'a If, span: Span) {
        if !block.is_else {
            self.has_branch = Some(false);
            self.compared.clear();
        }
        if self.has_branch == Some(false) {
            let condition = block.condition.as_ref();
            let value = condition.map_or(Some(1), |condition| self.evaluate(condition));
            self.has_branch = value.map(|value| value != 0);
            if let Some(condition) = condition {
                self.compare(condition);
            }
            if self.has_branch == Some(true) {
                self.note_branch(block, span);
                return self.items(&block.body);
            }
        }
        if self.has_branch.is_none() {
            self.mark_all_uncertain(&block.body);
        }
    }

    /// Records the numbers that a condition names.
    fn compare(&mut self, condition: &Expr) {
        match &condition.kind {
            ExprKind::Name(symbol) => {
                let name = Name {
                    symbol: *symbol,
                    span: condition.span,
                };
                if let Some(BoundValue::Number(value)) = self.value(name) {
                    self.compared.push((*symbol, value));
                }
            }
            ExprKind::Int(_) | ExprKind::Face(_) => {}
            ExprKind::Negate(inner) | ExprKind::Not(inner) => self.compare(inner),
            ExprKind::Call(_, arguments) => arguments.iter().for_each(|it| self.compare(it)),
            ExprKind::Binary(_, sides) => {
                self.compare(&sides.0);
                self.compare(&sides.1);
            }
        }
    }

    fn note_branch(&mut self, block: &If, span: Span) {
        // A condition without names needs no reason.
        if self.pass == Pass::Counting || self.compared.is_empty() {
            return;
        }
        let start = span.start;
        let keyword = Span::new(start, start + "else".len() as u32);
        let head = block.condition.as_ref().map_or(keyword, |it| it.span);
        let new = Branch {
            head: self.location(head),
            end: span.end,
            values: Vec::new(),
        };
        let branches = &mut self.plan.branches.0;
        let branch = branches.entry((self.file, start)).or_insert(new);
        branch.add(&self.compared);
    }
}
