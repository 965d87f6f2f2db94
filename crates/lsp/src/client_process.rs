//! The process of a client that has gone without a word.
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use super::event::ServerEvent;
use super::wire::Incoming;

/// How often it is looked for.
const PAUSE: Duration = Duration::from_secs(2);

/// Ends the conversation once a process has ended whose stream somebody else holds open. One that is not there from the
/// beginning may be of another machine or container, and is not waited for.
pub fn watch(id: i32, events: SyncSender<ServerEvent>) {
    if !is_running(id) {
        return;
    }
    // Without a thread the stream tells of the end, as it mostly does.
    let _ = std::thread::Builder::new().spawn(move || {
        while is_running(id) {
            std::thread::sleep(PAUSE);
        }
        // Nobody listens after the end.
        let _ = events.send(ServerEvent::Incoming(Incoming::End));
    });
}

#[cfg(unix)]
fn is_running(id: i32) -> bool {
    use rustix::io::Errno;
    use rustix::process::{Pid, test_kill_process};
    // One of another user is there as well, though no signal may be sent to it.
    let found = (id > 0).then(|| Pid::from_raw(id)).flatten();
    found.is_some_and(|id| test_kill_process(id) != Err(Errno::SRCH))
}

/// Nothing is known of it.
#[cfg(not(unix))]
fn is_running(_: i32) -> bool {
    false
}
