//! What goes wrong, and is made good.
use std::process::Command;

use crate::emulated::{Ensemble, Held, SLOW, cluster, daemon, end, members, signal, until};

#[test]
fn a_task_that_is_killed_is_made_again() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let name = cluster.name(&ensemble.path);
    let child = cluster.submit(&ensemble.path, "");
    signal("-9", &[Held::making(&ensemble.path, "1").0]);
    ensemble.is_made_by(child);
    assert_eq!(cluster.arrays(&name), 2);
}

#[test]
fn a_node_that_is_lost_is_done_without() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let child = cluster.submit(&ensemble.path, "");
    let pieces = ["0", "1"].map(|piece| Held::making(&ensemble.path, piece));
    let lost = members(&cluster, Some("n2"));
    assert!(pieces.iter().any(|piece| lost.contains(&piece.0)));
    // All at once, so that nobody can tell of the others' end.
    signal("-STOP", &lost);
    signal("-9", &lost);
    // Slurm finds out by itself in half a minute.
    cluster.ask("scontrol update nodename=n2 state=down reason=lost");
    pieces.into_iter().for_each(Held::goes_on);
    ensemble.is_made_by(child);
    let mut node = cluster.command("slurmd -N n2");
    assert!(node.status().unwrap().success());
    cluster.ask("scontrol update nodename=n2 state=resume");
}

/// And whoever has submitted goes away meanwhile.
#[test]
fn a_controller_that_restarts_is_waited_for() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let name = cluster.name(&ensemble.path);
    let mut child = cluster.submit(&ensemble.path, "");
    let piece = Held::making(&ensemble.path, "1");
    child.kill().unwrap();
    child.wait().unwrap();
    let controller = daemon(&cluster, "slurmctld");
    signal("-TERM", std::slice::from_ref(&controller));
    until("end of the controller", || {
        !members(&cluster, None).contains(&controller)
    });
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
    piece.goes_on();
    ensemble.is_made_by(child);
    until("controller", || cluster.arrays(&name) == 1);
}

/// The process that makes a piece may write no further byte, as on a disk that is full: `prlimit` needs no disk of its own.
#[test]
fn a_piece_for_which_the_disk_was_full_is_made_again() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let name = cluster.name(&ensemble.path);
    let child = cluster.submit(&ensemble.path, "");
    let piece = Held::making(&ensemble.path, "0");
    let mut limit = Command::new("prlimit");
    limit.args(["--fsize=1", "--pid", &piece.0]);
    assert!(limit.status().unwrap().success());
    piece.goes_on();
    ensemble.is_made_by(child);
    assert_eq!(cluster.arrays(&name), 2);
}

/// Slurm counts time limits in minutes, and looks at them twice a minute; so the end is set to be now.
#[test]
fn a_task_that_is_out_of_time_goes_on_in_the_next() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let name = cluster.name(&ensemble.path);
    let child = cluster.submit(&ensemble.path, "--time 10");
    // Held until then, however quick it is.
    Held::making(&ensemble.path, "0");
    let tasks = cluster.ask(&format!(
        "squeue --noheader --array --name={name} --format=%A|%K|"
    ));
    let task = tasks
        .lines()
        .find_map(|line| line.trim().strip_suffix("|0|"));
    let task = task.unwrap_or_else(|| panic!("{tasks}"));
    cluster.ask(&format!("scontrol update jobid={task} EndTime=now"));
    ensemble.is_made_by(child);
    assert_eq!(cluster.arrays(&name), 2);
    let timed_out = format!("squeue --noheader --states=timeout --name={name} --format=%K");
    assert_eq!(cluster.ask(&timed_out).trim(), "0");
}
