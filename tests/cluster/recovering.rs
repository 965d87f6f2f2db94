//! What goes wrong, and is made good.
use std::process::Command;

use crate::emulated::{Ensemble, SLOW, cluster, daemon, end, making, members, signal, until};

#[test]
fn a_task_that_is_killed_is_made_again() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let child = cluster.submit(&ensemble.path, "");
    signal("-9", &[making(&ensemble.path, "1")]);
    until("another array", || cluster.arrays(&ensemble.path) == 2);
    ensemble.is_made_by(child);
}

#[test]
fn a_node_that_is_lost_is_done_without() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let child = cluster.submit(&ensemble.path, "");
    making(&ensemble.path, "0");
    making(&ensemble.path, "1");
    signal("-9", &members(&cluster, Some("n2")));
    ensemble.is_made_by(child);
    let mut node = cluster.command("slurmd -N n2");
    assert!(node.status().unwrap().success());
}

/// And whoever has submitted goes away meanwhile.
#[test]
fn a_controller_that_restarts_is_waited_for() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let mut child = cluster.submit(&ensemble.path, "");
    making(&ensemble.path, "1");
    child.kill().unwrap();
    child.wait().unwrap();
    signal("-9", &[daemon(&cluster, "slurmctld")]);
    let impatient = cluster.submit(&ensemble.path, "--controller-timeout 1s");
    let child = cluster.submit(&ensemble.path, "");
    let (status, said) = end(impatient);
    assert_eq!(status, 2, "{said}");
    assert!(said.contains("Slurm has not answered for"), "{said}");
    assert!(
        said.contains("Unable to contact slurm controller"),
        "{said}"
    );
    let mut controller = cluster.command("slurmctld");
    assert!(controller.status().unwrap().success());
    until("controller", || {
        !cluster.ask("squeue --noheader").is_empty()
    });
    assert_eq!(cluster.arrays(&ensemble.path), 1);
    ensemble.is_made_by(child);
}

/// The process that makes a piece may write no further byte, as on a disk that is full: `prlimit` needs no disk of its own.
#[test]
fn a_piece_for_which_the_disk_was_full_is_made_again() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let child = cluster.submit(&ensemble.path, "");
    let id = making(&ensemble.path, "0");
    let mut limit = Command::new("prlimit");
    limit.args(["--fsize=1", "--pid", &id]);
    assert!(limit.status().unwrap().success());
    until("another array", || cluster.arrays(&ensemble.path) == 2);
    ensemble.is_made_by(child);
}
