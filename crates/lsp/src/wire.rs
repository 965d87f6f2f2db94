//! JSON-RPC messages over a pair of streams.
//!
//! Messages that are not valid JSON are answered with an error and skipped. Unreasonable lengths
//! are rejected before allocation. A faulty client does no harm.
use std::io::{self, BufRead, Read as _, Write};

use serde_json::{Value, json};
use stochc_compiler::Cancelled;

/// Largest message \[bytes\].
const MAX_BYTES: u64 = 1 << 28;

/// Largest header line \[bytes\].
const MAX_HEAD: u64 = 1 << 12;

/// Message from the client.
#[derive(Clone, Debug, PartialEq)]
pub struct ClientMessage {
    /// Number for the response. Messages without one need no response.
    pub id: Option<Value>,
    /// Method. Empty for a response of the client.
    pub method: String,
    /// Parameters.
    pub params: Value,
}

/// Input.
#[derive(Debug)]
pub enum Incoming {
    /// A message.
    Message(ClientMessage),
    /// Invalid input, with the reason.
    Garbage(String),
    /// The stream has ended or cannot be parsed further.
    End,
}

/// Messages of a stream.
#[derive(Debug)]
pub struct MessageStream<R> {
    input: R,
    /// Whether the last message was invalid, so that its rest may follow.
    lost: bool,
}

impl<R: BufRead> MessageStream<R> {
    /// Wraps a stream.
    pub fn new(input: R) -> MessageStream<R> {
        MessageStream { input, lost: false }
    }

    /// Waits for the next message.
    pub fn read(&mut self) -> Incoming {
        let body = match self.body() {
            Ok(Ok(body)) => body,
            Ok(Err(why)) => {
                self.lost = true;
                return Incoming::Garbage(why.to_owned());
            }
            Err(_) => return Incoming::End,
        };
        let message = serde_json::from_slice(&body);
        self.lost = message.is_err();
        match message {
            Ok(Value::Object(mut fields)) => Incoming::Message(ClientMessage {
                id: fields.remove("id").filter(|id| !id.is_null()),
                method: match fields.remove("method") {
                    Some(Value::String(method)) => method,
                    _ => String::new(),
                },
                params: fields.remove("params").unwrap_or_default(),
            }),
            Ok(_) => Incoming::Garbage("a message is a JSON object".to_owned()),
            Err(error) => Incoming::Garbage(error.to_string()),
        }
    }

    /// Returns the next message, or the reason why it is invalid.
    ///
    /// # Errors
    ///
    /// At the end of the stream.
    fn body(&mut self) -> io::Result<Result<Vec<u8>, &'static str>> {
        let length = match self.head()? {
            Ok(length) => length,
            Err(why) => return Ok(Err(why)),
        };
        let mut body = Vec::new();
        let count = self.input.by_ref().take(length).read_to_end(&mut body)?;
        if count as u64 == length {
            Ok(Ok(body))
        } else {
            Err(io::ErrorKind::UnexpectedEof.into())
        }
    }

    /// Returns the length of the next message.
    fn head(&mut self) -> io::Result<Result<u64, &'static str>> {
        let mut lengths = Vec::new();
        loop {
            let line = self.line()?;
            let line = String::from_utf8_lossy(&line);
            let line = line.trim_end();
            match content_length(line, self.lost) {
                Some(length) => {
                    // Earlier lines may belong to the invalid message.
                    if self.lost {
                        lengths.clear();
                    }
                    lengths.push(length);
                }
                None if !line.is_empty() => {}
                None if self.lost && lengths.is_empty() => {}
                None => break,
            }
        }
        let Some(Ok(length)) = lengths.first() else {
            return Ok(Err(if lengths.is_empty() {
                "a message without its `Content-Length`"
            } else {
                "a `Content-Length` that is not a number of bytes"
            }));
        };
        Ok(if lengths.iter().any(|other| other != &Ok(*length)) {
            Err("a message with two lengths")
        } else if *length > MAX_BYTES {
            Err("a message of more than 256 MiB")
        } else {
            Ok(*length)
        })
    }

    /// Returns the next line with its end, or the last [`MAX_HEAD`] bytes of a longer one.
    fn line(&mut self) -> io::Result<Vec<u8>> {
        let mut line = Vec::new();
        loop {
            let mut part = self.input.by_ref().take(MAX_HEAD);
            if part.read_until(b'\n', &mut line)? == 0 {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            if line.last() == Some(&b'\n') {
                return Ok(line);
            }
            line.drain(..line.len().saturating_sub(MAX_HEAD as usize));
        }
    }
}

/// Returns the length in a header line, or `None` if it has none.
///
/// After a `lost` message, the next header may begin in the middle of a line, since messages have
/// no end mark. It cannot be within JSON, because JSON strings contain no line ends.
fn content_length(line: &str, lost: bool) -> Option<Result<u64, ()>> {
    const NAME: &str = "content-length";
    let (before, value) = line.rsplit_once(':')?;
    let value = value.trim();
    let length = if value.bytes().all(|byte| byte.is_ascii_digit()) {
        value.parse().map_err(|_| ())
    } else {
        Err(())
    };
    let name = before.trim_end().to_ascii_lowercase();
    let is_whole = name == NAME || line.to_ascii_lowercase().starts_with("content-length:");
    (is_whole || lost && length.is_ok() && name.ends_with(NAME)).then_some(length)
}

/// Writes a message.
///
/// # Errors
///
/// Errors of the stream, such as a disconnected client.
pub fn write(output: &mut impl Write, message: &Value) -> io::Result<()> {
    let body = message.to_string();
    write!(output, "Content-Length: {}\r\n\r\n{body}", body.len())?;
    output.flush()
}

/// Error code of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    ParseError = -32700,
    InvalidRequest = -32600,
    MethodNotFound = -32601,
    InvalidParams = -32602,
    InternalError = -32603,
    ServerNotInitialized = -32002,
    RequestFailed = -32803,
    RequestCancelled = -32800,
    ContentModified = -32801,
}

/// Error response to a request.
#[derive(Clone, Debug, PartialEq)]
pub struct RequestFailure {
    /// Error code.
    pub reason: Reason,
    /// Message for users.
    pub message: String,
}

impl RequestFailure {
    /// Returns an error.
    pub fn new(reason: Reason, message: impl Into<String>) -> RequestFailure {
        RequestFailure {
            reason,
            message: message.into(),
        }
    }

    /// Returns the error for a request cancelled by the client.
    pub fn cancelled() -> RequestFailure {
        RequestFailure::new(Reason::RequestCancelled, "cancelled")
    }

    /// Returns the error for a valid request that cannot be fulfilled.
    pub fn request_failed(message: impl Into<String>) -> RequestFailure {
        RequestFailure::new(Reason::RequestFailed, message)
    }
}

impl From<Cancelled> for RequestFailure {
    fn from(_: Cancelled) -> RequestFailure {
        RequestFailure::cancelled()
    }
}

/// Returns a response.
pub fn answer(id: &Value, result: Result<Value, RequestFailure>) -> Value {
    match result {
        Ok(result) => json!({ "jsonrpc": "2.0", "id": id, "result": result }),
        Err(failure) => {
            let error = json!({ "code": failure.reason as i32, "message": failure.message });
            json!({ "jsonrpc": "2.0", "id": id, "error": error })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<String> {
        let mut messages = MessageStream::new(text.as_bytes());
        let mut seen = Vec::new();
        loop {
            seen.push(match messages.read() {
                Incoming::Message(message) => message.method,
                Incoming::Garbage(why) => format!("garbage: {why}"),
                Incoming::End => return seen,
            });
        }
    }

    fn framed(body: &str) -> String {
        format!("Content-Length: {}\r\n\r\n{body}", body.len())
    }

    #[test]
    fn what_is_no_message_is_passed_over() {
        for (bytes, why) in [
            (framed("{\"method\":"), "EOF"),
            (framed("[1]"), "JSON object"),
            (framed("\u{b5}"), "expected value"),
            (framed(""), "EOF"),
        ] {
            let seen = all(&[framed(A), bytes, framed(B)].concat());
            assert_eq!((seen[0].as_str(), seen[2].as_str()), ("a", "b"));
            assert!(seen.len() == 3 && seen[1].contains(why), "{seen:?}");
        }
        assert_eq!(all("content-length: 2 \nContent-Type: x\n\n{}"), [""]);
        assert_eq!(all("Content-Length: 20\r\n\r\n{}"), [""; 0]);
    }

    const A: &str = "{\"method\":\"a\"}";
    const B: &str = "{\"method\":\"b\"}";

    #[test]
    fn a_head_that_cannot_be_read_costs_one_message() {
        let long = format!("{{\"text\": \"{}\"}}", "Content-Length: 5 ".repeat(2000));
        for head in [
            "Content-Length: abc",
            "Content-Length:",
            "Content-Length: 1e1",
            "Content-Length: 10 bytes",
            "Content-Length 10",
            "Content-Length: -10",
            "Content-Length: 99999999999",
            "Content-Length: 99999999999999999999999999",
            "Content-Length: 1\r\nContent-Length: 2",
            "Content-Length: 1\r\nContent-Length: x",
            "Content-Type: x",
            "\u{b5}",
        ] {
            for body in ["", A, "{\n\n  \"a\": 1\n}", &long, "Content-Length: \r\n"] {
                let text = [&framed(A), head, "\r\n\r\n", body, &framed(B), &framed(A)].concat();
                let seen = all(&text);
                let (garbage, told): (Vec<_>, Vec<_>) =
                    seen.iter().partition(|seen| seen.starts_with("garbage"));
                assert_eq!(told, ["a", "b", "a"], "{head}: {seen:?}");
                assert!(seen[1].starts_with("garbage"), "{head}: {seen:?}");
                assert_eq!(garbage.len(), 1, "{head}: {seen:?}");
            }
        }
    }

    #[test]
    fn a_length_that_is_wrong_costs_what_it_cuts() {
        for length in [A.len() - 9, A.len() - 1, A.len() + 1, A.len() + 9] {
            let cut = format!("Content-Length: {length}\r\n\r\n{A}");
            let seen = all(&[cut, framed(B), framed(A)].concat());
            assert_eq!(seen.last().map(String::as_str), Some("a"), "{seen:?}");
            // A truncated message is invalid JSON; one that is too long includes the next message.
            let whole = seen.iter().filter(|seen| *seen == "b").count();
            assert_eq!(whole, usize::from(length < A.len()), "{seen:?}");
        }
    }

    #[test]
    fn what_is_written_can_be_read() {
        let mut bytes = Vec::new();
        let message = json!({ "id": 3, "method": "m\u{b5}", "params": [1] });
        write(&mut bytes, &message).unwrap();
        let Incoming::Message(read) = MessageStream::new(bytes.as_slice()).read() else {
            panic!();
        };
        assert_eq!((read.id, read.method.as_str()), (Some(json!(3)), "m\u{b5}"));
    }
}
