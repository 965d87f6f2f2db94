//! Where nothing goes wrong but with whoever follows.
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::emulated::{
    Cluster, FAST, SLOW, cluster, comes_to, end, ensemble, making, members, signal, until,
};

#[test]
fn all_is_well_also_if_two_submit() {
    let Some(cluster) = cluster() else { return };
    let folder = tempfile::tempdir().unwrap();
    // The site takes five tasks.
    let folders = ensemble(folder.path(), FAST, 12, 12);
    let name = cluster.name(&folders[1]);
    let both = [(); 2].map(|()| cluster.submit(&folders[1], ""));
    for child in both {
        comes_to(child, &folders);
    }
    let jobs = cluster.ask(&format!(
        "squeue --noheader --array --states=all --name={name} --format=%F|%K"
    ));
    assert_eq!(jobs.lines().count(), 4, "{jobs}");
    let (status, said) = end(cluster.submit(&folders[1], ""));
    assert_eq!((status, said.as_str()), (0, ""));
}

#[test]
fn whoever_follows_may_go_and_come_back() {
    let Some(cluster) = cluster() else { return };
    let folder = tempfile::tempdir().unwrap();
    let folders = ensemble(folder.path(), SLOW, 6, 2);
    let [_, pieces] = &folders;
    // Ctrl-C leaves the jobs alone.
    let first = cluster.submit(pieces, "");
    making(pieces, "0");
    signal("-INT", &[first.id().to_string()]);
    let (status, said) = end(first);
    assert_eq!(status, 130, "{said}");
    assert!(said.contains("the cluster goes on"), "{said}");
    assert!(said.contains("`scancel "), "{said}");
    // The machine goes away.
    let mut second = cluster.submit(pieces, "");
    std::thread::sleep(std::time::Duration::from_secs(1));
    second.kill().unwrap();
    second.wait().unwrap();
    // Somebody else cancels.
    let third = cluster.submit(pieces, "");
    std::thread::sleep(std::time::Duration::from_millis(300));
    assert_eq!(cluster.arrays(pieces), 1);
    cluster.ask(&format!("scancel --name={}", cluster.name(pieces)));
    let (status, said) = end(third);
    assert_eq!(status, 3, "{said}");
    assert!(said.contains("somebody has cancelled jobs: "), "{said}");
    // Ctrl-C takes the jobs with it, if asked.
    let fourth = cluster.submit(pieces, "--cancel-on-interrupt");
    until("another array", || cluster.arrays(pieces) == 2);
    making(pieces, "1");
    signal("-TERM", &[fourth.id().to_string()]);
    let (status, said) = end(fourth);
    assert_eq!(status, 130, "{said}");
    assert!(said.contains("are cancelled"), "{said}");
    let name = cluster.name(pieces);
    until("end of all jobs", || {
        let line = format!("squeue --noheader --name={name},{name}-merge");
        cluster.ask(&line).is_empty()
    });
    comes_to(cluster.submit(pieces, ""), &folders);
}

#[test]
fn a_cluster_that_is_killed_leaves_nothing() {
    // In its own processes.
    let Some(mut cluster) = Cluster::start() else {
        crate::skipped::skipped("slurm-wlm", "slurmctld");
        return;
    };
    let folder = cluster.folder().to_owned();
    let job = cluster.command("sbatch --parsable --output=/dev/null --wrap sleep\t1000");
    drop(job);
    let mut job = cluster.command("sbatch --output=/dev/null");
    job.arg("--wrap=sleep 1000").stdout(Stdio::null());
    assert!(job.status().unwrap().success());
    until("job", || !members(&cluster, Some("n1")).is_empty());
    assert!(folder.join("slurmctld.pid").exists());
    let id = cluster.script().id().to_string();
    let killed = Command::new("kill").args(["-9", &id]).status();
    assert!(killed.unwrap().success());
    cluster.script().wait().unwrap();
    until("end of the processes", || {
        members(&cluster, None).is_empty()
    });
    until("end of the folder", || !Path::new(&folder).exists());
    assert!(fs::metadata(&folder).is_err());
}
