//! The conversation: what has come in, what is still to be checked, and what has been said.
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::rc::Rc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use gen_lsp_types::Diagnostic;
use serde_json::{Value, json};

use super::analysis::Analysis;
use super::diagnostics;
use super::documents::Documents;
use super::position::Encoding;
use super::wire::{self, Failure, Incoming, Message, Reason};

/// How long nothing has to come in before a changed text is checked.
const PAUSE: Duration = Duration::from_millis(120);

/// How far the conversation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Begun,
    Serving,
    /// The client has said that it will leave.
    Leaving,
}

/// A client, and what it has open.
pub struct Server<W> {
    output: W,
    stage: Stage,
    /// Messages that wait for their turn.
    queue: VecDeque<Incoming>,
    pub(super) documents: Documents,
    pub(super) encoding: Encoding,
    /// What is known of each open program; nothing, where that is out of date.
    analyses: BTreeMap<String, Rc<Analysis>>,
    /// Programs whose findings the client has not seen.
    unseen: BTreeSet<String>,
    /// The diagnostics of each program by file, as they were found.
    found: BTreeMap<String, BTreeMap<String, Vec<Diagnostic>>>,
    /// The diagnostics of each file, as the client has them, and the number of its text.
    shown: BTreeMap<String, (Option<i32>, Vec<Diagnostic>)>,
    /// Nobody listens any more.
    gone: bool,
}

impl<W: Write> Server<W> {
    /// Waits for a client.
    pub fn new(output: W) -> Server<W> {
        Server {
            output,
            stage: Stage::Begun,
            queue: VecDeque::new(),
            documents: Documents::default(),
            encoding: Encoding::default(),
            analyses: BTreeMap::new(),
            unseen: BTreeSet::new(),
            found: BTreeMap::new(),
            shown: BTreeMap::new(),
            gone: false,
        }
    }

    /// Answers until the end; whether the client said `shutdown` before it left.
    pub fn run(mut self, receiver: &Receiver<Incoming>) -> bool {
        while !self.gone {
            // What has come in meanwhile may take back what is asked.
            while self.queue.len() < super::MOST_WAITING
                && let Ok(incoming) = receiver.try_recv()
            {
                self.enqueue(incoming);
            }
            let next = match self.queue.pop_front() {
                Some(next) => next,
                None if self.unseen.is_empty() => match receiver.recv() {
                    Ok(incoming) => incoming,
                    Err(_) => break,
                },
                None => match receiver.recv_timeout(PAUSE) {
                    Ok(incoming) => incoming,
                    Err(RecvTimeoutError::Timeout) => {
                        self.check_one();
                        continue;
                    }
                    Err(RecvTimeoutError::Disconnected) => break,
                },
            };
            match next {
                Incoming::Message(message) if message.method == "exit" => break,
                Incoming::Message(message) => self.message(message),
                Incoming::Garbage(why) => {
                    let failure = Failure::new(Reason::ParseError, why);
                    self.send(&wire::answer(&Value::Null, Err(failure)));
                }
                Incoming::End => break,
            }
        }
        self.stage == Stage::Leaving
    }

    /// Puts a message at the end of the queue, or takes one out of it that is cancelled.
    fn enqueue(&mut self, incoming: Incoming) {
        let cancelled = match &incoming {
            Incoming::Message(message) if message.method == "$/cancelRequest" => {
                message.params.get("id").cloned()
            }
            _ => {
                self.queue.push_back(incoming);
                return;
            }
        };
        let Some(id) = cancelled else { return };
        let is_it = |waiting: &Incoming| {
            matches!(waiting, Incoming::Message(message)
                if message.id.as_ref() == Some(&id) && !message.method.is_empty())
        };
        if let Some(at) = self.queue.iter().position(is_it) {
            self.queue.remove(at);
            let failure = Failure::new(Reason::RequestCancelled, "cancelled");
            self.send(&wire::answer(&id, Err(failure)));
        }
    }

    fn message(&mut self, message: Message) {
        let Message { id, method, params } = message;
        let Some(id) = id else {
            if self.stage == Stage::Serving {
                self.notification(&method, params);
            }
            return;
        };
        if method.is_empty() {
            // An answer; nothing has been asked.
            return;
        }
        let result = match (method.as_str(), self.stage) {
            ("initialize", Stage::Begun) => Ok(self.initialize(&params)),
            (_, Stage::Begun) => Err(Failure::new(
                Reason::ServerNotInitialized,
                "`initialize` comes first",
            )),
            ("shutdown", Stage::Serving) => {
                self.stage = Stage::Leaving;
                Ok(Value::Null)
            }
            ("initialize", Stage::Serving) | (_, Stage::Leaving) => Err(Failure::new(
                Reason::InvalidRequest,
                format!("too late for `{method}`"),
            )),
            (_, Stage::Serving) => self.guarded(&method, params),
        };
        self.send(&wire::answer(&id, result));
    }

    /// Answers a request; a mistake of the server's costs an answer, not the conversation.
    fn guarded(&mut self, method: &str, params: Value) -> Result<Value, Failure> {
        let answer = catch_unwind(AssertUnwindSafe(|| self.request(method, params)));
        answer.unwrap_or_else(|_| {
            let why = format!("`{method}` failed: please report this with the program");
            Err(Failure::new(Reason::InternalError, why))
        })
    }

    fn initialize(&mut self, params: &Value) -> Value {
        let encodings = params.pointer("/capabilities/general/positionEncodings");
        let offers = |wanted: &str| {
            let offered = encodings.and_then(Value::as_array);
            offered.is_some_and(|offered| offered.iter().any(|it| it == wanted))
        };
        if offers("utf-8") {
            self.encoding = Encoding::Utf8;
        }
        self.stage = Stage::Serving;
        let encoding = match self.encoding {
            Encoding::Utf8 => "utf-8",
            Encoding::Utf16 => "utf-16",
        };
        json!({
            "capabilities": {
                "positionEncoding": encoding,
                "textDocumentSync": { "openClose": true, "change": 2, "save": true },
                "hoverProvider": true,
                "completionProvider": {},
                "definitionProvider": true,
                "referencesProvider": true,
                "documentHighlightProvider": true,
                "documentSymbolProvider": true,
                "documentFormattingProvider": true,
                "renameProvider": { "prepareProvider": true },
                "codeActionProvider": { "codeActionKinds": ["quickfix"] },
            },
            "serverInfo": { "name": "stochc", "version": env!("CARGO_PKG_VERSION") },
        })
    }

    /// Says that a text has changed: what is known of it and of those that import it is out of date.
    pub(super) fn changed(&mut self, path: &str) {
        let is_concerned = |analysis: &Analysis| {
            let files = analysis.checked.sources.files();
            let missing = analysis
                .checked
                .findings
                .iter()
                .any(|finding| finding.code == stochc_compiler::finding::Code::ImportMissing);
            missing || files.iter().any(|file| file.name == path)
        };
        self.analyses.retain(|_, analysis| !is_concerned(analysis));
        self.analyses.remove(path);
        for path in self.documents.paths() {
            if !self.analyses.contains_key(path) {
                self.unseen.insert(path.clone());
            }
        }
    }

    /// Forgets a program that is closed.
    pub(super) fn closed(&mut self, path: &str) {
        self.unseen.remove(path);
        self.found.remove(path);
        self.changed(path);
        self.show();
    }

    /// What is known of an open program as it is now.
    pub(super) fn analysis(&mut self, path: &str) -> Option<Rc<Analysis>> {
        self.documents.get(path)?;
        if let Some(known) = self.analyses.get(path) {
            return Some(known.clone());
        }
        let analysis = Rc::new(Analysis::of(path, &self.documents, self.encoding));
        self.analyses.insert(path.to_owned(), analysis.clone());
        Some(analysis)
    }

    /// What is known of all open programs as they are now.
    pub(super) fn all_analyses(&mut self) -> Vec<Rc<Analysis>> {
        let paths: Vec<String> = self.documents.paths().cloned().collect();
        paths
            .iter()
            .filter_map(|path| self.analysis(path))
            .collect()
    }

    /// Checks one program that has changed, and shows what is found.
    fn check_one(&mut self) {
        let Some(path) = self.unseen.pop_first() else {
            return;
        };
        let found = catch_unwind(AssertUnwindSafe(|| {
            let analysis = self.analysis(&path)?;
            Some(diagnostics::of(&analysis, &path, &self.documents))
        }));
        if let Ok(Some(found)) = found {
            self.found.insert(path, found);
        }
        self.show();
    }

    /// Tells the client of every file whose diagnostics have changed.
    fn show(&mut self) {
        let mut now: BTreeMap<String, Vec<Diagnostic>> = BTreeMap::new();
        for (path, diagnostics) in self.found.values().flatten() {
            let all = now.entry(path.clone()).or_default();
            for diagnostic in diagnostics {
                // Two programs that import one file find the same in it.
                if !all.contains(diagnostic) {
                    all.push(diagnostic.clone());
                }
            }
        }
        let mut shown = std::mem::take(&mut self.shown);
        let paths: BTreeSet<String> = now.keys().chain(shown.keys()).cloned().collect();
        for path in paths {
            // Of a text that is still to be checked, what is known is out of date.
            if self.unseen.contains(&path) {
                now.remove(&path);
                if let Some(old) = shown.remove(&path) {
                    self.shown.insert(path, old);
                }
                continue;
            }
            let version = self.documents.get(&path).map(|document| document.version);
            let is_known = now.contains_key(&path);
            let new = (version, now.remove(&path).unwrap_or_default());
            if shown.get(&path) != Some(&new) {
                self.publish(&path, &new);
            }
            if is_known {
                self.shown.insert(path, new);
            }
        }
    }

    fn publish(&mut self, path: &str, (version, diagnostics): &(Option<i32>, Vec<Diagnostic>)) {
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

    fn send(&mut self, message: &Value) {
        self.gone |= wire::write(&mut self.output, message).is_err();
    }
}
