//! Tests estimates of completion times.
use stochc_compiler::Program;
use stochc_compiler::diagnostic::Code;
use stochc_estimate::{Cost, Interaction, Rates};

use crate::checked;

fn program(text: &str) -> (Program, Cost, Vec<String>) {
    let mut checked = checked(text);
    assert!(!checked.has_errors(), "{:#?}", checked.diagnostics);
    let program = checked.programs.remove(0);
    let rates = program.scene.as_ref().and_then(Rates::built_in);
    let cost = program.estimate(rates).unwrap();
    let order = (cost.captures.iter())
        .map(|capture| program.plan.describe(capture.event, &checked.symbols))
        .collect();
    (program, cost, order)
}

fn mean(text: &str) -> f64 {
    program(text)
        .1
        .total
        .expect("the default scene has rates")
        .mean
        .expect("it has no timeout")
}

#[test]
fn critical_captures_are_sorted_by_share() {
    let (_, cost, order) = program(include_str!("../../../examples/five_tower.sa"));
    assert_eq!(order[..2], ["M.up -> N", "N.up -> O"]);
    assert!(cost.captures.is_sorted_by(|a, b| a.share >= b.share));
    let sum: f64 = cost.captures.iter().map(|capture| capture.share).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    let orders = cost.phases.iter().map(|phase| (phase.depth, phase.width));
    assert!(orders.eq([(2, 4), (2, 1)]));
    let (all, phases) = (
        cost.total.unwrap(),
        cost.phases.iter().map(|it| it.times.unwrap().mean.unwrap()),
    );
    assert!((phases.sum::<f64>() - all.mean.unwrap()).abs() < 1e-6);
    assert!(all.p10 < all.median && all.median < all.p90);
}

#[test]
fn a_chain_takes_the_sum_of_its_waits() {
    let (_, cost, _) = program(include_str!("../../../examples/line.sa"));
    let sum: f64 = cost.captures.iter().map(|capture| capture.wait).sum();
    let total = cost.total.unwrap();
    let (mean, half_width) = (total.mean.unwrap(), total.half_width.unwrap());
    assert!(
        (mean - sum).abs() < half_width,
        "{mean} ± {half_width}, {sum}"
    );
}

#[test]
fn released_blocks_count_for_earlier_statements_too() {
    let [first, last] = ["release B A.west -> C", "A.west -> C release B"].map(|lines| {
        mean(&format!(
            "assembly one {{ seed plate 3 x 1 {{ S at (1, 0) }}
                phase hold {{ S.up -> A.north -> B }}
                phase turn {{ {lines} }} }}"
        ))
    });
    assert_eq!(first, last);
}

#[test]
fn the_waiting_time_includes_blocks_released_nearby() {
    let (_, cost, order) = program(
        "assembly chain { seed plate 3 x 1 { S at (1, 0) }
            phase hold { S.up -> A.east -> B }
            phase on { release B A.up -> C.east -> D.down -> B }
            allow tight-approach \"the last cell\" }",
    );
    let sum: f64 = cost.captures.iter().map(|capture| capture.wait).sum();
    let total = cost.total.unwrap();
    assert!(
        (sum - total.mean.unwrap()).abs() < 2.0 * total.half_width.unwrap(),
        "{sum} {total:?}"
    );
    let near = order.iter().position(|it| it == "A.up -> C").unwrap();
    assert!(
        cost.captures[near].wait < 350.0,
        "{:?}",
        cost.captures[near]
    );
}

#[test]
fn the_last_of_adjacent_captures_decides() {
    let alone = mean("assembly a { seed plate 21 x 1 { A at (0, 0) } phase p { A.up -> E } }");
    let four = mean(
        "assembly a { seed plate 21 x 21 { A at (0, 0) B at (20, 0) C at (0, 20) D at (20, 20) } \
         phase p { A.up -> E B.up -> F C.up -> G D.up -> H } }",
    );
    // The last of four exponential waits takes 1 + 1/2 + 1/3 + 1/4 of one. Docking times reduce
    // this.
    assert!(four > 1.5 * alone && four < 2.09 * alone, "{four} {alone}");
}

#[test]
fn a_block_released_above_the_open_face_docks_there_at_once() {
    let body = |end: &str| {
        mean(&format!(
            "assembly a {{ seed plate 3 x 1 {{ A at (0, 0) B at (1, 0) }}
             phase p {{ A.up ->> T[1..2] T[2].east -> E }} {end} }}"
        ))
    };
    let before = body("");
    let dropped = body("phase q { release E B.up -> F after release E }") - before;
    let awaited = body("phase q { B.up -> F }") - before;
    assert!(dropped < 0.9 * awaited, "{dropped} {awaited}");
}

#[test]
fn without_enough_blocks_there_are_no_times() {
    let mut checked = checked(include_str!("../../../examples/line.sa"));
    let mut program = checked.programs.remove(0);
    let scene = program.scene.as_mut().unwrap();
    let rates = Rates::built_in(scene);
    scene.free.count = 5;
    let cost = program.estimate(rates).unwrap();
    assert!(rates.is_some());
    assert_eq!((cost.total, cost.captures.len()), (None, 0));
    assert!(cost.phases.iter().all(|phase| phase.times.is_none()));
}

#[test]
fn without_rates_there_are_no_times() {
    let text = include_str!("../../../examples/line.sa")
        .replace("assembly line", "assembly line in hemisphere_soft");
    let (_, cost, order) = program(&text);
    assert!(cost.total.is_none() && order.is_empty());
    assert_eq!((cost.phases[0].depth, cost.phases[0].width), (13, 1));
}

#[test]
fn a_phase_that_reaches_its_timeout_is_incomplete() {
    let cost = |timeout: u32| {
        let text = format!(
            "assembly a {{ seed plate 21 x 1 {{ A at (0, 0) }} phase p timeout {timeout} ticks {{ A.up -> E }} }}"
        );
        program(&text).1
    };
    let (often, seldom) = (cost(1000), cost(100));
    let complete = often.draws.iter().filter(|draw| draw.is_complete).count();
    assert!(complete > often.draws.len() / 2 && complete < often.draws.len());
    assert!(often.draws.iter().all(|draw| draw.ticks <= 1000.0));
    // A timeout stops slow runs and does not change the others.
    let (total, patient) = (often.total.unwrap(), cost(1_000_000).total.unwrap());
    for (with, without) in [(total.p10, patient.p10), (total.median, patient.median)] {
        let [with, without] = [with, without].map(Option::unwrap);
        assert!((with / without - 1.0).abs() < 0.08, "{with} {without}");
    }
    assert_eq!((total.mean, total.p90), (None, None));
    assert!(patient.mean.is_some() && patient.p90.is_some());
    // Fewer than one run in ten completes.
    assert_eq!((seldom.total, seldom.phases[0].times), (None, None));
}

#[test]
fn neglected_parts_of_a_sum_are_bounded() {
    let interaction = |text: &str| program(text).1.interaction;
    let beside = |other: &str| {
        format!(
            "assembly a {{ seed plate 9 x 1 {{ A at (1, 0) B at ({other}, 0) }}
             phase p {{ A.up ->> S[1..3] B.up ->> T[1..3] }} }}"
        )
    };
    assert_eq!(interaction(&beside("3")), Interaction::Apart);
    assert_eq!(interaction(&beside("2")), Interaction::Racing);
    // One column follows the other, so no second face is open next to a waiting one.
    let serial = "assembly a { seed plate 9 x 1 { A at (1, 0) B at (2, 0) }
        phase p { A.up ->> S[1..3] } phase q { B.up ->> T[1..3] } }";
    assert_eq!(interaction(serial), Interaction::Apart);
    let released = "assembly a { seed plate 9 x 1 { A at (1, 0) } phase p { A.up -> S } phase q { release S } }";
    assert_eq!(interaction(released), Interaction::Releases);
}

#[test]
fn a_capture_may_decide_the_time_to_a_timeout() {
    let (_, cost, _) = program(
        "assembly one { seed plate 3 x 1 { A at (0, 0) } phase half timeout 900 ticks { A.up -> B } }",
    );
    let stopped = cost.draws.iter().filter(|draw| !draw.is_complete).count();
    assert!(stopped > 0);
    assert_eq!(cost.captures.len(), 1);
    let share = cost.captures[0].share;
    assert!((share - 1.0).abs() < 1e-9, "{share}");
}

/// Tests two towers of three. The last one's top reports. A message crosses the plate to its foot,
/// and requests release blocks.
#[test]
fn messages_take_time_per_hop() {
    let mean = |messages: &str, body: &str| {
        let (_, cost, _) = program(&format!(
            "scene slow from hemisphere {{ {messages} }}
            assembly a in slow {{ seed plate 9 x 1 {{ A at (0, 0) B at (8, 0) }} {body} }}"
        ));
        cost.total.unwrap().mean.unwrap()
    };
    let tower = "phase p { A.up ->> T[1..3] }";
    let notified = "phase p { A.up ->> T[1..3] B.up ->> U[1..3] after T[3] }";
    let known = "phase p { A.up ->> T[1..3] T[1].north -> E after T[3] }";
    let released = "phase p { A.up ->> T[1..3] } phase q { release T[3] }";
    let others =
        "phase p { A.up ->> T[1..3] } phase q { release T[3] B.up -> U after release T[3] }";
    for (body, hops) in [
        (tower, 3.0),
        (notified, 3.0 + 3.0),
        (known, 2.0 + 2.0),
        (released, 3.0 + 1.0 + 2.0),
        (others, 3.0 + 1.0 + 2.0 + 1.0),
    ] {
        let none = mean("", body);
        assert_eq!(mean("messages { hop 0 ticks }", body), none);
        // A random deviation of the sums stays below one hop.
        let off = mean("messages { hop 10000 ticks }", body) - none;
        assert!(
            (off / 10000.0 - hops).abs() < 0.05,
            "{body}: {off}, not {hops}"
        );
        // Half of all transfers are lost and repeated after 2 h + 1 ticks. Each hop costs one such
        // repetition on average, with a standard deviation of 0.94. If adjacent branches end
        // together, the later report counts. `tests/library/estimate.rs` runs such programs.
        let lost = (mean("messages { hop 10000 ticks loss 50% }", body) - none) / 30001.0;
        let chance = 4.0 * 0.94 * (hops / 4000_f64).sqrt();
        let is_alone = [tower, released].contains(&body);
        assert!(lost > hops - chance, "{body}: {lost}");
        assert!(!is_alone || lost < hops + chance, "{body}: {lost}");
    }
}

/// Jams make an estimate a lower bound, even if they are allowed.
#[test]
fn a_program_that_may_jam_has_a_lower_bound() {
    let reasons = |text: &str| {
        let (_, cost, _) = program(text);
        serde_json::to_value(cost.lower_bound).expect("it is a list")
    };
    let five_tower = include_str!("../../../examples/five_tower.sa");
    let allowed = five_tower.replacen(
        "assembly",
        "allow tight-approach \"as in the paper\"\nassembly",
        1,
    );
    assert_eq!(reasons(five_tower), serde_json::json!(["tight-approach"]));
    assert_eq!(reasons(&allowed), serde_json::json!(["tight-approach"]));
    let square = "assembly a { seed plate 2 x 2 { A at (0, 0) B at (1, 0) C at (0, 1) }
        phase p { A.up -> D  B.up -> E  C.up -> F } }";
    assert_eq!(reasons(square), serde_json::json!(["crowded-captures"]));
    // Each row has five towers of two blocks.
    let towers = |rows: u32| {
        let last = rows - 1;
        format!(
            "assembly a {{ seed plate 13 x 13 {{
                for x in 0..4 {{ for y in 0..{last} {{ S[x, y] at (3 * x, 3 * y) }} }} }}
            phase p {{ for x in 0..4 {{ for y in 0..{last} {{ S[x, y].up -> A[x, y].up -> B[x, y] }} }} }} }}"
        )
    };
    assert_eq!(reasons(&towers(3)), serde_json::json!([]));
    assert_eq!(reasons(&towers(4)), serde_json::json!(["large-structure"]));
    assert_eq!(
        reasons(include_str!("../../../examples/line.sa")),
        serde_json::json!([])
    );
}

#[test]
fn warns_of_a_timeout_that_ends_most_runs() {
    let found = |timeout: &str| {
        let text = format!(
            "assembly a {{ seed plate 1 x 1 {{ M at (0, 0) }}
                phase first {{ M.up -> A }}
                phase last timeout {timeout} {{ A.up ->> T[1..2] }} }}"
        );
        checked(&text).diagnostics
    };
    assert!(found("4000 ticks").is_empty());
    for short in ["400 ticks", "8 s"] {
        let [warning] = &found(short)[..] else {
            panic!("one warning");
        };
        assert_eq!(warning.code, Code::ShortTimeout);
        assert!(warning.title.starts_with("phase `last` would time out in "));
        // The proposed timeout resolves the warning.
        let help = warning.help.as_deref().expect("it says what to write");
        let timeout = help.split('`').nth(1).expect("it is quoted");
        assert!(
            found(timeout.trim_start_matches("timeout ")).is_empty(),
            "{help}"
        );
    }
}
