//! Tests work that continues during other requests, and that ends when no request needs it.
//!
//! These tests use no clock. A large program takes seconds, and tests check the order of answers.
use serde_json::{Value, json};

use crate::lsp::client::{Client, place};

const LARGE: &str = "file:///nowhere/large.sa";
const SMALL: &str = "file:///nowhere/small.sa";

const TEXT: &str = "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }\n";

const MODIFIED: i64 = -32801;
const CANCELLED: i64 = -32800;

/// Returns the source of a program without events that takes long to expand.
fn large() -> String {
    let loops = "for i in 1..1000 { for j in 1..8000 { } }";
    let seeds = "seed plate 1 x 1 { M at (0, 0) }";
    (0..100)
        .map(|i| format!("assembly a{i} {{ {seeds} phase p {{ {loops} M.up -> A }} }}\n"))
        .collect()
}

fn hover(client: &mut Client, uri: &str, text: &str) -> i64 {
    client.request("textDocument/hover", place(uri, text, "M.up", 0))
}

fn change(client: &mut Client, uri: &str, version: i64, text: &str) {
    client.notify(
        "textDocument/didChange",
        json!({
            "textDocument": { "uri": uri, "version": version },
            "contentChanges": [{ "text": text }],
        }),
    );
}

/// Returns the request number and the error code of each answer.
fn codes(answers: &[Value]) -> Vec<(i64, Option<i64>)> {
    let codes = answers.iter();
    codes
        .map(|it| (it["id"].as_i64().unwrap(), it["error"]["code"].as_i64()))
        .collect()
}

#[test]
fn requests_are_answered_during_a_large_check() {
    let mut client = Client::new(&[]);
    let text = large();
    client.open(LARGE, &text);
    let large = hover(&mut client, LARGE, &text);
    client.open(SMALL, TEXT);
    let small = hover(&mut client, SMALL, TEXT);
    assert_eq!(codes(&client.answers(1)), [(small, None)]);
    assert_eq!(client.diagnostics(SMALL), [Value::Null; 0]);
    client.notify("$/cancelRequest", json!({ "id": large }));
    assert_eq!(codes(&client.answers(1)), [(large, Some(CANCELLED))]);
    assert_eq!(client.diagnosed(LARGE), [0; 0]);
    assert_eq!(client.leave(), 0);
}

#[test]
fn formatting_is_answered_during_a_check() {
    let mut client = Client::new(&[]);
    let text = large();
    client.open(LARGE, &text);
    let large = hover(&mut client, LARGE, &text);
    let options = json!({ "tabSize": 4, "insertSpaces": true });
    let params = json!({ "textDocument": { "uri": LARGE }, "options": options });
    let layout = client.request("textDocument/formatting", params);
    assert_eq!(codes(&client.answers(1)), [(layout, None)]);
    client.notify("$/cancelRequest", json!({ "id": large }));
    assert_eq!(codes(&client.answers(1)), [(large, Some(CANCELLED))]);
}

#[test]
fn edits_cancel_all_checks_except_the_last() {
    let mut client = Client::new(&[]);
    let text = large();
    client.open(LARGE, &text);
    let mut expected = Vec::new();
    for version in 2..20 {
        // The check begins before the first request or with it.
        expected.push((hover(&mut client, LARGE, &text), Some(MODIFIED)));
        change(
            &mut client,
            LARGE,
            version,
            &format!("{text}// {version}\n"),
        );
    }
    expected.push((hover(&mut client, LARGE, &text), Some(MODIFIED)));
    change(&mut client, LARGE, 20, TEXT);
    expected.push((hover(&mut client, LARGE, TEXT), None));
    let answers = client.answers(expected.len());
    assert_eq!(codes(&answers), expected);
    assert_eq!(client.diagnosed(LARGE), [20]);
    assert_eq!(client.leave(), 0);
}

#[test]
fn an_edit_cancels_the_checks_of_importing_files() {
    let mut client = Client::new(&[]);
    let text = format!("import \"small.sa\"\n{}", large());
    client.open(SMALL, "let n = 1\n");
    assert_eq!(client.diagnostics(SMALL), [Value::Null; 0]);
    client.open(LARGE, &text);
    let before = hover(&mut client, LARGE, &text);
    // The answer for the small file comes after the first check has read it.
    let symbols = json!({ "textDocument": { "uri": SMALL } });
    client.ask("textDocument/documentSymbol", symbols);
    loop {
        change(&mut client, SMALL, 2, "let n = 2\n");
        client.notify("$/cancelRequest", json!({ "id": "none" }));
        let symbols = json!({ "textDocument": { "uri": SMALL } });
        let requested = client.request("textDocument/documentSymbol", symbols);
        let answers = codes(&client.answers(1));
        if answers[0].0 == before {
            assert_eq!(answers, [(before, Some(MODIFIED))]);
            break;
        }
        assert_eq!(answers, [(requested, None)]);
    }
    assert_eq!(client.leave(), 0);
}

#[test]
fn the_server_exits_during_a_check() {
    let text = large();
    let mut client = Client::new(&[]);
    client.open(LARGE, &text);
    let requested = hover(&mut client, LARGE, &text);
    let leaving = client.request("shutdown", Value::Null);
    let answers = client.answers(2);
    let expected = [(requested, Some(CANCELLED)), (leaving, None)];
    assert_eq!(codes(&answers), expected);
    client.notify("exit", Value::Null);
    assert_eq!(client.hang_up(), 0);

    let mut client = Client::new(&[]);
    client.open(LARGE, &text);
    hover(&mut client, LARGE, &text);
    assert_eq!(client.hang_up(), 1);
}

#[test]
fn a_program_too_large_for_the_editor_is_reported() {
    let text = TEXT.replace("-> A", "->> T[1..1300000]");
    let mut client = Client::new(&[]);
    client.open(SMALL, &text);
    let found = client.diagnostics(SMALL);
    assert_eq!(found[0]["code"], "expansion-limit");
    let message = found[0]["message"].as_str().unwrap();
    assert!(message.contains("more than 200000"), "{message}");
    assert!(
        message.contains("`stochc check` has a higher limit"),
        "{message}"
    );
}
