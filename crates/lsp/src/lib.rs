//! The language server: what editors ask about programs while they are written.
//!
//! One thread reads messages (`wire`), one answers them (`server`) and does nothing that takes long. Programs are
//! checked (`programs`) and requests worked out (`requests`) beside it (`jobs`), each on a thread that can be
//! cancelled. Each feature is a module of pure functions over an `analysis` of what the editor has, saved or
//! not (`documents`). A change is checked once nothing more has come in for a moment, or somebody asks.
//!
//! ```
//! # fn main() -> std::io::Result<()> {
//! let message = r#"{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"capabilities":{}}}"#;
//! let input = format!("Content-Length: {}\r\n\r\n{message}", message.len());
//! let mut output = Vec::new();
//! // The client goes without a goodbye.
//! assert!(!stochc_lsp::serve(std::io::Cursor::new(input), &mut output)?);
//! assert!(String::from_utf8_lossy(&output).contains("hoverProvider"));
//! # Ok(())
//! # }
//! ```
mod actions;
mod analysis;
mod client_process;
mod definition;
mod diagnostics;
mod documents;
mod event;
mod formatting;
mod hover;
mod jobs;
mod position;
mod programs;
mod reads;
mod rename;
mod requests;
mod scene;
mod server;
mod symbols;
mod uri;
mod wire;

use std::io::{BufReader, Write};
use std::sync::mpsc;

use event::ServerEvent;
use wire::Incoming;

/// Messages that wait for their turn, at most; then the client has to.
const MAX_WAITING: usize = 256;

/// Serves a client over a pair of streams until it says goodbye; whether it did so properly.
///
/// # Errors
/// Where the system has no thread more.
pub fn serve(
    input: impl std::io::Read + Send + 'static,
    output: impl Write,
) -> std::io::Result<bool> {
    let (sender, receiver) = mpsc::sync_channel(MAX_WAITING);
    let events = sender.clone();
    // It ends with the stream, or with the process.
    let reader = std::thread::Builder::new();
    reader.spawn(move || {
        let mut messages = wire::MessageStream::new(BufReader::new(input));
        loop {
            let incoming = messages.read();
            let is_end = matches!(incoming, Incoming::End);
            if sender.send(ServerEvent::Incoming(incoming)).is_err() || is_end {
                break;
            }
        }
    })?;
    Ok(server::Server::new(output, events).run(receiver))
}
