//! The language server: what editors ask about programs while they are written.
//!
//! One thread reads messages (`wire`), one answers them (`server`); each feature is a module
//! of pure functions over an `analysis` of what the editor has, saved or not (`documents`).
//! A change is checked once nothing more has come in for a moment.
mod actions;
mod analysis;
mod definition;
mod diagnostics;
mod documents;
mod formatting;
mod hover;
mod position;
mod rename;
mod requests;
mod scene;
mod server;
mod symbols;
mod uri;
mod wire;

use std::io::{BufReader, Write};
use std::sync::mpsc;

use wire::Incoming;

/// Messages that wait to be answered, at most; then the client has to.
const MOST_WAITING: usize = 256;

/// Serves a client over a pair of streams until it says goodbye; whether it did so properly.
pub fn serve(input: impl std::io::Read + Send + 'static, output: impl Write) -> bool {
    let (sender, receiver) = mpsc::sync_channel(MOST_WAITING);
    // It ends with the stream, or with the process.
    std::thread::spawn(move || {
        let mut messages = wire::Messages::of(BufReader::new(input));
        loop {
            let incoming = messages.read();
            let is_end = matches!(incoming, Incoming::End);
            if sender.send(incoming).is_err() || is_end {
                break;
            }
        }
    });
    server::Server::new(output).run(&receiver)
}
