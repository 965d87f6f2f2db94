//! Event tables in every order of events.
use stochc::compiler::table::Tables;
use stochc::runtime::explore::{Bounds, Expected, Exploration, Report, Verdict, explore};

fn tables_of(path: &str) -> Vec<Tables> {
    let checked = stochc::check(path);
    assert!(!checked.has_errors(), "{path}");
    let programs = checked.programs.into_iter();
    programs.map(|program| program.tables.unwrap()).collect()
}

fn in_full(tables: &Tables, bounds: &Bounds) -> Report {
    let expected = Expected::of(tables);
    let mut exploration = Exploration::new(tables, &expected, bounds);
    exploration.reduce = false;
    exploration.run()
}

#[test]
fn every_example_holds_in_every_order() {
    let examples = std::fs::read_dir("examples").unwrap();
    let mut count = 0;
    for path in examples.map(|entry| entry.unwrap().path()) {
        for tables in tables_of(path.to_str().unwrap()) {
            let report = explore(&tables, &Bounds::default());
            assert_eq!(report.verdict, Verdict::Holds, "{}", path.display());
            count += 1;
        }
    }
    assert!(count >= 5);
}

#[test]
fn fewer_orders_are_enough_for_the_five_towers() {
    let [tables] = &tables_of("examples/five_tower.sa")[..] else {
        panic!("one assembly");
    };
    let full = in_full(tables, &Bounds::default());
    let reduced = explore(tables, &Bounds::default());
    assert_eq!(
        (full.verdict, reduced.verdict),
        (Verdict::Holds, Verdict::Holds)
    );
    // Four towers, each in one of five states (waiting for either block, a report with two hops to
    // make, one, none), then one that passes through five such states, and the end.
    assert_eq!(full.states, 5_u64.pow(4) + 5 + 1);
    assert!(reduced.states < 30, "{}", reduced.states);
}
