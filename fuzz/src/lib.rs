//! Fuzz targets, and the program that their input files belong to. An ordinary test runs the
//! targets on the corpus.
pub mod check;
pub mod checkpoint;
pub mod executable;
pub mod journal;
pub mod manifest;
pub mod parse;
pub mod recording;
pub mod voxels;

use std::path::PathBuf;

use stochc_compiler::{Limits, Program, check};
use stochc_ir::Executable;
use stochc_results::Manifest;
use stochc_runtime::Settings;

/// Source of a program with two phases, a release, and few blocks.
const PROGRAM: &str = "scene s from hemisphere { free 4 uniform }
assembly a in s { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } phase q { release A } }";

/// Returns the compiled program.
fn program() -> Executable {
    let mut reader = |_: &str| Ok(PROGRAM.as_bytes().to_vec());
    let checked = check("a.sa", &mut reader, Limits::default());
    let mut programs = checked.programs.into_iter();
    let executable = programs.find_map(Program::into_executable);
    executable.expect("the program is right")
}

/// Returns an ensemble of the program.
fn ensemble() -> Manifest {
    let program = stochc_results::EnsembleProgram::new("a", Vec::new(), program());
    let settings = Settings {
        max_ticks: Some(1000),
        ..Settings::default()
    };
    Manifest::new(settings.resolved(), 1, 3, vec![program])
}

/// Returns an empty folder for results, in memory if possible, and the identity of the ensemble.
fn folder() -> (tempfile::TempDir, String) {
    let memory = PathBuf::from("/dev/shm");
    let above = if memory.is_dir() {
        memory
    } else {
        std::env::temp_dir()
    };
    let folder = tempfile::tempdir_in(above).expect("a folder can be made");
    let manifest = ensemble();
    std::fs::write(folder.path().join("manifest.json"), manifest.to_json())
        .expect("it can be written");
    (folder, manifest.identity())
}
