//! Mapping from methods of the protocol to features.
use std::sync::Arc;

use gen_lsp_types::{
    CodeActionParams, CodeLensParams, CompletionParams, DefinitionParams,
    DidChangeTextDocumentParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams,
    DidSaveTextDocumentParams, DocumentDiagnosticParams, DocumentFormattingParams,
    DocumentHighlightParams, DocumentLinkParams, DocumentRangeFormattingParams,
    DocumentSymbolParams, FoldingRangeParams, HoverParams, InlayHintParams, Location, Position,
    PrepareRenameParams, ReferenceParams, RenameParams, SemanticTokens, SemanticTokensParams,
    SemanticTokensRangeParams, TextDocumentPositionParams, TextEdit, WorkspaceSymbolParams,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use stochc_compiler::{Cancellation, FileId};

use super::wire::{Reason, RequestFailure};
use crate::features::definition::{self, named_at};
use crate::features::{
    actions, completion, diagnostics, folding, formatting, hints, hover, lenses, rename, symbols,
    tokens,
};
use crate::workspace::analysis::Analysis;
use crate::workspace::documents::Documents;
use crate::workspace::position::{Encoding, LineIndex};
use crate::workspace::uri;

fn params<T: DeserializeOwned>(params: Value) -> Result<T, RequestFailure> {
    serde_json::from_value(params)
        .map_err(|error| RequestFailure::new(Reason::InvalidParams, error.to_string()))
}

fn json_text(result: impl Serialize) -> Result<String, RequestFailure> {
    serde_json::to_string(&result)
        .map_err(|error| RequestFailure::new(Reason::InternalError, error.to_string()))
}

/// Notification from the client.
pub enum Notification {
    /// A text was opened or changed.
    Changed(String),
    /// Files on disk may have changed.
    ChangedOnDisk,
    /// A text was closed.
    Closed(String),
}

/// Processes a notification. Returns `None` if it is invalid or needs no action.
pub fn notification(
    method: &str,
    raw: Value,
    documents: &Documents,
    encoding: Encoding,
) -> Option<Notification> {
    match method {
        "textDocument/didOpen" => {
            let it = params::<DidOpenTextDocumentParams>(raw).ok()?.text_document;
            let path = documents.open(it.uri.0, it.text, it.version);
            Some(Notification::Changed(path))
        }
        "textDocument/didChange" => {
            let it = params::<DidChangeTextDocumentParams>(raw).ok()?;
            let id = it.text_document;
            let (uri, version) = (id.text_document_identifier.uri.0, id.version);
            let path = documents.change(&uri, version, it.content_changes, encoding)?;
            Some(Notification::Changed(path))
        }
        "textDocument/didSave" => {
            params::<DidSaveTextDocumentParams>(raw).ok()?;
            Some(Notification::ChangedOnDisk)
        }
        // The changed paths are irrelevant: a link or a folder may have changed as well.
        "workspace/didChangeWatchedFiles" => Some(Notification::ChangedOnDisk),
        "textDocument/didClose" => {
            let it = params::<DidCloseTextDocumentParams>(raw).ok()?;
            Some(Notification::Closed(
                documents.close(&it.text_document.uri.0),
            ))
        }
        _ => None,
    }
}

/// Programs that the response to a request needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// No program: the request needs only the text.
    Text,
    /// The program of the request's file.
    Own,
    /// The program of the request's file. If its check takes long, its last analysis is enough.
    Recent,
    /// All open programs.
    All,
}

pub struct Query {
    /// File of the request. Empty for a request about the workspace.
    pub path: String,
    pub needs: Needs,
    /// Whether the response may contain edits of files.
    pub has_edits: bool,
    pub answer: RequestHandler,
}

/// Function that computes a response.
pub type RequestHandler =
    Box<dyn FnOnce(&RequestContext<'_>) -> Result<String, RequestFailure> + Send>;

/// Context of a request, for computing the response.
pub struct RequestContext<'c> {
    pub path: String,
    /// Analyses of the required programs. The program of the request comes first.
    pub programs: Vec<Arc<Analysis>>,
    pub documents: Documents,
    pub encoding: Encoding,
    pub cancellation: Cancellation<'c>,
}

impl RequestContext<'_> {
    /// Returns the analysis of the request's program.
    fn own(&self) -> Result<&Analysis, RequestFailure> {
        let own = self.programs.first();
        own.map(|own| &**own).ok_or_else(not_open)
    }

    /// Returns the analysis of the request's program, and the byte of a position in its file.
    fn at(&self, position: Position) -> Result<(&Analysis, usize), RequestFailure> {
        let analysis = self.own()?;
        if analysis.checked.sources.files().is_empty() {
            return Err(RequestFailure::request_failed("the file cannot be read"));
        }
        let at = analysis.lines(FileId(0)).offset(position);
        Ok((analysis, at))
    }

    fn all(&self) -> Vec<&Analysis> {
        self.programs.iter().map(|analysis| &**analysis).collect()
    }
}

pub fn not_open() -> RequestFailure {
    RequestFailure::request_failed("the file is not open")
}

impl Query {
    fn new(
        uri: &str,
        needs: Needs,
        answer: impl FnOnce(&RequestContext<'_>) -> Result<String, RequestFailure> + Send + 'static,
    ) -> Query {
        Query {
            path: uri::path(uri),
            needs,
            has_edits: false,
            answer: Box::new(answer),
        }
    }

    /// Marks the response as containing edits of files that may not be open.
    fn with_edits(self) -> Query {
        Query {
            has_edits: true,
            ..self
        }
    }

    /// Returns a request about a position.
    fn at(
        it: TextDocumentPositionParams,
        needs: Needs,
        answer: impl FnOnce(&RequestContext<'_>, &Analysis, usize) -> Result<String, RequestFailure>
        + Send
        + 'static,
    ) -> Query {
        Query::new(&it.text_document.uri.0, needs, move |context| {
            let (analysis, at) = context.at(it.position)?;
            answer(context, analysis, at)
        })
    }

    /// Parses a request.
    ///
    /// # Errors
    ///
    /// If it is invalid.
    pub fn parse(method: &str, raw: Value) -> Result<Query, RequestFailure> {
        Ok(match method {
            "textDocument/hover" => {
                let it: HoverParams = params(raw)?;
                let it = it.text_document_position_params;
                Query::at(it, Needs::Recent, |context, analysis, at| {
                    let found = hover::hover(analysis, at, context.cancellation)?;
                    json_text(found.map(|(text, location)| {
                        json!({
                            "contents": { "kind": "markdown", "value": text },
                            "range": analysis.range(location),
                        })
                    }))
                })
            }
            "textDocument/definition" => {
                let it: DefinitionParams = params(raw)?;
                let it = it.text_document_position_params;
                Query::at(it, Needs::Recent, |context, analysis, at| {
                    let locations = definition::definitions(analysis, at, context.cancellation)?;
                    let found = locations.into_iter();
                    let found =
                        found.map(|location| analysis.location(location, &context.documents));
                    json_text(found.collect::<Vec<Location>>())
                })
            }
            "textDocument/completion" => {
                let it: CompletionParams = params(raw)?;
                let it = it.text_document_position_params;
                let position = it.position;
                Query::at(it, Needs::Recent, move |_, analysis, at| {
                    let line = analysis.lines(FileId(0)).line_before(position);
                    json_text(completion::completions(analysis, at, line))
                })
            }
            "textDocument/references" => {
                let it: ReferenceParams = params(raw)?;
                let with_declaration = it.context.include_declaration;
                let it = it.text_document_position_params;
                Query::at(it, Needs::All, move |context, analysis, at| {
                    references(context, analysis, at, with_declaration)
                })
            }
            "textDocument/documentHighlight" => {
                let it: DocumentHighlightParams = params(raw)?;
                let it = it.text_document_position_params;
                Query::at(it, Needs::Recent, |context, analysis, at| {
                    let ranges = definition::highlights(analysis, at, context.cancellation)?;
                    // Read or write access.
                    let kind = |declares| if declares { 3 } else { 2 };
                    let shown = ranges
                        .into_iter()
                        .map(|(range, declares)| json!({ "range": range, "kind": kind(declares) }));
                    json_text(shown.collect::<Vec<Value>>())
                })
            }
            "textDocument/prepareRename" => {
                let it: PrepareRenameParams = params(raw)?;
                let it = it.text_document_position_params;
                Query::at(it, Needs::Own, |_, analysis, at| {
                    let location = rename::renameable(analysis, at)?;
                    let placeholder = analysis.checked.sources.text(location);
                    json_text(
                        json!({ "range": analysis.range(location), "placeholder": placeholder }),
                    )
                })
            }
            "textDocument/rename" => {
                let it: RenameParams = params(raw)?;
                let new_name = it.new_name;
                let it = it.text_document_position_params;
                Query::at(it, Needs::All, move |context, analysis, at| {
                    let all = context.all();
                    let (documents, cancellation) = (&context.documents, context.cancellation);
                    json_text(rename::rename(
                        analysis,
                        &all,
                        at,
                        &new_name,
                        documents,
                        cancellation,
                    )?)
                })
                .with_edits()
            }
            _ => return Query::parse_for_document(method, raw),
        })
    }

    /// Parses a request about a whole document, or the workspace.
    fn parse_for_document(method: &str, raw: Value) -> Result<Query, RequestFailure> {
        Ok(match method {
            "textDocument/documentSymbol" => {
                let it: DocumentSymbolParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Recent, |context| {
                    let analysis = context.own()?;
                    let lines = analysis.lines(FileId(0));
                    let checked = &analysis.checked;
                    json_text(symbols::symbols(
                        &checked.tree.items,
                        &checked.symbols,
                        &lines,
                    ))
                })
            }
            "textDocument/semanticTokens/full" => {
                let it: SemanticTokensParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Recent, |context| {
                    let data = tokens::tokens(context.own()?, &(0..usize::MAX));
                    json_text(SemanticTokens {
                        result_id: None,
                        data,
                    })
                })
            }
            "textDocument/semanticTokens/range" => {
                let it: SemanticTokensRangeParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Recent, move |context| {
                    let analysis = context.own()?;
                    let within = analysis.lines(FileId(0)).offsets(it.range);
                    let data = tokens::tokens(analysis, &within);
                    json_text(SemanticTokens {
                        result_id: None,
                        data,
                    })
                })
            }
            "textDocument/inlayHint" => {
                let it: InlayHintParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Recent, move |context| {
                    let analysis = context.own()?;
                    let within = analysis.lines(FileId(0)).offsets(it.range);
                    json_text(hints::hints(analysis, &within))
                })
            }
            "textDocument/foldingRange" => {
                let it: FoldingRangeParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Text, |context| {
                    let document = context.documents.get(&context.path).ok_or_else(not_open)?;
                    json_text(folding::ranges(&document.program_text(context.encoding)))
                })
            }
            "textDocument/documentLink" => {
                let it: DocumentLinkParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Recent, |context| {
                    let analysis = context.own()?;
                    let links = definition::imports(analysis).map(|(path, file)| {
                        let target = context.documents.uri(analysis.path(file));
                        json!({ "range": analysis.range(path), "target": target })
                    });
                    json_text(links.collect::<Vec<Value>>())
                })
            }
            "textDocument/codeLens" => {
                let it: CodeLensParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Recent, |context| {
                    let uri = context.documents.uri(&context.path);
                    json_text(lenses::lenses(context.own()?, &uri))
                })
            }
            "textDocument/diagnostic" => {
                let it: DocumentDiagnosticParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Recent, |context| {
                    let path = &context.path;
                    let mut all = diagnostics::of(context.own()?, path, &context.documents);
                    json_text(json!({ "kind": "full", "items": all.remove(path) }))
                })
            }
            "workspace/symbol" => {
                let it: WorkspaceSymbolParams = params(raw)?;
                Query {
                    path: String::new(),
                    needs: Needs::All,
                    has_edits: false,
                    answer: Box::new(move |context| {
                        let all = context.all();
                        json_text(symbols::in_workspace(&all, &it.query, &context.documents))
                    }),
                }
            }
            _ => return Query::parse_edit(method, raw),
        })
    }

    fn parse_edit(method: &str, raw: Value) -> Result<Query, RequestFailure> {
        Ok(match method {
            "textDocument/formatting" => {
                let it: DocumentFormattingParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Text, |context| {
                    json_text(formatted(context)?)
                })
            }
            "textDocument/rangeFormatting" => {
                let it: DocumentRangeFormattingParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Text, move |context| {
                    let lines = it.range.start.line..=it.range.end.line;
                    let mut edits = formatted(context)?;
                    edits.retain(|edit| lines.contains(&edit.range.start.line));
                    json_text(edits)
                })
            }
            "textDocument/codeAction" => {
                let it: CodeActionParams = params(raw)?;
                Query::new(&it.text_document.uri.0, Needs::Recent, move |context| {
                    let analysis = context.own()?;
                    let within = analysis.lines(FileId(0)).offsets(it.range);
                    let (path, documents) = (&context.path, &context.documents);
                    json_text(actions::actions(analysis, path, &within, documents))
                })
                .with_edits()
            }
            _ => {
                return Err(RequestFailure::new(
                    Reason::MethodNotFound,
                    format!("unknown method `{method}`"),
                ));
            }
        })
    }
}

/// Returns the edits that format the request's file.
fn formatted(context: &RequestContext<'_>) -> Result<Vec<TextEdit>, RequestFailure> {
    let document = context.documents.get(&context.path).ok_or_else(not_open)?;
    let text = document.program_text(context.encoding);
    let lines = LineIndex::new(&text, context.encoding);
    formatting::edits(&text, &lines)
}

fn references(
    context: &RequestContext<'_>,
    analysis: &Analysis,
    at: usize,
    with_declaration: bool,
) -> Result<String, RequestFailure> {
    let Some(name) = analysis.name_at(at) else {
        return json_text(json!([]));
    };
    let all = context.all();
    let span = name.location.span;
    let from = (
        analysis.path(name.location.file).to_owned(),
        span.start,
        span.end,
    );
    let uses = definition::everywhere(&all, from, context.cancellation)?;
    let found = uses.iter().filter_map(|location| {
        let (analysis, name) =
            (all.iter()).find_map(|analysis| Some((analysis, named_at(analysis, location)?)))?;
        let is_included = with_declaration || !name.declares;
        is_included.then(|| analysis.location(name.location, &context.documents))
    });
    json_text(found.collect::<Vec<Location>>())
}
