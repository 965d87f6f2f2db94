//! Tests failures. After each, a second `stochc shard submit` completes the ensemble.
use crate::emulated::{Ensemble, Held, SLOW, cluster, daemon, members, signal, until};

#[test]
fn the_shard_of_a_killed_task_is_submitted_again() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let name = cluster.name(&ensemble.path);
    cluster.submits(&ensemble.path, 2);
    signal("-9", &[Held::making(&ensemble.path, "1").0]);
    cluster.until_ended(&name);
    let log = ensemble.path.join("slurm");
    let logs = std::fs::read_dir(log).unwrap().flatten();
    let names: Vec<String> = logs
        .map(|it| it.file_name().into_string().unwrap())
        .collect();
    assert!(names.iter().any(|it| it.ends_with("_1.log")), "{names:?}");
    cluster.submits(&ensemble.path, 1);
    ensemble.is_made();
    assert_eq!(cluster.arrays(&name), 2);
}

#[test]
fn a_lost_node_is_tolerated() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let name = cluster.name(&ensemble.path);
    cluster.submits(&ensemble.path, 2);
    let shards = ["0", "1"].map(|shard| Held::making(&ensemble.path, shard));
    let lost = members(&cluster, Some("n2"));
    assert!(shards.iter().any(|shard| lost.contains(&shard.0)));
    // All processes are stopped first, so that none can report that the others ended.
    signal("-STOP", &lost);
    signal("-9", &lost);
    // Without this update, Slurm would need half a minute to detect the loss.
    cluster.ask("scontrol update nodename=n2 state=down reason=lost");
    shards.into_iter().for_each(Held::resume);
    // By default, Slurm resubmits the task of a lost node.
    cluster.until_ended(&name);
    if ensemble.path.join("shards.json").exists() {
        cluster.submits(&ensemble.path, 1);
    }
    ensemble.is_made();
    let mut node = cluster.command("slurmd -N n2");
    assert!(node.status().unwrap().success());
    cluster.ask("scontrol update nodename=n2 state=resume");
}

#[test]
fn a_controller_may_restart() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let name = cluster.name(&ensemble.path);
    cluster.submits(&ensemble.path, 2);
    let shard = Held::making(&ensemble.path, "1");
    let controller = daemon(&cluster, "slurmctld");
    signal("-TERM", std::slice::from_ref(&controller));
    until("end of the controller", || {
        !members(&cluster, None).contains(&controller)
    });
    let (status, output) = cluster.submit(&ensemble.path, "");
    assert_eq!(status, 2, "{output}");
    for what in [
        "Unable to contact slurm controller",
        "jobs that were submitted are not affected",
    ] {
        assert!(output.contains(what), "{what}: {output}");
    }
    let mut controller = cluster.command("slurmctld");
    assert!(controller.status().unwrap().success());
    let (status, output) = cluster.submit(&ensemble.path, "");
    assert_eq!(status, 0, "{output}");
    assert!(output.contains("nothing was submitted"), "{output}");
    shard.resume();
    ensemble.is_made();
    assert_eq!(cluster.arrays(&name), 1);
}
