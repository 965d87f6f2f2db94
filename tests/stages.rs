//! Every stage of every example, held in snapshots.
use stochc::compiler::emit::{graph_dot, graph_json, graph_text, table_json, table_text};

#[test]
fn examples_compile_as_before() {
    insta::glob!("../examples", "*.sa", |path| {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let text = std::fs::read(path).unwrap();
        let mut reader = |_: &str| Ok(text.clone());
        let shown = format!("examples/{name}.sa");
        let checked = stochc::compiler::check(&shown, &mut reader, Default::default());
        assert!(!checked.has_errors(), "{:?}", checked.findings);
        let symbols = &checked.symbols;
        let mut settings = insta::Settings::clone_current();
        settings.set_omit_expression(true);
        settings.bind(|| {
            insta::assert_snapshot!("ast", stochc_grammar::print(&checked.tree, symbols));
            insta::assert_snapshot!(
                "ast_json",
                format!("{:#}", stochc_grammar::to_json(&checked.tree, symbols))
            );
            for program in &checked.programs {
                let order = program.order.as_ref().unwrap();
                let tables = program.tables.as_ref().unwrap();
                let (plan, graph) = (&program.plan, &program.graph);
                insta::assert_snapshot!("graph", graph_text(plan, graph, order, symbols));
                insta::assert_snapshot!("graph_dot", graph_dot(plan, graph, order, symbols));
                let json = graph_json(plan, graph, order, symbols);
                insta::assert_snapshot!("graph_json", format!("{json:#}"));
                insta::assert_snapshot!("table", table_text(tables));
                insta::assert_snapshot!("table_json", format!("{:#}", table_json(tables)));
            }
        });
    });
}

#[test]
fn the_longest_serial_chains_are_those_of_the_paper() {
    for (file, length, serial) in [
        ("examples/five_tower.sa", 2, 4),
        ("examples/five_tower_reconfigured.sa", 4, 11),
        ("examples/line.sa", 13, 13),
    ] {
        let checked = stochc::check(file);
        let program = &checked.programs[0];
        let order = program.order.as_ref().unwrap();
        let lengths = order
            .chains
            .iter()
            .map(|chain| stochc::compiler::order::Order::length(&program.plan, chain));
        assert_eq!(lengths.clone().max(), Some(length), "{file}");
        assert_eq!(lengths.sum::<usize>(), serial, "{file}");
    }
}
