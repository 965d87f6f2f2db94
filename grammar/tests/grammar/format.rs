//! Checks that formatting changes only the layout, and that formatting twice changes nothing.
use proptest::prelude::*;
use stochc_grammar::{FormatError, Symbols, format, parse, print};

/// Character that occurs in every inserted comment and nowhere else. A number follows it.
const MARK: char = '\u{a4}';

/// Surroundings of a line.
#[derive(Clone, Copy, PartialEq)]
enum Within {
    Statements,
    Scene,
    Shape,
}

/// Draws choices from a few random bytes, which are reused cyclically.
struct Dice<'a> {
    bytes: &'a [u8],
    at: usize,
    notes: usize,
}

impl Dice<'_> {
    fn pick<'c>(&mut self, choices: &[&'c str]) -> &'c str {
        self.at += 1;
        let byte = self.bytes.get(self.at % self.bytes.len().max(1));
        choices[usize::from(byte.copied().unwrap_or(0)) % choices.len()]
    }

    /// Returns space and comments that can be between two tokens.
    fn trivia(&mut self) -> String {
        let kinds = [
            "",
            "",
            "",
            " ",
            "   ",
            "\t",
            "\n",
            "\n\n\n",
            "\r\n",
            " // #\n",
            "\n  //// #\n \n",
            " //#  \r\n",
        ];
        self.numbered(&kinds)
    }

    /// Returns space and comments with a line break.
    fn line_end(&mut self) -> String {
        let kinds = [
            "\n",
            "\n",
            "\n",
            "\n\n",
            "\n \n\n\t",
            "\r\n",
            "// #\n",
            "  //// #\n",
            "   // #\n      // #\n",
            "// #\n\n\n// #\n\n",
            "\n    // #\n",
        ];
        self.numbered(&kinds)
    }

    fn numbered(&mut self, kinds: &[&str]) -> String {
        let mut text = String::new();
        for part in self.pick(kinds).split_inclusive('#') {
            match part.strip_suffix('#') {
                Some(before) => {
                    self.notes += 1;
                    text.push_str(&std::format!("{before}{MARK}{} ", self.notes));
                }
                None => text.push_str(part),
            }
        }
        text
    }
}

/// Returns the same program with irregular layout.
fn scrawl(canonical: &str, dice: &mut Dice<'_>) -> String {
    let mut out = String::new();
    let mut within = Vec::new();
    for line in canonical.lines() {
        let code = line.trim_start();
        if code.starts_with("///") {
            out.push_str(code);
            out.push('\n');
            continue;
        }
        let inside = within.last().copied().unwrap_or(Within::Statements);
        let is_string = code.contains('"');
        let is_row = inside == Within::Shape && code.starts_with(['#', '.']);
        if is_row || is_string {
            out.push_str(&if is_row && dice.pick(&["a", "b"]) == "a" {
                code.replace(' ', "")
            } else {
                code.to_owned()
            });
            out.push_str(&dice.line_end());
            continue;
        }
        scrawl_line(code, inside, dice, &mut out);
        for sign in code.chars() {
            match sign {
                '{' => within.push(match code.split(' ').next() {
                    Some("scene") if within.is_empty() => Within::Scene,
                    Some("shape" | "layer") if inside != Within::Scene => Within::Shape,
                    _ => inside,
                }),
                '}' => {
                    within.pop();
                }
                _ => {}
            }
        }
        match inside {
            Within::Statements if !code.is_empty() && dice.pick(&["a", "b"]) == "a" => {
                out.push(' ')
            }
            _ => out.push_str(&dice.line_end()),
        }
    }
    out
}

fn scrawl_line(code: &str, inside: Within, dice: &mut Dice<'_>, out: &mut String) {
    let mut brackets = 0;
    for (i, word) in code.split_inclusive(' ').enumerate() {
        if i > 0 && word.starts_with("->") {
            out.push_str(&dice.trivia());
        }
        for sign in word.chars() {
            if matches!(sign, ')' | ']' | '}') {
                out.push_str(&dice.trivia());
            }
            out.push(sign);
            match sign {
                '[' => brackets += 1,
                ']' => brackets -= 1,
                _ => {}
            }
            let may_follow = matches!(sign, '(' | '[' | ',' | '{')
                || (sign == '=' && word.len() <= 2)
                || (sign == '>' && !word.contains(">>") && !word.contains('='));
            if may_follow {
                out.push_str(&dice.trivia());
            }
        }
        if inside == Within::Scene && word == ".. " {
            out.push_str(&dice.trivia());
        }
    }
    assert_eq!(brackets, 0, "{code}");
}

fn notes(text: &str) -> Vec<usize> {
    let marks = text.split(MARK).skip(1);
    marks
        .map(|rest| {
            let digits: String = rest.chars().take_while(char::is_ascii_digit).collect();
            digits.parse().unwrap()
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn formatting_preserves_tree_and_comments(
        tree in crate::trees::tree(),
        bytes in prop::collection::vec(any::<u8>(), 1..200),
    ) {
        let mut symbols = crate::trees::symbols();
        let canonical = print(&tree, &symbols);
        let mut dice = Dice { bytes: &bytes, at: 0, notes: 0 };
        let scrawled = scrawl(&canonical, &mut dice);
        let read = parse(&scrawled, &mut symbols);
        prop_assert!(read.errors.is_empty(), "{:?}\n{}", read.errors, scrawled);
        prop_assert_eq!(&read.tree, &tree, "the test itself changed the program\n{}", scrawled);

        let formatted = format(&scrawled);
        prop_assert!(formatted.is_ok(), "{:?}\n{}", formatted, scrawled);
        let formatted = formatted.unwrap();
        let again = parse(&formatted, &mut symbols);
        prop_assert!(again.errors.is_empty(), "{}", formatted);
        prop_assert_eq!(&again.tree, &tree, "{}\n{}", scrawled, formatted);
        let expected: Vec<usize> = (1..=dice.notes).collect();
        prop_assert_eq!(notes(&formatted), expected, "{}\n{}", scrawled, formatted);
        let twice = format(&formatted).unwrap();
        prop_assert_eq!(&twice, &formatted, "{}", scrawled);
        for line in formatted.lines() {
            prop_assert!(line.is_empty() || !line.ends_with([' ', '\t']), "{:?}", line);
        }
        prop_assert!(!formatted.contains("\n\n\n"));
    }

    #[test]
    fn printed_trees_are_formatted(tree in crate::trees::tree()) {
        let printed = print(&tree, &crate::trees::symbols());
        prop_assert_eq!(format(&printed), Ok(printed));
    }
}

const PIECES: [&str; 40] = [
    "assembly a",
    "in s",
    "{",
    "}",
    "{",
    "}",
    "\n",
    "\n",
    "\n\n",
    "\t",
    " ",
    "\r",
    "// c",
    "//// d\n",
    "/// doc\n",
    "seed plate",
    "1 x 1",
    "A at (0, 0)",
    "phase p",
    "timeout 3 min",
    "M.up -> A",
    "->>",
    "T[1..",
    "3]",
    "release A",
    ",",
    "after B",
    "t(A, 2)",
    "as k",
    "let n =",
    "-(n + 1)",
    "% 2",
    "shape s",
    "layer 1",
    "# . #",
    "##",
    "scene s",
    "20 ms",
    "0 .. 4 m/s",
    "block",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 4_000, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_formatted_or_rejected(
        pieces in prop::collection::vec(prop::sample::select(&PIECES[..]), 0..30),
        blanks in any::<bool>(),
    ) {
        let text = pieces.join(if blanks { " " } else { "" });
        match format(&text) {
            Ok(laid_out) => prop_assert_eq!(format(&laid_out), Ok(laid_out), "{:?}", text),
            Err(error) => prop_assert!(matches!(error, FormatError::Wrong(_)), "{:?}", text),
        }
    }

    #[test]
    fn a_truncated_program_is_formatted_or_rejected(
        start in 0usize..900,
        length in 0usize..40,
    ) {
        let text = include_str!("../../../examples/five_tower_reconfigured.sa");
        let start = start.min(text.len());
        let mut text = text.to_owned();
        text.replace_range(start..(start + length).min(text.len()), "");
        match format(&text) {
            Ok(laid_out) => prop_assert_eq!(format(&laid_out), Ok(laid_out), "{:?}", text),
            Err(error) => prop_assert!(matches!(error, FormatError::Wrong(_)), "{:?}", text),
        }
    }
}

/// Checks that a source is formatted as expected.
fn becomes(text: &str, expected: &str) {
    let formatted = format(text).unwrap();
    assert_eq!(formatted, expected);
    assert_eq!(format(&formatted).unwrap(), formatted);
}

#[test]
fn tokens_are_separated_consistently() {
    becomes(
        "let n=2*( 3+-4 )\nassembly a in s{seed plate n x 1{A   at( 0,0 )}phase p[ n ]timeout 3   min{\
         A.up->B[ 1 , n-1 ].east->>C[1 .. 3]after release D,E}}",
        "let n = 2 * (3 + -4)

assembly a in s {
    seed plate n x 1 { A at (0, 0) }
    phase p[n] timeout 3 min { A.up -> B[1, n - 1].east ->> C[1..3] after release D, E }
}
",
    );
}

#[test]
fn seeds_on_one_line_are_aligned() {
    becomes(
        "assembly a { seed plate 9 x 9 {
            A at (0, 0) Longer at (2, 0)
            D[10] at (0, 2)     C at (2, 2)   E at (3, 3)

            M at (1, 1) N at (2, 1)
            for i in 1..2 { F[i] at (i, 5) G[i] at (i, 6) }
        } }",
        "assembly a {
    seed plate 9 x 9 {
        A at (0, 0)       Longer at (2, 0)
        D[10] at (0, 2)   C at (2, 2)   E at (3, 3)

        M at (1, 1)   N at (2, 1)
        for i in 1..2 { F[i] at (i, 5)   G[i] at (i, 6) }
    }
}
",
    );
}

#[test]
fn comments_stay_at_their_statements() {
    becomes(
        "
// of the file

// of the assembly
assembly a { // after the head
 seed plate 1 x 1 { M at (0, 0) } // after a short block
  phase p {

    M.up -> A.up // short
       -> Longer    // long
    B.up -> C
    D.up -> E // below
              // it continues
    // own

    // before the end

  } // after the end
  // last
}
// of nothing",
        "// of the file

// of the assembly
assembly a {   // after the head
    seed plate 1 x 1 { M at (0, 0) }   // after a short block
    phase p {
        M.up -> A.up   // short
            -> Longer   // long
        B.up -> C
        D.up -> E   // below
                    // it continues
        // own

        // before the end
    }   // after the end
    // last
}
// of nothing
",
    );
}

#[test]
fn long_statements_break_before_arrows_and_after_commas() {
    becomes(
        "pattern p(a, b) {
            a.up ->> First[1..100].east ->> Second[1..100].north ->> Third[1..100].west ->> Fourth[1..100] after release Fifth
            release First[1..100], Second[1..100], Third[1..100], Fourth[1..100], Fifth[1..100], Sixth after Seventh
        }",
        "pattern p(a, b) {
    a.up ->> First[1..100].east ->> Second[1..100].north ->> Third[1..100].west ->> Fourth[1..100]
        after release Fifth
    release First[1..100], Second[1..100], Third[1..100], Fourth[1..100], Fifth[1..100], Sixth
        after Seventh
}
",
    );
}

#[test]
fn rows_of_a_layer_are_spaced_consistently() {
    becomes(
        "shape s at(-1,0){layer 1{
 ##.
#   // south
}
 layer 2..3 {
#.#

   # \t. #
 }
 layer 4 {
 #
 } layer 5 {
 } }",
        "shape s at (-1, 0) {
    layer 1 {
        ##.
        #   // south
    }
    layer 2..3 {
        # . #

        # . #
    }
    layer 4 {
        #
    }
    layer 5 {}
}
",
    );
}

#[test]
fn scenes_retain_their_lines_and_wide_gaps() {
    becomes(
        "scene s from t{tick   20ms\tblock cube{side 20cm    mass 1   kg\tfaces 1}free 3 uniform
         bond attract {
            pull 15 N within 20cm
            anchor centres 1mm tilt 26 deg }
         drag {} contact {
         } agitation kicks { speed 0..4 m / s }
         }",
        "scene s from t {
    tick 20ms  block cube { side 20cm  mass 1 kg  faces 1 }
    free 3 uniform
    bond attract {
        pull 15 N within 20cm
        anchor centres 1mm tilt 26 deg
    }
    drag {}
    contact {}
    agitation kicks { speed 0 .. 4 m / s }
}
",
    );
}

#[test]
fn a_word_does_not_become_a_unit() {
    becomes(
        "scene z {\n tick 20\rs 3\n}",
        "scene z {\n    tick 20\n    s 3\n}\n",
    );
    becomes(
        "scene z { b { tick 20\rs 3 } }",
        "scene z {\n    b {\n        tick 20\n        s 3\n    }\n}\n",
    );
}

#[test]
fn a_tab_before_or_in_a_unit_is_a_space() {
    becomes(
        "scene z {\n\ttick\t20\tms\n\twall 25 \tN\t/\tm\n\tof\t3\tmPa\ts ..\t4 mPa  s\n}\n\
         assembly a in z {\n\tphase p\ttimeout\t3\tmin {}\n}",
        "scene z {
    tick 20 ms
    wall 25 N / m
    of 3 mPa s .. 4 mPa s
}

assembly a in z {
    phase p timeout 3 min {}
}
",
    );
}

#[test]
fn line_endings_are_preserved() {
    assert_eq!(
        format("let  a = 1\r\n\r\n\r\n// b \r\n").unwrap(),
        "let a = 1\r\n\r\n// b\r\n"
    );
    assert_eq!(format("").unwrap(), "");
    assert_eq!(format(" \n\n").unwrap(), "");
}

#[test]
fn documentation_stands_directly_above_its_item() {
    becomes(
        "let n = 6 /// first

// between

///   second  \nlet m = 2",
        "let n = 6
/// first
// between
///   second
let m = 2
",
    );
}

#[test]
fn pre_attached_blocks_may_share_the_line_of_their_seed() {
    becomes(
        "aggregate  four in\ntank to 2*2 timeout 317  s // c
aggregate two to(2)
assembly a { seed plate 1 x 1 { P at (0,0) P.up->A }
seed plate 1 x 1 { P at (0,0) Q at (1, 0)  P.up->A.up->>B[1..2]
Q.up -> C Q.west -> D } }",
        "aggregate four in tank to 2 * 2 timeout 317 s   // c
aggregate two to (2)

assembly a {
    seed plate 1 x 1 { P at (0, 0)   P.up -> A }
    seed plate 1 x 1 {
        P at (0, 0)   Q at (1, 0)
        P.up -> A.up ->> B[1..2]
        Q.up -> C
        Q.west -> D
    }
}
",
    );
}

#[test]
fn a_text_with_errors_is_rejected() {
    for wrong in [
        "assembly a {",
        "let n = ;",
        "phase p { }",
        "/// alone",
        "aggregate a",
        "assembly a { seed plate 1 x 1 { P at (0, 0) P.up -> A after B } }",
        "assembly a { seed plate 1 x 1 { P at (0, 0) P.up -> A release A } }",
    ] {
        assert!(
            matches!(format(wrong), Err(FormatError::Wrong(errors)) if !errors.is_empty()),
            "{wrong}"
        );
    }
}

#[test]
fn formatting_preserves_the_trees_of_this_project() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    let mut seen = 0;
    for folder in ["examples", "tests/fixtures"] {
        for entry in std::fs::read_dir(std::format!("{root}/{folder}")).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|extension| extension != "sa") {
                continue;
            }
            let text = String::from_utf8(std::fs::read(&path).unwrap()).unwrap();
            let formatted = format(&text).unwrap();
            let mut symbols = Symbols::new();
            let (old, new) = (parse(&text, &mut symbols), parse(&formatted, &mut symbols));
            assert_eq!(old.tree, new.tree, "{}", path.display());
            assert_eq!(format(&formatted).unwrap(), formatted, "{}", path.display());
            if folder == "examples" {
                assert_eq!(formatted, text, "{} is not laid out", path.display());
            }
            seen += 1;
        }
    }
    assert!(seen > 10);
}
