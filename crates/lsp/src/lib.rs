//! The language server for editors.
//!
//! One thread reads messages (`wire`). Another one answers them (`server`) and does no long work.
//! Background jobs (`jobs`) check programs (`programs`) and compute responses (`requests`), each on
//! a thread that can be cancelled. Each feature is a module of pure functions over an `analysis` of
//! the editor's texts, saved or not (`documents`). A change is checked after a short pause in the
//! input, or when a request needs it.
//!
//! ```
//! # fn main() -> std::io::Result<()> {
//! let message = r#"{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"capabilities":{}}}"#;
//! let input = format!("Content-Length: {}\r\n\r\n{message}", message.len());
//! let mut output = Vec::new();
//! // The client disconnects without `shutdown`.
//! assert!(!stochc_lsp::serve(std::io::Cursor::new(input), &mut output)?);
//! assert!(String::from_utf8_lossy(&output).contains("hoverProvider"));
//! # Ok(())
//! # }
//! ```
mod client_process;
mod event;
mod features;
mod jobs;
mod requests;
mod server;
mod wire;
mod workspace;

use std::io::{BufReader, Write};
use std::sync::mpsc;

use event::ServerEvent;
use wire::Incoming;

/// Largest number of queued messages. If the queue is full, the client must wait.
const MAX_WAITING: usize = 256;

/// Serves a client over a pair of streams until the client exits. Returns whether the client sent a
/// shutdown request before it exited.
///
/// # Errors
///
/// If the system has no thread left.
pub fn serve(
    input: impl std::io::Read + Send + 'static,
    output: impl Write,
) -> std::io::Result<bool> {
    let (sender, receiver) = mpsc::sync_channel(MAX_WAITING);
    let events = sender.clone();
    // The thread ends with the stream or the process.
    let reader = std::thread::Builder::new();
    reader.spawn(move || {
        let mut input = BufReader::new(input);
        loop {
            let incoming = wire::read(&mut input);
            let is_end = matches!(incoming, Incoming::End);
            if sender.send(ServerEvent::Incoming(incoming)).is_err() || is_end {
                break;
            }
        }
    })?;
    Ok(server::Server::new(output, events).run(receiver))
}
