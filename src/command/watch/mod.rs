//! `simulate --watch`: a page on this machine that shows the ensemble while it runs.
//!
//! [`server`] answers requests, [`access`] says which, [`request`] reads them within bounds, and [`events`] is what goes to the pages: of
//! everything only the latest, so that whoever reads slowly misses some of it and holds up nobody.
mod access;
mod events;
mod request;
mod server;

use std::net::{Ipv4Addr, Ipv6Addr, TcpListener};
use std::sync::atomic::AtomicUsize;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use serde_json::json;
use stochc_ensemble::clock::now;
use stochc_ensemble::{Manifest, Progress};
use stochc_report::watch;

use super::terminal::warn;
use crate::exit::Failure;
use crate::viewer::{NO_THREAD, Viewer};
use access::Access;
use events::EventBroadcast;
use server::ServerState;

/// Between two looks at the ensemble, at least.
const BEAT: Duration = Duration::from_millis(250);
/// The share of the time that looking may take: one in so many.
const SHARE: u32 = 20;

/// A server that has a port, and serves while an ensemble runs.
#[derive(Debug)]
pub struct Watching {
    listener: TcpListener,
    access: Access,
}

impl Watching {
    /// Takes a port of the loopback interface; 0: any that is free.
    ///
    /// # Errors
    /// If it cannot be had.
    pub fn at(port: u16) -> Result<Watching, Failure> {
        let cannot =
            |error| Failure::usage(format!("--watch: cannot serve at port {port}: {error}"));
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
            .or_else(|error| match error.kind() {
                // There are machines without IPv4.
                std::io::ErrorKind::AddrNotAvailable => {
                    TcpListener::bind((Ipv6Addr::LOCALHOST, port))
                }
                _ => Err(error),
            })
            .map_err(cannot)?;
        listener.set_nonblocking(true).map_err(cannot)?;
        let address = listener.local_addr().map_err(cannot)?;
        let access = Access::new(address)
            .map_err(|error| Failure::usage(format!("--watch: no random numbers: {error}")))?;
        Ok(Watching { listener, access })
    }
}

impl Viewer for Watching {
    fn begin(&self) {
        warn(&format!("watch at {}\n", self.access.link()));
    }

    fn attend(&self, manifest: &Manifest, progress: &Progress, ended: &Receiver<()>) {
        let events = EventBroadcast::default();
        let state = ServerState {
            manifest,
            page: watch::page(manifest),
            access: &self.access,
            events: &events,
            connections: AtomicUsize::new(0),
        };
        std::thread::scope(|scope| {
            let (listener, state) = (&self.listener, &state);
            let accept = move || server::accept(listener, state, scope);
            if std::thread::Builder::new()
                .spawn_scoped(scope, accept)
                .is_err()
            {
                warn(NO_THREAD);
                return;
            }
            // Also at a panic: the others wait for it.
            let _closing = events.closing();
            publish(manifest, progress, &events, ended);
        });
    }
}

/// Has events tell of an ensemble until it has ended; nothing is made while nobody listens.
fn publish(
    manifest: &Manifest,
    progress: &Progress,
    events: &EventBroadcast,
    ended: &Receiver<()>,
) {
    let start = now();
    let mut drawn = None;
    let mut pause = BEAT;
    while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(pause) {
        pause = BEAT;
        // What was given while nobody listened is old.
        let viewed = progress.take_view();
        if !events.has_listeners() {
            drawn = None;
            continue;
        }
        let begun = now();
        let mut cost = Duration::ZERO;
        if let Some(viewed) = viewed {
            cost += viewed.took;
            if let Some(frame) = watch::frame(manifest, &viewed) {
                events.publish("frame", &frame);
            }
        }
        publish_numbers(manifest, progress, events, start, &mut drawn);
        progress.ask_view(|program| watch::not_shown(manifest, program).is_none());
        cost += begun.elapsed();
        pause = BEAT.max(cost * SHARE);
    }
    if events.has_listeners() {
        publish_numbers(manifest, progress, events, start, &mut None);
    }
    let snapshot = progress.snapshot();
    let complete = snapshot.done == snapshot.total;
    events.publish("end", &json!({ "complete": complete }));
}

/// Publishes the numbers, and the curves where they have changed since they were `drawn`, of so many runs and when.
fn publish_numbers(
    manifest: &Manifest,
    progress: &Progress,
    events: &EventBroadcast,
    start: Instant,
    drawn: &mut Option<(u64, Instant)>,
) {
    /// Runs under way go on all the time; that is seen as often as this.
    const AGAIN: Duration = Duration::from_secs(2);
    let snapshot = progress.snapshot();
    let numbers = watch::numbers(manifest, &snapshot, start.elapsed());
    events.publish("numbers", &numbers);
    let is_new = |(done, when): (u64, Instant)| done != snapshot.done || when.elapsed() >= AGAIN;
    if drawn.is_none_or(is_new)
        && let Some(curves) = watch::curves(manifest, &progress.times())
    {
        events.publish("curves", &json!(curves));
        *drawn = Some((snapshot.done, now()));
    }
}
