//! JSON-RPC messages over a pair of streams.
//!
//! A message that is no JSON is answered and passed over, and a length that nobody can mean is
//! refused before anything is allocated for it: a careless client does no harm.
use std::io::{self, BufRead, Read as _, Write};

use serde_json::{Value, json};

/// Bytes of one message, at most.
const MOST_BYTES: u64 = 1 << 28;

/// Bytes of one line of a message's head, at most.
const MOST_HEAD: u64 = 1 << 12;

/// A message from the client.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
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
    Message(Message),
    /// Bytes that are none, and why.
    Garbage(String),
    /// The stream has ended, or cannot be followed any more.
    End,
}

/// Reads the next message.
pub fn read(input: &mut impl BufRead) -> Incoming {
    let length = match head(input) {
        Ok(Some(length)) => length,
        Ok(None) => return Incoming::End,
        Err(error) if error.kind() == io::ErrorKind::InvalidData => {
            return Incoming::Garbage(error.to_string());
        }
        Err(_) => return Incoming::End,
    };
    let mut body = Vec::new();
    match input.take(length).read_to_end(&mut body) {
        Ok(count) if count as u64 == length => {}
        _ => return Incoming::End,
    }
    match serde_json::from_slice(&body) {
        Ok(Value::Object(mut fields)) => Incoming::Message(Message {
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

/// The length of the message that follows; `None` at the end of the stream.
fn head(input: &mut impl BufRead) -> io::Result<Option<u64>> {
    let invalid = |why: &str| io::Error::new(io::ErrorKind::InvalidData, why);
    let mut length = None;
    loop {
        let mut line = Vec::new();
        input.take(MOST_HEAD).read_until(b'\n', &mut line)?;
        if line.is_empty() {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim_end();
        if line.is_empty() {
            return match length {
                Some(length) if length <= MOST_BYTES => Ok(Some(length)),
                Some(_) => Err(invalid("a message of more than 256 MiB")),
                None => Err(invalid("a message without its `Content-Length`")),
            };
        }
        if let Some((name, value)) = line.split_once(':')
            && name.eq_ignore_ascii_case("content-length")
        {
            length = Some(value.trim().parse().map_err(|_| invalid("not a length"))?);
        }
    }
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
}

/// Why a request cannot be answered.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// What kind of reason.
    pub reason: Reason,
    /// The reason, for people.
    pub message: String,
}

impl Failure {
    /// A reason of a kind.
    pub fn new(reason: Reason, message: impl Into<String>) -> Failure {
        Failure {
            reason,
            message: message.into(),
        }
    }

    /// What was wanted makes sense, but cannot be done here.
    pub fn refusal(message: impl Into<String>) -> Failure {
        Failure::new(Reason::RequestFailed, message)
    }
}

/// An answer.
pub fn answer(id: &Value, result: Result<Value, Failure>) -> Value {
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

    #[test]
    fn what_is_no_message_is_passed_over() {
        let text = [
            framed("{\"method\":\"a\"}"),
            framed("{\"method\":"),
            framed("[1]"),
            framed("\u{b5}"),
            "content-length: 2 \nContent-Type: x\n\n{}".to_owned(),
            "Content-Length: 99999999999\r\n\r\n".to_owned(),
            "Content-Length: -1\r\n\r\n".to_owned(),
            framed("{\"method\":\"b\"}"),
        ];
        let seen = all(&text.concat());
        assert_eq!(seen.first().map(String::as_str), Some("a"));
        assert_eq!(seen.last().map(String::as_str), Some("b"));
        let garbage = seen.iter().filter(|seen| seen.starts_with("garbage"));
        // The blank line behind a length that is none is a second one.
        assert_eq!(garbage.count(), 6);
        assert_eq!(all("Content-Length: 20\r\n\r\n{}"), [""; 0]);
    }

    #[test]
    fn what_is_written_can_be_read() {
        let mut bytes = Vec::new();
        let message = json!({ "id": 3, "method": "m\u{b5}", "params": [1] });
        write(&mut bytes, &message).unwrap();
        let Incoming::Message(read) = read(&mut bytes.as_slice()) else {
            panic!();
        };
        assert_eq!((read.id, read.method.as_str()), (Some(json!(3)), "m\u{b5}"));
    }
}
