//! Reads arbitrary bytes as compiled programs. Valid programs must be equal after writing and
//! reading, and must run.
use std::ops::ControlFlow;

use stochc_ir::Executable;
use stochc_runtime::{Model, Settings};

/// Reads an input as compiled programs. Panics if the result is wrong.
pub fn read(bytes: &[u8]) {
    let Ok(programs) = Executable::read_all(bytes) else {
        return;
    };
    let mut written = Vec::new();
    Executable::write_all(&programs, &mut written).expect("memory takes everything");
    let again = Executable::read_all(&written).expect("written files can be read");
    for (program, again) in programs.iter().zip(&again) {
        assert_eq!(program.identity(), again.identity());
    }
    for Executable { tables, scene, .. } in programs.iter().take(2) {
        // Run only small programs, for short executions.
        if scene.free.count > 50 || tables.roles.len() > 50 {
            continue;
        }
        for model in [Model::Shuffle, Model::Rigid] {
            let mut settings = Settings::new(model, 1);
            settings.max_ticks = Some(5);
            let mut watch = |tick, _| {
                if tick > 5 {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            };
            let _ = stochc_runtime::run(tables, scene, &settings, 1, 0, &mut watch);
        }
    }
}
