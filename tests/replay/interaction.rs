//! Tests navigation in the replay page: clicks, keys and automatic movements.
use serde_json::Value;
use stochc::text::palette::{DARK, LIGHT};

use crate::browser::browser;
use crate::folder::{PROGRAM, Results};
use crate::page_under_test::{Mouse, Page};

type Check<P> = fn(&mut P);

/// Returns the checks, each with the hash that it adds to the address.
fn checks<P: Page>() -> [(Check<P>, &'static str); 9] {
    [
        (a_click_on_a_name_chooses_its_block, ""),
        (
            what_is_anchored_is_chosen_before_what_lets_light_through,
            "",
        ),
        (names_do_not_show_through_solid_blocks, ""),
        (sheets_are_no_larger_than_what_is_on_them, "#tick=9000"),
        (the_strip_of_marks_is_dragged, ""),
        (graphics_that_are_lost_come_back, "#tick=2500"),
        (keys_turn_the_view_and_choose_a_block, "#tick=9000"),
        (the_graph_scrolls_to_what_happens_and_the_focus_stays, ""),
        (no_block_that_is_seen_is_left_out, "#tick=4000"),
    ]
}

/// Runs all checks in a page of a browser.
pub fn check_all(page: &mut impl Page, results: &Results) {
    for (check, hash) in checks() {
        page.size(1000, 700);
        page.open(&results.page(0), hash);
        check(page);
    }
}

/// Runs a range of [`checks`], so that tests run in parallel.
fn in_chromium(which: std::ops::Range<usize>) {
    let Some(mut browser) = browser(&[]) else {
        return;
    };
    let results = Results::from_records(PROGRAM, "--record 0");
    for (check, hash) in &checks()[which] {
        browser.size(1000, 700);
        browser.open(&results.page(0), hash);
        check(&mut browser);
    }
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn a_click_selects_a_block() {
    in_chromium(0..4);
}

#[test]
fn timelines_keys_and_lost_graphics() {
    in_chromium(4..7);
}

#[test]
fn graphs_and_visible_blocks() {
    in_chromium(7..9);
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn a_click_on_a_name_chooses_its_block(browser: &mut impl Page) {
    let end = number(&browser.value("replay.state().end"));
    let mut clicked = 0;
    for part in 1..=12 {
        let tick = (end * f64::from(part) / 12.0).floor();
        browser.value(&format!("replay.seek({tick}).then(() => 1)"));
        for name in browser.value("replay.names()").as_array().unwrap() {
            let (x, y) = (number(&name["x"]), number(&name["y"]));
            let hit = "document.elementFromPoint";
            if browser.value(&format!("{hit}({x}, {y})?.id")) != "arena" {
                continue;
            }
            browser.click(x, y);
            let selected = browser.value("replay.state().selected");
            assert_eq!(selected, name["body"], "{name} at {tick}");
            browser.key("Escape");
            clicked += 1;
        }
    }
    assert!(clicked >= 40, "{clicked}");
}

fn what_is_anchored_is_chosen_before_what_lets_light_through(browser: &mut impl Page) {
    // A free block is between the camera and a block of the structure. A click picks it only if it
    // is solid.
    let found = browser.value(
        "(async () => {
            const end = replay.state().end;
            for (let tick = 100; tick < end; tick += 100) {
                const { structure } = await replay.seek(tick);
                for (const [body] of structure) for (const face of ['up', 'south', 'east']) {
                    const { x, y } = replay.face(body, face);
                    if (replay.names().some(name => Math.hypot(name.x - x, name.y - y) < 40)) continue;
                    const faint = replay.pick(x, y);
                    if (!structure.some(([other]) => other === faint)) continue;
                    document.getElementById('cloud').click();
                    await replay.settled();
                    const solid = replay.pick(x, y);
                    document.getElementById('cloud').click();
                    document.getElementById('cloud').click();
                    await replay.settled();
                    if (solid >= 0 && !structure.some(([other]) => other === solid)) return { x, y, solid, faint };
                }
            }
        })()",
    );
    assert!(found["solid"].is_u64(), "{found}");
    // A selected free block is still transparent, and does not hide the anchored block.
    let shown = browser.value(&format!(
        "(async () => {{
            const at = () => replay.pixel({x}, {y});
            const before = at();
            replay.select({solid});
            await replay.settled();
            const chosen = at();
            document.getElementById('cloud').click();
            await replay.settled();
            return [before, chosen, at()];
        }})()",
        x = found["x"],
        y = found["y"],
        solid = found["solid"],
    ));
    assert_ne!(shown[1], shown[2], "{shown}");
}

fn names_do_not_show_through_solid_blocks(browser: &mut impl Page) {
    let covered = browser.value(
        "(async () => {
            const end = replay.state().end;
            for (let tick = 50; tick < end; tick += 50) {
                await replay.seek(tick);
                const faint = replay.names().map(({ text }) => text);
                document.getElementById('cloud').click();
                const solid = (await replay.settled()).labels;
                document.getElementById('cloud').click();
                document.getElementById('cloud').click();
                const gone = faint.filter(text => !solid.includes(text));
                if (solid.some(text => !faint.includes(text))) return 'a name more';
                if (gone.length) return gone;
            }
            return [];
        })()",
    );
    assert!(!covered.as_array().unwrap().is_empty(), "{covered}");
}

fn sheets_are_no_larger_than_what_is_on_them(browser: &mut impl Page) {
    // The views are the first one, another one, and one so close that the edge of the arena cuts
    // names.
    for view in [
        "replay.state().view",
        "[0.8, 0.3, 30, 4, 0, 2]",
        "[2.4, 0.9, 6, 0, 0, 2]",
    ] {
        browser.value(&format!("replay.look({view})"));
        let seen = browser.value(
            "replay.settled().then(() => {
                const arena = document.getElementById('arena').getBoundingClientRect();
                const [names, axes] = ['names', 'axes'].map(name => document.querySelector(`#labels .${name}`));
                const box = names.getBoundingClientRect();
                const pen = new OffscreenCanvas(arena.width, arena.height).getContext('2d', { willReadFrequently: true });
                pen.drawImage(names, box.left - arena.left, box.top - arena.top);
                const inked = ({ x, y }) => pen.getImageData(x - 12, y - 8, 24, 16).data.some((part, i) => i % 4 === 3 && part > 100);
                const inside = replay.names().filter(({ x, y }) => x > 12 && y > 8 && x < arena.width - 12 && y < arena.height - 8);
                const share = [names, axes].reduce((sum, { width, height }) => sum + width * height, 0) / (arena.width * arena.height);
                const sharp = [names, axes].every(sheet => sheet.clientWidth === sheet.width && sheet.clientHeight === sheet.height);
                return { names: inside.length, blank: inside.filter(name => !inked(name)).length, share, sharp };
            })",
        );
        assert!(number(&seen["names"]) >= 4.0, "{view}: {seen}");
        assert_eq!(seen["blank"], 0, "{view}: {seen}");
        assert_eq!(seen["sharp"], true, "{view}: {seen}");
        // In the closest view, names are everywhere.
        if view.starts_with("replay") {
            assert!(number(&seen["share"]) < 0.4, "{view}: {seen}");
        }
    }
}

fn the_strip_of_marks_is_dragged(browser: &mut impl Page) {
    let strip = browser.value(
        "(({ left, top, width, height }) => ({ left, top, width, height }))(document.getElementById('timeline').getBoundingClientRect())",
    );
    let (left, width) = (number(&strip["left"]), number(&strip["width"]));
    let y = number(&strip["top"]) + number(&strip["height"]) / 2.0;
    let end = number(&browser.value("replay.state().end"));
    for (part, what) in [
        (0.25, Mouse::Press),
        (0.5, Mouse::Drag),
        (0.75, Mouse::Release),
    ] {
        let x = left + 8.0 + part * (width - 16.0);
        browser.mouse(what, x, y);
        let tick = number(&browser.value("replay.settled()")["tick"]);
        // Movements after the button was released have no effect.
        let expected = end * f64::min(part, 0.5);
        assert!(
            (tick - expected).abs() < 2.0 * end / width,
            "{tick} at {part}"
        );
    }
}

fn graphics_that_are_lost_come_back(browser: &mut impl Page) {
    let middle = "replay.pixel(300, 300)";
    let before = browser.value(middle);
    let lost = "window.lost = document.getElementById('arena').getContext('webgl2').getExtension('WEBGL_lose_context')";
    browser.value(&format!("{lost}, lost.loseContext(), 1"));
    browser.value("new Promise(done => setTimeout(done, 100))");
    // Actions during this time still take effect.
    browser.key("ArrowRight");
    browser.key("ArrowLeft");
    browser.value("lost.restoreContext(), new Promise(done => setTimeout(done, 200))");
    browser.value("replay.settled().then(() => 1)");
    assert_eq!(browser.value(middle), before);
    let failed = browser.value("document.body.classList.contains('failed')");
    assert_eq!(failed, false);
}

fn keys_turn_the_view_and_choose_a_block(browser: &mut impl Page) {
    let place = "replay.settled().then(() => replay.screen(0))";
    let first = browser.value(place);
    for (there, back) in [("a", "d"), ("w", "s"), ("A", "D"), ("W", "S"), ("e", "q")] {
        browser.key(there);
        assert_ne!(browser.value(place), first, "{there}");
        browser.key(back);
        let again = browser.value(place);
        for axis in ["x", "y"] {
            let moved = number(&again[axis]) - number(&first[axis]);
            assert!(moved.abs() < 1e-6, "{there}, {back}: {again}");
        }
    }
    let structure = browser.value("replay.state().structure");
    let mut chosen = std::collections::BTreeSet::new();
    for _ in 0..30 {
        browser.key("b");
        let selected = browser.value("replay.state().selected");
        assert!(selected.is_i64(), "{selected}");
        chosen.insert(selected.as_i64().unwrap());
    }
    for block in structure.as_array().unwrap() {
        assert!(chosen.contains(&block[0].as_i64().unwrap()), "{block}");
    }
    browser.key("B");
    let before = browser.value("replay.state().selected");
    browser.key("b");
    browser.key("B");
    assert_eq!(browser.value("replay.state().selected"), before);
}

fn the_graph_scrolls_to_what_happens_and_the_focus_stays(browser: &mut impl Page) {
    browser.size(1000, 420);
    let end = number(&browser.value("replay.state().end"));
    let mut looked = 0;
    for part in 1..=20 {
        let tick = (end * f64::from(part) / 20.0).floor();
        browser.value(&format!("replay.seek({tick}).then(() => 1)"));
        let inside = browser.value(
            "(() => {
                const box = document.getElementById('graph').getBoundingClientRect();
                const nodes = [...document.querySelectorAll('#graph .under-way, #graph .new')];
                const seen = node => {
                    const { left, right, top, bottom } = node.getBoundingClientRect();
                    return left >= box.left - 1 && right <= box.right + 1 && top >= box.top - 1 && bottom <= box.bottom + 1;
                };
                return nodes.length ? nodes.some(seen) : null;
            })()",
        );
        if !inside.is_null() {
            assert_eq!(inside, true, "at {tick}");
            looked += 1;
        }
    }
    assert!(looked > 10, "{looked}");
    let focused = browser.value(
        "(async () => {
            const line = document.querySelector('#block li button');
            line.focus();
            const text = line.parentNode.textContent;
            await replay.seek(replay.state().end);
            const same = document.activeElement.closest('#block li') !== null;
            await replay.seek(3);
            return same && document.activeElement.tagName === 'BUTTON' && text.length > 0;
        })()",
    );
    assert_eq!(focused, true);
}

fn no_block_that_is_seen_is_left_out(browser: &mut impl Page) {
    // All blocks are solid, so a click picks the block itself or a block in front of it.
    browser.value("document.getElementById('cloud').click()");
    let theme = match browser.value("themeName()").as_str().unwrap() {
        "dark" => DARK,
        _ => LIGHT,
    };
    let free = [theme.free.0, theme.free.1, theme.free.2].map(f64::from);
    // The views are the first one, one within the free blocks, and the whole arena. In the last
    // one, blocks are a few pixels wide.
    for view in [
        "replay.state().view",
        "[0.4, 0.2, 4, 8, -6, 5]",
        "[2.2, 0.6, 75, 0, 0, 8]",
        "[-1.3, 0.3, 160, 0, 0, 8]",
    ] {
        browser.value(&format!("replay.look({view})"));
        let found = browser.value(
            "replay.settled().then(({ structure, pulled, blocks }) => {
                const { clientWidth, clientHeight } = document.getElementById('arena');
                const others = new Set([...structure.map(([body]) => body), ...pulled]);
                let [seen, missing] = [0, 0];
                const pixels = [];
                for (let body = 0; body < blocks; body++) {
                    const at = replay.screen(body);
                    if (!at || at.x < 1 || at.y < 1 || at.x > clientWidth - 1 || at.y > clientHeight - 1) continue;
                    seen++;
                    const name = replay.names().some(({ x, y }) => Math.hypot(x - at.x, y - at.y) < 60);
                    const meant = replay.pick(at.x, at.y);
                    if (meant === null && !name) missing++;
                    if (meant === body && !others.has(body) && !name && pixels.length < 25) pixels.push(replay.pixel(at.x, at.y));
                }
                return { seen, missing, pixels };
            })",
        );
        assert_eq!(found["missing"], 0, "{view}: {found}");
        let pixels = found["pixels"].as_array().unwrap();
        assert!(pixels.len() > 3, "{view}: {found}");
        // The pixel has the colour of free blocks, except at lines of the wall. The brightness
        // depends on the light.
        let is_free = |pixel: &&Value| {
            let light = number(&pixel[0]) / free[0];
            let is_near = |i: usize| (number(&pixel[i]) - light * free[i]).abs() < 4.0;
            (0.15..1.1).contains(&light) && is_near(1) && is_near(2)
        };
        let drawn = pixels.iter().filter(is_free).count();
        assert!(10 * drawn >= 9 * pixels.len(), "{view}: {found}");
    }
}
