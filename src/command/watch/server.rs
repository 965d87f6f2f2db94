//! Answers requests, each within bounds of time and memory, and each by a thread of its own, of which there are few.
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{Builder, Scope, sleep};
use std::time::{Duration, Instant};

use stochc_ensemble::Manifest;
use stochc_report::watch::{Page, program};

use super::access::{Access, Refusal};
use super::events::Events;
use super::request::{BadRequest, MOST_BYTES, Request};
use crate::command::progress::now;

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
pub(super) struct Site<'a> {
    pub manifest: &'a Manifest,
    pub page: Page,
    pub access: &'a Access,
    pub events: &'a Events,
    /// How many there are.
    pub connections: AtomicUsize,
}

/// An answer: its status, and what it is.
struct Answer {
    status: &'static str,
    kind: &'static str,
    more: &'static str,
    body: String,
}

impl Answer {
    fn told(status: &'static str, words: &str) -> Answer {
        Answer {
            status,
            kind: "text/plain; charset=utf-8",
            more: "",
            body: format!("{words}\n"),
        }
    }

    fn not_found() -> Answer {
        let words =
            "there is nothing here; the whole link is what `stochc simulate --watch` has printed";
        Answer::told("404 Not Found", words)
    }
}

impl From<BadRequest> for Answer {
    fn from(bad: BadRequest) -> Answer {
        match bad {
            BadRequest::Malformed => Answer::told("400 Bad Request", "this is no HTTP/1.1"),
            BadRequest::TooLarge => {
                let status = "431 Request Header Fields Too Large";
                Answer::told(status, "the request is too large")
            }
        }
    }
}

impl From<Refusal> for Answer {
    fn from(refusal: Refusal) -> Answer {
        match refusal {
            Refusal::Method => Answer {
                more: "Allow: GET\r\n",
                ..Answer::told("405 Method Not Allowed", "there is only GET")
            },
            Refusal::Host => Answer::told("403 Forbidden", "this is for another host"),
            Refusal::Token => Answer::not_found(),
        }
    }
}

/// Answers whoever comes, until all has ended.
pub(super) fn accept<'s>(listener: &'s TcpListener, site: &'s Site<'s>, scope: &'s Scope<'s, '_>) {
    /// Dropped when a connection is closed.
    struct Open<'a>(&'a AtomicUsize);
    impl Drop for Open<'_> {
        fn drop(&mut self) {
            self.0.fetch_sub(1, Ordering::Relaxed);
        }
    }
    while !site.events.is_closed() {
        // Nobody has come, or the system has no more files.
        let Ok((stream, _)) = listener.accept() else {
            sleep(SLICE / 2);
            continue;
        };
        let open = site.connections.fetch_add(1, Ordering::Relaxed);
        let guard = Open(&site.connections);
        if open >= MOST_CONNECTIONS {
            let _ = stream.set_nonblocking(true);
            let answer = Answer::told("503 Service Unavailable", "too many connections");
            let mut whole = head(&answer, site, Some(answer.body.len()));
            whole.extend(answer.body.bytes());
            let _ = (&stream).write_all(&whole);
            continue;
        }
        // Without a thread for it, it is closed.
        let builder = Builder::new().stack_size(STACK);
        let _ = builder.spawn_scoped(scope, move || {
            let _open = guard;
            // Whoever does not read, or has gone, is left alone.
            let _ = answer(&stream, site);
        });
    }
}

/// Answers one request, the only one of its connection.
fn answer(stream: &TcpStream, site: &Site<'_>) -> io::Result<()> {
    // On some systems it is as the one that listens.
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    let Some(request) = read(stream, site.events)? else {
        return Ok(());
    };
    let answer = match request.map_err(Answer::from) {
        Err(bad) => bad,
        Ok(request) => match site.access.admit(&request) {
            Err(refusal) => refusal.into(),
            Ok("events") => return listen(stream, site),
            Ok(path) => found(path, site),
        },
    };
    let head = head(&answer, site, Some(answer.body.len()));
    write(stream, &head, site.events)?;
    write(stream, answer.body.as_bytes(), site.events)?;
    leave(stream)
}

fn found(path: &str, site: &Site<'_>) -> Answer {
    if path.is_empty() {
        return Answer {
            status: "200 OK",
            kind: "text/html; charset=utf-8",
            more: "",
            body: site.page.html.clone(),
        };
    }
    let number = path.strip_prefix("program/").and_then(|it| it.parse().ok());
    match number.and_then(|number| program(site.manifest, number)) {
        Some(about) => Answer {
            status: "200 OK",
            kind: "application/json",
            more: "",
            body: about.to_string(),
        },
        None => Answer::not_found(),
    }
}

/// Reads a request within its time; `None`: whoever made it has gone.
fn read(stream: &TcpStream, events: &Events) -> io::Result<Option<Result<Request, BadRequest>>> {
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
        match Request::parse(&bytes) {
            Ok(None) if begun.elapsed() > READING || events.is_closed() => return Ok(None),
            Ok(None) => {}
            Ok(Some(request)) => return Ok(Some(Ok(request))),
            Err(bad) => return Ok(Some(Err(bad))),
        }
    }
}

/// Sends events, as they come, to the last one.
fn listen(stream: &TcpStream, site: &Site<'_>) -> io::Result<()> {
    let answer = Answer {
        status: "200 OK",
        kind: "text/event-stream",
        more: "",
        body: String::new(),
    };
    write(stream, &head(&answer, site, None), site.events)?;
    let mut listener = site.events.listen();
    while let Some(new) = listener.next(LIFE) {
        if new.is_empty() {
            write(stream, b":\n\n", site.events)?;
        }
        for event in new {
            write(stream, event.as_bytes(), site.events)?;
        }
    }
    leave(stream)
}

/// The status and the headers of an answer; `length`: of its body, if that is known.
fn head(answer: &Answer, site: &Site<'_>, length: Option<usize>) -> Vec<u8> {
    let length = length.map_or(String::new(), |it| format!("Content-Length: {it}\r\n"));
    let Answer {
        status, kind, more, ..
    } = answer;
    format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\n{length}{more}Connection: close\r\n\
         Cache-Control: no-store\r\nContent-Security-Policy: {}\r\nX-Content-Type-Options: nosniff\r\n\
         Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Cross-Origin-Opener-Policy: same-origin\r\n\r\n",
        site.page.policy
    )
    .into_bytes()
}

/// Writes all of it within its time, of which little is left once all has ended.
fn write(stream: &TcpStream, mut bytes: &[u8], events: &Events) -> io::Result<()> {
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
        let written = write(&near, &much(), &Events::default());
        assert_eq!(written.unwrap_err().kind(), ErrorKind::TimedOut);
        assert!(begun.elapsed() > WRITING);
    }

    #[test]
    fn at_the_end_he_is_given_up_sooner() {
        let (near, _deaf) = pair();
        let events = Events::default();
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
        write(&near, &much(), &Events::default()).unwrap();
        drop(near);
        assert_eq!(reading.join().unwrap().unwrap(), much().len());
    }
}
