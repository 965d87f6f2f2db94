//! Tests that names are shown only as text.
use std::fs::File;
use std::sync::Arc;

use crate::browser::browser;
use crate::folder::Results;
use crate::page_under_test::Page;

/// Name that ends a script, begins other elements, and reverses the text around it.
const HOSTILE: &str = "<meta http-equiv='refresh' content='0;url=about:blank'></script><script>document.title='broken'</script><img src=x onerror=\"document.title='broken'\">'\"\u{202e}\u{2028}`${1}\\";

#[test]
fn hostile_names_are_shown_as_text() {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    check(&mut browser);
    assert_eq!(browser.complaints, [""; 0]);
}

/// Checks that hostile names do not change the page.
pub fn check(browser: &mut impl Page) {
    let results = Results::from_records("tests/fixtures/dense.sa", "--record 0");
    let page = results.page(0);
    // The compiler rejects such names, but an edited manifest may contain them.
    let manifest = std::fs::read_to_string(results.path().join("manifest.json")).unwrap();
    let mut manifest = stochc::results::Manifest::from_json(&manifest).unwrap();
    manifest.stochc = HOSTILE.to_owned();
    let program = &mut manifest.programs[0];
    program.name = HOSTILE.to_owned();
    program.scene.name = HOSTILE.to_owned();
    program.sources[0].path = HOSTILE.to_owned();
    let tables = &mut Arc::make_mut(&mut program.compiled).tables;
    for role in &mut tables.roles {
        role.name = format!("{HOSTILE}{}", role.name);
    }
    tables.phases[0].name = HOSTILE.to_owned();
    let about = stochc::report::replay::about(
        &manifest,
        &manifest.programs[0],
        &[],
        serde_json::json!([]),
        false,
    );
    let recording = File::open(results.recording_path(0)).unwrap();
    let file = File::create(&page).unwrap();
    stochc::report::replay::write(HOSTILE, &about, recording, None::<&[u8]>, file).unwrap();
    browser.open(&page, "#tick=100000");
    assert_eq!(browser.value("document.body.dataset.ready"), "yes");
    let shown = HOSTILE
        .replace('\u{202e}', "⟨U+202E⟩")
        .replace('\u{2028}', "⟨U+2028⟩");
    assert_eq!(browser.value("document.title"), shown);
    assert_eq!(browser.value("document.querySelectorAll('img').length"), 0);
    let instructions =
        "[...document.querySelectorAll('[http-equiv]')].map(it => it.httpEquiv).join()";
    assert_eq!(browser.value(instructions), "Content-Security-Policy");
    assert_eq!(
        browser.value("document.querySelectorAll('script').length"),
        4
    );
    assert_eq!(
        browser.value("document.getElementById('name').textContent"),
        shown
    );
    let facts = browser.value("document.getElementById('facts').textContent");
    assert!(
        facts.as_str().unwrap().contains(&format!("scene {shown}")),
        "{facts}"
    );
    let graph = browser.value("document.getElementById('graph').textContent");
    assert!(graph.as_str().unwrap().contains(&shown), "{graph}");
    // The panel shows a block with such a role.
    browser.value("replay.select(replay.state().structure[0][0])");
    browser.value("replay.seek(100000)");
    let panel = browser.value("document.getElementById('block').textContent");
    assert!(
        panel
            .as_str()
            .unwrap()
            .contains(&format!("Event table of {shown}")),
        "{panel}"
    );
}
