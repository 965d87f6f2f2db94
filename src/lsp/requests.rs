//! From methods of the protocol to features.
use std::io::Write;
use std::rc::Rc;

use gen_lsp_types::{
    CodeActionParams, CompletionParams, DefinitionParams, DidChangeTextDocumentParams,
    DidCloseTextDocumentParams, DidOpenTextDocumentParams, DidSaveTextDocumentParams,
    DocumentFormattingParams, DocumentHighlightParams, DocumentSymbolParams, HoverParams, Location,
    PrepareRenameParams, ReferenceParams, RenameParams, TextDocumentPositionParams,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use stochc_compiler::FileId;

use super::analysis::Analysis;
use super::definition::{self, named_at};
use super::position::Lines;
use super::server::Server;
use super::wire::{Failure, Reason};
use super::{actions, formatting, hover, rename, scene, symbols, uri};

fn params<T: DeserializeOwned>(params: Value) -> Result<T, Failure> {
    serde_json::from_value(params)
        .map_err(|error| Failure::new(Reason::InvalidParams, error.to_string()))
}

fn value(result: impl Serialize) -> Result<Value, Failure> {
    serde_json::to_value(result)
        .map_err(|error| Failure::new(Reason::InternalError, error.to_string()))
}

fn not_open() -> Failure {
    Failure::refusal("the file is not open")
}

impl<W: Write> Server<W> {
    /// Takes note of something; what cannot be understood is passed over.
    pub(super) fn notification(&mut self, method: &str, raw: Value) {
        match method {
            "textDocument/didOpen" => {
                if let Ok(it) = params::<DidOpenTextDocumentParams>(raw) {
                    let it = it.text_document;
                    let path = self.documents.open(it.uri.0, it.text, it.version);
                    self.changed(&path);
                }
            }
            "textDocument/didChange" => {
                if let Ok(it) = params::<DidChangeTextDocumentParams>(raw) {
                    let encoding = self.encoding;
                    let id = it.text_document;
                    let (uri, version) = (id.text_document_identifier.uri.0, id.version);
                    let changes = it.content_changes;
                    let changed = self.documents.change(&uri, version, changes, encoding);
                    if let Some(path) = changed {
                        self.changed(&path);
                    }
                }
            }
            "textDocument/didSave" => {
                // A program that was missing a file may find it now.
                if let Ok(it) = params::<DidSaveTextDocumentParams>(raw) {
                    self.changed(&uri::path(&it.text_document.uri.0));
                }
            }
            "textDocument/didClose" => {
                if let Ok(it) = params::<DidCloseTextDocumentParams>(raw) {
                    let path = self.documents.close(&it.text_document.uri.0);
                    self.closed(&path);
                }
            }
            _ => {}
        }
    }

    /// Answers a request.
    pub(super) fn request(&mut self, method: &str, raw: Value) -> Result<Value, Failure> {
        match method {
            "textDocument/hover" => {
                let it: HoverParams = params(raw)?;
                let (analysis, at) = self.at(&it.text_document_position_params)?;
                value(hover::hover(&analysis, at).map(|(text, site)| {
                    json!({
                        "contents": { "kind": "markdown", "value": text },
                        "range": analysis.range(site),
                    })
                }))
            }
            "textDocument/completion" => {
                let it: CompletionParams = params(raw)?;
                let (analysis, at) = self.at(&it.text_document_position_params)?;
                value(scene::completions(&analysis, at))
            }
            "textDocument/definition" => {
                let it: DefinitionParams = params(raw)?;
                let (analysis, at) = self.at(&it.text_document_position_params)?;
                let sites = definition::definitions(&analysis, at).into_iter();
                let places = sites.map(|site| analysis.location(site, &self.documents));
                value(places.collect::<Vec<Location>>())
            }
            "textDocument/references" => self.references(params(raw)?),
            "textDocument/documentHighlight" => {
                let it: DocumentHighlightParams = params(raw)?;
                let (analysis, at) = self.at(&it.text_document_position_params)?;
                let places = definition::highlights(&analysis, at).into_iter();
                // Reading, or writing.
                let kind = |declares| if declares { 3 } else { 2 };
                let shown = places
                    .map(|(range, declares)| json!({ "range": range, "kind": kind(declares) }));
                value(shown.collect::<Vec<Value>>())
            }
            "textDocument/prepareRename" => {
                let it: PrepareRenameParams = params(raw)?;
                let (analysis, at) = self.at(&it.text_document_position_params)?;
                let site = rename::renameable(&analysis, at)?;
                let placeholder = analysis.checked.sources.text(site);
                value(json!({ "range": analysis.range(site), "placeholder": placeholder }))
            }
            "textDocument/rename" => {
                let it: RenameParams = params(raw)?;
                let (analysis, at) = self.at(&it.text_document_position_params)?;
                let all = self.all_analyses();
                let all: Vec<&Analysis> = all.iter().map(|analysis| &**analysis).collect();
                value(rename::rename(
                    &analysis,
                    &all,
                    at,
                    &it.new_name,
                    &self.documents,
                )?)
            }
            "textDocument/documentSymbol" => {
                let it: DocumentSymbolParams = params(raw)?;
                let analysis = self.of(&it.text_document.uri.0)?;
                let lines = analysis.lines(FileId(0));
                let checked = &analysis.checked;
                value(symbols::symbols(
                    &checked.tree.items,
                    &checked.symbols,
                    &lines,
                ))
            }
            "textDocument/formatting" => {
                let it: DocumentFormattingParams = params(raw)?;
                let path = uri::path(&it.text_document.uri.0);
                let document = self.documents.get(&path).ok_or_else(not_open)?;
                let lines = Lines::of(&document.text, self.encoding);
                value(formatting::edits(&document.text, &lines)?)
            }
            "textDocument/codeAction" => {
                let it: CodeActionParams = params(raw)?;
                let path = uri::path(&it.text_document.uri.0);
                let analysis = self.of(&it.text_document.uri.0)?;
                let lines = analysis.lines(FileId(0));
                let between = (lines.offset(it.range.start), lines.offset(it.range.end));
                value(actions::actions(&analysis, &path, between, &self.documents))
            }
            _ => Err(Failure::new(
                Reason::MethodNotFound,
                format!("`{method}` is not known"),
            )),
        }
    }

    fn references(&mut self, it: ReferenceParams) -> Result<Value, Failure> {
        let (analysis, at) = self.at(&it.text_document_position_params)?;
        let Some(name) = analysis.name_at(at) else {
            return value(json!([]));
        };
        let all = self.all_analyses();
        let all: Vec<&Analysis> = all.iter().map(|analysis| &**analysis).collect();
        let span = name.site.span;
        let from = (
            analysis.path(name.site.file).to_owned(),
            span.start,
            span.end,
        );
        let places = definition::everywhere(&all, from);
        let found = places.iter().filter_map(|place| {
            let (analysis, name) =
                (all.iter()).find_map(|analysis| Some((analysis, named_at(analysis, place)?)))?;
            let wanted = it.context.include_declaration || !name.declares;
            wanted.then(|| analysis.location(name.site, &self.documents))
        });
        value(found.collect::<Vec<Location>>())
    }

    /// What is known of an open program.
    fn of(&mut self, uri: &str) -> Result<Rc<Analysis>, Failure> {
        self.analysis(&uri::path(uri)).ok_or_else(not_open)
    }

    /// The same, and a byte of its file.
    fn at(&mut self, it: &TextDocumentPositionParams) -> Result<(Rc<Analysis>, usize), Failure> {
        let analysis = self.of(&it.text_document.uri.0)?;
        if analysis.checked.sources.files().is_empty() {
            return Err(Failure::refusal("the file cannot be read"));
        }
        let at = analysis.lines(FileId(0)).offset(it.position);
        Ok((analysis, at))
    }
}
