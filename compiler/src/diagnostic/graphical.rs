//! Diagnostics as pictures of the source, drawn by miette.
use miette::{
    Diagnostic as MietteDiagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan,
    MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents,
};
use stochc_text::visible_lines;

use super::{Diagnostic, Label, Severity};
use crate::{FileId, SourceFile, Sources};

/// Draws diagnostics over the source.
pub struct Renderer {
    theme: GraphicalTheme,
    width: usize,
}

impl Renderer {
    /// Creates a renderer with colours for a terminal, or for plain text. `width` is in columns.
    pub fn new(colour: bool, width: usize) -> Renderer {
        let theme = if colour {
            GraphicalTheme::unicode()
        } else {
            GraphicalTheme::unicode_nocolor()
        };
        Renderer { theme, width }
    }

    /// Returns the picture of a diagnostic. Its first line is `error[code]: title`.
    pub fn render(&self, diagnostic: &Diagnostic, sources: &Sources) -> String {
        // miette writes the header on two lines. Its icon can be any text, so the icon becomes the
        // severity and code.
        let mut theme = self.theme.clone();
        theme.characters.error = format!("error[{}]:", diagnostic.code);
        theme.characters.warning = format!("warning[{}]:", diagnostic.code);
        theme.characters.advice = "also".to_owned();
        let handler = GraphicalReportHandler::new_themed(theme)
            .with_width(self.width)
            .with_links(false);
        let mut out = String::new();
        for picture in Picture::new(diagnostic, sources) {
            let mut drawn = String::new();
            // Writing to a string cannot fail. A span that cannot be shown leaves the title.
            if handler.render_report(&mut drawn, &picture).is_err() {
                return header_line(diagnostic);
            }
            out.push_str(drawn.trim_start());
        }
        out
    }
}

/// Returns `error[code]: title`, ending in a newline.
fn header_line(diagnostic: &Diagnostic) -> String {
    let (severity, code) = (diagnostic.severity.name(), diagnostic.code);
    format!("{severity}[{code}]: {}\n", visible(&diagnostic.message()))
}

/// Printed picture of a diagnostic, or of its labels in one file.
#[derive(Debug)]
struct Picture<'a> {
    severity: miette::Severity,
    title: String,
    help: Option<String>,
    excerpt: Option<Excerpt<'a>>,
    labels: Vec<LabeledSpan>,
}

impl<'a> Picture<'a> {
    /// Returns one picture for each file with labels. Only the last picture contains the help.
    fn new(diagnostic: &'a Diagnostic, sources: &'a Sources) -> Vec<Picture<'a>> {
        let home = diagnostic.labels.first().map(|label| label.location.file);
        let mut elsewhere: Vec<FileId> = (diagnostic.labels.iter())
            .map(|label| label.location.file)
            .filter(|&file| Some(file) != home)
            .collect();
        elsewhere.sort_unstable();
        elsewhere.dedup();
        let part = |file: FileId| -> Vec<LabeledSpan> {
            let labels = diagnostic
                .labels
                .iter()
                .filter(|label| label.location.file == file);
            labels.map(labeled).collect()
        };
        let first = Picture {
            severity: match diagnostic.severity {
                Severity::Error => miette::Severity::Error,
                Severity::Warning => miette::Severity::Warning,
            },
            title: visible(&diagnostic.message()),
            help: None,
            excerpt: home.map(|file| Excerpt(sources.file(file))),
            labels: home.map(part).unwrap_or_default(),
        };
        let others = elsewhere.into_iter().map(move |file| Picture {
            severity: miette::Severity::Advice,
            title: format!("in {}", stochc_text::visible(&sources.file(file).name)),
            help: None,
            excerpt: Some(Excerpt(sources.file(file))),
            labels: part(file),
        });
        let mut pictures: Vec<Picture<'a>> = std::iter::once(first).chain(others).collect();
        if let Some(last) = pictures.last_mut() {
            last.help = advice(diagnostic).as_deref().map(visible);
        }
        pictures
    }
}

/// Returns the help, followed by the fix if the help does not include it.
fn advice(diagnostic: &Diagnostic) -> Option<String> {
    let help = diagnostic.help.as_deref();
    let Some(fix) = &diagnostic.fix else {
        return help.map(str::to_owned);
    };
    let new = match &fix.edits[..] {
        [edit] if !edit.text.contains('\n') => edit.text.trim(),
        _ => "",
    };
    let says = |text: &str| !text.is_empty() && text.contains(new) && !new.is_empty();
    // The help already states the part to remove.
    let is_stated = !fix.safe && new.is_empty() && help.is_some();
    if is_stated || help.is_some_and(says) {
        return help.map(str::to_owned);
    }
    let mut line = if fix.safe {
        format!("`stochc check --fix` can {}", fix.title)
    } else {
        format!("possible fix: {}", fix.title)
    };
    if !new.is_empty() && !says(&fix.title) {
        line.push_str(&format!(": `{new}`"));
    }
    Some(match help {
        Some(help) => format!("{help}\n{line}"),
        None => line,
    })
}

fn labeled(label: &Label) -> LabeledSpan {
    let span = label.location.span;
    let text = visible(&label.text);
    LabeledSpan::new(Some(text), span.start as usize, span.len())
}

/// Returns a text without control characters. Words that would fill the terminal are shortened.
pub fn visible(text: &str) -> String {
    /// Largest number of characters that are shown of a word.
    const LONGEST: usize = 100;
    let mut out = String::with_capacity(text.len().min(1 << 10));
    let mut length = 0;
    for c in text.chars() {
        length = if c.is_whitespace() { 0 } else { length + 1 };
        match length {
            0..LONGEST => out.push(c),
            LONGEST => out.push_str("..."),
            _ => {}
        }
    }
    visible_lines(&out)
}

impl std::fmt::Display for Picture<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.title)
    }
}

impl std::error::Error for Picture<'_> {}

impl MietteDiagnostic for Picture<'_> {
    fn severity(&self) -> Option<miette::Severity> {
        Some(self.severity)
    }

    fn help<'b>(&'b self) -> Option<Box<dyn std::fmt::Display + 'b>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<_>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| excerpt as _)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.labels.iter().cloned()))
    }
}

/// A file with an index of its lines. Long lines are truncated.
#[derive(Debug)]
struct Excerpt<'a>(&'a SourceFile);

impl SourceCode for Excerpt<'_> {
    fn read_span<'b>(
        &'b self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'b> + 'b>, MietteError> {
        /// Number of bytes that are shown on each side of the span in a long line.
        const MARGIN: usize = 60;
        /// Largest number of bytes that are shown before or after a span.
        const LONG: usize = 800;
        /// Largest number of bytes of a span that are shown.
        const LONGEST: usize = 4000;
        let file = self.0;
        let text = file.shown();
        let from = span.offset().min(text.len());
        let to = (from + span.len().min(LONGEST)).min(text.len());
        let first = file.line_of(from as u32).saturating_sub(before);
        let last_byte = to.saturating_sub(usize::from(to > from));
        let last = (file.line_of(last_byte as u32) + after).min(file.line_count() - 1);
        let (line_start, _) = file.line_range(first);
        // The span may end with its line's newline.
        let line_end = file.line_range(last).1.max(to);
        let mut start = line_start;
        // miette asks for the span without context to find its start.
        if before == 0 {
            start = from;
        } else if from - start > LONG {
            start = from - MARGIN;
        }
        let mut end = line_end;
        if end - to > LONG {
            end = to + MARGIN;
        }
        while !text.is_char_boundary(start) {
            start -= 1;
        }
        while !text.is_char_boundary(end) {
            end += 1;
        }
        let line = file.line_of(start as u32);
        // Columns count characters, as in all other forms.
        let column = file.position(start as u32).1 - 1;
        Ok(Box::new(MietteSpanContents::new_named(
            stochc_text::visible(&file.name),
            &text.as_bytes()[start..end],
            (start, end - start).into(),
            line,
            column,
            last - first + 1,
        )))
    }
}
