//! The session: incoming messages, pending requests and published diagnostics.
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::time::Duration;

use gen_lsp_types::Diagnostic as LspDiagnostic;
use serde_json::{Value, json};
use stochc_files::bound;

use super::client_process;
use super::event::{Done, ServerEvent};
use super::jobs::{JobId, JobTrigger, Jobs};
use super::requests::{self, Needs, Notification, Query, RequestContext, RequestHandler};
use super::wire::{self, ClientMessage, Incoming, Reason, RequestFailure};
use crate::features::tokens;
use crate::workspace::analysis::Analysis;
use crate::workspace::documents::Documents;
use crate::workspace::position::Encoding;
use crate::workspace::programs::{Knowledge, Programs};
use crate::workspace::uri;

/// Idle time before a changed text is checked in the background.
const PAUSE: Duration = Duration::from_millis(120);

const REFRESH_DIAGNOSTICS: &str = "workspace/diagnostic/refresh";

/// Capabilities of clients for refreshes, each with the request for the refresh.
const REFRESHES: [(&str, &str); 4] = [
    ("semanticTokens", "workspace/semanticTokens/refresh"),
    ("inlayHint", "workspace/inlayHint/refresh"),
    ("codeLens", "workspace/codeLens/refresh"),
    ("diagnostics", REFRESH_DIAGNOSTICS),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SessionStage {
    Begun,
    Serving,
    /// The client has requested shutdown.
    Leaving,
}

pub struct Server<W> {
    output: W,
    stage: SessionStage,
    jobs: Jobs<Done>,
    events: SyncSender<ServerEvent>,
    documents: Documents,
    encoding: Encoding,
    programs: Programs,
    /// Workspace folders of the client. Every program may import from them.
    folders: Arc<[PathBuf]>,
    /// Whether the client can report changes of files.
    can_watch: bool,
    /// Whether the client requests the diagnostics of open files.
    can_pull: bool,
    /// Requests for a refresh that the client supports.
    refreshes: Vec<&'static str>,
    /// Pending requests in the order of arrival.
    requests: Vec<PendingRequest>,
    /// Diagnostics published for each file, with the version of its text.
    shown: BTreeMap<String, (Option<i32>, Vec<LspDiagnostic>)>,
    disconnected: bool,
}

/// A request without a response so far.
struct PendingRequest {
    id: Value,
    method: String,
    path: String,
    needs: Needs,
    has_edits: bool,
    work: Work,
}

/// Progress of a request.
enum Work {
    /// The request waits for analyses of programs.
    Waiting(RequestHandler),
    Running(JobId),
}

impl PendingRequest {
    /// Returns whether a change makes the response to this request outdated.
    fn is_about(&self, changed: &str, outdated: &BTreeSet<String>) -> bool {
        match self.needs {
            Needs::Text => self.path == changed,
            Needs::Own | Needs::Recent => outdated.contains(&self.path),
            Needs::All => {
                let is_running = matches!(self.work, Work::Running(_));
                outdated.contains(&self.path) || is_running && !outdated.is_empty()
            }
        }
    }
}

impl<W: Write> Server<W> {
    /// Returns the session before the client's first message. `output` receives the messages to the
    /// client, and `events` the results of jobs.
    pub fn new(output: W, events: SyncSender<ServerEvent>) -> Server<W> {
        let of_jobs = events.clone();
        Server {
            output,
            stage: SessionStage::Begun,
            jobs: Jobs::new(move |job, done| {
                // The receiver may already have ended.
                let _ = of_jobs.send(ServerEvent::Done(job, done));
            }),
            events,
            documents: Documents::default(),
            encoding: Encoding::default(),
            programs: Programs::default(),
            folders: Arc::default(),
            can_watch: false,
            can_pull: false,
            refreshes: Vec::new(),
            requests: Vec::new(),
            shown: BTreeMap::new(),
            disconnected: false,
        }
    }

    /// Serves until the end. Returns whether the client sent `shutdown` before exiting.
    pub fn run(mut self, receiver: Receiver<ServerEvent>) -> bool {
        while !self.disconnected {
            let event = match self.unchecked() {
                None => receiver.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(_) => receiver.recv_timeout(PAUSE),
            };
            match event {
                Ok(ServerEvent::Incoming(Incoming::Message(message)))
                    if message.method == "exit" =>
                {
                    break;
                }
                Ok(ServerEvent::Incoming(Incoming::Message(message))) => self.message(message),
                Ok(ServerEvent::Incoming(Incoming::Garbage(why))) => {
                    let failure = RequestFailure::new(Reason::ParseError, why);
                    self.respond(&Value::Null, Err(failure));
                }
                Ok(ServerEvent::Done(job, done)) => self.done(job, done),
                Err(RecvTimeoutError::Timeout) => {
                    if let Some(path) = self.unchecked() {
                        self.check(&path, JobTrigger::Background);
                    }
                }
                Ok(ServerEvent::Incoming(Incoming::End)) | Err(RecvTimeoutError::Disconnected) => {
                    break;
                }
            }
            self.proceed();
        }
        // Unblocks jobs that have ended in the meantime.
        drop(receiver);
        self.stage == SessionStage::Leaving
    }

    fn message(&mut self, message: ClientMessage) {
        let ClientMessage { id, method, params } = message;
        let Some(id) = id else {
            match method.as_str() {
                "initialized" if self.can_watch => self.watch_files(),
                "$/cancelRequest" => self.cancel(params.get("id").unwrap_or(&Value::Null)),
                _ if self.stage == SessionStage::Serving => self.notification(&method, params),
                _ => {}
            }
            return;
        };
        if method.is_empty() {
            // The client sends a response, although the server has sent no request.
            return;
        }
        let result = match (method.as_str(), self.stage) {
            ("initialize", SessionStage::Begun) => Ok(self.initialize(&params).to_string()),
            (_, SessionStage::Begun) => Err(RequestFailure::new(
                Reason::ServerNotInitialized,
                "`initialize` comes first",
            )),
            ("shutdown", SessionStage::Serving) => {
                self.stage = SessionStage::Leaving;
                self.jobs.cancel_all();
                self.programs = Programs::default();
                self.fail(|_| true, &RequestFailure::cancelled());
                Ok("null".to_owned())
            }
            ("initialize", SessionStage::Serving) | (_, SessionStage::Leaving) => Err(
                RequestFailure::new(Reason::InvalidRequest, format!("too late for `{method}`")),
            ),
            (_, SessionStage::Serving) => match self.query(&method, params) {
                Ok(query) => {
                    self.requests.push(PendingRequest {
                        id,
                        method,
                        path: query.path,
                        needs: query.needs,
                        has_edits: query.has_edits,
                        work: Work::Waiting(query.answer),
                    });
                    return;
                }
                Err(failure) => Err(failure),
            },
        };
        self.respond(&id, result);
    }

    fn query(&self, method: &str, params: Value) -> Result<Query, RequestFailure> {
        let mut query = Query::parse(method, params)?;
        // Without a refresh, the client would keep outdated diagnostics.
        if method == "textDocument/diagnostic" && !self.refreshes.contains(&REFRESH_DIAGNOSTICS) {
            query.needs = Needs::Own;
        }
        if query.path.is_empty() || self.documents.is_open(&query.path) {
            Ok(query)
        } else {
            Err(requests::not_open())
        }
    }

    fn notification(&mut self, method: &str, params: Value) {
        let (documents, encoding) = (&self.documents, self.encoding);
        let Some(it) = requests::notification(method, params, documents, encoding) else {
            return;
        };
        let (path, outdated) = match it {
            Notification::Changed(path) => {
                let outdated = self.programs.changed(&path, &self.jobs);
                (path, outdated)
            }
            Notification::ChangedOnDisk => (String::new(), self.changed_on_disk()),
            Notification::Closed(path) => {
                let outdated = self.programs.closed(&path, &self.jobs);
                self.show();
                (path, outdated)
            }
        };
        self.fail(|request| request.is_about(&path, &outdated), &modified());
    }

    /// Compares the files of all programs with the disk. Returns the programs that have to be
    /// checked again.
    fn changed_on_disk(&mut self) -> BTreeSet<String> {
        let (documents, jobs) = (&self.documents, &self.jobs);
        self.programs
            .changed_on_disk(documents, self.encoding, jobs)
    }

    fn cancel(&mut self, id: &Value) {
        self.fail(|request| request.id == *id, &RequestFailure::cancelled());
    }

    /// Answers the selected requests with an error and cancels their jobs.
    fn fail(&mut self, matches: impl Fn(&PendingRequest) -> bool, why: &RequestFailure) {
        let (matching, rest) = std::mem::take(&mut self.requests)
            .into_iter()
            .partition(matches);
        self.requests = rest;
        for request in matching {
            if let Work::Running(job) = request.work {
                self.jobs.cancel(job);
            }
            self.respond(&request.id, Err(why.clone()));
        }
    }

    /// Processes the result of a job.
    fn done(&mut self, job: JobId, done: Option<Done>) {
        self.jobs.ended(job);
        let is_it =
            |request: &PendingRequest| matches!(request.work, Work::Running(own) if own == job);
        if let Some(at) = self.requests.iter().position(is_it) {
            let request = self.requests.remove(at);
            let result = match done {
                Some(Done::Answered(result)) => self.compared_with_disk(&request, result),
                _ => Err(failed(&request.method)),
            };
            self.respond(&request.id, result);
            return;
        }
        let checked = match done {
            Some(Done::Checked(checked)) => Some(checked),
            _ => None,
        };
        if let Some(is_refresh_due) = self.programs.checked(job, checked) {
            self.show();
            if is_refresh_due {
                self.refresh();
            }
        }
    }

    /// Replaces an answer by an error if it contains edits and one of its files has changed on the
    /// disk.
    ///
    /// The edits would otherwise be applied at positions of the old text.
    fn compared_with_disk(
        &mut self,
        request: &PendingRequest,
        result: Result<String, RequestFailure>,
    ) -> Result<String, RequestFailure> {
        if !request.has_edits || result.as_ref().map_or(true, |answer| answer == "[]") {
            return result;
        }
        let outdated = self.changed_on_disk();
        self.fail(|other| other.is_about("", &outdated), &modified());
        if request.is_about("", &outdated) {
            Err(modified())
        } else {
            result
        }
    }

    /// Advances the pending requests: starts required checks, and jobs whose input is complete.
    fn proceed(&mut self) {
        for mut request in std::mem::take(&mut self.requests) {
            if let Work::Waiting(answer) = request.work {
                request.work = match self.needed(&request.path, request.needs) {
                    Some(Ok(programs)) if self.jobs.has_room(JobTrigger::Requested) => {
                        match self.work_out(request.path.clone(), programs, answer) {
                            Some(job) => Work::Running(job),
                            None => {
                                let why = failed(&request.method);
                                self.respond(&request.id, Err(why));
                                continue;
                            }
                        }
                    }
                    Some(Err(())) => {
                        let why = failed(&request.method);
                        self.respond(&request.id, Err(why));
                        continue;
                    }
                    Some(Ok(_)) | None => Work::Waiting(answer),
                };
            }
            self.requests.push(request);
        }
    }

    /// Returns the analyses that a request needs, its own program first. Returns an error if one of
    /// the checks has failed.
    ///
    /// Returns `None` if a check must run first. The check starts as soon as another job is
    /// allowed.
    fn needed(&mut self, path: &str, needs: Needs) -> Option<Result<Vec<Arc<Analysis>>, ()>> {
        let paths: Vec<String> = match needs {
            Needs::Text => Vec::new(),
            Needs::Own | Needs::Recent => vec![path.to_owned()],
            Needs::All => {
                let own = Some(path.to_owned()).filter(|path| !path.is_empty());
                let others = self.programs.paths().filter(|other| *other != path);
                own.into_iter().chain(others.cloned()).collect()
            }
        };
        let mut programs = Some(Vec::new());
        for path in paths {
            match self.programs.known(&path) {
                Some(Knowledge::Known(analysis)) => {
                    if let Some(programs) = &mut programs {
                        programs.push(analysis);
                    }
                }
                Some(Knowledge::Failed) | None => return Some(Err(())),
                Some(Knowledge::Waiting) => {
                    if needs == Needs::Recent
                        && let Some(last) = self.programs.last(&path)
                    {
                        return Some(Ok(vec![last]));
                    }
                    self.check(&path, JobTrigger::Requested);
                    programs = None;
                }
            }
        }
        programs.map(Ok)
    }

    /// Starts a job that computes a response. Returns `None` if no thread is available.
    fn work_out(
        &mut self,
        path: String,
        programs: Vec<Arc<Analysis>>,
        answer: RequestHandler,
    ) -> Option<JobId> {
        let (documents, encoding) = (self.documents.clone(), self.encoding);
        let job = self.jobs.start(move |cancellation| {
            if let (Some(own), Some(document)) = (programs.first(), documents.get(&path)) {
                own.set_newer(|| document.program_text(encoding));
            }
            let context = RequestContext {
                path,
                programs,
                documents,
                encoding,
                cancellation,
            };
            Some(Done::Answered(answer(&context)))
        });
        job.ok()
    }

    /// Returns a program to check in the background, if another job is allowed. Running requests
    /// end first.
    fn unchecked(&self) -> Option<String> {
        let is_running = |request: &PendingRequest| matches!(request.work, Work::Running(_));
        let may_start =
            !self.requests.iter().any(is_running) && self.jobs.has_room(JobTrigger::Background);
        let unchecked = self.programs.unchecked();
        unchecked.filter(|_| may_start).cloned()
    }

    fn check(&mut self, path: &str, trigger: JobTrigger) {
        let (documents, encoding) = (&self.documents, self.encoding);
        let (folders, jobs) = (&self.folders, &mut self.jobs);
        (self.programs).check(path, trigger, documents, folders, encoding, jobs);
    }

    fn initialize(&mut self, params: &Value) -> Value {
        let encodings = params.pointer("/capabilities/general/positionEncodings");
        let offers = |kind: &str| {
            let offered = encodings.and_then(Value::as_array);
            offered.is_some_and(|offered| offered.iter().any(|it| it == kind))
        };
        if offers("utf-8") {
            self.encoding = Encoding::Utf8;
        }
        self.folders = folders(params);
        let watching = "/capabilities/workspace/didChangeWatchedFiles/dynamicRegistration";
        self.can_watch = params.pointer(watching) == Some(&Value::Bool(true));
        let capabilities = &params["capabilities"];
        self.can_pull = capabilities["textDocument"]["diagnostic"].is_object();
        let supported = REFRESHES
            .iter()
            .filter(|(area, _)| capabilities["workspace"][area]["refreshSupport"] == true);
        self.refreshes = supported.map(|(_, method)| *method).collect();
        let client = params["processId"].as_i64();
        if let Some(client) = client.and_then(|id| i32::try_from(id).ok()) {
            client_process::watch(client, self.events.clone());
        }
        self.stage = SessionStage::Serving;
        let encoding = match self.encoding {
            Encoding::Utf8 => "utf-8",
            Encoding::Utf16 => "utf-16",
        };
        json!({
            "capabilities": {
                "positionEncoding": encoding,
                "textDocumentSync": { "openClose": true, "change": 2, "save": true },
                "hoverProvider": true,
                "completionProvider": { "triggerCharacters": ["."] },
                "definitionProvider": true,
                "referencesProvider": true,
                "documentHighlightProvider": true,
                "documentSymbolProvider": true,
                "workspaceSymbolProvider": true,
                "codeLensProvider": {},
                "diagnosticProvider": {
                    "identifier": "stochc",
                    "interFileDependencies": true,
                    "workspaceDiagnostics": false,
                },
                "documentFormattingProvider": true,
                "documentRangeFormattingProvider": true,
                "documentLinkProvider": {},
                "renameProvider": { "prepareProvider": true },
                "codeActionProvider": { "codeActionKinds": ["quickfix"] },
                "foldingRangeProvider": true,
                "inlayHintProvider": true,
                "semanticTokensProvider": {
                    "legend": { "tokenTypes": tokens::TYPES, "tokenModifiers": tokens::MODIFIERS },
                    "full": true,
                    "range": true,
                },
            },
            "serverInfo": { "name": "stochc", "version": env!("CARGO_PKG_VERSION") },
        })
    }

    /// Asks the client to report changes of programs on the disk.
    fn watch_files(&mut self) {
        let watchers = json!([{ "globPattern": "**/*.sa" }]);
        let registration = json!({
            "id": "watched-files",
            "method": "workspace/didChangeWatchedFiles",
            "registerOptions": { "watchers": watchers },
        });
        self.send(&json!({
            "jsonrpc": "2.0",
            "id": "watched-files",
            "method": "client/registerCapability",
            "params": { "registrations": [registration] },
        }));
    }

    /// Asks the client to repeat requests whose responses have changed.
    fn refresh(&mut self) {
        for method in self.refreshes.clone() {
            self.send(&json!({ "jsonrpc": "2.0", "id": method, "method": method }));
        }
    }

    /// Publishes the diagnostics of every file whose diagnostics have changed. A client that
    /// requests the diagnostics of a file only gets those that other programs find in the file.
    fn show(&mut self) {
        let mut now: BTreeMap<String, Vec<LspDiagnostic>> = BTreeMap::new();
        for (path, diagnostics) in self.programs.found() {
            let all = now.entry(path.clone()).or_default();
            for diagnostic in diagnostics {
                // Programs with a common import find the same diagnostics in it.
                let is_pulled = self.can_pull && self.programs.own(path).contains(diagnostic);
                if !is_pulled && !all.contains(diagnostic) {
                    all.push(diagnostic.clone());
                }
            }
        }
        let mut shown = std::mem::take(&mut self.shown);
        let paths: BTreeSet<String> = now.keys().chain(shown.keys()).cloned().collect();
        for path in paths {
            // The diagnostics of an unchecked text are out of date.
            if self.programs.is_unseen(&path) {
                now.remove(&path);
                if let Some(old) = shown.remove(&path) {
                    self.shown.insert(path, old);
                }
                continue;
            }
            let version = self.documents.get(&path).map(|document| document.version);
            let is_known = now.contains_key(&path);
            let new = (version, now.remove(&path).unwrap_or_default());
            let old = shown.get(&path);
            let is_empty = new.1.is_empty() && old.is_none_or(|(_, old)| old.is_empty());
            if old != Some(&new) && !(self.can_pull && is_empty) {
                self.publish(&path, &new);
            }
            if is_known {
                self.shown.insert(path, new);
            }
        }
    }

    fn publish(&mut self, path: &str, (version, diagnostics): &(Option<i32>, Vec<LspDiagnostic>)) {
        let mut params = json!({ "uri": self.documents.uri(path), "diagnostics": diagnostics });
        if let Some(version) = version {
            params["version"] = json!(version);
        }
        self.send(&json!({
            "jsonrpc": "2.0",
            "method": "textDocument/publishDiagnostics",
            "params": params,
        }));
    }

    fn respond(&mut self, id: &Value, result: Result<String, RequestFailure>) {
        self.write(&wire::answer(id, result));
    }

    fn send(&mut self, message: &Value) {
        self.write(&message.to_string());
    }

    fn write(&mut self, message: &str) {
        self.disconnected |= wire::write(&mut self.output, message).is_err();
    }
}

/// Returns the error for a response that refers to an old text.
fn modified() -> RequestFailure {
    RequestFailure::new(Reason::ContentModified, "the text has changed")
}

/// Returns the error for a failure of the server.
fn failed(method: &str) -> RequestFailure {
    let why = format!("`{method}` failed: please report this with the program");
    RequestFailure::new(Reason::InternalError, why)
}

/// Returns the folders that the client has open at initialization.
fn folders(params: &Value) -> Arc<[PathBuf]> {
    let several = params["workspaceFolders"].as_array();
    let several = several.map(|all| all.iter().map(|folder| &folder["uri"]).collect());
    let uris: Vec<&Value> = several.unwrap_or_else(|| vec![&params["rootUri"]]);
    let paths = uris.into_iter().filter_map(Value::as_str).map(uri::path);
    paths
        .filter_map(|path| bound::folder(Path::new(&path)).ok())
        .collect()
}
