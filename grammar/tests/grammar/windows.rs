//! Checks that reading a text in windows gives the same result as reading it whole.
use stochc_grammar::tree::{Item, ItemKind, Term, Tree};
use stochc_grammar::{MAX_STATEMENT, Parsed, Symbols, SyntaxErrorKind, accepts, parse};

/// Size that exceeds the largest first window.
const LARGE: usize = 80_000;

fn read(text: &str) -> Parsed {
    parse(text, &mut Symbols::new())
}

/// Returns the statements of the only phase of the only assembly.
fn statements(tree: &Tree) -> &[Item] {
    let [ref assembly] = tree.items[..] else {
        panic!("{} items", tree.items.len());
    };
    let ItemKind::Assembly(assembly) = &assembly.kind else {
        panic!("no assembly");
    };
    let [ref phase] = assembly.body[..] else {
        panic!("{} parts", assembly.body.len());
    };
    let ItemKind::Phase(phase) = &phase.kind else {
        panic!("no phase");
    };
    &phase.body
}

/// Compares a phase of many equal statements with small files of one statement each.
fn repeats(statement: &str, size: usize) {
    let head = "assembly a { phase p {";
    let alone = read(&format!("{head}{statement}}} }}"));
    assert_eq!(alone.errors, [], "{statement}");
    let alone = statements(&alone.tree);
    let count = size / statement.len() + 2;
    // Shifting the text moves the window borders through every byte of the statement.
    let step = (statement.len() / 16).max(1);
    for shift in (0..statement.len()).step_by(step) {
        let text = format!(
            "{}{head}{}}} }}",
            " ".repeat(shift),
            statement.repeat(count)
        );
        let many = read(&text);
        assert_eq!(many.errors, [], "shifted by {shift}: {statement}");
        let many = statements(&many.tree);
        assert_eq!(
            many.len(),
            count * alone.len(),
            "shifted by {shift}: {statement}"
        );
        for group in many.chunks(alone.len()) {
            assert_eq!(group, alone, "shifted by {shift}: {statement}");
        }
    }
}

#[test]
fn windows_may_split_statements() {
    for statement in [
        " A.up -> B\n",
        "A.up -> B[1, 2].north ->> T[1..n+1].east -> C after J, release K, L\n",
        "A.up\n->\nB\nafter\nrelease\nrelease1\n",
        "A.up->B\r\n",
        "A.up -> B\t\r\nafter\r\nC\r\n",
        "release A, B[1..3] after release C\n",
        "tower(A, 2 + (3 * -n), up, b.T[2]) as a\ntower(A)\n",
        "let n = 3 + 4\n- 2 // * 3\n * (n\n/2)\n",
        "/// one\n/// two\nA.up -> B // end\n",
        "/// one\r\n/// two -> {\r\nA.up -> B // } end\r\n",
        "// } all of it {\n//// four\n/// three\nA.up // here {\n -> // and } here\n B\n",
        "for i in 1..4 { for j in 1..i { A.up -> B[i, j] } }\n",
        "A.up -> B C.up -> D tower(A) release E let n = 3 yields s ",
        "/// µ\u{202e}\u{200b}é 🦀 }\nA.up -> B // µ\u{202e}\u{200b}é 🦀\n",
    ] {
        repeats(statement, LARGE);
    }
}

#[test]
fn statements_longer_than_a_window_are_read() {
    let long = format!(
        " A.up{} after C{}\n",
        " -> B.up".repeat(9_000),
        ", D".repeat(9_000)
    );
    let long = long.replace("B.up after", "B after");
    repeats(&long, 3 * long.len());
    let comment = format!(
        "A.up // {}\n -> B /// {}\n C.up -> D\n",
        "x {".repeat(30_000),
        "y }".repeat(30_000)
    );
    repeats(&comment, 3 * comment.len());
    let word = format!(
        "A.up -> {} after {}\n",
        "b".repeat(100_000),
        "c".repeat(100_000)
    );
    repeats(&word, 3 * word.len());
    let blank = format!(
        "A.up {} -> {} B\n",
        "\n \r\t".repeat(30_000),
        " ".repeat(100_000)
    );
    repeats(&blank, 3 * blank.len());
}

#[test]
fn one_line_of_megabytes_is_read() {
    let count = 300_000;
    for (end, statement) in [("", "A.up -> B "), ("\n", "A.up->B "), ("\r\n", "t(A,1)")] {
        let body = statement.repeat(count);
        let text = format!("assembly a {{ phase p {{ {body}}} }}{end}");
        let parsed = read(&text);
        assert_eq!(parsed.errors, []);
        assert_eq!(statements(&parsed.tree).len(), count);
    }
}

/// Errors in a long line have the right position and message.
#[test]
fn errors_in_a_huge_line_read_as_in_a_short_one() {
    for size in [10_usize, 10_000, 2_000_000] {
        let good = "A.up -> B ".repeat(size);
        let text = format!("assembly a {{ phase p {{ {good} ! {good} }} }}");
        let parsed = read(&text);
        let at = text.find('!').unwrap() as u32;
        assert_eq!(parsed.errors.len(), 1, "{size}");
        assert_eq!(parsed.errors[0].span.start, at, "{size}");
        assert!(
            matches!(&parsed.errors[0].kind, SyntaxErrorKind::Unexpected { found, .. } if found == "!"),
            "{size}: {:?}",
            parsed.errors[0]
        );
        assert_eq!(statements(&parsed.tree).len(), size);
    }
}

#[test]
fn a_too_long_statement_is_reported() {
    let text = format!(
        "assembly a {{ phase p {{\nA.up{}\nC.up -> D\n}} }}",
        " -> B".repeat(MAX_STATEMENT)
    );
    let parsed = read(&text);
    assert_eq!(parsed.errors.len(), 1);
    assert_eq!(parsed.errors[0].kind, SyntaxErrorKind::StatementTooLong);
    assert_eq!(statements(&parsed.tree).len(), 1);
}

#[test]
fn scenes_and_shapes_larger_than_a_window_are_read() {
    for end in ["\n", "\r\n", " ", " // é }\n"] {
        let words = format!("tick 20 ms {{ speed 0 .. 0.4 m/s x }}{end}").repeat(9_000);
        let text = format!("scene s {{ {words} }} scene t {{ }} let n = 3");
        assert!(accepts(&text));
        let parsed = read(&text);
        assert_eq!(parsed.errors, []);
        assert_eq!(parsed.tree.items.len(), 3);
        let ItemKind::Scene(scene) = &parsed.tree.items[0].kind else {
            panic!("no scene");
        };
        assert_eq!(scene.terms.len(), 3 * 9_000);
        for clause in scene.terms.chunks(3) {
            assert!(matches!(&clause[1], Term::Quantity(tick) if tick.unit[0].symbol == "ms"));
            assert!(matches!(&clause[2], Term::Block(terms, _) if terms.len() == 3));
        }
    }
    for end in ["\n", "\r\n", " // }\n"] {
        let rows = format!("# . #  .{end}").repeat(9_000);
        let layers = format!("layer 1..2 {{{end}#{end}}}{end}").repeat(3_000);
        let text = format!("shape s {{ layer 3 {{ {rows} }} {layers} }} let n = 3");
        assert!(accepts(&text));
        let parsed = read(&text);
        assert_eq!(parsed.errors, []);
        let ItemKind::Shape(shape) = &parsed.tree.items[0].kind else {
            panic!("no shape");
        };
        assert_eq!(shape.layers.len(), 3_001);
        assert_eq!(shape.layers[0].rows.len(), 9_000);
        assert!(
            shape.layers[0]
                .rows
                .iter()
                .all(|row| row.cells == [true, false, true, false])
        );
    }
    // A row of a megabyte is a single row.
    let text = format!("shape s {{ layer 1 {{ {} \n # }} }}", "#.".repeat(500_000));
    let parsed = read(&text);
    assert_eq!(parsed.errors, []);
    let ItemKind::Shape(shape) = &parsed.tree.items[0].kind else {
        panic!("no shape");
    };
    assert_eq!(shape.layers[0].rows.len(), 2);
    assert_eq!(shape.layers[0].rows[0].cells.len(), 1_000_000);
}

/// Reads many small scenes and shapes. The text after the end of a block is read again.
#[test]
fn alternating_blocks_are_read() {
    let text = "scene s from t { tick 20 ms x { y } }\nshape s at (1, -2) { layer 1 { # } }\n\
                assembly a in s { seed plate 3 x n { A at (0, 0) } phase p timeout 3 s { } }\n\
                pattern p(a) { for i in 1..2 { } }\nimport \"x\"\n"
        .repeat(3_000);
    assert!(accepts(&text));
    let parsed = read(&text);
    assert_eq!(parsed.errors, []);
    assert_eq!(parsed.tree.items.len(), 5 * 3_000);
    for group in parsed.tree.items.chunks(5) {
        assert_eq!(group, &parsed.tree.items[..5]);
    }
}

/// Each kind of error, except exceeded limits, which are not part of the grammar.
#[test]
fn errors_agree_with_the_whole_grammar() {
    let texts = [
        "assembly a { seed }",
        "assembly a {",
        "assembly a phase p { } }",
        "}",
        "assembly a { phase p { } } }",
        "assembly a { A.up -> B }",
        "phase p { }",
        "shape s (2)",
        "scene s from hemisphere { free uniform }",
        "scene s from hemisphere { tick s }",
        "assembly a { seed plate 1 x 1 { after at (0, 0) } }",
        "assembly a { seed plate 1 x 1 { up at (0, 0) } }",
        "assembly a { phase p { A.B -> C } }",
        "assembly a { phase p { up -> C } }",
        "let n = 99999999999999999999",
        "scene s from hemisphere { tick 1e999 s }",
        "deny tight-approach\n",
        "allow tight-approach \"why\"",
        "/// to nothing\n",
        "shape s { layer 1 { # } .. }",
        "shape s { layer 1 { layer 2 { # } } }",
        "assembly a { } /// to nothing",
    ];
    let mut kinds = std::collections::HashSet::new();
    for text in texts {
        let parsed = read(text);
        let of_grammar = (parsed.errors.iter()).any(|error| error.kind.is_of_grammar());
        assert_eq!(!of_grammar, accepts(text), "{text:?}: {:?}", parsed.errors);
        kinds.extend(
            parsed
                .errors
                .into_iter()
                .map(|error| std::mem::discriminant(&error.kind)),
        );
    }
    assert!(kinds.len() >= 10, "{}", kinds.len());
}

/// One wrong byte is far beyond the first window. Both readers report it, or neither does.
#[test]
fn acceptance_agrees_with_the_whole_grammar() {
    let good =
        "/// doc\nA.up -> B after C // so\r\ntower(A, 2) as t\nrelease A, B\nfor i in 1..2 { }\n";
    let many = good.repeat(500);
    let middle = many[..many.len() / 2].rfind("///").unwrap();
    for (place, _) in good.char_indices() {
        for wrong in [
            "!", "}", "{", "->", "(", " ", "\n", "/", ",", "after ", "é", "\0", "\r",
        ] {
            let at = middle + place;
            let text = format!(
                "assembly a {{ phase p {{ {}{wrong}{} }} }}",
                &many[..at],
                &many[at..]
            );
            let parsed = read(&text);
            let wrong_by_grammar = (parsed.errors.iter()).any(|error| error.kind.is_of_grammar());
            assert_eq!(
                !wrong_by_grammar,
                accepts(&text),
                "{wrong:?} in {:?}: {:?}",
                &text[at - 10..at + 50],
                parsed.errors
            );
        }
    }
}

#[test]
fn a_range_of_values_may_cross_windows() {
    // A value is as long as the first window, and its `..` is at the end of a line.
    for length in 200..300 {
        let zeros = "0".repeat(length);
        let text = format!("scene s {{ speed 0.{zeros}1 ..\n 4 m/s }}");
        let parsed = parse(&text, &mut Symbols::new());
        assert_eq!(parsed.errors, [], "{length}");
    }
}

/// The grammar does not check which clause a block belongs to. The compiler does.
#[test]
fn a_block_of_a_scene_without_a_word_is_read() {
    for text in [
        "scene c { { speed 0 } }",
        "scene c { contact { a 0 } { b 0 } 1 { } }",
    ] {
        assert_eq!(read(text).errors, [], "{text}");
        assert!(accepts(text), "{text}");
    }
}
