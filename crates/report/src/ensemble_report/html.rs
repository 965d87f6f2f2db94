//! HTML under construction. Escapes all text that is not HTML itself.
use std::fmt::Write as _;

use stochc_text::escaped;

/// HTML of a page under construction. Arguments named `plain` are text to be escaped. Arguments
/// named `marked` are HTML from these functions.
#[derive(Clone, Debug, Default)]
pub(super) struct Html {
    text: String,
    tables: usize,
}

#[derive(Clone, Debug)]
pub(super) enum HtmlCell {
    /// Text that is already HTML.
    Marked(String),
    /// Plain text, to be escaped.
    Plain(String),
    /// Number, aligned to the right. May have several lines.
    Number(String),
}

impl Html {
    pub fn finish(self) -> String {
        self.text
    }

    pub fn raw(&mut self, html: &str) {
        self.text += html;
    }

    pub fn heading(&mut self, level: u8, id: &str, marked: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "<h{level} id=\"{id}\">{marked}</h{level}>");
    }

    pub fn paragraph(&mut self, marked: &str) {
        let _ = writeln!(self.text, "<p>{marked}</p>");
    }

    pub fn note(&mut self, marked: &str) {
        let _ = writeln!(self.text, "<p class=\"note\">{marked}</p>");
    }

    pub fn list(&mut self, kind: &str, items: &[String]) {
        let _ = writeln!(self.text, "<{kind}>");
        for item in items {
            let _ = writeln!(self.text, "<li>{item}</li>");
        }
        let _ = writeln!(self.text, "</{kind}>");
    }

    /// Adds a table. The first cell of every row is its row header.
    pub fn table(&mut self, caption: &str, header: &[&str], rows: &[Vec<HtmlCell>]) {
        self.tables += 1;
        let numeric = |column: usize| {
            let cells = rows.iter().filter_map(|row| row.get(column));
            let mut cells = cells.peekable();
            cells.peek().is_some() && cells.all(|cell| matches!(cell, HtmlCell::Number(_)))
        };
        let _ = writeln!(
            self.text,
            "<div class=\"table\">\n<p class=\"caption\" id=\"table-{n}\">{caption}</p>\n\
             <div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-labelledby=\"table-{n}\">\
             <table aria-labelledby=\"table-{n}\">\n<thead><tr>",
            n = self.tables,
            caption = escaped(caption)
        );
        for (i, name) in header.iter().enumerate() {
            let class = if numeric(i) { " class=\"n\"" } else { "" };
            let _ = writeln!(self.text, "<th scope=\"col\"{class}>{}</th>", escaped(name));
        }
        let _ = writeln!(self.text, "</tr></thead>\n<tbody>");
        for row in rows {
            let _ = write!(self.text, "<tr>");
            for (i, cell) in row.iter().enumerate() {
                let (tag, scope) = if i == 0 {
                    ("th", " scope=\"row\"")
                } else {
                    ("td", "")
                };
                let (class, content) = match cell {
                    HtmlCell::Marked(html) => ("", html.clone()),
                    HtmlCell::Plain(text) => ("", escaped(text)),
                    HtmlCell::Number(text) => {
                        let lines: Vec<_> = text.lines().map(escaped).collect();
                        (" class=\"n\"", lines.join("<br/> "))
                    }
                };
                let _ = write!(self.text, "<{tag}{scope}{class}>{content}</{tag}>");
            }
            let _ = writeln!(self.text, "</tr>");
        }
        let _ = writeln!(self.text, "</tbody></table></div>\n</div>");
    }
}

/// Returns a name from a file as HTML. Its text direction cannot affect the surrounding text.
pub(super) fn name(text: &str) -> String {
    format!("<bdi>{}</bdi>", escaped(text))
}

/// Returns a command or a part of a program as HTML.
pub(super) fn code(text: &str) -> String {
    /// Largest length of a command without line breaks \[characters\].
    const WHOLE: usize = 40;
    let class = if text.chars().count() <= WHOLE {
        " class=\"whole\""
    } else {
        ""
    };
    format!("<code{class}><bdi>{}</bdi></code>", escaped(text))
}

/// Returns a command as HTML. One click selects all of it.
pub(super) fn command(text: &str) -> String {
    format!(
        "<pre class=\"command\"><code>{}</code></pre>",
        escaped(text)
    )
}
