//! JSON-RPC messages over a pair of streams.
//!
//! A message that is no JSON is answered and passed over, and a length that nobody can mean is
//! refused before anything is allocated for it: a careless client does no harm.
use std::io::{self, BufRead, Read as _, Write};

use serde_json::{Value, json};
use stochc_compiler::Cancelled;

/// Bytes of one message, at most.
const MAX_BYTES: u64 = 1 << 28;

/// Bytes of one line of a message's head, at most.
const MAX_HEAD: u64 = 1 << 12;

/// A message from the client.
#[derive(Clone, Debug, PartialEq)]
pub struct ClientMessage {
    /// What its answer refers to; a message without it wants none.
    pub id: Option<Value>,
    /// What is wanted; empty: an answer of the client's.
    pub method: String,
    /// With what.
    pub params: Value,
}

/// What came in.
#[derive(Debug)]
pub enum Incoming {
    /// A message.
    Message(ClientMessage),
    /// Bytes that are none, and why.
    Garbage(String),
    /// The stream has ended, or cannot be followed any more.
    End,
}

/// The messages of a stream.
#[derive(Debug)]
pub struct MessageStream<R> {
    input: R,
    /// The last message could not be followed, so that what comes next may be the rest of it.
    lost: bool,
}

impl<R: BufRead> MessageStream<R> {
    /// Those that come in from now on.
    pub fn new(input: R) -> MessageStream<R> {
        MessageStream { input, lost: false }
    }

    /// Waits for the next one.
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

    /// The next message, or why it cannot be read.
    ///
    /// # Errors
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

    /// The length of the message that follows.
    fn head(&mut self) -> io::Result<Result<u64, &'static str>> {
        let mut lengths = Vec::new();
        loop {
            let line = self.line()?;
            let line = String::from_utf8_lossy(&line);
            let line = line.trim_end();
            match content_length(line, self.lost) {
                Some(length) => {
                    // What comes before it may still be the rest of the message that was lost.
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
                "a `Content-Length` that is no number of bytes"
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

    /// The next line with its end, or the last [`MAX_HEAD`] bytes of a longer one.
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

/// What a line of a head says of the length; `None`: nothing.
///
/// A message that could not be followed has no end of its own: behind `lost` ones the next head may
/// begin in the middle of a line. Within JSON it cannot, because no text in it has an end of a line.
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
/// Those of the stream, such as a client that has gone.
pub fn write(output: &mut impl Write, message: &Value) -> io::Result<()> {
    let body = message.to_string();
    write!(output, "Content-Length: {}\r\n\r\n{body}", body.len())?;
    output.flush()
}

/// What kind of reason there is for not answering, with the protocol's number.
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

/// Why a request cannot be answered.
#[derive(Clone, Debug, PartialEq)]
pub struct RequestFailure {
    /// What kind of reason.
    pub reason: Reason,
    /// The reason, for people.
    pub message: String,
}

impl RequestFailure {
    /// A reason of a kind.
    pub fn new(reason: Reason, message: impl Into<String>) -> RequestFailure {
        RequestFailure {
            reason,
            message: message.into(),
        }
    }

    /// The client does not want the answer any more.
    pub fn cancelled() -> RequestFailure {
        RequestFailure::new(Reason::RequestCancelled, "cancelled")
    }

    /// What was wanted makes sense, but cannot be done here.
    pub fn request_failed(message: impl Into<String>) -> RequestFailure {
        RequestFailure::new(Reason::RequestFailed, message)
    }
}

impl From<Cancelled> for RequestFailure {
    fn from(_: Cancelled) -> RequestFailure {
        RequestFailure::cancelled()
    }
}

/// An answer.
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
            // Without its end a message is no JSON; what is too long takes the next one with it.
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
