//! Checks that the attachment of blocks depends on the blocks, not on their names.
use stochc_compiler::check;
use stochc_compiler::diagnostic::Code;
use stochc_control::explore::ExplorationVerdict;

use crate::programs::{explore, tables};

fn program(phase: &str) -> String {
    format!(
        "assembly holders {{
            seed plate 3 x 1 {{ M at (0, 0)  N at (2, 0) }}
            phase grow {{ M.up -> A.up -> B  N.up -> C }}
            phase change {{ {phase} }}
        }}"
    )
}

#[test]
fn a_block_is_not_released_for_a_namesake() {
    for phase in [
        // The first B is released. The second B is attached to a block that is also released.
        "release B  A.east -> B  release A",
        "release B  N.up -> X.up -> B  release C, X",
        // The block that replaces a released one stays.
        "release B  A.up -> D  release A",
    ] {
        let text = program(phase);
        let mut reader = |_: &str| Ok(text.clone().into_bytes());
        let checked = check("holders.sa", &mut reader, Default::default());
        let errors: Vec<Code> = (checked.diagnostics.iter())
            .filter(|diagnostic| diagnostic.is_error())
            .map(|diagnostic| diagnostic.code)
            .collect();
        assert_eq!(errors, [Code::Adrift], "{phase}");
    }
}

#[test]
fn a_release_waits_for_all_children() {
    for phase in [
        "release B  A.up -> D  release D, A",
        "release B, A  M.up -> A after release B",
        "release C  N.up -> X.up -> C after release C  C.up -> D",
        "release B, A  M.up -> B after release B  B.up -> A after release A",
    ] {
        let tables = tables(&program(phase));
        assert_eq!(
            explore(&tables).verdict,
            ExplorationVerdict::Holds,
            "{phase}"
        );
    }
}
