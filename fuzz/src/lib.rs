//! What the targets for files do with an input, and the program that it is about. An ordinary test does the same with the corpus.
pub mod executable;
pub mod journal;
pub mod manifest;
pub mod recording;

use stochc_compiler::{Limits, Program, check};
use stochc_ensemble::Manifest;
use stochc_ir::Executable;
use stochc_runtime::Settings;

/// Two phases, a release, and few blocks.
const PROGRAM: &str = "scene s from hemisphere { free 4 uniform }
assembly a in s { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } phase q { release A } }";

/// The program, compiled.
fn program() -> Executable {
    let mut reader = |_: &str| Ok(PROGRAM.as_bytes().to_vec());
    let checked = check("a.sa", &mut reader, Limits::default());
    let mut programs = checked.programs.into_iter();
    let executable = programs.find_map(Program::into_executable);
    executable.expect("the program is right")
}

/// An ensemble of it.
fn ensemble() -> Manifest {
    let program = stochc_ensemble::Program::new("a", Vec::new(), program());
    let settings = Settings {
        max_ticks: Some(1000),
        ..Settings::default()
    };
    Manifest::new(settings.resolved(), 1, 3, vec![program])
}
