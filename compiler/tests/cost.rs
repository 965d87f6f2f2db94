//! What the compiler says of a program's effort from its geometry.
use stochc_compiler::cost::{Cost, estimate};
use stochc_compiler::{Program, check};

fn program(text: &str) -> (Program, Cost, Vec<String>) {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    let mut checked = check("test.sa", &mut reader, Default::default());
    assert!(!checked.has_errors(), "{:#?}", checked.diagnostics);
    let program = checked.programs.remove(0);
    let cost = estimate(&program).unwrap();
    let order = (cost.captures.iter())
        .map(|capture| program.plan.describe(capture.event, &checked.symbols))
        .collect();
    (program, cost, order)
}

#[test]
fn the_most_enclosed_cell_comes_first() {
    let (_, cost, order) = program(include_str!("../../examples/five_tower.sa"));
    assert_eq!(order[..2], ["M.up -> N", "N.up -> O"]);
    assert!(cost.captures.is_sorted_by(|a, b| a.exposure <= b.exposure));
    let orders = cost.phases.iter().map(|phase| (phase.depth, phase.width));
    assert!(orders.eq([(2, 4), (2, 1)]));
}

#[test]
fn equal_cells_keep_the_order_of_the_source() {
    let text = "assembly a { seed plate 21 x 21 { A at (0, 0) B at (20, 0) C at (0, 20) D at (20, 20) } \
                phase p { C.up -> G B.up -> F after G D.up -> H A.up -> E } }";
    let (_, cost, order) = program(text);
    assert_eq!(order, ["C.up -> G", "B.up -> F", "D.up -> H", "A.up -> E"]);
    assert_eq!((cost.phases[0].depth, cost.phases[0].width), (2, 3));
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
