//! Programs to explore, and ways to explore them.
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use stochc_compiler::{Checked, Limits, check};
use stochc_control::explore::{
    Exploration, ExplorationBounds, ExplorationReport, Faults, ProgramGoals,
};
use stochc_ir::table::Tables;

/// The root of the project.
pub const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The tables of the one assembly of a text.
pub fn tables(text: &str) -> Tables {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let mut checked = check("text.sa", &mut reader, Default::default());
    // Of a program that can wall itself in, too: some are here for that.
    let program = checked.programs.remove(0);
    (program.tables.or(program.stuck))
        .unwrap_or_else(|| panic!("{text}\n{:#?}", checked.diagnostics))
}

/// Checks a file of the project. Names of files start at its root.
pub fn checked(path: &str) -> Checked {
    let mut reader = |path: &str| std::fs::read(format!("{ROOT}/{path}"));
    check(path, &mut reader, Limits::default())
}

/// The tables of all assemblies in a file.
pub fn tables_of(path: &str) -> Vec<Tables> {
    let checked = checked(path);
    assert!(!checked.has_errors(), "{path}");
    let programs = checked.programs.into_iter();
    programs.map(|program| program.tables.unwrap()).collect()
}

/// Explores tables with the default bounds and without faults.
pub fn explore(tables: &Tables) -> ExplorationReport {
    stochc_control::explore::explore(tables, &ExplorationBounds::default(), &Faults::default())
}

/// Random programs that are the same in every run of the test, for sums over all of them.
pub fn fixed_cases(number: u32) -> TestRunner {
    let random = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    TestRunner::new_with_rng(Config::with_cases(number), random)
}

/// Explores tables, after something about the exploration has been changed.
pub fn explore_as(tables: &Tables, change: impl Fn(&mut Exploration)) -> ExplorationReport {
    let expected = ProgramGoals::new(tables);
    let (bounds, faults) = (ExplorationBounds::default(), Faults::default());
    let mut exploration = Exploration::new(tables, &expected, bounds, faults);
    change(&mut exploration);
    exploration.run()
}

/// One phase that uses everything: releases, names and cells that are taken again, `after`.
pub const BUSY: &str = "
assembly busy {
    seed plate 5 x 1 { A at (0, 0)  B at (2, 0)  C at (4, 0) }
    phase first { A.up -> P.up -> X  B.up -> Q }
    phase second {
        release X after Z
        C.up -> Z
        B.up -> Q2 after release Q
        release Q after Z
        Q2.up -> X after release X
        X.east -> Y after Z
        P.up -> W.up -> U
        W.west -> V
    }
}";
