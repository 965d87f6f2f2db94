//! Tests requests about programs with damaged lines.
use serde_json::{Value, json};

use crate::lsp::client::Client;

/// Lines that replace or precede a line of a program.
const GARBAGE: [&str; 8] = [
    "",
    "}",
    "import \"nowhere.sa\"",
    "{ M.up -> ->> ",
    "phase \"",
    "for i in 1.. release T[1",
    "import \"damaged.sa\"",
    "assembly \u{1f9f1}\r let n = n",
];

const INTERNAL_ERROR: i64 = -32603;

/// Returns the requests of an editor, with their parameters.
fn requests(uri: &str, line: usize) -> Vec<(&'static str, Value)> {
    let position = json!({ "line": line, "character": 9 });
    let range =
        json!({ "start": { "line": line.saturating_sub(3), "character": 0 }, "end": position });
    let params = json!({
        "textDocument": { "uri": uri },
        "position": position,
        "range": range,
        "context": { "diagnostics": [], "includeDeclaration": true, "triggerKind": 1 },
        "options": { "tabSize": 4, "insertSpaces": true },
        "newName": "other",
        "query": "a",
    });
    let methods = [
        "textDocument/codeLens",
        "textDocument/hover",
        "textDocument/definition",
        "textDocument/references",
        "textDocument/documentHighlight",
        "textDocument/completion",
        "textDocument/documentSymbol",
        "textDocument/documentLink",
        "textDocument/foldingRange",
        "textDocument/inlayHint",
        "textDocument/semanticTokens/full",
        "textDocument/semanticTokens/range",
        "textDocument/diagnostic",
        "textDocument/codeAction",
        "textDocument/formatting",
        "textDocument/rangeFormatting",
        "textDocument/prepareRename",
        "textDocument/rename",
        "workspace/symbol",
    ];
    methods.map(|method| (method, params.clone())).into()
}

/// Damages the examples line by line, and checks that no request fails with an internal error.
#[test]
fn damaged_programs_are_answered() {
    let examples = std::fs::read_dir("examples").unwrap();
    let mut paths: Vec<_> = examples.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|it| it == "sa"));
    paths.sort();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("damaged.sa"),
        "pattern p(base {\n let n = ",
    )
    .unwrap();
    let mut random = 1_usize;
    let mut next = |below: usize| {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (random >> 33) % below
    };
    let mut client = Client::new(&["utf-16"]);
    for path in paths {
        let name = path.file_name().unwrap().to_str().unwrap();
        let uri = format!("file://{}/{name}", folder.path().to_str().unwrap());
        let text = std::fs::read_to_string(&path).unwrap();
        let mut lines: Vec<&str> = text.lines().collect();
        client.open(&uri, &text);
        for version in 2..5 {
            let line = next(lines.len());
            let replaced = next(2);
            let garbage = GARBAGE[next(GARBAGE.len())];
            lines.splice(line..line + replaced, [garbage]);
            let text = lines.join("\n");
            client.notify(
                "textDocument/didChange",
                json!({
                    "textDocument": { "uri": uri, "version": version },
                    "contentChanges": [{ "text": text }],
                }),
            );
            for (method, params) in requests(&uri, line) {
                let error = client.ask(method, params)["error"].take();
                assert_ne!(error["code"], INTERNAL_ERROR, "{error} in\n{text}");
                assert_ne!(error["code"], -32602, "{error}");
            }
        }
        client.notify(
            "textDocument/didClose",
            json!({ "textDocument": { "uri": uri } }),
        );
    }
    assert_eq!(client.leave(), 0);
}
