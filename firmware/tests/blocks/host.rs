//! The interpreter in C, in a process of its own.
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::OnceLock;

use stochc_firmware::Image;

/// Folder of the crate.
pub const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Event of the interpreters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostEvent {
    /// A face was switched on.
    Opened { unit: u32, face: u8 },
    /// A face has released its block.
    Closed { unit: u32, face: u8 },
    /// An empty face was switched off.
    Emptied { unit: u32, face: u8 },
    /// The plate has begun a phase.
    Phase(u32),
    /// The plate has aborted the phase.
    Abort,
    /// The plate has begun the aborted phase again.
    Retry,
    /// A timeout has ended the program.
    TimedOut,
    /// The time of the following events \[ticks\].
    Time(u32),
    /// The state with this hash was stored.
    Stored(u64),
    /// Bytes wait at a face.
    HasBytes { unit: u32, face: u8 },
    /// A block waits for an acknowledgement of a frame that is not in transit.
    CanRepeat(u32),
    /// A block or the plate may wait for a time.
    HasTimes(u32),
}

/// State of a block with a role.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockState {
    pub unit: u32,
    pub role: u32,
    pub phase: u32,
    pub directions: Vec<u8>,
    /// States of the faces, with the numbers of `block.h`.
    pub faces: Vec<u8>,
}

/// All blocks of a structure, as a process.
pub struct Host {
    process: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

/// Settings of a structure.
#[derive(Clone, Copy, Debug)]
pub struct Channel {
    /// Lost or changed bytes, per 1,000.
    pub loss: u32,
    /// Random bytes, per 1,000 calls.
    pub noise: u32,
    pub seed: u64,
}

/// Compiles the host once, with sanitizers. Returns its path.
fn compiled() -> &'static Path {
    static HOST: OnceLock<PathBuf> = OnceLock::new();
    let sanitizers = [
        "-O1",
        "-fsanitize=address,undefined",
        "-fno-sanitize-recover=all",
    ];
    HOST.get_or_init(|| compile("blocks", &sanitizers))
}

fn compile(name: &str, options: &[&str]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("stochc-{name}-{}", std::process::id()));
    let sources = ["tests/host/host.c", "block.c", "plate.c"];
    let status = Command::new("cc")
        .current_dir(ROOT)
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror"])
        .args(options)
        .args(["-Itests/host", "-I.", "-o"])
        .arg(&path)
        .args(sources)
        .status();
    assert!(status.expect("a C compiler").success());
    path
}

impl Host {
    pub fn new() -> Host {
        Host::started(compiled())
    }

    /// Returns a host with small buffers, whose state is stored often.
    pub fn small() -> Host {
        static SMALL: OnceLock<PathBuf> = OnceLock::new();
        let path = SMALL.get_or_init(|| compile("blocks-small", &["-O2", "-DSMALL"]));
        Host::started(path)
    }

    fn started(path: &Path) -> Host {
        let mut process = Command::new(path)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the host starts");
        let input = process.stdin.take().expect("an input");
        let output = BufReader::new(process.stdout.take().expect("an output"));
        Host {
            process,
            input,
            output,
        }
    }

    fn lines(&mut self, command: &str) -> Vec<String> {
        writeln!(self.input, "{command}").expect("the host reads");
        self.input.flush().expect("the host reads");
        let mut lines = Vec::new();
        // Each command ends with a line of its own.
        for _ in command.lines() {
            loop {
                let mut line = String::new();
                let read = self.output.read_line(&mut line).expect("the host writes");
                assert!(read > 0, "the host has ended");
                match line.trim_end() {
                    "." => break,
                    line => lines.push(line.to_owned()),
                }
            }
        }
        lines
    }

    /// Carries out commands, one per line, and returns the events.
    pub fn events(&mut self, command: &str) -> Vec<HostEvent> {
        let lines = self.lines(command);
        let parsed = lines.iter().map(|line| {
            let words: Vec<&str> = line.split(' ').collect();
            let number = |i: usize| words[i].parse::<u32>().expect("a number");
            let face = || number(2) as u8;
            match words[0] {
                "O" => HostEvent::Opened {
                    unit: number(1),
                    face: face(),
                },
                "C" => HostEvent::Closed {
                    unit: number(1),
                    face: face(),
                },
                "F" => HostEvent::Emptied {
                    unit: number(1),
                    face: face(),
                },
                "P" => HostEvent::Phase(number(1)),
                "A" => HostEvent::Abort,
                "Y" => HostEvent::Retry,
                "E" => HostEvent::TimedOut,
                "@" => HostEvent::Time(number(1)),
                "H" => HostEvent::Stored(words[1].parse().expect("a number")),
                "N" => HostEvent::HasBytes {
                    unit: number(1),
                    face: face(),
                },
                "I" => HostEvent::CanRepeat(number(1)),
                "V" => HostEvent::HasTimes(number(1)),
                _ => panic!("{line}"),
            }
        });
        parsed.collect()
    }

    pub fn load(&mut self, image: &Image, units: usize, channel: Channel) {
        let Channel { loss, noise, seed } = channel;
        let hex: String = image.bytes.iter().map(|b| format!("{b:02x}")).collect();
        let (seeds, length) = (image.sizes.seeds, image.bytes.len());
        let command = format!("L {seeds} {units} {loss} {noise} {seed} {length} {hex}");
        assert!(
            self.lines(&command)
                .iter()
                .all(|line| line.starts_with('O'))
        );
    }

    pub fn states(&mut self) -> Vec<BlockState> {
        let lines = self.lines("S");
        let parsed = lines.iter().map(|line| {
            let numbers: Vec<u32> = line[2..].split(' ').map(|n| n.parse().unwrap()).collect();
            let bytes = |range: std::ops::Range<usize>| numbers[range].iter().map(|&n| n as u8);
            BlockState {
                unit: numbers[0],
                role: numbers[1],
                phase: numbers[2],
                directions: bytes(3..9).collect(),
                faces: bytes(9..15).collect(),
            }
        });
        parsed.collect()
    }

    /// Returns the largest numbers of waiting notifications: at a block and at a seed.
    pub fn waiting(&mut self) -> (usize, usize) {
        let lines = self.lines("W");
        let mut numbers = lines[0][2..].split(' ').map(|n| n.parse().unwrap());
        (numbers.next().unwrap(), numbers.next().unwrap())
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
