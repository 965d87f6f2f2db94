//! Detection of clients that have ended without notice.
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use super::event::ServerEvent;
use super::wire::Incoming;

/// Time between two checks of the client's process.
const PAUSE: Duration = Duration::from_secs(2);

/// Watches the client's process. Ends the session after the process has ended, even if another
/// process keeps the client's stream open.
///
/// A process that is absent from the start may be on another machine or in a container, and is
/// ignored.
pub fn watch(id: i32, events: SyncSender<ServerEvent>) {
    if !is_running(id) {
        return;
    }
    // Without a thread, the end of the stream usually reports this.
    let _ = std::thread::Builder::new().spawn(move || {
        while is_running(id) {
            std::thread::sleep(PAUSE);
        }
        // The receiver may already have ended.
        let _ = events.send(ServerEvent::Incoming(Incoming::End));
    });
}

#[cfg(unix)]
fn is_running(id: i32) -> bool {
    use rustix::io::Errno;
    use rustix::process::{Pid, test_kill_process};
    // A process of another user exists even if it cannot be signalled.
    let found = (id > 0).then(|| Pid::from_raw(id)).flatten();
    found.is_some_and(|id| test_kill_process(id) != Err(Errno::SRCH))
}

/// Returns `true`, because this system offers no check.
#[cfg(not(unix))]
fn is_running(_: i32) -> bool {
    false
}
