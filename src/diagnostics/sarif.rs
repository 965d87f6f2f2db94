//! Diagnostics as SARIF 2.1.0. Code review systems show them next to the changed lines.
//!
//! # Source
//!
//! [OASIS Standard](https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html). Section
//! numbers in comments refer to this standard.
use std::path::Path;

use serde_json::{Map, Value, json};
use stochc_compiler::diagnostic::{Code, Diagnostic, Fix, Label};
use stochc_compiler::{Allowed, Checked, SourceLocation, Sources, without_dots};
use stochc_files::address::address;

/// Address of the JSON schema that the document follows.
const SCHEMA: &str =
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

/// SARIF log with the diagnostics of one or more files, as one run of the tool.
#[derive(Debug)]
pub struct SarifLog {
    /// Folder that file addresses are relative to. Its path has the separator `/`, also at the end.
    /// `None` for absolute addresses.
    folder: Option<String>,
    results: Vec<Value>,
    /// Whether every file could be read.
    complete: bool,
}

impl SarifLog {
    /// Creates an empty log. Files below the absolute path `folder` get relative addresses.
    pub fn new(folder: Option<&Path>) -> SarifLog {
        let folder = folder.and_then(Path::to_str).map(|folder| {
            let folder = slashes(folder);
            format!("{}/", folder.trim_end_matches('/'))
        });
        SarifLog {
            folder,
            results: Vec::new(),
            complete: true,
        }
    }

    /// Adds the diagnostics of the file at `path` and of its imports.
    pub fn add(&mut self, path: &str, checked: &Checked) {
        self.complete &= !checked.sources.files().is_empty();
        for diagnostic in &checked.diagnostics {
            let result = self.result(path, diagnostic, &checked.sources);
            self.results.push(Value::Object(result));
        }
        for Allowed { diagnostic, reason } in &checked.allowed {
            let mut result = self.result(path, diagnostic, &checked.sources);
            // Section 3.35: a suppressed result states the reason.
            let suppression = match reason {
                Some(reason) => json!({ "kind": "inSource", "justification": reason }),
                None => json!({ "kind": "external" }),
            };
            result.insert("suppressions".into(), json!([suppression]));
            self.results.push(Value::Object(result));
        }
    }

    /// Records that a file could not be read, so that the log is incomplete.
    pub fn leave_out(&mut self) {
        self.complete = false;
    }

    /// Returns the complete log as JSON text.
    pub fn document(self) -> String {
        let version = env!("CARGO_PKG_VERSION");
        let rules: Value = Code::ALL.iter().map(|&code| rule(code)).collect();
        let document = json!({
            "$schema": SCHEMA,
            "version": "2.1.0",
            "runs": [{
                "tool": { "driver": {
                    "name": "stochc",
                    "version": version,
                    "semanticVersion": version,
                    "rules": rules,
                }},
                "invocations": [{ "executionSuccessful": self.complete }],
                "columnKind": "unicodeCodePoints",
                "results": self.results,
            }],
        });
        format!("{document:#}\n")
    }

    /// Returns a diagnostic as a SARIF result (section 3.27).
    fn result(&self, path: &str, diagnostic: &Diagnostic, sources: &Sources) -> Map<String, Value> {
        let mut text = diagnostic.message();
        if let Some(help) = &diagnostic.help {
            text.push_str("\nhelp: ");
            text.push_str(help);
        }
        let mut labels = diagnostic.labels.iter();
        let place = match labels.next() {
            Some(label) => self.location(label, sources),
            // A file that cannot be read has no lines.
            None => json!({ "physicalLocation": { "artifactLocation": self.artifact(path) } }),
        };
        let mut result = Map::new();
        let mut put = |key: &str, value: Value| result.insert(key.into(), value);
        put("ruleId", diagnostic.code.name().into());
        let number = Code::ALL.iter().position(|&code| code == diagnostic.code);
        put("ruleIndex", number.into());
        put("level", diagnostic.severity.name().into());
        put("message", json!({ "text": text }));
        put("locations", json!([place]));
        let others: Vec<Value> = (labels.enumerate())
            .map(|(number, label)| {
                let mut place = self.location(label, sources);
                place["id"] = (number + 1).into();
                place
            })
            .collect();
        if !others.is_empty() {
            put("relatedLocations", others.into());
        }
        if let Some(fix) = &diagnostic.fix {
            put("fixes", json!([self.fix(fix, sources)]));
        }
        result
    }

    /// Returns a label of a diagnostic as a SARIF location (section 3.28).
    fn location(&self, label: &Label, sources: &Sources) -> Value {
        let name = &sources.file(label.location.file).name;
        json!({
            "physicalLocation": {
                "artifactLocation": self.artifact(name),
                "region": region(sources, label.location),
            },
            "message": { "text": label.text },
        })
    }

    /// Returns a fix as a SARIF fix (section 3.55), with one `artifactChange` per changed file.
    fn fix(&self, fix: &Fix, sources: &Sources) -> Value {
        let mut files: Vec<_> = fix.edits.iter().map(|edit| edit.location.file).collect();
        files.sort_unstable();
        files.dedup();
        let changes: Value = (files.into_iter())
            .map(|file| {
                let edits = fix.edits.iter().filter(|edit| edit.location.file == file);
                let replacements: Value = edits
                    .map(|edit| {
                        json!({
                            "deletedRegion": region(sources, edit.location),
                            "insertedContent": { "text": edit.text },
                        })
                    })
                    .collect();
                json!({
                    "artifactLocation": self.artifact(&sources.file(file).name),
                    "replacements": replacements,
                })
            })
            .collect();
        // SARIF has no field that states whether a fix is safe.
        let text = if fix.safe {
            fix.title.clone()
        } else {
            format!("possible fix: {}", fix.title)
        };
        json!({ "description": { "text": text }, "artifactChanges": changes })
    }

    /// Returns a file as an artifact location (section 3.4).
    fn artifact(&self, name: &str) -> Value {
        json!({ "uri": file_address(name, self.folder.as_deref()) })
    }
}

/// Returns a source location as a region (section 3.30). The run declares the unit of its columns.
fn region(sources: &Sources, location: SourceLocation) -> Value {
    let (start_line, start_column) = sources.file(location.file).position(location.span.start);
    let (end_line, end_column) = sources.file(location.file).position(location.span.end);
    json!({
        "startLine": start_line,
        "startColumn": start_column,
        "endLine": end_line,
        "endColumn": end_column,
    })
}

/// Returns a diagnostic code as a reporting descriptor (section 3.49). Its texts are from the page
/// about the code.
fn rule(code: Code) -> Value {
    let page = code.page();
    let (_, text) = page.split_once('\n').unwrap_or((page, ""));
    let first = text.trim_start().split("\n\n").next().unwrap_or_default();
    let full = first.replace('\n', " ");
    json!({
        "id": code.name(),
        "shortDescription": { "text": code.meaning() },
        "fullDescription": { "text": full.trim_end() },
        "help": { "text": page, "markdown": page },
        "defaultConfiguration": { "level": code.severity().name() },
    })
}

/// Returns the address of a file. It is relative if the name is relative or below `folder`.
fn file_address(name: &str, folder: Option<&str>) -> String {
    let name = slashes(name);
    let path = folder
        .and_then(|folder| name.strip_prefix(folder))
        .unwrap_or(&name);
    let path = without_dots(path);
    let encoded = address(&path);
    match path.starts_with('/') {
        true => format!("file://{encoded}"),
        false if Path::new(&path).is_absolute() => format!("file:///{encoded}"),
        false => encoded,
    }
}

/// Returns a path with `/` as separator.
fn slashes(path: &str) -> String {
    match std::path::MAIN_SEPARATOR {
        '/' => path.to_owned(),
        other => path.replace(other, "/"),
    }
}

#[cfg(test)]
mod tests {
    use super::file_address;

    #[test]
    fn addresses_are_relative_and_escaped() {
        let folder = Some("/home/a b/");
        for (name, uri) in [
            ("a.sa", "a.sa"),
            ("./x/../y/a.sa", "y/a.sa"),
            ("../a.sa", "../a.sa"),
            ("two towers#1?.sa", "two%20towers%231%3F.sa"),
            ("100%.sa", "100%25.sa"),
            ("türme/塔.sa", "t%C3%BCrme/%E5%A1%94.sa"),
            ("c:a.sa", "c%3Aa.sa"),
            ("/home/a b/c.sa", "c.sa"),
            ("/home/a bc/d.sa", "file:///home/a%20bc/d.sa"),
        ] {
            assert_eq!(file_address(name, folder), uri, "{name}");
        }
    }
}
