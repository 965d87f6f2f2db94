//! Tests renaming, and new names that are rejected.
use serde_json::{Value, json};

use crate::lsp::client::{Client, edited, place};

const URI: &str = "file:///nowhere/a.sa";

const TEXT: &str = "\
let n = 2
pattern tower(base, height) {
    base.up ->> T[1..height]
    T[n].east -> U
}
assembly a in hemisphere {
    seed plate 2 x 1 { A at (0, 0)   B at (1, 0) }
    phase p {
        tower(A, n) as left
        for i in 1..1 { B.up -> T[i] }
    }
    phase q {
        left.T[n].up -> Top
        T[1].up -> V
    }
}
";

fn rename(words: &str, nth: usize, new: &str) -> Result<String, String> {
    let mut client = Client::new(&["utf-16"]);
    client.open(URI, TEXT);
    let mut params = place(URI, TEXT, words, nth);
    params["newName"] = json!(new);
    let answer = client.ask("textDocument/rename", params);
    match answer.get("error") {
        Some(error) => Err(error["message"].as_str().unwrap().to_owned()),
        None => Ok(edited(TEXT, &answer["result"]["changes"][URI])),
    }
}

#[test]
fn a_name_is_renamed_at_all_its_uses() {
    let renamed = rename("T[1..", 0, "Block").unwrap();
    let expected = TEXT
        .replace("->> T[1..height]", "->> Block[1..height]")
        .replace("T[n].east", "Block[n].east")
        .replace("left.T[n]", "left.Block[n]");
    assert_eq!(renamed, expected);

    let renamed = rename("T[1].up", 0, "S").unwrap();
    let expected = TEXT
        .replace("-> T[i]", "-> S[i]")
        .replace("T[1].up", "S[1].up");
    assert_eq!(renamed, expected);

    let renamed = rename("n)", 0, "count").unwrap();
    let expected = TEXT
        .replace("let n", "let count")
        .replace("T[n]", "T[count]")
        .replace("A, n)", "A, count)");
    assert_eq!(renamed, expected);

    let renamed = rename("tower", 1, "stack").unwrap();
    assert_eq!(renamed, TEXT.replace("tower", "stack"));
    let renamed = rename("left", 1, "west_side").unwrap();
    assert_eq!(renamed, TEXT.replace("left", "west_side"));
    let renamed = rename("base.up", 0, "foot").unwrap();
    assert_eq!(renamed, TEXT.replace("base", "foot"));
}

#[test]
fn a_rename_that_changes_the_program_is_rejected() {
    for (words, nth, new, why) in [
        ("T[1].up", 0, "V", "already has a meaning"),
        ("T[1].up", 0, "n", "already has a meaning"),
        ("T[1..", 0, "U", "already has a meaning"),
        ("n)", 0, "height", "already has a meaning"),
        ("i in", 0, "n", ""),
        ("p {", 0, "q", "already has a meaning"),
        ("hemisphere", 0, "h", "built in"),
        ("A at", 0, "release", "keyword"),
        ("A at", 0, "up", "keyword"),
        ("A at", 0, "2x", "does not begin with a digit"),
        ("A at", 0, "\u{b5}", "does not begin with a digit"),
        ("A at", 0, "", "does not begin with a digit"),
        ("seed", 0, "x", "no name at this position"),
    ] {
        match rename(words, nth, new) {
            Err(error) => assert!(!why.is_empty() && error.contains(why), "{new}: {error}"),
            Ok(_) => assert_eq!(why, "", "{words} may not become {new}"),
        }
    }
}

/// Checks that an underscore can be added to an unused name, as `check` recommends.
#[test]
fn an_underscore_may_be_added_to_an_unused_name() {
    let unused = format!("let spare = 3\n{TEXT}");
    for (text, new) in [
        (unused.clone(), "_spare"),
        (unused.replace("spare", "_spare"), "spare"),
        (format!("allow unused-let \"later\"\n{unused}"), "_spare"),
    ] {
        let mut client = Client::new(&["utf-16"]);
        client.open(URI, &text);
        let mut params = place(URI, &text, "spare =", 0);
        params["newName"] = json!(new);
        let answer = client.ask("textDocument/rename", params);
        let renamed = edited(&text, &answer["result"]["changes"][URI]);
        assert!(renamed.contains(&format!("let {new} =")), "{answer}");
    }
}

/// Checks that a scene cannot be renamed to `hemisphere`, because assemblies without a scene would
/// then use it.
#[test]
fn a_rename_does_not_change_the_scene_of_a_program() {
    let text = |name: &str| {
        format!(
            "scene {name} from hemisphere_soft {{ free 40 uniform }}\n\
             assembly a in {name} {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A }} }}\n\
             assembly b {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A }} }}\n"
        )
    };
    for (old, new, is_right) in [
        ("dense", "hemisphere", false),
        ("hemisphere", "dense", false),
        ("dense", "thick", true),
    ] {
        let text = text(old);
        let mut client = Client::new(&["utf-16"]);
        client.open(URI, &text);
        let mut params = place(URI, &text, &format!("{old} from"), 0);
        params["newName"] = json!(new);
        let answer = client.ask("textDocument/rename", params);
        let message = answer["error"]["message"].as_str();
        assert_eq!(message.is_none(), is_right, "{answer}");
        assert!(
            message.is_none_or(|message| message.contains("run in another")),
            "{answer}"
        );
    }
}

#[test]
fn programs_that_share_a_file_are_renamed_together() {
    let folder = tempfile::tempdir().unwrap();
    let uri = |name: &str| format!("file://{}/{name}", folder.path().to_str().unwrap());
    let pattern = "pattern tower(base) {\n    base.up -> T\n}\n";
    std::fs::write(folder.path().join("towers.sa"), pattern).unwrap();
    let program = |name: &str| {
        format!(
            "import \"towers.sa\"\nassembly {name} {{\n    seed plate 1 x 1 {{ M at (0, 0) }}\n    phase p {{ tower(M) }}\n}}\n"
        )
    };
    let mut client = Client::new(&["utf-16"]);
    client.open(&uri("a.sa"), &program("a"));
    client.open(&uri("b.sa"), &program("b"));
    let mut params = place(&uri("a.sa"), &program("a"), "tower(", 0);
    params["newName"] = json!("mast");
    let answer = client.ask("textDocument/rename", params);
    let changes = &answer["result"]["changes"];
    for (name, text) in [
        ("a.sa", program("a")),
        ("b.sa", program("b")),
        ("towers.sa", pattern.to_owned()),
    ] {
        let renamed = edited(&text, &changes[uri(name)]);
        assert_eq!(renamed, text.replace("tower(", "mast("), "{changes}");
    }
}

#[test]
fn prepare_rename_returns_the_range_of_the_name() {
    let mut client = Client::new(&["utf-16"]);
    client.open(URI, TEXT);
    let answer = client.ask("textDocument/prepareRename", place(URI, TEXT, "eft.T", 0));
    assert_eq!(answer["result"]["placeholder"], "left");
    let answer = client.ask(
        "textDocument/prepareRename",
        place(URI, TEXT, "hemisphere", 0),
    );
    assert_eq!(answer["error"]["code"], -32803);
    client.open(
        URI,
        "assembly a { seed plate 1 x 1 { A at (0, 0) } phase p { A.up -> } }",
    );
    let mut params = json!({
        "textDocument": { "uri": URI },
        "position": { "line": 0, "character": 32 },
    });
    params["newName"] = json!("B");
    let answer: Value = client.ask("textDocument/rename", params);
    let why = answer["error"]["message"].as_str().unwrap();
    assert!(why.contains("syntax errors"), "{why}");
}
