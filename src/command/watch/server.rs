//! Answers requests, each within bounds of time and memory, and each by a thread of its own, of which there are few.
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{Builder, Scope, sleep};
use std::time::{Duration, Instant};

use stochc_ensemble::Manifest;
use stochc_ensemble::clock::now;
use stochc_report::watch::{Page, program};

use super::access::{Access, AccessDenied};
use super::events::EventBroadcast;
use super::request::{BadRequest, HttpRequest, MOST_BYTES};

/// Connections at the same time: a page has one, and for a moment a second.
const MOST_CONNECTIONS: usize = 16;
/// Of the thread of a connection, which `--memory` counts.
const STACK: usize = 256 << 10;
/// In which a request has to be there.
const READING: Duration = Duration::from_secs(5);
/// In which an answer, or an event, has to be taken.
const WRITING: Duration = Duration::from_secs(5);
/// What is left for that once all has ended.
const LEAVING: Duration = Duration::from_secs(1);
/// How soon a thread sees that all has ended.
const SLICE: Duration = Duration::from_millis(100);
/// A sign of life where nothing happens, so that whoever has gone is noticed.
const LIFE: Duration = Duration::from_secs(10);

/// What is served.
pub(super) struct ServerState<'a> {
    pub manifest: &'a Manifest,
    pub page: Page,
    pub access: &'a Access,
    pub events: &'a EventBroadcast,
    /// How many there are.
    pub connections: AtomicUsize,
}

/// An answer: its status, and what it is.
struct HttpResponse {
    status: &'static str,
    kind: &'static str,
    more: &'static str,
    body: String,
}

impl HttpResponse {
    fn text(status: &'static str, words: &str) -> HttpResponse {
        HttpResponse {
            status,
            kind: "text/plain; charset=utf-8",
            more: "",
            body: format!("{words}\n"),
        }
    }

    fn not_found() -> HttpResponse {
        let words =
            "there is nothing here; the whole link is what `stochc simulate --watch` has printed";
        HttpResponse::text("404 Not Found", words)
    }
}

impl From<BadRequest> for HttpResponse {
    fn from(bad: BadRequest) -> HttpResponse {
        match bad {
            BadRequest::Malformed => HttpResponse::text("400 Bad Request", "this is no HTTP/1.1"),
            BadRequest::TooLarge => {
                let status = "431 Request Header Fields Too Large";
                HttpResponse::text(status, "the request is too large")
            }
        }
    }
}

impl From<AccessDenied> for HttpResponse {
    fn from(denied: AccessDenied) -> HttpResponse {
        match denied {
            AccessDenied::Method => HttpResponse {
                more: "Allow: GET\r\n",
                ..HttpResponse::text("405 Method Not Allowed", "there is only GET")
            },
            AccessDenied::Host => HttpResponse::text("403 Forbidden", "this is for another host"),
            AccessDenied::Token => HttpResponse::not_found(),
        }
    }
}

/// Answers whoever comes, until all has ended.
pub(super) fn accept<'s>(
    listener: &'s TcpListener,
    state: &'s ServerState<'s>,
    scope: &'s Scope<'s, '_>,
) {
    /// Dropped when a connection is closed.
    struct ConnectionGuard<'a>(&'a AtomicUsize);
    impl Drop for ConnectionGuard<'_> {
        fn drop(&mut self) {
            self.0.fetch_sub(1, Ordering::Relaxed);
        }
    }
    while !state.events.is_closed() {
        // Nobody has come, or the system has no more files.
        let Ok((stream, _)) = listener.accept() else {
            sleep(SLICE / 2);
            continue;
        };
        let open = state.connections.fetch_add(1, Ordering::Relaxed);
        let guard = ConnectionGuard(&state.connections);
        if open >= MOST_CONNECTIONS {
            let _ = stream.set_nonblocking(true);
            let answer = HttpResponse::text("503 Service Unavailable", "too many connections");
            let mut whole = head(&answer, state, Some(answer.body.len()));
            whole.extend(answer.body.bytes());
            let _ = (&stream).write_all(&whole);
            continue;
        }
        // Without a thread for it, it is closed.
        let builder = Builder::new().stack_size(STACK);
        let _ = builder.spawn_scoped(scope, move || {
            let _open = guard;
            // Whoever does not read, or has gone, is left alone.
            let _ = answer(&stream, state);
        });
    }
}

/// Answers one request, the only one of its connection.
fn answer(stream: &TcpStream, state: &ServerState<'_>) -> io::Result<()> {
    // On some systems it is as the one that listens.
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    let Some(request) = read(stream, state.events)? else {
        return Ok(());
    };
    let answer = match request.map_err(HttpResponse::from) {
        Err(bad) => bad,
        Ok(request) => match state.access.admit(&request) {
            Err(error) => error.into(),
            Ok("events") => return listen(stream, state),
            Ok(path) => found(path, state),
        },
    };
    let head = head(&answer, state, Some(answer.body.len()));
    write(stream, &head, state.events)?;
    write(stream, answer.body.as_bytes(), state.events)?;
    leave(stream)
}

fn found(path: &str, state: &ServerState<'_>) -> HttpResponse {
    if path.is_empty() {
        return HttpResponse {
            status: "200 OK",
            kind: "text/html; charset=utf-8",
            more: "",
            body: state.page.html.clone(),
        };
    }
    let number = path.strip_prefix("program/").and_then(|it| it.parse().ok());
    match number.and_then(|number| program(state.manifest, number)) {
        Some(about) => HttpResponse {
            status: "200 OK",
            kind: "application/json",
            more: "",
            body: about.to_string(),
        },
        None => HttpResponse::not_found(),
    }
}

/// Reads a request within its time; `None`: whoever made it has gone.
fn read(
    stream: &TcpStream,
    events: &EventBroadcast,
) -> io::Result<Option<Result<HttpRequest, BadRequest>>> {
    stream.set_read_timeout(Some(SLICE))?;
    let begun = now();
    let mut bytes = Vec::new();
    loop {
        let mut part = [0; 1024];
        let most = part.len().min(MOST_BYTES - bytes.len());
        match (&*stream).read(&mut part[..most]) {
            Ok(0) => return Ok(None),
            Ok(count) => bytes.extend(&part[..count]),
            Err(error) if is_slow(&error) => {}
            Err(error) => return Err(error),
        }
        match HttpRequest::parse(&bytes) {
            Ok(None) if begun.elapsed() > READING || events.is_closed() => return Ok(None),
            Ok(None) => {}
            Ok(Some(request)) => return Ok(Some(Ok(request))),
            Err(bad) => return Ok(Some(Err(bad))),
        }
    }
}

/// Sends events, as they come, to the last one.
fn listen(stream: &TcpStream, state: &ServerState<'_>) -> io::Result<()> {
    let answer = HttpResponse {
        status: "200 OK",
        kind: "text/event-stream",
        more: "",
        body: String::new(),
    };
    write(stream, &head(&answer, state, None), state.events)?;
    let mut listener = state.events.listen();
    while let Some(new) = listener.next(LIFE) {
        if new.is_empty() {
            write(stream, b":\n\n", state.events)?;
        }
        for event in new {
            write(stream, event.as_bytes(), state.events)?;
        }
    }
    leave(stream)
}

/// The status and the headers of an answer; `length`: of its body, if that is known.
fn head(answer: &HttpResponse, state: &ServerState<'_>, length: Option<usize>) -> Vec<u8> {
    let length = length.map_or(String::new(), |it| format!("Content-Length: {it}\r\n"));
    let HttpResponse {
        status, kind, more, ..
    } = answer;
    format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\n{length}{more}Connection: close\r\n\
         Cache-Control: no-store\r\nContent-Security-Policy: {}\r\nX-Content-Type-Options: nosniff\r\n\
         Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Cross-Origin-Opener-Policy: same-origin\r\n\r\n",
        state.page.policy
    )
    .into_bytes()
}

/// Writes all of it within its time, of which little is left once all has ended.
fn write(stream: &TcpStream, mut bytes: &[u8], events: &EventBroadcast) -> io::Result<()> {
    stream.set_write_timeout(Some(SLICE))?;
    let begun = now();
    let mut ended: Option<Instant> = None;
    while !bytes.is_empty() {
        match (&*stream).write(bytes) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(count) => bytes = &bytes[count..],
            Err(error) if is_slow(&error) => {}
            Err(error) => return Err(error),
        }
        if ended.is_none() && events.is_closed() {
            ended = Some(now());
        }
        let is_late = begun.elapsed() > WRITING || ended.is_some_and(|it| it.elapsed() > LEAVING);
        if !bytes.is_empty() && is_late {
            return Err(ErrorKind::TimedOut.into());
        }
    }
    Ok(())
}

/// Closes a connection: what the other side still sends would have the system throw away what it has not read yet.
fn leave(stream: &TcpStream) -> io::Result<()> {
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(SLICE))?;
    let mut rest = [0; 1024];
    let begun = now();
    while begun.elapsed() < 3 * SLICE && (&*stream).read(&mut rest)? > 0 {}
    Ok(())
}

/// Whether nothing is wrong but that it takes long.
fn is_slow(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;

    /// Both ends of a connection.
    fn pair() -> (TcpStream, TcpStream) {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let near = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        (near, listener.accept().unwrap().0)
    }

    /// More than any system keeps for somebody who does not read.
    fn much() -> Vec<u8> {
        vec![0; 64 << 20]
    }

    #[test]
    fn whoever_does_not_read_is_given_up() {
        let (near, _deaf) = pair();
        let begun = now();
        let written = write(&near, &much(), &EventBroadcast::default());
        assert_eq!(written.unwrap_err().kind(), ErrorKind::TimedOut);
        assert!(begun.elapsed() > WRITING);
    }

    #[test]
    fn at_the_end_he_is_given_up_sooner() {
        let (near, _deaf) = pair();
        let events = EventBroadcast::default();
        drop(events.closing());
        let begun = now();
        let written = write(&near, &much(), &events);
        assert_eq!(written.unwrap_err().kind(), ErrorKind::TimedOut);
        assert!(LEAVING < begun.elapsed() && begun.elapsed() < WRITING);
    }

    #[test]
    fn whoever_reads_gets_all_of_it() {
        let (near, mut far) = pair();
        let reading = std::thread::spawn(move || {
            let mut all = Vec::new();
            far.read_to_end(&mut all).map(|_| all.len())
        });
        write(&near, &much(), &EventBroadcast::default()).unwrap();
        drop(near);
        assert_eq!(reading.join().unwrap().unwrap(), much().len());
    }
}
