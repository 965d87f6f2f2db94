//! Tests imported files that change on the disk while no document of them is open.
use std::path::Path;

use serde_json::{Value, json};

use crate::lsp::client::{Client, edited, place};

const MODIFIED: i64 = -32801;

const LIBRARY: &str = "shape sq { layer 1 { # # } }\n";

const MAIN: &str = "import \"lib.sa\"
assembly a {
    seed plate 2 x 1 { M at (0, 0)  N at (1, 0) }
    phase g {
        M.up -> A
        N.up -> B
        yields sq
    }
}
";

fn uri(folder: &Path, name: &str) -> String {
    format!("file://{}/{name}", folder.to_str().unwrap())
}

/// Returns a client that has opened `main.sa` of a folder. The file must have no diagnostics.
fn client(folder: &Path, capabilities: Value) -> Client {
    std::fs::write(folder.join("lib.sa"), LIBRARY).unwrap();
    let mut client = Client::with(capabilities);
    let main = uri(folder, "main.sa");
    client.open(&main, MAIN);
    assert_eq!(client.diagnostics(&main), [Value::Null; 0]);
    client
}

fn rename(client: &mut Client, folder: &Path) -> Value {
    let mut params = place(&uri(folder, "main.sa"), MAIN, "sq", 0);
    params["newName"] = json!("wall");
    client.ask("textDocument/rename", params)
}

#[test]
fn a_changed_import_is_checked_again_when_a_file_is_saved_or_reported() {
    let folder = tempfile::tempdir().unwrap();
    let main = uri(folder.path(), "main.sa");
    let changes = json!([{ "uri": uri(folder.path(), "lib.sa"), "type": 2 }]);
    for (method, params) in [
        (
            "workspace/didChangeWatchedFiles",
            json!({ "changes": changes }),
        ),
        (
            "textDocument/didSave",
            json!({ "textDocument": { "uri": main } }),
        ),
    ] {
        let mut client = client(folder.path(), json!({}));
        let library = LIBRARY.replace("sq", "square");
        std::fs::write(folder.path().join("lib.sa"), library).unwrap();
        client.notify(method, params.clone());
        let found = client.diagnostics(&main);
        assert_eq!(found[0]["code"], "unknown-name", "{method}");
        assert_eq!(
            found[0]["range"]["start"],
            json!({ "line": 6, "character": 15 })
        );
        std::fs::remove_file(folder.path().join("lib.sa")).unwrap();
        client.notify(method, params.clone());
        assert_eq!(
            client.diagnostics(&main)[0]["code"],
            "import-missing",
            "{method}"
        );
        std::fs::write(folder.path().join("lib.sa"), LIBRARY).unwrap();
        client.notify(method, params);
        assert_eq!(client.diagnostics(&main), [Value::Null; 0], "{method}");
    }
}

#[test]
fn file_watching_is_registered_if_supported() {
    let folder = tempfile::tempdir().unwrap();
    for offers in [true, false] {
        let watching = json!({ "dynamicRegistration": offers });
        let capabilities = json!({ "workspace": { "didChangeWatchedFiles": watching } });
        let client = client(folder.path(), capabilities);
        let requested = client.requests_of_server();
        assert_eq!(requested.len(), usize::from(offers));
        for request in requested {
            assert_eq!(request["method"], "client/registerCapability");
            let registration = &request["params"]["registrations"][0];
            assert_eq!(registration["method"], "workspace/didChangeWatchedFiles");
            let watcher = &registration["registerOptions"]["watchers"][0];
            assert_eq!(watcher["globPattern"], "**/*.sa");
        }
    }
}

/// Checks a file that changed without a notification of the client. A rename at the old positions
/// would corrupt the file.
#[test]
fn files_are_compared_with_the_disk_before_they_are_edited() {
    let folder = tempfile::tempdir().unwrap();
    let mut client = client(folder.path(), json!({}));
    let library = format!("// by a colleague\n{LIBRARY}");
    std::fs::write(folder.path().join("lib.sa"), &library).unwrap();
    let answer = rename(&mut client, folder.path());
    assert_eq!(answer["error"]["code"], MODIFIED, "{answer}");
    // The program was checked again, so the second rename succeeds.
    let answer = rename(&mut client, folder.path());
    let edits = &answer["result"]["changes"][uri(folder.path(), "lib.sa")];
    assert_eq!(
        edited(&library, edits),
        library.replace("sq", "wall"),
        "{answer}"
    );
}

#[test]
fn fixes_that_follow_from_an_old_import_are_not_offered() {
    let folder = tempfile::tempdir().unwrap();
    let main = uri(folder.path(), "main.sa");
    std::fs::write(
        folder.path().join("lib.sa"),
        LIBRARY.replace("sq", "square"),
    )
    .unwrap();
    let mut client = Client::with(json!({}));
    client.open(&main, &MAIN.replace("sq", "squar"));
    let found = client.diagnostics(&main);
    let actions = json!({
        "textDocument": { "uri": main },
        "range": found[0]["range"],
        "context": { "diagnostics": found },
    });
    let answer = client.ask("textDocument/codeAction", actions.clone());
    let edit = &answer["result"][0]["edit"]["changes"][&main][0];
    assert_eq!(edit["newText"], "square", "{answer}");
    std::fs::write(folder.path().join("lib.sa"), LIBRARY.replace("sq", "squad")).unwrap();
    let answer = client.ask("textDocument/codeAction", actions.clone());
    assert_eq!(answer["error"]["code"], MODIFIED, "{answer}");
    let answer = client.ask("textDocument/codeAction", actions);
    let edit = &answer["result"][0]["edit"]["changes"][&main][0];
    assert_eq!(edit["newText"], "squad", "{answer}");
}
