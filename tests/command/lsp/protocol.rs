//! Tests the messages of the language server protocol.
use serde_json::{Value, json};

use crate::lsp::client::{Client, place, shown};

const URI: &str = "file:///nowhere/a%20b.sa";

#[test]
fn the_exit_status_depends_on_the_shutdown_request() {
    assert_eq!(Client::new(&[]).leave(), 0);
    assert_eq!(Client::new(&[]).hang_up(), 1);
    let mut client = Client::new(&[]);
    client.notify("exit", Value::Null);
    assert_eq!(client.hang_up(), 1);
    assert_eq!(Client::start().hang_up(), 1);
}

/// Checks that the server ends if the client ends but the stream stays open. A child process of the
/// client may have inherited it.
#[cfg(unix)]
#[test]
fn the_server_ends_with_the_process_of_its_client() {
    let mut process = std::process::Command::new("sleep")
        .arg("600")
        .spawn()
        .unwrap();
    let mut client = Client::start();
    let params = json!({ "capabilities": {}, "processId": process.id() });
    client.ask("initialize", params);
    let hover = place(URI, "x", "x", 0);
    let answer = client.ask("textDocument/hover", hover);
    assert!(answer["error"]["code"].is_i64(), "it is served");
    process.kill().unwrap();
    process.wait().unwrap();
    assert_eq!(client.ended(), 1);
}

#[test]
fn requests_come_between_initialize_and_shutdown() {
    let mut client = Client::start();
    let hover = place(URI, "x", "x", 0);
    let answer = client.ask("textDocument/hover", hover.clone());
    assert_eq!(answer["error"]["code"], -32002);
    client.notify("textDocument/didOpen", json!({}));
    let answer = client.ask("initialize", json!({ "capabilities": {} }));
    assert_eq!(
        answer["result"]["capabilities"]["positionEncoding"],
        "utf-16"
    );
    assert_eq!(client.ask("initialize", json!({}))["error"]["code"], -32600);
    client.ask("shutdown", Value::Null);
    assert_eq!(
        client.ask("textDocument/hover", hover)["error"]["code"],
        -32600
    );
    client.notify("exit", Value::Null);
    assert_eq!(client.hang_up(), 0);
}

#[test]
fn unknown_messages_are_ignored() {
    let mut client = Client::new(&[]);
    client.open(URI, "let n = 1\n");
    client.send_raw(b"Content-Length: 5\r\n\r\n{{{{{");
    assert_eq!(client.answer(&Value::Null)["error"]["code"], -32700);
    client.send_raw(b"Content-Length: 2\r\n\r\n[]");
    assert_eq!(client.answer(&Value::Null)["error"]["code"], -32700);
    client.notify("textDocument/didChange", json!({ "textDocument": 3 }));
    client.notify("textDocument/didOpen", json!([]));
    client.notify("no/such", json!({}));
    client.notify(
        "textDocument/didChange",
        json!({ "textDocument": { "uri": "file:///other", "version": 1 }, "contentChanges": [] }),
    );
    assert_eq!(client.ask("no/such", json!({}))["error"]["code"], -32601);
    for params in [
        json!({}),
        json!([1]),
        json!("x"),
        json!({ "textDocument": { "uri": 3 } }),
    ] {
        for method in [
            "hover",
            "completion",
            "rename",
            "formatting",
            "codeAction",
            "documentSymbol",
        ] {
            let answer = client.ask(&format!("textDocument/{method}"), params.clone());
            assert_eq!(answer["error"]["code"], -32602, "{method} {params}");
        }
    }
    // No document with this address is open.
    let answer = client.ask("textDocument/hover", place("file:///none", "x", "x", 0));
    assert_eq!(answer["error"]["code"], -32803);
    let answer = client.ask("textDocument/hover", place(URI, "let n", "n", 0));
    assert!(answer["result"].is_object(), "{answer}");
    assert_eq!(client.leave(), 0);
}

#[test]
fn a_request_can_be_cancelled_before_its_turn() {
    let mut client = Client::new(&[]);
    // The program is long, so its check is still running when the other requests arrive.
    let text = "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up ->> T[1..200000] } }";
    client.open(URI, text);
    let first = client.request("textDocument/hover", place(URI, text, "M.up", 0));
    let second = client.request("textDocument/hover", place(URI, text, "M.up", 0));
    client.notify("$/cancelRequest", json!({ "id": second }));
    client.notify("$/cancelRequest", json!({ "id": "none" }));
    let mut answers = [
        client.answer(&json!(second)),
        client.ask("shutdown", Value::Null),
    ];
    // Either answer may come first. Each request is answered exactly once.
    let answer = answers[0].take();
    let cancelled = answer["error"]["code"] == -32800;
    assert!(cancelled || answer["result"].is_object(), "{answer}");
    assert!(first < second);
}

#[test]
fn diagnostics_follow_the_text() {
    let mut client = Client::new(&["utf-16"]);
    let text = "// \u{1f9f1}\nassembly a {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase p { M.up -> A B.up -> C }\n}\n";
    client.open(URI, text);
    let found = client.diagnostics(URI);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0]["code"], "unknown-name");
    assert_eq!(found[0]["severity"], 1);
    assert_eq!(found[0]["source"], "stochc");
    assert_eq!(shown(&found[0]["range"]), "3:24-3:33");
    assert!(
        found[0]["message"]
            .as_str()
            .unwrap()
            .starts_with("cannot find block `B`\n")
    );

    // The change replaces the character `B` by `A`.
    let range = json!({
        "start": { "line": 3, "character": 24 },
        "end": { "line": 3, "character": 25 },
    });
    client.notify(
        "textDocument/didChange",
        json!({
            "textDocument": { "uri": URI, "version": 2 },
            "contentChanges": [{ "range": range, "text": "A" }],
        }),
    );
    assert_eq!(client.diagnostics(URI), [Value::Null; 0]);

    client.notify(
        "textDocument/didChange",
        json!({
            "textDocument": { "uri": URI, "version": 3 },
            "contentChanges": [{ "text": "assembly" }],
        }),
    );
    let found = client.diagnostics(URI);
    assert_eq!(found[0]["code"], "syntax");
    client.notify(
        "textDocument/didClose",
        json!({ "textDocument": { "uri": URI } }),
    );
    assert_eq!(client.diagnostics(URI), [Value::Null; 0]);
}

#[test]
fn positions_are_counted_as_agreed() {
    let text = "let n = 1\nimport \"\u{1f9f1}\u{b5}.sa\"\n";
    for (encodings, expected) in [
        (&["utf-8", "utf-16"][..], "1:7-1:18"),
        (&["utf-16"], "1:7-1:15"),
        (&["utf-32"], "1:7-1:15"),
    ] {
        let mut client = Client::new(encodings);
        client.open(URI, text);
        let found = client.diagnostics(URI);
        assert_eq!(found[0]["code"], "import-missing");
        assert_eq!(shown(&found[0]["range"]), expected, "{encodings:?}");
    }
}

/// Checks that a client that requests diagnostics gets each of them once, and learns when to ask
/// again.
#[test]
fn diagnostics_are_pulled() {
    let folder = tempfile::tempdir().unwrap();
    let uri = |name: &str| format!("file://{}/{name}", folder.path().to_str().unwrap());
    let (own, imported) = (uri("own.sa"), uri("imported.sa"));
    let mut client = Client::with(json!({
        "textDocument": { "diagnostic": {} },
        "workspace": { "diagnostics": { "refreshSupport": true } },
    }));
    let pulled = |client: &mut Client, uri: &str| {
        let params = json!({ "textDocument": { "uri": uri } });
        let report = client.ask("textDocument/diagnostic", params)["result"].take();
        assert_eq!(report["kind"], "full", "{report}");
        report["items"].as_array().unwrap().clone()
    };
    client.open(&imported, "let n = 2\n");
    assert_eq!(pulled(&mut client, &imported), [Value::Null; 0]);
    client.open(
        &own,
        "import \"imported.sa\"\nassembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up ->> T[1..m] } }\n",
    );
    let errors = pulled(&mut client, &own);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0]["code"], "unknown-name");
    // Nothing is sent twice.
    assert_eq!(client.diagnosed(&own), [0; 0]);
    assert_eq!(client.diagnosed(&imported), [0; 0]);
    // A change of one file changes the diagnostics of the other.
    client.notify(
        "textDocument/didChange",
        json!({
            "textDocument": { "uri": imported, "version": 2 },
            "contentChanges": [{ "text": "let m = 2\n" }],
        }),
    );
    assert_eq!(client.request_of_server(), "workspace/diagnostic/refresh");
    assert_eq!(pulled(&mut client, &own), [Value::Null; 0]);
    assert_eq!(client.leave(), 0);
}

#[test]
fn symbols_of_the_workspace_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let uri = |name: &str| format!("file://{}/{name}", folder.path().to_str().unwrap());
    std::fs::write(
        folder.path().join("towers.sa"),
        "pattern tower(base) { base.up -> A }\n",
    )
    .unwrap();
    let mut client = Client::new(&["utf-16"]);
    client.open(
        &uri("main.sa"),
        "import \"towers.sa\"\nassembly two_towers { seed plate 1 x 1 { M at (0, 0) } phase grow { tower(M) } }\n",
    );
    let mut found = |query: &str| {
        let answer = client.ask("workspace/symbol", json!({ "query": query }));
        let symbols = answer["result"].as_array().unwrap().iter().map(|symbol| {
            let file = symbol["location"]["uri"]
                .as_str()
                .unwrap()
                .rsplit('/')
                .next();
            let container = symbol["containerName"].as_str().unwrap_or("-");
            let place = shown(&symbol["location"]["range"]);
            format!(
                "{} {container} {} {place}",
                symbol["name"].as_str().unwrap(),
                file.unwrap()
            )
        });
        symbols.collect::<Vec<String>>()
    };
    assert_eq!(
        found("TWR"),
        [
            "tower - towers.sa 0:8-0:13",
            "two_towers - main.sa 1:9-1:19"
        ]
    );
    assert_eq!(found("grow"), ["grow two_towers main.sa 1:61-1:65"]);
    assert_eq!(found("").len(), 5);
    assert_eq!(found("nothing"), [""; 0]);
}
