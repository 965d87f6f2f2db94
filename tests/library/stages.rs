//! Snapshots of all compiler stages of all examples.
use stochc::ir::emit::{graph_dot, graph_json, graph_text, table_json, table_text};

#[test]
fn examples_compile_as_before() {
    insta::glob!("../../examples", "*.sa", |path| {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let checked = stochc::check(&format!("examples/{name}.sa"));
        assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
        let mut settings = insta::Settings::clone_current();
        settings.set_omit_expression(true);
        settings.bind(|| {
            for program in &checked.programs {
                let tables = program.tables.as_ref().unwrap();
                let graph = program.event_graph();
                // If a file has several programs, each has its own snapshots.
                let name = |stage: &str| match &checked.programs[..] {
                    [_] => stage.to_owned(),
                    _ => format!("{stage}_{}", tables.assembly),
                };
                let text = graph_text(&graph, tables);
                insta::assert_snapshot!(name("graph"), text.to_string());
                let dot = graph_dot(&graph, tables);
                insta::assert_snapshot!(name("graph_dot"), dot.to_string());
                let json = graph_json(&graph, tables);
                insta::assert_snapshot!(name("graph_json"), format!("{json:#}"));
                insta::assert_snapshot!(name("table"), table_text(tables).to_string());
                insta::assert_snapshot!(name("table_json"), format!("{:#}", table_json(tables)));
            }
        });
    });
}

#[test]
fn critical_paths_agree_with_the_paper() {
    for (file, length, serial) in [
        ("examples/five_tower.sa", 2, 4),
        ("examples/five_tower_reconfigured.sa", 4, 11),
        ("examples/line.sa", 13, 13),
    ] {
        let checked = stochc::check(file);
        let program = &checked.programs[0];
        let order = program.order.as_ref().unwrap();
        let (_, longest) = order.longest(&program.plan).unwrap();
        let longest = stochc::compiler::order::Order::length(&program.plan, longest);
        assert_eq!(longest, length, "{file}");
        assert_eq!(order.critical_path_length(&program.plan), serial, "{file}");
    }
}

#[test]
fn one_program_is_lowered_for_three_kinds_of_hardware() {
    let scene = |base: &str| {
        format!(
            "scene here from {base} {{ block cube {{ side 5cm  mass 115g  faces 2 }}  free 9 uniform  enclosure hemisphere {{ radius 50cm  wall 200 N/m }} }}"
        )
    };
    let text = "
        assembly tower in here {
            allow unplanned-bond \"each kind in turn\"
            seed plate 2 x 1 { A at (0, 0)  B at (1, 0) }
            phase grow timeout 100 ticks {
                A.up -> C
                C.up -> D
                C.west -> E
                C.north -> F
                B.up -> G after D
            }
            phase change { release F, D  G.up -> D }
        }";
    let compiled = |base: &str| {
        let text = format!("{}{text}", scene(base));
        let mut reader = |_: &str| Ok(text.clone().into_bytes());
        let checked = stochc::compiler::check("tower.sa", &mut reader, Default::default());
        assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
        let tables = checked.programs[0].tables.clone().unwrap();
        let json = serde_json::to_value(table_json(&tables)).unwrap();
        (table_text(&tables).to_string(), json)
    };
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.bind(|| {
        for (kind, base) in [
            ("attract", "hemisphere"),
            ("suction", "suction_tank"),
            ("reject", "magnet_tank"),
        ] {
            let (text, json) = compiled(base);
            insta::assert_snapshot!(format!("kind_{kind}"), text);
            insta::assert_snapshot!(format!("kind_{kind}_json"), format!("{json:#}"));
            // Programs for default hardware do not have this key.
            assert_eq!(json.get("bond").is_none(), kind == "attract");
            assert_eq!(json.get("otherwise").is_some(), kind == "reject");
        }
    });
}
