//! `simulate --watch`: who is answered, and what they are told while the runs go on.
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::stochc::{Said, command, path, stochc, stochc_with};

/// Longer than anything takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// Runs that would go on for hours.
const ENDLESS: &str = "simulate tests/fixtures/still.sa --runs 1000 --max-ticks 100000000";

/// A command that can be watched.
struct Watched {
    child: Child,
    /// What is left of its standard error.
    err: BufReader<std::process::ChildStderr>,
    /// `127.0.0.1:PORT`.
    host: String,
    token: String,
}

impl Watched {
    fn start(line: &str, more: &[&str]) -> Watched {
        let words = line.split_whitespace().chain(more.iter().copied());
        let mut command = command(words.chain(["--watch"]));
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut err = BufReader::new(child.stderr.take().unwrap());
        let link = loop {
            let mut line = String::new();
            assert!(
                err.read_line(&mut line).unwrap() > 0,
                "it ends without a link"
            );
            if let Some(link) = line.strip_prefix("watch at http://") {
                break link.trim_end().to_owned();
            }
        };
        let (host, token) = link.split_once('/').unwrap();
        let token = token.strip_suffix('/').unwrap();
        assert!(host.starts_with("127.0.0.1:"), "{link}");
        assert_eq!(token.len(), 32);
        Watched {
            host: host.to_owned(),
            token: token.to_owned(),
            child,
            err,
        }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.set_write_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// The whole answer to some bytes; what cannot be read any more is missing.
    fn answer(&self, bytes: &[u8]) -> String {
        let mut stream = self.connect();
        // It may be closed before all is sent.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8(answer).unwrap()
    }

    fn request(&self, path: &str) -> Vec<u8> {
        let Watched { host, token, .. } = self;
        format!("GET /{token}/{path} HTTP/1.1\r\nHost: {host}\r\n\r\n").into_bytes()
    }

    fn get(&self, path: &str) -> String {
        self.answer(&self.request(path))
    }

    /// Listens to events.
    fn listen(&self) -> Stream {
        let mut stream = self.connect();
        stream.write_all(&self.request("events")).unwrap();
        let mut lines = BufReader::new(stream);
        let mut head = String::new();
        while !head.ends_with("\r\n\r\n") {
            assert!(lines.read_line(&mut head).unwrap() > 0, "{head}");
        }
        assert!(head.starts_with("HTTP/1.1 200 OK\r\n"), "{head}");
        assert!(head.contains("\r\nContent-Type: text/event-stream\r\n"));
        Stream(lines)
    }

    /// Waits for the end.
    fn end(mut self) -> Said {
        let mut err = String::new();
        self.err.read_to_string(&mut err).unwrap();
        let output = self.child.wait_with_output().unwrap();
        Said {
            status: output.status.code().unwrap(),
            out: String::from_utf8(output.stdout).unwrap(),
            err,
        }
    }

    fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

/// Events as they come.
struct Stream(BufReader<TcpStream>);

impl Stream {
    /// The next event, its kind and what it says; `None`: the stream has ended.
    fn next(&mut self) -> Option<(String, Value)> {
        let mut kind = String::new();
        loop {
            let mut line = String::new();
            if self.0.read_line(&mut line).unwrap() == 0 {
                return None;
            }
            if let Some(it) = line.strip_prefix("event: ") {
                kind = it.trim_end().to_owned();
            }
            if let Some(data) = line.strip_prefix("data: ") {
                return Some((kind, serde_json::from_str(data).unwrap()));
            }
        }
    }

    /// The next event of a kind.
    fn wait(&mut self, kind: &str) -> Value {
        loop {
            let (it, data) = self.next().expect("the stream goes on");
            if it == kind {
                return data;
            }
        }
    }
}

fn status(answer: &str) -> &str {
    answer.split(' ').nth(1).unwrap_or("none")
}

#[test]
fn only_whoever_knows_the_link_is_answered() {
    let watched = Watched::start(ENDLESS, &[]);
    let Watched { host, token, .. } = &watched;
    let ask = |text: String| watched.answer(text.as_bytes());
    let mut wrong = token.clone();
    let last = if wrong.pop() == Some('0') { '1' } else { '0' };
    wrong.push(last);
    for path in [
        "/",
        "/events",
        "/favicon.ico",
        "/program/0",
        &format!("/{wrong}/"),
        &format!("/{wrong}/events"),
        &format!("/{token}"),
        &format!("/{token}/nothing"),
        &format!("/{token}/program/1"),
        &format!("/{token}/program/-1"),
        &format!("/{token}/../{token}/"),
        &format!("/?{token}"),
    ] {
        let answer = ask(format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n"));
        assert_eq!(status(&answer), "404", "{path}: {answer}");
        // Not even a page that guesses learns anything.
        assert!(!answer.contains(token.as_str()), "{answer}");
    }
    let port = host.rsplit(':').next().unwrap();
    for (name, expected) in [
        (format!("localhost:{port}"), "200"),
        (host.clone(), "200"),
        ("evil.example".to_owned(), "403"),
        (format!("evil.example:{port}"), "403"),
        ("127.0.0.1".to_owned(), "403"),
        (String::new(), "403"),
    ] {
        let answer = ask(format!("GET /{token}/ HTTP/1.1\r\nHost: {name}\r\n\r\n"));
        assert_eq!(status(&answer), expected, "{name}: {answer}");
    }
    let answer = ask(format!("GET /{token}/ HTTP/1.1\r\n\r\n"));
    assert_eq!(status(&answer), "403", "{answer}");
    for method in ["POST", "HEAD", "OPTIONS", "PUT", "DELETE"] {
        let answer = ask(format!(
            "{method} /{token}/ HTTP/1.1\r\nHost: {host}\r\n\r\n"
        ));
        assert_eq!(status(&answer), "405", "{method}: {answer}");
        assert!(answer.contains("\r\nAllow: GET\r\n"), "{answer}");
    }
    watched.kill();
}

#[test]
fn what_is_no_request_does_no_harm() {
    let watched = Watched::start(ENDLESS, &[]);
    let Watched { host, token, .. } = &watched;
    let begin = format!("GET /{token}/ HTTP/1.1\r\nHost: {host}\r\n");
    let long = format!("{begin}X: {}\r\n\r\n", "x".repeat(1 << 20));
    assert_eq!(status(&watched.answer(long.as_bytes())), "431");
    let many = format!("{begin}{}\r\n", "X: x\r\n".repeat(100));
    assert_eq!(status(&watched.answer(many.as_bytes())), "431");
    let line = format!("GET /{} HTTP/1.1\r\n\r\n", "x".repeat(1 << 20));
    assert_eq!(status(&watched.answer(line.as_bytes())), "431");
    for text in [
        "\r\n\r\n\0".to_owned(),
        "hello\r\n\r\n".to_owned(),
        format!("{begin}Host: {host}\r\n\r\n"),
        format!("GET /{token}/ HTTP/2.0\r\nHost: {host}\r\n\r\n"),
    ] {
        assert_eq!(status(&watched.answer(text.as_bytes())), "400", "{text:?}");
    }
    assert_eq!(status(&watched.get("")), "200");
    watched.kill();
}

#[test]
fn the_page_may_do_nothing_but_ask_for_more_of_itself() {
    let watched = Watched::start(ENDLESS, &[]);
    for path in ["", "program/0", "nothing"] {
        let answer = watched.get(path);
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        let policy = "default-src 'none'; script-src 'sha256-";
        assert!(head.contains(&format!("\r\nContent-Security-Policy: {policy}")));
        assert!(head.contains("frame-ancestors 'none'"), "{head}");
        assert!(head.contains("connect-src 'self'"), "{head}");
        assert!(head.contains("\r\nCache-Control: no-store\r\n"), "{head}");
        assert!(head.contains("\r\nX-Content-Type-Options: nosniff\r\n"));
        assert!(!head.to_lowercase().contains("access-control"), "{head}");
        assert!(!head.to_lowercase().contains("cookie"), "{head}");
        let length = format!("\r\nContent-Length: {}\r\n", body.len());
        assert!(head.contains(&length), "{head}");
    }
    let about = watched.get("program/0");
    let (_, body) = about.split_once("\r\n\r\n").unwrap();
    let about: Value = serde_json::from_str(body).unwrap();
    assert_eq!(about["scene"]["free"]["count"], 2);
    watched.kill();
}

#[test]
fn whoever_listens_is_told_all_to_the_end() {
    let line = "simulate tests/fixtures/tower.sa --runs 12 --threads 2 --quiet";
    let watched = Watched::start(line, &[]);
    let mut stream = watched.listen();
    let (mut frames, mut curves, mut done) = (Vec::new(), 0, Vec::new());
    let end = loop {
        let (kind, data) = stream.next().expect("an end");
        match kind.as_str() {
            "frame" => frames.push(data),
            "curves" => {
                curves += 1;
                let picture = data.as_str().unwrap();
                assert!(picture.starts_with("<svg "), "{picture}");
            }
            "numbers" => {
                assert_eq!(data["total"], 12);
                done.push(data["done"].as_u64().unwrap());
            }
            _ => break (kind, data),
        }
    };
    assert_eq!(
        end,
        ("end".to_owned(), serde_json::json!({ "complete": true }))
    );
    assert_eq!(stream.next(), None);
    assert!(done.is_sorted(), "{done:?}");
    assert_eq!(done.last(), Some(&12));
    assert!(curves > 0);
    let said = watched.end();
    assert_eq!(said.status, 0, "{}", said.err);
}

#[test]
fn a_frame_is_of_the_first_run_under_way() {
    let watched = Watched::start(ENDLESS, &["--threads", "2"]);
    let mut stream = watched.listen();
    let first = stream.wait("frame");
    let later = stream.wait("frame");
    for frame in [&first, &later] {
        assert_eq!(
            (&frame["program"], &frame["run"]),
            (&Value::from(0), &Value::from(0))
        );
        use base64::Engine as _;
        let numbers = frame["numbers"].as_str().unwrap();
        let numbers = base64::engine::general_purpose::STANDARD
            .decode(numbers)
            .unwrap();
        // Two blocks of seven numbers of two bytes.
        assert_eq!(numbers.len(), 2 * 7 * 2);
    }
    assert!(
        later["tick"].as_u64() > first["tick"].as_u64(),
        "{first} {later}"
    );
    watched.kill();
}

#[test]
fn nothing_that_is_kept_depends_on_it() {
    let folder = tempfile::tempdir().unwrap();
    let [alone, seen] = ["alone", "seen"].map(|name| path(folder.path(), name));
    let line = "simulate tests/fixtures/tower.sa --runs 20 --threads 1 --record 0..1 --checkpoints 500ticks --quiet --out";
    let said = stochc_with(line, &[&alone]);
    assert_eq!(said.status, 0, "{}", said.err);
    let watched = Watched::start(line, &[&seen]);
    let mut stream = watched.listen();
    let mut frames = 0;
    while let Some((kind, _)) = stream.next() {
        frames += u32::from(kind == "frame");
    }
    assert!(frames > 0);
    let watched = watched.end();
    assert_eq!(
        (watched.status, &watched.out),
        (0, &said.out),
        "{}",
        watched.err
    );
    for name in [
        "journal.jsonl",
        "runs.parquet",
        "recordings/0-0.rec",
        "recordings/0-1.rec",
    ] {
        let [alone, seen] =
            [&alone, &seen].map(|folder| fs::read(path(folder.as_ref(), name)).unwrap());
        assert!(alone == seen, "{name}");
    }
}

#[test]
fn slow_and_many_clients_hold_up_nobody() {
    let line = "simulate tests/fixtures/tower.sa --runs 100 --threads 2 --quiet";
    let watched = Watched::start(line, &[]);
    // One begins a request and never ends it, one never reads what it has asked for, and many say nothing.
    let mut begun = watched.connect();
    begun.write_all(b"GET /").unwrap();
    let mut deaf = watched.connect();
    deaf.write_all(&watched.request("events")).unwrap();
    let crowd: Vec<TcpStream> = (0..60).map(|_| watched.connect()).collect();
    let mut refused = 0;
    for mut stream in crowd {
        let mut answer = String::new();
        let _ = stream.read_to_string(&mut answer);
        assert!(["503", "none"].contains(&status(&answer)), "{answer}");
        refused += u32::from(status(&answer) == "503");
    }
    assert!(refused >= 60 - 16, "{refused}");
    let said = watched.end();
    assert_eq!(said.status, 0, "{}", said.err);
    let mut rest = Vec::new();
    let _ = begun.read_to_end(&mut rest);
    assert_eq!(rest, b"");
}

#[test]
fn a_request_that_does_not_end_is_dropped() {
    let watched = Watched::start(ENDLESS, &[]);
    let mut stream = watched.connect();
    let start = Instant::now();
    let mut answer = Vec::new();
    // A byte at a time would go on for minutes.
    for byte in format!("GET /{}/ HTTP/1.1\r\n", watched.token).bytes() {
        if stream.write_all(&[byte]).is_err() {
            break;
        }
        std::thread::sleep(Duration::from_millis(200));
    }
    let _ = stream.read_to_end(&mut answer);
    assert!(answer.is_empty());
    let took = start.elapsed();
    assert!(took > Duration::from_secs(5), "{took:?}");
    // And others are answered meanwhile, and after.
    assert_eq!(status(&watched.get("")), "200");
    watched.kill();
}

#[test]
#[cfg(unix)]
fn it_ends_with_the_command() {
    let watched = Watched::start(ENDLESS, &["--quiet"]);
    let mut stream = watched.listen();
    stream.wait("numbers");
    let id = watched.child.id().to_string();
    let sent = std::process::Command::new("kill")
        .args(["-TERM", &id])
        .status();
    assert!(sent.unwrap().success());
    let end = stream.wait("end");
    assert_eq!(end["complete"], false);
    assert_eq!(stream.next(), None);
    let host = watched.host.clone();
    assert_eq!(watched.end().status, 130);
    assert!(TcpStream::connect(host).is_err());
}

#[test]
fn without_places_there_are_curves_alone() {
    let line =
        "simulate tests/fixtures/tower.sa --model shuffle --runs 10000000 --threads 1 --quiet";
    let watched = Watched::start(line, &[]);
    let mut stream = watched.listen();
    let told = stream.wait("numbers");
    let reason = told["arena"].as_str().unwrap();
    assert!(
        reason.contains("the model `shuffle` has no places"),
        "{reason}"
    );
    stream.wait("curves");
    for _ in 0..8 {
        let (kind, _) = stream.next().unwrap();
        assert_ne!(kind, "frame");
    }
    assert_eq!(status(&watched.get("program/0")), "404");
    watched.kill();
}

#[test]
fn a_port_is_taken_or_refused() {
    let watched = Watched::start(ENDLESS, &[]);
    let port = watched.host.rsplit(':').next().unwrap();
    let said = stochc(&format!("simulate tests/fixtures/tower.sa --watch={port}"));
    assert_eq!(said.status, 2);
    let told = format!("error: --watch: cannot serve at port {port}: ");
    assert!(said.err.contains(&told), "{}", said.err);
    for (more, told) in [
        ("--watch --run 0", "cannot be used with"),
        (
            "--watch --shards 2 --out /nowhere/at/all",
            "cannot be used with",
        ),
        ("--watch --replan 100", "cannot be used with"),
        ("--watch=80000", "80000 is not in 0..=65535"),
    ] {
        let said = stochc(&format!("simulate tests/fixtures/tower.sa {more}"));
        assert_eq!(said.status, 2, "{more}");
        assert!(said.err.contains(told), "{}", said.err);
    }
    watched.kill();
}

#[test]
fn a_port_behind_a_blank_is_told_from_a_program() {
    let said = stochc("simulate tests/fixtures/still.sa --watch 8081");
    assert_eq!((said.status, said.out.as_str()), (2, ""));
    assert_eq!(
        said.err,
        "error: there is no file `8081`; a port is said as `--watch=8081`\n"
    );
}
