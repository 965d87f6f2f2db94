//! Resumes a run from arbitrary bytes. The run must either continue for some ticks or be rejected.
//!
//! The first byte selects the model and the kind of input: a file, a state, or values. A value has
//! a length of two bytes in the input, and of eight bytes in the state.
use std::io::{Cursor, Read};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::LazyLock;

use stochc_files::checksum::{crc32, sealed};
use stochc_ir::Executable;
use stochc_ir::table::PhaseId;
use stochc_results::CHECKPOINTS;
use stochc_results::integrity::verify;
use stochc_runtime::{Model, Settings, Watch};

/// Number of ticks that a resumed run continues for.
const TICKS: u32 = 20;

static PROGRAM: LazyLock<Executable> = LazyLock::new(super::program);

static PLACE: LazyLock<(tempfile::TempDir, PathBuf)> = LazyLock::new(|| {
    let (folder, _) = super::folder();
    let file = folder.path().join(CHECKPOINTS).join("0-0.state");
    std::fs::create_dir(folder.path().join(CHECKPOINTS)).expect("it can be made");
    (folder, file)
});

/// Watch that supplies the state to resume from.
struct Resumed {
    state: Option<Vec<u8>>,
    left: u32,
}

impl Watch for Resumed {
    fn tick(&mut self, _: u64, _: PhaseId) -> ControlFlow<()> {
        match self.left.checked_sub(1) {
            None => ControlFlow::Break(()),
            Some(left) => {
                self.left = left;
                ControlFlow::Continue(())
            }
        }
    }

    fn saved(&mut self) -> Option<Box<dyn Read>> {
        let state = self.state.take()?;
        Some(Box::new(Cursor::new(state)))
    }
}

/// Returns a checkpoint file: a header line and the state, with their checksums.
fn whole(bytes: &[u8]) -> Vec<u8> {
    let mut parts = bytes.splitn(2, |byte| *byte == b'\n');
    let line = String::from_utf8_lossy(parts.next().unwrap_or_default()).into_owned();
    let line = if line.ends_with('}') {
        sealed(line)
    } else {
        line
    };
    let file = [line.as_bytes(), b"\n", parts.next().unwrap_or_default()].concat();
    [&file[..], &crc32(&file).to_le_bytes()].concat()
}

/// Returns a state with the values in the input, each after its length.
fn values(mut bytes: &[u8]) -> Vec<u8> {
    let mut state = Vec::new();
    while let [low, high, rest @ ..] = bytes {
        let length = usize::from(u16::from_le_bytes([*low, *high])).min(rest.len());
        let (value, behind) = rest.split_at(length);
        state.extend((length as u64).to_le_bytes());
        state.extend(value);
        bytes = behind;
    }
    state
}

/// Resumes a run from an input. Panics if the result is wrong.
pub fn read(bytes: &[u8]) {
    let Some((how, bytes)) = bytes.split_first() else {
        return;
    };
    let state = match how % 4 {
        0 | 1 => {
            let file = match how % 4 {
                0 => bytes.to_vec(),
                _ => whole(bytes),
            };
            let (folder, path) = &*PLACE;
            std::fs::write(path, file).expect("it can be written");
            let files = verify(folder.path()).expect("there is a manifest");
            assert!(files.iter().any(|file| file.name.ends_with(".state")));
            return;
        }
        2 => bytes.to_vec(),
        _ => values(bytes),
    };
    let model = match how / 4 % 2 {
        0 => Model::Shuffle,
        _ => Model::Rigid,
    };
    let settings = Settings::new(model, 1).resolved();
    let mut watch = Resumed {
        state: Some(state),
        left: TICKS,
    };
    // In production, such a run is restarted, as after an error.
    let run = || stochc_runtime::run(&PROGRAM.tables, &PROGRAM.scene, &settings, 1, 0, &mut watch);
    let _ = catch_unwind(AssertUnwindSafe(run));
}
