//! Tests the cancellation of checks.
use std::cell::Cell;

use stochc_compiler::{Cancellation, Cancelled, Limits, check_cancellable};

/// Checks a text and cancels after `most` queries. Returns the number of queries, and the number of
/// events or the cancellation.
fn polled(text: &str, most: u64) -> (u64, Result<usize, Cancelled>) {
    let count = Cell::new(0);
    let ask = || {
        count.set(count.get() + 1);
        count.get() > most
    };
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let cancellation = Cancellation::new(&ask);
    let checked = check_cancellable("a.sa", &mut reader, Limits::default(), cancellation);
    let events = checked.map(|checked| {
        let plans = checked.programs.iter().map(|program| &program.plan);
        plans.map(|plan| plan.events.len()).sum()
    });
    (count.get(), events)
}

fn assembly(plate: &str, body: &str) -> String {
    format!("assembly a in magnet_tank {{\n    seed plate {plate} }}\n{body}\n}}\n")
}

/// Returns programs that together exercise every stage.
fn programs() -> Vec<String> {
    let row = |n| {
        assembly(
            "1 x 1 { M at (0, 0)",
            &format!("phase p {{ M.up ->> T[1..{n}] }}"),
        )
    };
    // A room that is closed from above, so that access paths are searched and a fix is tried.
    let room = assembly(
        "5 x 5 { for i in 0..4 { for j in 0..4 { S[i, j] at (i, j) } }",
        "phase p { for i in 0..4 { for j in 0..4 { S[i, j].up -> A[i, j] } }
                   for i in 0..4 { for j in 0..4 { A[i, j].up -> B[i, j] } } }",
    );
    let slips = "let unusd = 1\n".to_owned() + &row(3).replace("M.up", "N.up");
    let shape = row(4).replace("phase p {", "phase p { yields s ") + "shape s { layer 1..4 { # } }";
    vec![row(300), room, slips, shape]
}

#[test]
fn a_check_polls_once_per_event_in_every_stage() {
    let row = &programs()[0];
    let (count, events) = polled(row, u64::MAX);
    assert_eq!(events, Ok(300));
    // Five stages: expansion, names, cells, order, tables.
    assert!(count > 300 * 5, "{count}");
}

#[test]
fn a_check_ends_when_it_is_cancelled() {
    for text in programs() {
        let (all, result) = polled(&text, u64::MAX);
        assert!(result.is_ok());
        for most in (0..all).step_by((all / 100).max(1) as usize) {
            let (count, result) = polled(&text, most);
            assert_eq!(result, Err(Cancelled), "after {most} of {all}: {text}");
            // Each level of the call stack queries once more before it returns.
            assert!(count <= most + 10, "{count} after {most}: {text}");
        }
        assert_eq!(polled(&text, all).1, result);
    }
}
