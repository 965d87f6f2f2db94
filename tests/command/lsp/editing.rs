//! Tests tokens, folding, completion and hints.
use serde_json::{Value, json};

use crate::lsp::client::{Client, edited, place, shown};

const URI: &str = "file:///nowhere/tower.sa";

const TOWER: &str = "\
// A tower and
// a flag.
let n = 2

pattern tower(base) {
    base.up ->> T[1..n]
}

shape flag {
    layer 1 { # }
}

assembly city in hemisphere {
    seed plate 2 x 1 { A at (0, 0)   B at (1, 0) }
    phase grow {
        tower(A) as left   // \u{1f9f1} {
        B.up -> C.up -> D
    }
}
";

fn ask(text: &str, method: &str, params: Value) -> Value {
    let mut client = Client::new(&["utf-16"]);
    client.open(URI, text);
    let answer = client.ask(&format!("textDocument/{method}"), params);
    assert!(answer.get("error").is_none(), "{answer}");
    answer["result"].clone()
}

fn document() -> Value {
    json!({ "textDocument": { "uri": URI } })
}

/// Returns the words of semantic tokens with their type and modifiers.
fn decoded(text: &str, data: &Value) -> Vec<String> {
    let types = ["type", "function", "parameter", "variable"];
    let lines: Vec<Vec<u16>> = text
        .lines()
        .map(|line| line.encode_utf16().collect())
        .collect();
    let numbers: Vec<usize> = (data.as_array().unwrap().iter())
        .map(|number| number.as_u64().unwrap() as usize)
        .collect();
    let (mut line, mut start) = (0, 0);
    let tokens = numbers.chunks(5).map(|token| {
        start = if token[0] > 0 {
            token[1]
        } else {
            start + token[1]
        };
        line += token[0];
        let word = String::from_utf16(&lines[line][start..start + token[2]]).unwrap();
        format!("{word} {} {}", types[token[3]], token[4])
    });
    tokens.collect()
}

#[test]
fn every_name_has_a_token() {
    let found = ask(TOWER, "semanticTokens/full", document());
    let found = decoded(TOWER, &found["data"]);
    for (token, count) in [
        ("n variable 3", 1),
        ("n variable 2", 1),
        ("tower function 1", 1),
        ("tower function 0", 1),
        ("base parameter 1", 1),
        ("base parameter 0", 1),
        ("flag type 1", 1),
        ("city type 1", 1),
        ("grow type 1", 1),
        ("A variable 1", 1),
        ("A variable 0", 1),
        ("C variable 1", 1),
    ] {
        let equal = found.iter().filter(|it| *it == token).count();
        assert_eq!(equal, count, "{token} in {found:?}");
    }
}

#[test]
fn blocks_and_comments_are_folded() {
    // Braces in strings and comments do not count.
    let text = TOWER.replace("let n = 2", "import \"{//.sa\" // {");
    let found = ask(&text, "foldingRange", document());
    let mut ranges: Vec<(u64, u64, bool)> = (found.as_array().unwrap().iter())
        .map(|range| {
            let line = |key: &str| range[key].as_u64().unwrap();
            (
                line("startLine"),
                line("endLine"),
                range["kind"] == "comment",
            )
        })
        .collect();
    ranges.sort_unstable();
    let expected = [
        (0, 1, true),
        (4, 5, false),
        (8, 9, false),
        (12, 17, false),
        (14, 16, false),
    ];
    assert_eq!(ranges, expected);
}

#[test]
fn captured_blocks_have_hints_with_cells_and_waits() {
    let hints = |from: u32, to: u32| {
        let range = json!({
            "start": { "line": from, "character": 0 },
            "end": { "line": to, "character": 0 },
        });
        let params = json!({ "textDocument": { "uri": URI }, "range": range });
        let found = ask(TOWER, "inlayHint", params);
        let hints = found.as_array().unwrap().iter().map(|hint| {
            let position = &hint["position"];
            let label = hint["label"].as_str().unwrap();
            format!("{}:{} {label}", position["line"], position["character"])
        });
        hints.collect::<Vec<String>>()
    };
    // The blocks of a range have none.
    assert_eq!(
        hints(0, 18),
        ["16:17 (1, 0, 1), 631 ticks", "16:25 (1, 0, 2), 342 ticks"]
    );
    assert_eq!(hints(0, 10), [""; 0]);
}

#[test]
fn programs_have_lenses_with_critical_path_and_simulation() {
    let lenses = |text: &str| {
        let found = ask(text, "codeLens", document());
        let lenses = found.as_array().unwrap().iter().map(|lens| {
            let command = &lens["command"];
            let (place, title) = (shown(&lens["range"]), command["title"].as_str().unwrap());
            let words = [command["command"].as_str().unwrap()];
            let arguments = command["arguments"].as_array().unwrap().iter();
            let words = words
                .into_iter()
                .chain(arguments.map(|it| it.as_str().unwrap()));
            format!("{place} {title} {}", words.collect::<Vec<_>>().join(" "))
        });
        lenses.collect::<Vec<String>>()
    };
    let found = lenses(TOWER);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(
        found[0].starts_with("12:9-12:13 critical path: 2 of 4 captures, "),
        "{found:?}"
    );
    assert_eq!(
        found[1],
        format!("12:9-12:13 ▶ simulate stochc.simulate {URI}")
    );
    let claim = "expect complete within 9000 ticks with probability >= 0.5";
    let claimed = TOWER.replace("seed plate", &format!("{claim}\n    seed plate"));
    let found = lenses(&claimed);
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found[2].ends_with(&format!(" ▶ test claims stochc.test {URI}")));
    // A program with errors cannot be simulated.
    let wrong = TOWER.replace("B.up -> C", "B.up -> C   Q.up -> E");
    assert!(!lenses(&wrong).iter().any(|lens| lens.contains("simulate")));
    assert_eq!(lenses("let n = 1\n"), [""; 0]);
}

/// Checks that a client gets answers about the last checked text during the check of a long
/// program. Their positions are those of the edited text.
#[test]
fn a_long_program_is_answered_during_its_check() {
    let capture = |i: usize| format!("        A{i}.up -> A{}\n", i + 1);
    let body: String = (0..800).map(capture).collect();
    let text = format!(
        "assembly long in hemisphere {{\n    seed plate 1 x 1 {{ A0 at (0, 0) }}\n    phase p {{\n{body}    }}\n}}\n\
         assembly b in hemispher {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A }} }}\n"
    );
    let refresh = json!({ "refreshSupport": true });
    let mut client = Client::with(json!({
        "textDocument": { "diagnostic": {} },
        "workspace": { "inlayHint": refresh, "semanticTokens": {}, "diagnostics": refresh },
    }));
    client.open(URI, &text);
    client.ask("textDocument/diagnostic", document());
    // The check of these loops takes seconds.
    let loops = "for i in 1..1000 { for j in 1..8000 { } }";
    let seeds = "seed plate 1 x 1 { M at (0, 0) }";
    let slow_programs: String = (0..100)
        .map(|i| format!("assembly a{i} {{ {seeds} phase p {{ {loops} M.up -> A }} }}\n"))
        .collect();
    let start = json!({ "line": 0, "character": 0 });
    let change = json!({ "range": { "start": start, "end": start }, "text": slow_programs });
    client.notify(
        "textDocument/didChange",
        json!({
            "textDocument": { "uri": URI, "version": 2 },
            "contentChanges": [change],
        }),
    );
    let slow = client.request(
        "textDocument/prepareRename",
        json!({ "textDocument": { "uri": URI }, "position": start }),
    );
    let place =
        json!({ "textDocument": { "uri": URI }, "position": { "line": 104, "character": 17 } });
    let hover = client.ask("textDocument/hover", place.clone());
    assert!(
        hover["result"]["contents"]["value"]
            .as_str()
            .unwrap()
            .contains("**`A2`**"),
        "{hover}"
    );
    assert_eq!(shown(&hover["result"]["range"]), "104:17-104:19");
    let symbols = client.ask("textDocument/documentSymbol", document());
    assert_eq!(
        shown(&symbols["result"][0]["selectionRange"]),
        "100:9-100:13"
    );
    let tokens = client.ask("textDocument/semanticTokens/full", document());
    assert!(tokens["result"]["data"].as_array().unwrap().len() > 4000);
    let mut range = json!({ "textDocument": { "uri": URI } });
    range["range"] =
        json!({ "start": { "line": 103, "character": 0 }, "end": { "line": 104, "character": 0 } });
    let tokens = client.ask("textDocument/semanticTokens/range", range.clone());
    assert_eq!(tokens["result"]["data"].as_array().unwrap().len(), 2 * 5);
    let completion = client.ask("textDocument/completion", place.clone());
    assert!(completion["result"]["items"].is_array(), "{completion}");
    let definition = client.ask("textDocument/definition", place.clone());
    assert_eq!(shown(&definition["result"][0]["range"]), "104:17-104:19");
    range["range"] = unknown_scene(&mut client).unwrap();
    assert_eq!(shown(&range["range"]), "905:14-905:23");
    range["context"] = json!({ "diagnostics": [] });
    let action = &client.ask("textDocument/codeAction", range.clone())["result"][0];
    let edit = &action["edit"]["changes"][URI][0];
    assert_eq!(shown(&edit["range"]), "905:14-905:23");
    client.notify("$/cancelRequest", json!({ "id": slow }));
    client.answer(&json!(slow));

    // An edited name has no hover text, no fix and no diagnostic before the next check.
    for (version, range) in [
        (3, hover["result"]["range"].clone()),
        (4, range["range"].clone()),
    ] {
        client.notify(
            "textDocument/didChange",
            json!({
                "textDocument": { "uri": URI, "version": version },
                "contentChanges": [{ "range": range, "text": "" }],
            }),
        );
    }
    let hover = client.ask("textDocument/hover", place);
    assert_eq!(hover["result"], Value::Null);
    let actions = client.ask("textDocument/codeAction", range);
    assert_eq!(actions["result"], json!([]));
    assert_eq!(unknown_scene(&mut client), None);

    repeat_after_the_check(&mut client, &text, &start);
}

/// Returns the range of the first diagnostic about an unknown scene.
fn unknown_scene(client: &mut Client) -> Option<Value> {
    let found = client.ask("textDocument/diagnostic", document());
    let found = found["result"]["items"].as_array().unwrap().iter();
    let mut found = found.filter(|it| it["code"] == "unknown-scene");
    found.next().map(|it| it["range"].clone())
}

/// Checks that all edits and requests need a single check, and that the client is asked to repeat
/// its requests after it.
fn repeat_after_the_check(client: &mut Client, text: &str, start: &Value) {
    client.notify(
        "textDocument/didChange",
        json!({
            "textDocument": { "uri": URI, "version": 5 },
            "contentChanges": [{ "text": text }],
        }),
    );
    let mut requests = [client.request_of_server(), client.request_of_server()];
    requests.sort();
    assert_eq!(
        requests,
        [
            "workspace/diagnostic/refresh",
            "workspace/inlayHint/refresh"
        ]
    );
    client.ask(
        "textDocument/prepareRename",
        json!({ "textDocument": { "uri": URI }, "position": start }),
    );
    assert!(client.requests_of_server().is_empty());
}

/// Returns the completions offered before `|`.
fn offered(text: &str) -> Vec<String> {
    let plain = text.replace('|', "");
    let mut params = place(URI, text, "|", 0);
    params["context"] = json!({ "triggerKind": 1 });
    let completions = ask(&plain, "completion", params);
    let items = completions["items"].as_array().unwrap().iter();
    items
        .map(|item| item["label"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn keywords_names_and_faces_are_completed() {
    let within = |line: &str| {
        offered(&TOWER.replace("        B.up -> C.up -> D\n", &format!("        {line}\n")))
    };
    assert_eq!(
        within("B.|"),
        ["east", "west", "north", "south", "up", "down"]
    );
    let start = within("|");
    for word in ["A", "B", "tower", "release", "yields", "seed", "aggregate"] {
        assert!(start.contains(&word.to_owned()), "{word} in {start:?}");
    }
    assert!(!start.contains(&"flag".to_owned()), "{start:?}");
    assert_eq!(within("yields fl|"), ["flag"]);
    assert!(within("B.up -> |").contains(&"left".to_owned()));
    assert!(within("B.up -> X a|").contains(&"after".to_owned()));
    assert!(within("seed p|").contains(&"plate".to_owned()));
    assert!(within("tower(B, |").contains(&"east".to_owned()));
    assert!(within("tower(B) t|").contains(&"turned".to_owned()));
    assert!(offered("aggregate a in hemisphere t|").contains(&"to".to_owned()));
    assert_eq!(within("tower(B) as |"), [""; 0]);
    assert_eq!(within("// |"), [""; 0]);
    assert_eq!(offered("import \"|"), [""; 0]);
    let scenes = offered("scene mine from hemisphere {\n}\nassembly a in |");
    for scene in ["mine", "hemisphere", "suction_tank"] {
        assert!(scenes.contains(&scene.to_owned()), "{scenes:?}");
    }
}

#[test]
fn a_range_is_formatted_alone() {
    let careless = TOWER
        .replace("let n =", "let n  =")
        .replace("B.up -> C", "B.up->C");
    let range = |from: u32, to: u32| {
        let range = json!({
            "start": { "line": from, "character": 0 },
            "end": { "line": to, "character": 4 },
        });
        let options = json!({ "tabSize": 4, "insertSpaces": true });
        let params = json!({ "textDocument": { "uri": URI }, "range": range, "options": options });
        edited(&careless, &ask(&careless, "rangeFormatting", params))
    };
    assert_eq!(range(0, 5), careless.replace("let n  =", "let n ="));
    assert_eq!(range(12, 17), careless.replace("B.up->C", "B.up -> C"));
    assert_eq!(range(5, 7), careless);
}

#[test]
fn imports_are_links() {
    let folder = tempfile::tempdir().unwrap();
    let uri = |name: &str| format!("file://{}/{name}", folder.path().to_str().unwrap());
    std::fs::write(folder.path().join("towers.sa"), "let n = 2\n").unwrap();
    let text = "import \"towers.sa\"\nimport \"nowhere.sa\"\n";
    let mut client = Client::new(&["utf-16"]);
    client.open(&uri("main.sa"), text);
    let params = json!({ "textDocument": { "uri": uri("main.sa") } });
    let answer = client.ask("textDocument/documentLink", params);
    let links = answer["result"].as_array().unwrap();
    assert_eq!(links.len(), 1, "{answer}");
    assert_eq!(links[0]["target"], uri("towers.sa"));
    assert_eq!(shown(&links[0]["range"]), "0:7-0:18");
}
