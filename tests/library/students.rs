//! Snapshot of the messages about mistakes that beginners make.
use std::fmt::Write as _;

use stochc::diagnostics::{Format, show};

/// Name of each mistake, with a program that makes it.
const MISTAKES: [(&str, &str); 28] = [
    (
        "a value with a wrong unit",
        "scene pool from hemisphere { enclosure hemisphere { radius 5 kg  wall 250 N/m } }
assembly a in pool { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }",
    ),
    (
        "a value without its unit",
        "scene pool from hemisphere { tick 20 }
assembly a in pool { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }",
    ),
    (
        "a face that does not exist",
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.top -> A } }",
    ),
    (
        "a side face of a seed",
        "assembly a { seed plate 3 x 1 { M at (1, 0) } phase p { M.east -> A } }",
    ),
    (
        "a forgotten phase",
        "assembly a {
    seed plate 1 x 1 { M at (0, 0) }
    M.up -> A
}",
    ),
    (
        "a loop outside of every phase",
        "assembly a {
    seed plate 3 x 1 { for i in 0..2 { M[i] at (i, 0) } }
    for i in 0..2 { M[i].up -> A[i] }
}",
    ),
    (
        "a seed outside the plate",
        "assembly a { seed plate 3 x 3 { M at (3, 3) } phase p { M.up -> A } }",
    ),
    (
        "two blocks in one cell",
        "assembly a {
    seed plate 3 x 1 { M at (0, 0)  N at (2, 0) }
    phase p {
        M.up -> A.east -> B
        N.up -> C.west -> D
    }
}",
    ),
    (
        "a loop that captures into one cell",
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { for i in 1..3 { M.up -> T[i] } } }",
    ),
    (
        "a cell that can be closed",
        "assembly a {
    seed plate 3 x 3 {
        W at (0, 1)   E at (2, 1)   S at (1, 0)   N at (1, 2)
        M at (1, 1)
    }
    phase p {
        W.up -> W1.up -> W2
        E.up -> E1
        S.up -> S1
        N.up -> N1
        W2.east -> LID
        M.up -> CORE
    }
}",
    ),
    (
        "too many free blocks",
        "scene full from hemisphere { free 300 uniform  enclosure hemisphere { radius 1 m  wall 250 N/m } }
assembly a in full { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }",
    ),
    (
        "too few free blocks",
        "scene few from hemisphere { free 3 uniform }
assembly a in few { seed plate 1 x 1 { M at (0, 0) } phase p { M.up ->> T[1..4] } }",
    ),
    (
        "a misspelt keyword",
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phse p { M.up -> A } }",
    ),
    (
        "a misspelt block",
        "assembly a {
    seed plate 1 x 1 { base at (0, 0) }
    phase p { base.up -> middle.up -> top }
    phase q { midle.east -> arm }
}",
    ),
    (
        "a chain without a face",
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M -> A } }",
    ),
    (
        "a row with a single arrow",
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> T[1..3] } }",
    ),
    (
        "a block that is not closed",
        "assembly a {
    seed plate 1 x 1 { M at (0, 0) }
    phase p {
        M.up -> A
}",
    ),
    (
        "habits of another language",
        "# a tower
assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A; A.up => B } }",
    ),
    (
        "a seed as the captured block",
        "assembly a {
    seed plate 2 x 1 { M at (0, 0)  N at (1, 0) }
    phase p { M.up -> N }
}",
    ),
    (
        "a block that is used after its release",
        "assembly a {
    seed plate 1 x 1 { M at (0, 0) }
    phase p { M.up -> A.up -> B }
    phase q { release B }
    phase r { B.up -> C }
}",
    ),
    (
        "a release of a parent",
        "assembly a {
    seed plate 1 x 1 { M at (0, 0) }
    phase p { M.up -> A.up -> B }
    phase q { release A }
}",
    ),
    (
        "captures that wait for each other",
        "assembly a {
    seed plate 2 x 1 { M at (0, 0)  N at (1, 0) }
    phase p {
        M.up -> A after B
        N.up -> B after A
    }
}",
    ),
    (
        "a scene without its clauses",
        "scene tank { tick 20 ms }
assembly a in tank { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }",
    ),
    (
        "a timeout of a capture",
        "assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A timeout 5 s } }",
    ),
    (
        "a pattern without an argument",
        "pattern tower(base, height) { base.up ->> T[1..height] }
assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { tower(M) } }",
    ),
    (
        "a scene that the assembly does not name",
        "scene tank from magnet_tank { free 6 uniform }
assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }",
    ),
    (
        "a shape that is not built",
        "shape bar { layer 1 { ### } }
assembly a { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A.east -> B  yields bar } }",
    ),
    (
        "a block that comes last into a gap",
        "assembly a {
    seed plate 3 x 1 { A at (0, 0)   M at (1, 0)   B at (2, 0) }
    phase walls {
        A.up -> A1.up -> A2
        B.up -> B1.up -> B2
    }
    phase middle { M.up -> N }
}",
    ),
];

#[test]
fn messages_for_beginners_are_unchanged() {
    let mut all = String::new();
    for (mistake, text) in MISTAKES {
        let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
        let checked = stochc::compiler::check("a.sa", &mut reader, Default::default());
        let messages = show(&checked, Format::Graphical, false, 80);
        assert!(!messages.is_empty(), "{mistake}");
        writeln!(all, "## {mistake}\n\n{text}\n\n{messages}").unwrap();
    }
    insta::with_settings!({ omit_expression => true }, { insta::assert_snapshot!(all); });
}
