//! Tests that errors in event tables are detected before the tables are written.
use stochc::compiler::diagnostic::Code;
use stochc_control::explore::Property;

use crate::mutations::{explore_twice, mutants};

/// Checks each possible error of the compiler. If an event is missing in all tables, only a
/// comparison with the graph detects it.
#[test]
fn internal_errors_never_reach_users() {
    let mut checked = stochc::check("examples/five_tower_reconfigured.sa");
    assert!(!checked.has_errors());
    let right = checked.programs[0].tables.clone().unwrap();
    let mut count = 0;
    for (mistake, mutant) in mutants(&right) {
        let [report, _] = explore_twice(&mutant, &right);
        let Some(found) = report.violation() else {
            continue;
        };
        // The tables alone determine which block reports, so the phase may still end correctly.
        if found.property == Property::ReportsOnce {
            continue;
        }
        checked.diagnostics.clear();
        checked.programs[0].tables = Some(mutant);
        stochc::compiler::model_check::try_out(&mut checked);
        let [diagnostic] = &checked.diagnostics[..] else {
            panic!("{mistake}: {:?}", checked.diagnostics);
        };
        assert_eq!(diagnostic.code, Code::InternalError, "{mistake}");
        assert!(checked.programs[0].tables.is_none(), "{mistake}");
        let steps = diagnostic.help.as_ref().unwrap().lines().count() - 1;
        assert!(steps <= found.trace.len(), "{mistake}: {diagnostic:#?}");
        count += 1;
    }
    assert!(count > 40, "{count}");
}
