//! Snapshots of the messages about invalid programs, with the sources.
use stochc::diagnostics::{Format, show};

#[test]
fn messages_are_unchanged() {
    insta::glob!("../findings", "*.sa", |path| {
        let text = String::from_utf8(std::fs::read(path).unwrap()).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        let mut reader = |_: &str| Ok(text.clone().into_bytes());
        let checked = stochc::compiler::check(name, &mut reader, Default::default());
        assert!(checked.has_errors());
        let messages = show(&checked, Format::Graphical, false, 80);
        insta::with_settings!({ omit_expression => true }, {
            insta::assert_snapshot!("messages", format!("{text}\n{messages}"));
        });
    });
}
