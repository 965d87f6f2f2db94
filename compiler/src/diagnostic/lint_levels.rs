//! Levels of warnings, set by files or by the command line.
use rustc_hash::FxHashMap;
use stochc_grammar::tree::{Item, ItemKind, LintDirective, LintDirectiveKind};
use stochc_grammar::{Span, Symbols};
use stochc_ir::scene::warnings::Stepping;
use stochc_text::suggest::nearest;

use crate::diagnostic::{Code, Diagnostic, Fix, Severity, removal, report};
use crate::sources::load::Module;
use crate::{FileId, SourceLocation, Sources};

/// Level of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Suppresses the warning.
    Allow,
    /// Reports the warning.
    Warn,
    /// Reports the warning as an error.
    Deny,
}

/// Levels of warnings whose level is not set in a file. By default, all warnings are reported.
#[derive(Clone, Debug, PartialEq)]
pub struct LintLevels {
    chosen: Vec<(Option<Code>, Level)>,
    /// Model and time steps for the check of scenes. `None` if runs have no physics.
    stepping: Option<Stepping>,
}

impl Default for LintLevels {
    fn default() -> LintLevels {
        LintLevels {
            chosen: Vec::new(),
            stepping: Some(Stepping::DEFAULT),
        }
    }
}

impl LintLevels {
    /// Sets the level of a warning, or of all warnings. Later calls override earlier ones. The
    /// level of an error cannot be changed.
    pub fn set(&mut self, code: Option<Code>, level: Level) {
        self.chosen.push((code, level));
    }

    /// Returns these levels for runs with other time steps. `None` means runs without physics.
    #[must_use]
    pub fn for_runs(self, stepping: Option<Stepping>) -> LintLevels {
        LintLevels { stepping, ..self }
    }

    /// Returns the model and time steps for the check of scenes. Returns `None` if runs have no
    /// physics.
    pub(crate) fn stepping(&self) -> Option<Stepping> {
        self.stepping
    }

    /// Returns whether a check can find warnings of this code. If not, their absence means nothing.
    fn are_about(&self, code: Code) -> bool {
        !code.is_of_runs() || self.stepping == Some(Stepping::DEFAULT)
    }

    /// Returns the level of a warning.
    pub fn level(&self, code: Code) -> Level {
        let applies = |(of, _): &&(Option<Code>, Level)| of.is_none_or(|of| of == code);
        let last = self.chosen.iter().rev().find(applies);
        last.map_or(Level::Warn, |(_, level)| *level)
    }
}

/// A warning that an `allow` suppresses.
#[derive(Clone, Debug)]
pub struct Allowed {
    /// The warning.
    pub diagnostic: Diagnostic,
    /// Reason that the file states. `None` if the command line allows the warning.
    pub reason: Option<String>,
}

/// Statements in the files that set levels of warnings.
#[derive(Debug, Default)]
pub struct FileLevels {
    statements: Vec<Set>,
    /// For each file, the blocks of statements that set levels, sorted by first byte.
    scopes: FxHashMap<FileId, Vec<LintScope>>,
}

/// A statement that sets a level.
#[derive(Debug)]
struct Set {
    verdict: LintDirectiveKind,
    code: Code,
    reason: String,
    /// Location of the code.
    location: SourceLocation,
    /// Location of the whole statement.
    whole: SourceLocation,
    /// Whether a statement without effect is reported.
    reported: bool,
    documented: bool,
    used: bool,
}

/// Block of statements that directly contains statements that set levels.
#[derive(Debug)]
struct LintScope {
    span: Span,
    /// Index of the innermost block of statements around this one that also sets levels. `None` if
    /// there is none.
    outer: Option<usize>,
    /// For each code, the index of the last statement in this block that sets its level.
    set: FxHashMap<Code, usize>,
}

/// Position in a file during the search for statements that set levels.
#[derive(Clone, Copy)]
struct LevelScope {
    file: FileId,
    outer: Option<usize>,
    reported: bool,
}

impl FileLevels {
    /// Collects the statements that set levels in all files. Reports wrong ones.
    pub fn new(
        modules: &[Module],
        sources: &Sources,
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> FileLevels {
        let mut levels = FileLevels::default();
        let own = modules.last().map(|module| module.file);
        for module in modules {
            let items = &module.tree.items;
            let has_program =
                |item: &Item| matches!(item.kind, ItemKind::Assembly(_) | ItemKind::Aggregate(_));
            let place = LevelScope {
                file: module.file,
                outer: None,
                // Patterns of an imported file may warn only in other programs.
                reported: own == Some(module.file) && items.iter().any(has_program),
            };
            // Diagnostics at the end of the file are inside of it.
            let whole = Span::new(0, sources.file(module.file).text.len() as u32 + 1);
            levels.block(items, whole, place, sources, symbols, diagnostics);
        }
        levels
    }

    /// Collects the statements that set levels in a block of statements. The parser bounds the
    /// depth of such blocks.
    fn block(
        &mut self,
        items: &[Item],
        span: Span,
        mut place: LevelScope,
        sources: &Sources,
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let mut set = FxHashMap::default();
        for item in items {
            let ItemKind::Level(statement) = &item.kind else {
                continue;
            };
            let location = |span| SourceLocation {
                file: place.file,
                span,
            };
            match code(statement, location(item.span), sources, symbols) {
                Ok(code) => {
                    set.insert(code, self.statements.len());
                    self.statements.push(Set {
                        verdict: statement.verdict,
                        code,
                        reason: statement.reason.clone(),
                        location: location(statement.code.span),
                        whole: location(item.span),
                        reported: place.reported,
                        documented: item.docs.0.is_some(),
                        used: false,
                    });
                }
                Err(diagnostic) => report(diagnostics, *diagnostic),
            }
        }
        if !set.is_empty() {
            let scopes = self.scopes.entry(place.file).or_default();
            let outer = place.outer.replace(scopes.len());
            scopes.push(LintScope { span, outer, set });
        }
        for item in items {
            let mut inner = place;
            // A pattern may never be used.
            inner.reported &= !matches!(item.kind, ItemKind::Pattern(_));
            self.block(item.body(), item.span, inner, sources, symbols, diagnostics);
        }
    }

    /// Separates the reported diagnostics from the allowed ones.
    pub fn apply(
        mut self,
        diagnostics: Vec<Diagnostic>,
        levels: &LintLevels,
        sources: &Sources,
    ) -> (Vec<Diagnostic>, Vec<Allowed>) {
        let (mut reported, mut allowed) = (Vec::new(), Vec::new());
        // Errors may hide warnings.
        let complete = !diagnostics.iter().any(Diagnostic::is_error);
        for diagnostic in diagnostics {
            self.decide(diagnostic, levels, &mut reported, &mut allowed);
        }
        if complete {
            // Other statements use an allowed `unused-allow`.
            for about_itself in [false, true] {
                let unused = |set: &&Set| {
                    set.reported
                        && !set.used
                        && levels.are_about(set.code)
                        && set.verdict == LintDirectiveKind::Allow
                        && (set.code == Code::UnusedAllow) == about_itself
                };
                let mut diagnostics = Vec::new();
                for set in self.statements.iter().filter(unused) {
                    report(&mut diagnostics, set.unused(sources));
                }
                for diagnostic in diagnostics {
                    self.decide(diagnostic, levels, &mut reported, &mut allowed);
                }
            }
        }
        (reported, allowed)
    }

    fn decide(
        &mut self,
        mut diagnostic: Diagnostic,
        levels: &LintLevels,
        reported: &mut Vec<Diagnostic>,
        allowed: &mut Vec<Allowed>,
    ) {
        if diagnostic.code.severity() == Severity::Error {
            return reported.push(diagnostic);
        }
        let location = diagnostic.labels.first().map(|label| label.location);
        let set = location.and_then(|location| self.find(diagnostic.code, location));
        let level = match set {
            // A statement does not apply to itself.
            Some(set) if Some(self.statements[set].location) != location => {
                let set = &mut self.statements[set];
                set.used = true;
                if set.verdict == LintDirectiveKind::Allow {
                    let reason = Some(set.reason.clone());
                    return allowed.push(Allowed { diagnostic, reason });
                }
                let text = format!("denied here: {}", set.reason);
                diagnostic = diagnostic.label(set.location, text);
                Level::Deny
            }
            _ => levels.level(diagnostic.code),
        };
        match level {
            Level::Allow => allowed.push(Allowed {
                diagnostic,
                reason: None,
            }),
            Level::Warn => reported.push(diagnostic),
            Level::Deny => {
                diagnostic.severity = Severity::Error;
                reported.push(diagnostic);
            }
        }
    }

    /// Returns the statement that sets the level of a code at a location, in the innermost block.
    /// Returns `None` if no statement sets it.
    fn find(&self, code: Code, location: SourceLocation) -> Option<usize> {
        let scopes = self.scopes.get(&location.file)?;
        let at = location.span.start;
        // The last block that begins before the place contains it, or is inside one that does.
        let mut next = scopes
            .partition_point(|scope| scope.span.start <= at)
            .checked_sub(1);
        while let Some(scope) = next.map(|number| &scopes[number]) {
            if let Some(&set) = scope.set.get(&code).filter(|_| at < scope.span.end) {
                return Some(set);
            }
            next = scope.outer;
        }
        None
    }
}

impl Set {
    fn unused(&self, sources: &Sources) -> Diagnostic {
        let title = format!("`allow {}` has no effect", self.code);
        let mut diagnostic = Diagnostic::new(Code::UnusedAllow, title)
            .label(self.location, "this warning does not occur in the block")
            .help("remove it, or move it to the block with the warning");
        // The documentation of a removed statement would document nothing.
        if !self.documented {
            diagnostic.fix = Some(Fix::remove(
                removal(sources, self.whole),
                "remove the `allow`",
            ));
        }
        diagnostic
    }
}

/// Returns the code of the warning that a statement allows or denies.
///
/// # Errors
///
/// Returns a diagnostic if the word is not the code of a warning.
fn code(
    statement: &LintDirective,
    whole: SourceLocation,
    sources: &Sources,
    symbols: &Symbols,
) -> Result<Code, Box<Diagnostic>> {
    let word = symbols.word(statement.code.symbol);
    let verdict = statement.verdict.word();
    let location = SourceLocation {
        file: whole.file,
        span: statement.code.span,
    };
    let Some(code) = Code::from_name(word) else {
        let title = format!("`{word}` is not a code of a warning or error");
        let suggestion = nearest(word, Code::ALL.iter().map(|code| code.name()));
        return Err(Box::new(
            Diagnostic::new(Code::UnknownCode, title)
                .label(location, "unknown code")
                .suggest(location, suggestion, || {
                    "run `stochc explain` for a list of all codes".to_owned()
                }),
        ));
    };
    if code.severity() == Severity::Warning {
        return Ok(code);
    }
    let (title, help) = match statement.verdict {
        LintDirectiveKind::Allow => (
            format!("`{word}` is an error and cannot be allowed"),
            "fix the error; only warnings can be allowed".to_owned(),
        ),
        LintDirectiveKind::Deny => (
            format!("`{word}` is an error and cannot be denied"),
            "remove the `deny`: an error needs none".to_owned(),
        ),
    };
    let mut diagnostic = Diagnostic::new(Code::FixedLevel, title)
        .label(location, "code of an error")
        .help(help);
    if statement.verdict == LintDirectiveKind::Deny {
        let title = format!("remove the `{verdict}`");
        diagnostic.fix = Some(Fix::remove(removal(sources, whole), title));
    }
    Err(Box::new(diagnostic))
}
