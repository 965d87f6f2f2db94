//! Branches of conditions, for diagnostics about their statements.
use std::collections::BTreeMap;

use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::tree::{Expr, ExprKind, If, ItemKind, Name};
use stochc_grammar::{Span, Symbol, Symbols};
use stochc_text::series;

use super::expander::{Expander, Pass};
use super::scope::BoundValue;
use super::uncertain::each_name;
use crate::diagnostic::{Diagnostic, Label};
use crate::{FileId, SourceLocation};

/// Largest number of values that a message lists for a name.
const MAX_VALUES: usize = 3;

/// Largest number of nested branches in a message.
const MAX_NESTED: usize = 3;

/// File and first byte of a branch.
type BranchKey = (FileId, u32);

/// Branches that a program takes or skips.
#[derive(Clone, Debug, Default)]
pub struct Branches {
    taken: BTreeMap<BranchKey, Branch>,
    skipped: FxHashSet<BranchKey>,
    /// First name of each word that a skipped branch declares.
    absent: FxHashMap<Symbol, (BranchKey, SourceLocation)>,
}

/// A branch that is taken at least once.
#[derive(Clone, Debug)]
struct Branch {
    /// Its condition, or its `else`.
    head: SourceLocation,
    /// Position after its last byte.
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
        let before = self.taken.range((file, 0)..(file, at)).rev();
        let around = before.filter(|(_, branch)| branch.head.span.end <= at && at < branch.end);
        for (_, branch) in around.take(MAX_NESTED) {
            diagnostic.labels.push(Label {
                location: branch.head,
                text: branch.reason(symbols),
            });
        }
    }

    /// Returns the location of a block in a branch that is never taken. Returns `None` if there is
    /// no such branch.
    pub(crate) fn absent(&self, word: Symbol) -> Option<SourceLocation> {
        let (branch, location) = self.absent.get(&word)?;
        (!self.taken.contains_key(branch)).then_some(*location)
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
        match self.has_branch {
            Some(_) => self.note_skipped(block, span),
            None => self.mark_all_uncertain(&block.body),
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
        let branches = &mut self.plan.branches.taken;
        let branch = branches.entry((self.file, start)).or_insert(new);
        branch.add(&self.compared);
    }

    fn note_skipped(&mut self, block: &If, span: Span) {
        let (file, branch) = (self.file, (self.file, span.start));
        let branches = &mut self.plan.branches;
        if self.pass == Pass::Counting || !branches.skipped.insert(branch) {
            return;
        }
        each_name(&block.body, &mut |item, place| {
            let span = place.span;
            let first = place.path.first().map(|segment| segment.name.symbol);
            if let (Some(word), false) = (first, matches!(item.kind, ItemKind::Release(_))) {
                let location = SourceLocation { file, span };
                branches.absent.entry(word).or_insert((branch, location));
            }
        });
    }
}
