//! Section with warnings, at the top of the page.
use stochc_files::shell;
use stochc_runtime::Model;

use crate::analysis::reported_program::Input;
use crate::ensemble_report::html::{code, name};
use crate::tables::{KNOWN_BIAS, lower_bounds};

/// Returns warnings about a results folder as HTML. `is_running` states whether runs of the folder
/// are still being simulated.
pub(super) fn warnings(input: &Input, is_running: bool) -> Vec<String> {
    let mut found = Vec::new();
    let manifest = &input.manifest;
    let done = input.finished.len() as u64;
    let path = name(&input.path);
    let total = manifest.total();
    if done < total && is_running {
        found.push(format!(
            "{path} is <strong>still running</strong>: {done} of {total} runs are finished. Short runs \
             finish first, so times are too short until all runs are finished."
        ));
    } else if done < total {
        found.push(format!(
            "{path} is <strong>not finished</strong>: {done} of {total} runs are finished. The \
             slowest runs are missing, so the times are too short. To resume, run {}",
            code(&format!("stochc resume {}", shell::file(&input.path)))
        ));
    }
    if manifest.uses(Model::Shuffle) {
        found.push(format!(
            "{path} was made with the model <code>shuffle</code>. It has no physics, so its times \
             have no meaning."
        ));
    }
    if manifest.uses(Model::Rate) {
        found.push(format!("{path}: {}", name(KNOWN_BIAS)));
    }
    let bounds = lower_bounds(manifest).into_iter();
    found.extend(bounds.map(|bound| format!("{path}: {}", name(&bound))));
    if let Some(reduction) = manifest.settings.reduction {
        found.push(format!(
            "The runs of {path} leave out one part of the scene: {}.",
            reduction.name()
        ));
    }
    let version = env!("CARGO_PKG_VERSION");
    if manifest.stochc != version {
        found.push(format!(
            "The runs of {path} were made by stochc {}, and this report by {version}. Only that version can repeat the runs \
             exactly.",
            name(&manifest.stochc)
        ));
    }
    found
}
