//! What the compiler expects a program to cost.
use stochc_compiler::cost::{Cost, estimate};
use stochc_compiler::{Program, check};

fn program(text: &str) -> (Program, Cost, Vec<String>) {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let mut checked = check("test.sa", &mut reader, Default::default());
    assert!(!checked.has_errors(), "{:#?}", checked.findings);
    let program = checked.programs.remove(0);
    let cost = estimate(&program).unwrap();
    let ranked = (cost.captures.iter())
        .map(|capture| program.plan.describe(capture.event, &checked.symbols))
        .collect();
    (program, cost, ranked)
}

#[test]
fn the_middle_tower_is_the_bottleneck_of_the_five() {
    let (_, cost, ranked) = program(include_str!("../../examples/five_tower.sa"));
    assert_eq!(ranked[..2], ["M.up -> N", "N.up -> O"]);
    assert!(cost.phases[1].share > 0.5, "{cost:?}");
    assert_eq!((cost.phases[0].depth, cost.phases[0].width), (2, 4));
    assert_eq!((cost.phases[1].depth, cost.phases[1].width), (2, 1));
}

#[test]
fn waits_side_by_side_hide_each_other() {
    let text = |body: &str| {
        format!(
            "assembly a {{ seed plate 21 x 21 {{ A at (0, 0) B at (20, 0) C at (0, 20) D at (20, 20) }} {body} }}"
        )
    };
    // Equal waits: one takes 1, two side by side 1 + 1/2, four 1 + 1/2 + 1/3 + 1/4.
    let one = program(&text("phase p { A.up -> E }")).1.time;
    for (count, sum) in [(2, 1.5), (4, 25.0 / 12.0)] {
        let captures = ["A.up -> E ", "B.up -> F ", "C.up -> G ", "D.up -> H "][..count].concat();
        let (_, cost, _) = program(&text(&format!("phase p {{ {captures} }}")));
        assert!(
            (cost.time / one / sum - 1.0).abs() < 0.05,
            "{count}: {}",
            cost.time / one
        );
        let shares: f64 = cost.captures.iter().map(|capture| capture.share).sum();
        assert!((shares - 1.0).abs() < 1e-9);
    }
    // One after the other they add up, whether a chain or phases say so.
    for body in [
        "phase p { A.up -> E B.up -> F after E }",
        "phase p { A.up -> E } phase q { B.up -> F }",
    ] {
        let time = program(&text(body)).1.time;
        assert!((time / one - 2.0).abs() < 1e-9, "{body}: {}", time / one);
    }
}

#[test]
fn released_blocks_are_not_in_the_way() {
    let body = |end: &str| {
        format!(
            "assembly a {{ seed plate 3 x 1 {{ A at (0, 0) M at (1, 0) B at (2, 0) }}
             phase p {{ A.up -> E B.up -> F }} {end} }}"
        )
    };
    let exposure = |end: &str| {
        let (program, cost, _) = program(&body(end));
        let last = program.plan.events.len() as u32 - 1;
        cost.captures
            .iter()
            .find(|capture| capture.event.0 == last)
            .unwrap()
            .exposure
    };
    let between = exposure("phase q { M.up -> N }");
    let alone = exposure("phase q { release E, F } phase r { M.up -> N }");
    let told = exposure("phase q { release E release F M.up -> N after release E, release F }");
    assert!(between < alone - 0.1, "{between} {alone}");
    assert_eq!(alone, told);
}
