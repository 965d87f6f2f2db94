//! Checks that the compiler ends quickly for any input, with diagnostics that can be rendered.
use std::collections::BTreeMap;
use std::fmt::Write as _;

use proptest::prelude::*;
use proptest::sample::{Index, select};
use stochc_compiler::diagnostic::{Code, Diagnostic, Renderer};
use stochc_compiler::{Checked, Limits, check};

const EXAMPLES: [&str; 8] = [
    include_str!("../../../examples/five_tower.sa"),
    include_str!("../../../examples/five_tower_reconfigured.sa"),
    include_str!("../../../examples/line.sa"),
    include_str!("../../../examples/open_platform.sa"),
    include_str!("../../../examples/closed_platform.sa"),
    include_str!("../../../tests/findings/names_and_syntax.sa"),
    include_str!("../../../tests/findings/order_and_shape.sa"),
    include_str!("../../../tests/findings/scene.sa"),
];

/// Keywords and characters of the language, valid and invalid, for generating texts.
const TOKENS: [&str; 80] = [
    "assembly",
    "aggregate",
    "aggregate a in magnet_tank to",
    "to",
    "reject",
    "phase",
    "seed",
    "plate",
    "pattern",
    "shape",
    "scene",
    "layer",
    "let",
    "for",
    "in",
    "import",
    "release",
    "after",
    "yields",
    "expect",
    "timeout",
    "at",
    "as",
    "from",
    "up",
    "down",
    "north",
    "A",
    "B",
    "M",
    "T",
    "T[1]",
    "T[1..3]",
    "T[i, 2]",
    "a.b",
    "A.up",
    "B.east",
    "n",
    "i",
    "x",
    "=",
    "->",
    "->>",
    "..",
    ",",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "{",
    "}",
    "#",
    ".",
    "0",
    "1",
    "2",
    "-1",
    "9223372036854775807",
    "2147483648",
    "0.5",
    "3 x 3",
    "cm",
    "m/s",
    "kg",
    "%",
    "\"a.sa\"",
    "\"",
    "// c\n",
    "/// d\n",
    "\n",
    "\r\n",
    "tower(A, 2)",
    "+",
    "*",
    "/",
    "block",
    "bond",
    "\u{202e}",
];

/// Limits that are small enough for quick tests, and large enough to be reached seldom.
const SMALL: Limits = Limits {
    events: 20_000,
    steps: 100_000,
    search: 100_000,
    further: None,
};

fn run(bytes: &[u8], limits: Limits) -> Checked {
    let mut reader = |path: &str| match path {
        "bad.sa" => Ok(bytes.to_vec()),
        _ => Err(std::io::Error::other("there is only one file")),
    };
    let checked = check("bad.sa", &mut reader, limits);
    examine(&checked);
    checked
}

/// Checks the properties that every outcome must have.
fn examine(checked: &Checked) {
    let renderer = Renderer::new(false, 100);
    for diagnostic in &checked.diagnostics {
        assert!(!diagnostic.title.is_empty(), "{diagnostic:?}");
        for label in &diagnostic.labels {
            let text = &checked.sources.file(label.location.file).text;
            let (start, end) = (
                label.location.span.start as usize,
                label.location.span.end as usize,
            );
            assert!(text.get(start..end).is_some(), "{diagnostic:?}");
        }
    }
    for diagnostic in checked.diagnostics.iter().take(20) {
        let shown = renderer.render(diagnostic, &checked.sources);
        assert!(shown.contains(diagnostic.code.name()), "{shown}");
        assert!(shown.len() < 100_000, "{} bytes", shown.len());
        let hostile = |c: char| c.is_control() && c != '\n';
        assert!(!shown.contains(hostile), "{shown:?}");
    }
    if !checked.has_errors() {
        assert!(
            checked
                .programs
                .iter()
                .all(|program| program.tables.is_some())
        );
    }
}

fn codes(checked: &Checked) -> Vec<Code> {
    let mut codes: Vec<Code> = checked
        .diagnostics
        .iter()
        .map(|diagnostic| diagnostic.code)
        .collect();
    codes.dedup();
    codes
}

/// Returns a program of one phase.
fn program(phase: &str) -> String {
    format!(
        "assembly a {{ seed plate 3 x 3 {{ A at (0, 0) B at (2, 2) }}\nphase p {{\n{phase}\n}} }}\n"
    )
}

/// A way to corrupt a text.
#[derive(Clone, Debug)]
enum Slip {
    Delete(Index, usize),
    DeleteLine(Index),
    RepeatLine(Index),
    SwapLines(Index, Index),
    Insert(Index, &'static str),
    Replace(Index, u8),
    Cut(Index),
}

fn slip() -> impl Strategy<Value = Slip> {
    let at = any::<Index>;
    prop_oneof![
        (at(), 1..20usize).prop_map(|(at, count)| Slip::Delete(at, count)),
        at().prop_map(Slip::DeleteLine),
        at().prop_map(Slip::RepeatLine),
        (at(), at()).prop_map(|(a, b)| Slip::SwapLines(a, b)),
        (at(), select(&TOKENS[..])).prop_map(|(at, token)| Slip::Insert(at, token)),
        (at(), any::<u8>()).prop_map(|(at, byte)| Slip::Replace(at, byte)),
        at().prop_map(Slip::Cut),
    ]
}

fn corrupt(text: Vec<u8>, slip: &Slip) -> Vec<u8> {
    let mut bytes = text;
    if bytes.is_empty() {
        return bytes;
    }
    let mut lines: Vec<Vec<u8>> = bytes
        .split_inclusive(|&b| b == b'\n')
        .map(Vec::from)
        .collect();
    match slip {
        Slip::Delete(at, count) => {
            let at = at.index(bytes.len());
            bytes.drain(at..(at + count).min(bytes.len()));
            return bytes;
        }
        Slip::Insert(at, token) => {
            let at = at.index(bytes.len());
            bytes.splice(at..at, format!(" {token} ").into_bytes());
            return bytes;
        }
        Slip::Replace(at, byte) => {
            let at = at.index(bytes.len());
            bytes[at] = *byte;
            return bytes;
        }
        Slip::Cut(at) => {
            bytes.truncate(at.index(bytes.len()));
            return bytes;
        }
        Slip::DeleteLine(at) => {
            lines.remove(at.index(lines.len()));
        }
        Slip::RepeatLine(at) => {
            let at = at.index(lines.len());
            lines.insert(at, lines[at].clone());
        }
        Slip::SwapLines(a, b) => {
            let (a, b) = (a.index(lines.len()), b.index(lines.len()));
            lines.swap(a, b);
        }
    }
    lines.concat()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_get_diagnostics(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        run(&bytes, SMALL);
    }

    #[test]
    fn random_words_get_diagnostics(tokens in prop::collection::vec(select(&TOKENS[..]), 0..80)) {
        let text = tokens.join(" ");
        run(text.as_bytes(), SMALL);
        run(program(&text).as_bytes(), SMALL);
    }

    #[test]
    fn corrupted_examples_get_diagnostics(
        example in select(&EXAMPLES[..]),
        slips in prop::collection::vec(slip(), 1..6),
    ) {
        let text = slips.iter().fold(example.as_bytes().to_vec(), corrupt);
        run(&text, SMALL);
    }
}

#[test]
fn a_million_characters_get_diagnostics() {
    const MANY: usize = 1_000_000;
    for sign in [
        "(", ")", "{", "}", "[", "]", "\"", "/", "-", ">", "#", ".", ",", "\0", "é", "a ",
    ] {
        let signs = sign.repeat(MANY);
        for text in [
            signs.clone(),
            format!("let n = {signs}"),
            format!("scene s {{ {signs}"),
            format!("shape s {{ layer 1 {{ {signs}"),
            program(&signs),
            program(&format!("A.up -> T{signs}")),
            program(&format!("A.up -> T[{signs}")),
            program(&format!("t{signs}")),
        ] {
            let checked = run(text.as_bytes(), SMALL);
            assert!(
                checked.diagnostics.len() <= 120,
                "{sign}: {}",
                checked.diagnostics.len()
            );
        }
    }
}

#[test]
fn nesting_is_limited_and_never_overflows_the_stack() {
    const DEEP: usize = 100_000;
    let nested = |open: &str, close: &str| format!("{}{}", open.repeat(DEEP), close.repeat(DEEP));
    for (text, code) in [
        (program(&nested("for i in 1..2 {", "}")), Code::TooDeep),
        (
            program(&format!(
                "let n = {}",
                nested("(", ")").replace("()", "(1)")
            )),
            Code::TooDeep,
        ),
        (
            program(&format!(
                "let n = {}",
                nested("-(", ")").replace("()", "(1)")
            )),
            Code::TooDeep,
        ),
        (
            format!("scene s {{ {} }}", nested("a {", "}")),
            Code::TooDeep,
        ),
        (nested("pattern p() {", "}"), Code::Misplaced),
        (nested("assembly a {", "}"), Code::Misplaced),
        (nested("shape s {", "}"), Code::Syntax),
        (nested("shape s { layer 1 {", "}}"), Code::Syntax),
    ] {
        let checked = run(text.as_bytes(), SMALL);
        assert!(
            codes(&checked).contains(&code),
            "{code}: {:?}",
            codes(&checked)
        );
    }
    let rows = |count: usize, joint: &str| program(&format!("let n = 1{}", joint.repeat(count)));
    for joint in ["+1", " * n", "--1", "-(1)"] {
        run(rows(DEEP, joint).as_bytes(), SMALL);
        run(rows(1_000_000, joint).as_bytes(), SMALL);
    }
    run(
        program(&format!("let n = {}1", "-".repeat(1_000_000))).as_bytes(),
        SMALL,
    );
}

/// A sum of a hundred terms is compiled. A sum beyond the limit is reported.
#[test]
fn long_sums_are_evaluated() {
    let sum = format!("let n = 1{}\nA.up ->> T[1..n]", "+1".repeat(500));
    let checked = run(program(&sum).as_bytes(), SMALL);
    assert_eq!(checked.programs[0].plan.events.len(), 501);
}

#[test]
fn programs_that_multiply_stop_at_the_limit() {
    let doubling: String = (0..40).fold(String::new(), |mut text, i| {
        let inner = if i == 0 {
            "A.up -> B".to_owned()
        } else {
            format!("p{}() p{}()", i - 1, i - 1)
        };
        let _ = writeln!(text, "pattern p{i}() {{ {inner} }}");
        text
    });
    let silent = doubling.replace("A.up -> B", "");
    for (text, most) in [
        (format!("{doubling}{}", program("p39()")), 1),
        (format!("{silent}{}", program("p39()")), 1),
        (program("for i in 1..1000000000 { }"), 1),
        (
            program("for i in 1..1000000000 { for j in 1..1000000000 { } }"),
            1,
        ),
        (
            program("for i in -9223372036854775807..9223372036854775807 { }"),
            2,
        ),
        (program("A.up ->> T[1..2000000000]"), 1),
        (program("A.up ->> T[1..2000, 1..2000, 1..2000]"), 1),
        (
            program("A.up ->> T[-2147483648..2147483647, -2147483648..2147483647]"),
            1,
        ),
        (program("A.up -> T after E[1..2000000000]"), 1),
        (program("release E[1..2000000000]"), 1),
        (program("for i in 1..1000000000 { let n = i * 3 }"), 1),
    ] {
        let checked = run(text.as_bytes(), SMALL);
        assert!(
            codes(&checked).contains(&Code::ExpansionLimit),
            "{text}: {:?}",
            checked.diagnostics
        );
        let errors = checked
            .diagnostics
            .iter()
            .filter(|diagnostic| diagnostic.is_error())
            .count();
        assert!(errors <= most, "{text}: {:#?}", checked.diagnostics);
    }
    // An evaluated range counts even if it is not used.
    let text = program("for i in 1..1000000 { A[1..19999].up -> B }");
    run(text.as_bytes(), SMALL);
}

#[test]
fn mistakes_in_loops_are_reported_a_limited_number_of_times() {
    for statement in [
        "A.up -> T[i]",
        "X[i].up -> Y[i]",
        "release X[i]",
        "A.up -> B after X[i]",
        "A.down -> T[i]",
        "A -> T[i]",
        "A.up -> T[k]",
        "A.up -> T[i / 0]",
        "A.up -> T[i * 9223372036854775807]",
        "A.up -> T[i + 2147483647]",
        "q(i)",
        "A.up -> A",
        "A.up -> T[1..i]",
        "A.up -> T[i].up -> U[i].down -> V[i]",
        "a[i].T.up -> B",
    ] {
        let text = program(&format!("for i in 1..100000 {{ {statement} }}"));
        let checked = run(text.as_bytes(), Limits::default());
        assert!(checked.has_errors(), "{statement}");
        assert!(
            checked.diagnostics.len() <= 4,
            "{statement}: {:#?}",
            checked.diagnostics
        );
    }
    let text = program(&format!("A.up{}", " -> B".repeat(200_000)));
    let checked = run(text.as_bytes(), Limits::default());
    assert!(
        checked.diagnostics.len() <= 1_100,
        "{}",
        checked.diagnostics.len()
    );
}

/// The evaluation of an expression counts, in addition to its statement.
#[test]
fn long_expressions_in_loops_reach_the_limit() {
    let sum = vec!["1"; 800].join(" + ");
    for (rounds, has_enough) in [(100, false), (1_000, true)] {
        let text = program(&format!("for i in 1..{rounds} {{ let _x = {sum} }}"));
        let checked = run(text.as_bytes(), SMALL);
        let is_stopped = codes(&checked).contains(&Code::ExpansionLimit);
        assert_eq!(is_stopped, has_enough, "{rounds}");
    }
}

#[test]
fn recursive_patterns_are_reported() {
    let patterns = "pattern p(a) { q(a) } pattern q(a) { a.up -> b r(b) } pattern r(a) { p(a) }";
    let checked = run(format!("{patterns} {}", program("p(A)")).as_bytes(), SMALL);
    assert!(codes(&checked).contains(&Code::RecursivePattern));
    let chain: String = (0..1_000).fold(String::new(), |mut text, i| {
        let _ = writeln!(text, "pattern p{i}(a) {{ a.up -> b p{}(b) }}", i + 1);
        text
    });
    let checked = run(format!("{chain} {}", program("p0(A)")).as_bytes(), SMALL);
    assert_eq!(
        codes(&checked).first(),
        Some(&Code::TooDeep),
        "{:?}",
        checked.diagnostics
    );
}

#[test]
fn import_cycles_are_reported_once() {
    let circle = |count: usize, all: bool| {
        let mut reads = BTreeMap::new();
        let mut reader = |path: &str| {
            *reads.entry(path.to_owned()).or_insert(0) += 1;
            let number: usize = path[..path.len() - 3]
                .parse()
                .map_err(|_| std::io::Error::other("no number"))?;
            let mut text = String::new();
            let next = if all {
                0..count
            } else {
                number + 1..number + 2
            };
            for other in next {
                let _ = writeln!(text, "import \"{}.sa\"", other % count);
            }
            Ok(text.into_bytes())
        };
        let checked = check("0.sa", &mut reader, SMALL);
        assert!(reads.values().all(|&count| count == 1));
        assert_eq!(reads.len(), count);
        examine(&checked);
        assert_eq!(codes(&checked), [Code::ImportCycle]);
        checked
    };
    assert_eq!(circle(1, false).diagnostics.len(), 1);
    assert_eq!(circle(2, false).diagnostics.len(), 1);
    assert_eq!(circle(1_000, false).diagnostics.len(), 1);
    assert!(circle(100, true).diagnostics.len() <= 100);
}

#[test]
fn files_that_import_themselves_under_new_names_are_limited() {
    let mut reads = 0;
    let mut reader = |path: &str| {
        reads += 1;
        // Operating systems stop after this number of links in a path.
        if path.matches('/').count() > 40 {
            return Err(std::io::Error::other("too many levels of symbolic links"));
        }
        Ok(b"import \"l/a.sa\" import \"m/a.sa\" let n = 1".to_vec())
    };
    let checked = check("a.sa", &mut reader, SMALL);
    examine(&checked);
    let limit = |diagnostic: &&Diagnostic| diagnostic.code == Code::ExpansionLimit;
    assert_eq!(checked.diagnostics.iter().filter(limit).count(), 1);
    assert!(reads <= 10_001, "{reads}");
}

#[test]
fn long_words_are_shortened() {
    let long = "a".repeat(1_000_000);
    let digits = "1".repeat(1_000_000);
    for text in [
        program(&format!("{long}.up -> B")),
        program(&format!("A.up -> {long} A.up -> {long}")),
        program(&format!("{long}(A)")),
        program(&format!("A.up -> T[{long}]")),
        program(&format!("A.up -> T[{digits}]")),
        program(&format!("A.up -> {long}.{long}")),
        program(&format!("A.up -> B after {long}")),
        program(&format!("release {long}")),
        program(&format!("yields {long}")),
        format!("scene {long} {{ {long} 1{long} }}"),
        format!("scene s {{ tick {digits} ms }}"),
        format!("scene s {{ tick 1e{digits} ms }}"),
        format!("scene s from {long} {{ }}"),
        format!("assembly a in {long} {{ }}"),
        format!("assembly {long} {{ }} assembly {long} {{ }}"),
        format!("import \"{long}\""),
        format!("/// {long}"),
        format!("shape s {{ layer {digits} {{ # }} }}"),
        digits.clone(),
        long.clone(),
    ] {
        let checked = run(text.as_bytes(), SMALL);
        assert!(checked.has_errors());
    }
}

#[test]
fn unusual_characters_are_escaped() {
    for (sign, shown) in [
        ("\u{200b}", r"`\u{200b}`"),
        ("\u{202e}", r"`\u{202e}`"),
        ("\u{a0}", r"`\u{a0}`"),
        ("\u{feff}", "a byte-order mark"),
        ("\0", r"`\0`"),
        ("\u{1b}", r"`\u{1b}`"),
        ("é", "`é`"),
        ("→", "`→`"),
        ("🦀", "`🦀`"),
        ("'", "`'`"),
        ("\\", r"`\`"),
    ] {
        let checked = run(program(&format!("A.up {sign} -> T")).as_bytes(), SMALL);
        let title = &checked.diagnostics[0].title;
        assert!(title.contains(shown), "{title}");
    }
    // Comments may contain these characters. They are rendered visibly.
    let hidden = program("A.up -> T // \u{1b}[2J \u{202e} \u{9b} \u{7}\nC.up -> D");
    let checked = run(hidden.as_bytes(), SMALL);
    let shown = Renderer::new(false, 100).render(&checked.diagnostics[0], &checked.sources);
    assert!(
        !shown.contains(['\u{1b}', '\u{202e}', '\u{9b}', '\u{7}']),
        "{shown:?}"
    );
}

#[test]
fn encodings_other_than_utf_8_are_reported() {
    let good = EXAMPLES[0];
    let sixteen =
        |bytes: fn(u16) -> [u8; 2]| good.encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
    for bytes in [
        sixteen(u16::to_le_bytes),
        [&[0xff, 0xfe], &sixteen(u16::to_le_bytes)[..]].concat(),
        [good.as_bytes(), &[0xed, 0xa0, 0x80]].concat(),
        [good.as_bytes(), &[0xf0, 0x9f]].concat(),
        [&[0x80], good.as_bytes()].concat(),
        b"\xef\xbb".to_vec(),
    ] {
        let checked = run(&bytes, SMALL);
        assert!(checked.has_errors());
    }
    // A byte order mark is not part of the text.
    let checked = run(&[b"\xef\xbb\xbf", good.as_bytes()].concat(), SMALL);
    assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
    let checked = run(b"\xef\xbb\xbf\xff", SMALL);
    assert_eq!(codes(&checked), [Code::NotUtf8]);
}

#[test]
fn numbers_at_the_edges_do_not_wrap() {
    let plate = |size: &str, at: &str| {
        format!("assembly a {{ seed plate {size} {{ A at ({at}) }} phase p {{ A.up -> B }} }}")
    };
    for (text, code) in [
        (plate("0 x 0", "0, 0"), Code::WrongValue),
        (plate("-1 x 3", "0, 0"), Code::WrongValue),
        (
            plate("9223372036854775807 x 9223372036854775807", "0, 0"),
            Code::WrongValue,
        ),
        (plate("4294967297 x 1", "0, 0"), Code::WrongValue),
        (plate("3 x 3", "3, 0"), Code::SeedOutsidePlate),
        (plate("3 x 3", "-1, 0"), Code::SeedOutsidePlate),
        (plate("3 x 3", "4294967296, 0"), Code::SeedOutsidePlate),
        (
            plate("3 x 3", "9223372036854775807, -9223372036854775807"),
            Code::SeedOutsidePlate,
        ),
        (plate("n x n", "0, 0"), Code::UnknownName),
        (
            plate("3 x 3", "9223372036854775808, 0"),
            Code::NumberTooLarge,
        ),
        (
            plate("3 x 3", "-9223372036854775807 - 2, 0"),
            Code::Arithmetic,
        ),
        (
            plate("3 x 3", "(-9223372036854775807 - 1) / -1, 0"),
            Code::Arithmetic,
        ),
        (
            plate("3 x 3", "-(-9223372036854775807 - 1), 0"),
            Code::Arithmetic,
        ),
        (
            plate("3 x 3", "9223372036854775807 * 2, 0"),
            Code::Arithmetic,
        ),
        (program("A.up -> T[2147483648]"), Code::Arithmetic),
        (
            program("A.up ->> T[2147483647..2147483648]"),
            Code::Arithmetic,
        ),
        (program("A.up -> T[1, 2, 3, 4]"), Code::WrongArguments),
        (
            program("A.up -> E.up -> F yields s")
                .replace("assembly", "shape s { layer 1..2147483647 { # } } assembly"),
            Code::ShapeMalformed,
        ),
        (
            program("A.up -> E yields s")
                .replace("assembly", "shape s { layer 2147483648 { # } } assembly"),
            Code::ShapeMalformed,
        ),
        (
            program("A.up -> E yields s").replace(
                "assembly",
                "shape s at (2147483647, -2147483648) { layer 1 { ## \n ## } } assembly",
            ),
            Code::ShapeMalformed,
        ),
        (
            program("A.up -> E yields s")
                .replace("assembly", "shape s { layer 1..2147483647 { } } assembly"),
            Code::ShapeMismatch,
        ),
    ] {
        let checked = run(text.as_bytes(), SMALL);
        assert!(
            codes(&checked).contains(&code),
            "{text}: {:#?}",
            checked.diagnostics
        );
    }
    // The remainder is 0, but the quotient does not fit into 64 bits.
    let least = plate("3 x 3", "(-9223372036854775807 - 1) % -1, 0");
    assert_eq!(codes(&run(least.as_bytes(), SMALL)), []);
    let edge = program("A.up ->> T[2147483646..2147483647].up ->> T[-2147483648..-2147483647]");
    assert!(
        run(edge.as_bytes(), SMALL)
            .diagnostics
            .iter()
            .all(|diagnostic| !diagnostic.is_error() || diagnostic.code == Code::OutsideEnclosure)
    );
    let plate =
        "assembly a { seed plate 100000 x 100000 { A at (99999, 99999) } phase p { A.up -> B } }";
    run(plate.as_bytes(), SMALL);
}

#[test]
fn work_grows_linearly_with_the_program() {
    const MANY: usize = 100_000;
    let many = |one: &dyn Fn(usize) -> String| (0..MANY).map(one).collect::<String>();
    // A cycle of events, and a chain of events.
    let circle = many(&|i| format!("X{i}.up -> X{}\n", (i + 1) % MANY));
    let checked = run(program(&circle).as_bytes(), Limits::default());
    assert!(checked.has_errors());
    let circle = many(&|i| format!("A.up -> X{i} after X{}\n", (i + 1) % MANY));
    run(program(&circle).as_bytes(), Limits::default());
    // All statements use the same cell, block or name.
    run(
        program(&many(&|i| format!("A.up -> X{i}\n"))).as_bytes(),
        Limits::default(),
    );
    run(
        program(&many(&|_| "A.up -> X\n".to_owned())).as_bytes(),
        Limits::default(),
    );
    run(
        program(&many(&|i| format!("X.up -> Y{i}\n"))).as_bytes(),
        Limits::default(),
    );
    let row = format!("A.up ->> T[1..{MANY}] B.up -> E after T[1..{MANY}]");
    run(program(&row).as_bytes(), Limits::default());
    // Phases, claims and declarations.
    let phases = many(&|i| format!("phase p{i} {{ }}\n"));
    run(
        format!("assembly a {{ seed plate 1 x 1 {{ A at (0, 0) }} {phases} }}").as_bytes(),
        Limits::default(),
    );
    // Many undeclared names next to many declared ones: not every pair may be compared.
    let patterns = many(&|i| format!("pattern q{i}(b) {{ b.up -> C }}\n"));
    let instances = program(&many(&|i| format!("r{i}(A)\n")));
    run((patterns + &instances).as_bytes(), Limits::default());
    let shapes = many(&|i| format!("shape s{i} {{ layer 1 {{ # }} }}\n"));
    let claims = program(&many(&|i| format!("yields t{i}\n")));
    run((shapes + &claims).as_bytes(), Limits::default());
    let lets = many(&|i| format!("let n{i} = 1\n"));
    let loops = program(&many(&|i| format!("for i in 0..m{i} {{ A.up -> T[i] }}\n")));
    run((lets + &loops).as_bytes(), Limits::default());
    let scenes = many(&|i| format!("scene s{i} from t{i} {{ }}\n"));
    run(scenes.as_bytes(), Limits::default());
    let phases = (0..MANY / 10).fold(String::new(), |mut text, i| {
        let _ = writeln!(text, "phase p{i} {{ T[{i}].up -> T[{}] yields s }}", i + 1);
        text
    });
    let text = format!(
        "shape s {{ layer 1 {{ # }} }} assembly a {{ seed plate 1 x 1 {{ T[0] at (0, 0) }} {phases} }}"
    );
    run(text.as_bytes(), Limits::default());
    run(
        many(&|i| format!("let n{i} = 1\n")).as_bytes(),
        Limits::default(),
    );
    run(
        many(&|_| "let n = 1\n".to_owned()).as_bytes(),
        Limits::default(),
    );
    run(
        many(&|i| format!("scene s{i} from s{} {{ }}\n", i + 1)).as_bytes(),
        Limits::default(),
    );
    run(
        many(&|i| format!("scene s{i} from hemisphere {{ tick {i} }}\n")).as_bytes(),
        Limits::default(),
    );
    run(
        format!("scene s {{ {} }}", "tick 1 ".repeat(MANY)).as_bytes(),
        Limits::default(),
    );
    run(
        format!("scene s {{ block cube {{ {} }} }}", "side 1 ".repeat(MANY)).as_bytes(),
        Limits::default(),
    );
    run(
        many(&|i| format!("pattern p(a{i}) {{ a{i}.up -> b }}\n")).as_bytes(),
        Limits::default(),
    );
    let shape = format!(
        "shape s {{ layer 1 {{ {} }} }}\n{}",
        "# ".repeat(1_000).repeat(1_000),
        program("A.up -> E yields s")
    );
    run(shape.as_bytes(), Limits::default());
    run(
        many(&|i| format!("import \"{i}.sa\"\n")).as_bytes(),
        Limits::default(),
    );
}

/// Files of a hundred megabytes: a valid one, one with a single line, and garbage.
#[test]
#[ignore = "takes minutes and 8 GB without optimization; run it by hand in release mode"]
fn files_of_a_hundred_megabytes_get_diagnostics() {
    const SIZE: usize = 100_000_000;
    let head = "scene wide from hemisphere { free 10000000 uniform \
                enclosure hemisphere { radius 10000000m wall 25 N/m } } \
                assembly a in wide { seed plate 1 x 1 { T[0] at (0, 0) } phase p { ";
    for end in ["\n", " "] {
        let mut text = head.to_owned();
        for i in 0.. {
            if text.len() >= SIZE {
                break;
            }
            let _ = write!(text, "T[{i}].up -> T[{}]{end}", i + 1);
        }
        text.push_str("} }");
        let checked = run(text.as_bytes(), Limits::default());
        assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
    }
    for sign in [
        "{",
        "}",
        "a",
        "! a\n",
        "\0",
        "// c\n",
        "/// c\n",
        "#",
        "let n = 1\n",
    ] {
        let text = sign.repeat(SIZE / sign.len());
        let checked = run(text.as_bytes(), Limits::default());
        assert_eq!(checked.has_errors(), sign != "// c\n", "{sign}");
    }
}

#[test]
fn mistakes_in_declarations_are_reported_a_limited_number_of_times() {
    for one in [
        "import \"x.sa\" import \"y%.sa\"\n",
        "pattern p() { }\n",
        "shape s { }\n",
        "scene s from t { }\n",
        "scene s% from t { }\n",
        "scene s% { tick 1 m tick }\n",
        "let n = 1\n",
    ] {
        let text: String = (0..20_000)
            .map(|i| one.replace('%', &i.to_string()))
            .collect();
        let text = format!("{text}{}", program("A.up -> B"));
        let checked = run(text.as_bytes(), Limits::default());
        assert!(checked.has_errors(), "{one}");
        assert!(
            checked.diagnostics.len() <= 2_100,
            "{one}: {}",
            checked.diagnostics.len()
        );
    }
}
