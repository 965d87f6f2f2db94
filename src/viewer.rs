//! Whoever looks at an ensemble while it runs.
use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, channel};

use stochc_ensemble::{Manifest, Progress};

use crate::host::Host;

/// Looks at an ensemble while it runs, and changes nothing of it.
pub trait Viewer: Debug + Sync {
    /// Says where it can be seen; the runs begin after that.
    fn begin(&self);

    /// Shows it until it has `ended`: the channel closes. `progress` [keeps times](Progress::with_times).
    fn attend(&self, manifest: &Manifest, progress: &Progress, ended: &Receiver<()>);
}

/// What is said where the system has no thread for a viewer.
pub(crate) const NO_THREAD: &str = "note: the system has no thread for `--watch`\n";

/// Does some work, and has a viewer attend, if there is one.
pub(crate) fn attended<R>(
    (viewer, host): (Option<&dyn Viewer>, &dyn Host),
    manifest: &Manifest,
    progress: &Progress,
    work: impl FnOnce() -> R,
) -> R {
    let Some(viewer) = viewer else { return work() };
    viewer.begin();
    std::thread::scope(|scope| {
        // Dropped at the end of the work, also by a panic.
        let (_working, ended) = channel();
        // Nothing that goes wrong with it is to cost a run.
        let attend = move || {
            let _ = catch_unwind(AssertUnwindSafe(|| {
                viewer.attend(manifest, progress, &ended);
            }));
        };
        if std::thread::Builder::new()
            .spawn_scoped(scope, attend)
            .is_err()
        {
            host.warn(NO_THREAD);
        }
        work()
    })
}
