//! JSON-RPC messages over a pair of streams.
//!
//! A message that is not valid JSON is answered and skipped. Lengths are limited.
use std::io::{self, BufRead, Read as _, Write};

use serde_json::{Value, json};
use stochc_compiler::Cancelled;

/// Largest message \[bytes\].
const MAX_BYTES: u64 = 1 << 28;

/// Largest header line \[bytes\].
const MAX_HEAD: u64 = 1 << 12;

#[derive(Clone, Debug, PartialEq)]
pub struct ClientMessage {
    /// Number for the response. Messages without a number need no response.
    pub id: Option<Value>,
    /// Method of the message. Empty for a response of the client.
    pub method: String,
    /// Parameters of the request or notification.
    pub params: Value,
}

/// Incoming message of a client, or the end of the input.
#[derive(Debug)]
pub enum Incoming {
    Message(ClientMessage),
    /// Invalid input, with the reason.
    Garbage(String),
    /// The stream has ended or cannot be parsed further.
    End,
}

/// Reads the next message of a stream. A message without a valid length ends the stream.
pub fn read(input: &mut impl BufRead) -> Incoming {
    let Ok(body) = body(input) else {
        return Incoming::End;
    };
    match serde_json::from_slice(&body) {
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

fn body(input: &mut impl BufRead) -> io::Result<Vec<u8>> {
    let mut length = None;
    loop {
        let mut line = String::new();
        input.by_ref().take(MAX_HEAD).read_line(&mut line)?;
        let field = line.trim_end();
        if line.is_empty() {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        if field.is_empty() {
            break;
        }
        if let Some((name, value)) = field.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = value.trim().parse().ok();
        }
    }
    let length = length.filter(|length| *length <= MAX_BYTES);
    let length: u64 = length.ok_or(io::ErrorKind::InvalidData)?;
    let mut body = Vec::new();
    if input.by_ref().take(length).read_to_end(&mut body)? as u64 == length {
        Ok(body)
    } else {
        Err(io::ErrorKind::UnexpectedEof.into())
    }
}

/// Writes a message.
///
/// # Errors
///
/// Errors of the stream, such as a disconnected client.
pub fn write(output: &mut impl Write, body: &str) -> io::Result<()> {
    write!(output, "Content-Length: {}\r\n\r\n{body}", body.len())?;
    output.flush()
}

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
    pub reason: Reason,
    /// Message for users.
    pub message: String,
}

impl RequestFailure {
    pub fn new(reason: Reason, message: impl Into<String>) -> RequestFailure {
        RequestFailure {
            reason,
            message: message.into(),
        }
    }

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

/// Returns a response. Its result is JSON.
pub fn answer(id: &Value, result: Result<String, RequestFailure>) -> String {
    match result {
        Ok(result) => format!(r#"{{"jsonrpc":"2.0","id":{id},"result":{result}}}"#),
        Err(failure) => {
            let error = json!({ "code": failure.reason as i32, "message": failure.message });
            json!({ "jsonrpc": "2.0", "id": id, "error": error }).to_string()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<String> {
        let mut input = text.as_bytes();
        let mut seen = Vec::new();
        loop {
            seen.push(match read(&mut input) {
                Incoming::Message(message) => message.method,
                Incoming::Garbage(why) => format!("garbage: {why}"),
                Incoming::End => return seen,
            });
        }
    }

    fn framed(body: &str) -> String {
        format!("Content-Length: {}\r\n\r\n{body}", body.len())
    }

    const A: &str = "{\"method\":\"a\"}";
    const B: &str = "{\"method\":\"b\"}";

    #[test]
    fn a_message_without_valid_json_is_skipped() {
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
    }

    #[test]
    fn a_message_without_a_valid_length_ends_the_stream() {
        for length in [
            "abc",
            "",
            "-10",
            "99999999999",
            "99999999999999999999999999",
        ] {
            let text = format!("{}Content-Length: {length}\r\n\r\n{}", framed(A), framed(B));
            assert_eq!(all(&text), ["a"], "{length}");
        }
        assert_eq!(all("Content-Length: 20\r\n\r\n{}"), [""; 0]);
    }
}
