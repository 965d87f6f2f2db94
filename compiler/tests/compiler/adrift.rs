//! Tests the help for a release that sets a block adrift: it is reported and it works.
use stochc_compiler::Checked;
use stochc_compiler::diagnostic::{Code, Diagnostic};

fn checked(phases: &str) -> Checked {
    crate::checked(&format!(
        "assembly a {{ seed plate 1 x 1 {{ M at (0, 0) }} {phases} }}"
    ))
}

#[test]
fn the_help_names_possible_releases() {
    for (wrong, help, right) in [
        (
            "phase p { M.up -> A.up -> B } phase q { release A }",
            "release `B` too, in this phase or earlier",
            "phase p { M.up -> A.up -> B } phase q { release A, B }",
        ),
        (
            "phase p { M.up -> A } phase q { A.up -> B release A }",
            "release `B` too, in this phase",
            "phase p { M.up -> A } phase q { A.up -> B release A, B }",
        ),
        // A phase releases a name once. Here it releases an earlier block of that name.
        (
            "phase p { M.up -> A.up -> B } phase q { release B A.north -> B release A }",
            "release `A` in a later phase, together with the new `B`: this phase releases an earlier `B`",
            "phase p { M.up -> A.up -> B } phase q { release B A.north -> B } phase r { release A, B }",
        ),
    ] {
        let found = checked(wrong).diagnostics;
        let [diagnostic] = &found[..] else {
            panic!("{wrong}: {found:#?}");
        };
        assert_eq!(diagnostic.code, Code::Adrift);
        assert_eq!(diagnostic.help.as_deref(), Some(help), "{wrong}");
        let left = checked(right).diagnostics;
        assert!(!left.iter().any(Diagnostic::is_error), "{right}: {left:#?}");
    }
}
