//! What goes to the pages that listen: the latest event of each kind.
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::time::Duration;

use serde_json::Value;

/// The latest events, for any number of listeners, none of whom is waited for.
#[derive(Debug, Default)]
pub(super) struct EventBroadcast {
    latest: Mutex<Latest>,
    changed: Condvar,
    listeners: AtomicUsize,
}

#[derive(Debug, Default)]
struct Latest {
    /// By kind: its number among all events, and how it is sent. The oldest comes first.
    events: Vec<(&'static str, u64, Arc<str>)>,
    count: u64,
    is_closed: bool,
}

/// Somebody who listens; nobody any more when it is dropped.
#[derive(Debug)]
pub(super) struct Listener<'e> {
    events: &'e EventBroadcast,
    heard: u64,
}

/// Closes the events when it is dropped.
#[derive(Debug)]
pub(super) struct Closing<'e>(&'e EventBroadcast);

impl EventBroadcast {
    /// Puts an event in the place of the last one of its kind.
    pub fn publish(&self, kind: &'static str, data: &Value) {
        // JSON has no line breaks outside of strings, and writes them as `\n` within.
        let text = format!("event: {kind}\ndata: {data}\n\n").into();
        let mut latest = self.lock();
        latest.count += 1;
        let count = latest.count;
        latest.events.retain(|(it, ..)| *it != kind);
        latest.events.push((kind, count, text));
        drop(latest);
        self.changed.notify_all();
    }

    /// Somebody who has heard nothing yet.
    pub fn listen(&self) -> Listener<'_> {
        self.listeners.fetch_add(1, Ordering::Relaxed);
        Listener {
            events: self,
            heard: 0,
        }
    }

    /// Whether anybody listens.
    pub fn has_listeners(&self) -> bool {
        self.listeners.load(Ordering::Relaxed) > 0
    }

    /// No event follows once this is dropped.
    pub fn closing(&self) -> Closing<'_> {
        Closing(self)
    }

    /// Whether no event follows.
    pub fn is_closed(&self) -> bool {
        self.lock().is_closed
    }

    fn lock(&self) -> MutexGuard<'_, Latest> {
        self.latest.lock().expect("nobody panics while it is held")
    }
}

impl Listener<'_> {
    /// What is new, or what there is after so much time: nothing, perhaps. `None`: no more will come.
    pub fn next(&mut self, patience: Duration) -> Option<Vec<Arc<str>>> {
        let latest = self.events.lock();
        let is_old = |latest: &mut Latest| latest.count == self.heard && !latest.is_closed;
        let waited = (self.events.changed).wait_timeout_while(latest, patience, is_old);
        let (latest, _) = waited.expect("nobody panics while it is held");
        let events = latest.events.iter();
        let new: Vec<_> = (events.filter(|(_, count, _)| *count > self.heard))
            .map(|(.., text)| text.clone())
            .collect();
        self.heard = latest.count;
        (!new.is_empty() || !latest.is_closed).then_some(new)
    }
}

impl Drop for Listener<'_> {
    fn drop(&mut self) {
        self.events.listeners.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.0.lock().is_closed = true;
        self.0.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn heard(listener: &mut Listener<'_>) -> Option<String> {
        let new = listener.next(Duration::ZERO)?;
        Some(new.iter().map(|it| &**it).collect())
    }

    #[test]
    fn whoever_is_slow_hears_the_latest_of_each_kind() {
        let events = EventBroadcast::default();
        assert!(!events.has_listeners());
        let mut listener = events.listen();
        assert!(events.has_listeners());
        assert_eq!(heard(&mut listener).as_deref(), Some(""));
        for number in 0..1000 {
            events.publish("a", &json!(number));
        }
        events.publish("b", &json!("two\nlines"));
        let expected = "event: a\ndata: 999\n\nevent: b\ndata: \"two\\nlines\"\n\n";
        assert_eq!(heard(&mut listener).as_deref(), Some(expected));
        assert_eq!(heard(&mut listener).as_deref(), Some(""));
        // Somebody who comes later hears it as well.
        assert_eq!(heard(&mut events.listen()).as_deref(), Some(expected));
        drop(listener);
        assert!(!events.has_listeners());
    }

    #[test]
    fn what_is_closed_is_heard_to_its_end() {
        let events = EventBroadcast::default();
        let mut listener = events.listen();
        let closing = events.closing();
        events.publish("end", &json!({}));
        drop(closing);
        assert!(events.is_closed());
        let end = "event: end\ndata: {}\n\n";
        assert_eq!(heard(&mut listener).as_deref(), Some(end));
        assert_eq!(heard(&mut listener), None);
    }
}
