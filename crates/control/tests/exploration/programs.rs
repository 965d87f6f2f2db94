//! Programs to explore, and helpers to explore them.
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use stochc_compiler::{Checked, Limits, check};
use stochc_control::explore::{
    Exploration, ExplorationBounds, ExplorationReport, Faults, ProgramGoals,
};
use stochc_ir::table::Tables;

/// Root of the project.
pub const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Returns the tables of the only assembly of a text.
pub fn tables(text: &str) -> Tables {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let mut checked = check("text.sa", &mut reader, Default::default());
    // Tables of programs that can enclose cells are accepted, because some tests need them.
    let program = checked.programs.remove(0);
    (program.tables.or(program.stuck))
        .unwrap_or_else(|| panic!("{text}\n{:#?}", checked.diagnostics))
}

/// Checks a file of the project. Paths start at the root.
pub fn checked(path: &str) -> Checked {
    let mut reader = |path: &str| std::fs::read(format!("{ROOT}/{path}"));
    check(path, &mut reader, Limits::default())
}

/// Returns the tables of all assemblies in a file.
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

/// Returns a runner with the same random programs in every test run, for sums over all of them.
pub fn fixed_cases(number: u32) -> TestRunner {
    let random = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    TestRunner::new_with_rng(Config::with_cases(number), random)
}

/// Explores tables with a changed exploration.
pub fn explore_as(tables: &Tables, change: impl Fn(&mut Exploration)) -> ExplorationReport {
    let expected = ProgramGoals::new(tables);
    let (bounds, faults) = (ExplorationBounds::default(), Faults::default());
    let mut exploration = Exploration::new(tables, &expected, bounds, faults);
    change(&mut exploration);
    exploration.run()
}

/// Program with one phase that uses everything: releases, reused names and cells, `after`.
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
