//! Test client that uses the language server protocol directly.
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::{Value, json};

/// Running server, with the messages that it sent.
pub struct Client {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    next: i64,
    /// Notifications of the server that no test has read yet.
    notifications: Vec<Value>,
}

impl Client {
    /// Starts a server without sending a message.
    pub fn start() -> Client {
        let mut child = Command::new(env!("CARGO_BIN_EXE_stochc"))
            .args(["lsp", "--stdio"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        Client {
            input: child.stdin.take(),
            output: BufReader::new(child.stdout.take().unwrap()),
            child,
            next: 0,
            notifications: Vec::new(),
        }
    }

    /// Starts and initializes a server for a client with these position encodings.
    pub fn new(encodings: &[&str]) -> Client {
        Client::with(json!({ "general": { "positionEncodings": encodings } }))
    }

    /// Starts and initializes a server for a client with these capabilities.
    pub fn with(capabilities: Value) -> Client {
        let mut client = Client::start();
        let answer = client.ask("initialize", json!({ "capabilities": capabilities }));
        assert_eq!(answer["result"]["serverInfo"]["name"], "stochc");
        client.notify("initialized", json!({}));
        client
    }

    /// Opens a document.
    pub fn open(&mut self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "languageId": "stochc", "version": 1, "text": text });
        self.notify("textDocument/didOpen", json!({ "textDocument": document }));
    }

    /// Sends a notification.
    pub fn notify(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// Sends a request. Returns its answer.
    pub fn ask(&mut self, method: &str, params: Value) -> Value {
        let id = self.request(method, params);
        self.answer(&json!(id))
    }

    /// Sends a request. Returns its number without waiting for the answer.
    pub fn request(&mut self, method: &str, params: Value) -> i64 {
        self.next += 1;
        let id = self.next;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        id
    }

    /// Waits for the answer to a request, and returns it.
    pub fn answer(&mut self, id: &Value) -> Value {
        loop {
            let message = self.receive().expect("an answer");
            if message.get("method").is_some() {
                self.notifications.push(message);
            } else if message["id"] == *id {
                return message;
            }
        }
    }

    /// Returns the next answers to any requests, in order of arrival.
    pub fn answers(&mut self, count: usize) -> Vec<Value> {
        let mut answers = Vec::new();
        while answers.len() < count {
            let message = self.receive().expect("an answer");
            match message.get("method") {
                Some(_) => self.notifications.push(message),
                None => answers.push(message),
            }
        }
        answers
    }

    /// Returns the requests that the server has sent so far.
    pub fn requests_of_server(&self) -> Vec<&Value> {
        let notifications = self.notifications.iter();
        notifications.filter(|it| it.get("id").is_some()).collect()
    }

    /// Waits for a request of the server, and returns its method.
    pub fn request_of_server(&mut self) -> String {
        let is_request = |it: &Value| it.get("id").is_some() && it.get("method").is_some();
        while !self.notifications.iter().any(is_request) {
            let message = self.receive().expect("a request");
            self.notifications.push(message);
        }
        let at = self.notifications.iter().position(is_request).unwrap();
        self.notifications.remove(at)["method"]
            .as_str()
            .unwrap()
            .to_owned()
    }

    /// Returns the versions of a document that the server has sent diagnostics for.
    pub fn diagnosed(&self, uri: &str) -> Vec<i64> {
        let diagnosed = self.notifications.iter().map(|it| &it["params"]);
        (diagnosed.filter(|it| it["uri"] == uri))
            .map(|it| it["version"].as_i64().unwrap())
            .collect()
    }

    /// Waits for the next diagnostics of a document, and returns them.
    pub fn diagnostics(&mut self, uri: &str) -> Vec<Value> {
        let is_it = |message: &Value| {
            message["method"] == "textDocument/publishDiagnostics"
                && message["params"]["uri"] == uri
        };
        loop {
            if let Some(at) = self.notifications.iter().position(is_it) {
                let message = self.notifications.remove(at);
                return message["params"]["diagnostics"].as_array().unwrap().clone();
            }
            let message = self.receive().expect("diagnostics");
            self.notifications.push(message);
        }
    }

    /// Sends bytes that need not be a message.
    pub fn send_raw(&mut self, bytes: &[u8]) {
        let input = self.input.as_mut().unwrap();
        input.write_all(bytes).unwrap();
        input.flush().unwrap();
    }

    fn send(&mut self, message: &Value) {
        let body = message.to_string();
        self.send_raw(format!("Content-Length: {}\r\n\r\n{body}", body.len()).as_bytes());
    }

    /// Waits for the next message. Returns `None` at the end of the stream.
    fn receive(&mut self) -> Option<Value> {
        let mut length = 0;
        loop {
            let mut line = String::new();
            if self.output.read_line(&mut line).unwrap() == 0 {
                return None;
            }
            match line.trim_end() {
                "" => break,
                line => {
                    let (_, value) = line.split_once(": ").unwrap();
                    length = value.parse().unwrap();
                }
            }
        }
        let mut body = vec![0; length];
        self.output.read_exact(&mut body).unwrap();
        Some(serde_json::from_slice(&body).unwrap())
    }

    /// Shuts the server down as the protocol requires. Returns its exit status.
    pub fn leave(mut self) -> i32 {
        assert_eq!(self.ask("shutdown", Value::Null)["result"], Value::Null);
        self.notify("exit", Value::Null);
        self.ended()
    }

    /// Waits until the server ends by itself. Returns its exit status.
    pub fn ended(&mut self) -> i32 {
        self.child.wait().unwrap().code().unwrap()
    }

    /// Closes the connection without a shutdown. Returns the exit status of the server.
    pub fn hang_up(mut self) -> i32 {
        self.input = None;
        self.ended()
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Returns the parameters of a request at the start of the nth occurrence of `words`.
pub fn place(uri: &str, text: &str, words: &str, nth: usize) -> Value {
    let (at, _) = text.match_indices(words).nth(nth).unwrap();
    let before = &text[..at];
    let line = before.matches('\n').count();
    let column = before.rsplit('\n').next().unwrap().encode_utf16().count();
    json!({
        "textDocument": { "uri": uri },
        "position": { "line": line, "character": column },
    })
}

/// Returns a range as text, such as `1:2-1:5`.
pub fn shown(range: &Value) -> String {
    let end = |end: &str| format!("{}:{}", range[end]["line"], range[end]["character"]);
    format!("{}-{}", end("start"), end("end"))
}

/// Returns the byte offset of the start of a line. Lines end with `\n`, `\r\n` or `\r`.
fn line_start(text: &str, line: usize) -> usize {
    let bytes = text.as_bytes();
    let ends = (0..bytes.len())
        .filter(|&i| bytes[i] == b'\n' || (bytes[i] == b'\r' && bytes.get(i + 1) != Some(&b'\n')));
    let mut starts = std::iter::once(0).chain(ends.map(|end| end + 1));
    starts.nth(line).unwrap_or(bytes.len())
}

/// Returns a text after edits. Positions count UTF-16 units.
pub fn edited(text: &str, edits: &Value) -> String {
    let offset = |position: &Value| {
        let (line, character) = (
            position["line"].as_u64().unwrap() as usize,
            position["character"].as_u64().unwrap() as usize,
        );
        let start = line_start(text, line);
        let mut units = 0;
        let within = text[start..].char_indices().find(|(_, c)| {
            let here = units == character;
            units += c.len_utf16();
            here
        });
        within.map_or(text.len(), |(i, _)| start + i)
    };
    let mut spans: Vec<(usize, usize, &str)> = edits
        .as_array()
        .unwrap()
        .iter()
        .map(|edit| {
            let range = &edit["range"];
            let new = edit["newText"].as_str().unwrap();
            (offset(&range["start"]), offset(&range["end"]), new)
        })
        .collect();
    spans.sort_unstable();
    let mut out = text.to_owned();
    for (start, end, new) in spans.into_iter().rev() {
        out.replace_range(start..end, new);
    }
    out
}
