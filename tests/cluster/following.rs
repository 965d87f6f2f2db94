//! Where nothing goes wrong but with whoever follows.
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::emulated::{Cluster, Ensemble, FAST, Held, SLOW, cluster, end, members, signal, until};

#[test]
fn all_is_well_also_if_two_submit() {
    let Some(cluster) = cluster() else { return };
    // The site takes five tasks.
    let ensemble = Ensemble::cut(FAST, 12);
    let name = cluster.name(&ensemble.path);
    let both = [(); 2].map(|()| cluster.submit(&ensemble.path, ""));
    for child in both {
        ensemble.is_made_by(child);
    }
    let jobs = cluster.ask(&format!(
        "squeue --noheader --array --states=all --name={name} --format=%F|%K"
    ));
    assert_eq!(jobs.lines().count(), 4, "{jobs}");
    let (status, said) = end(cluster.submit(&ensemble.path, ""));
    assert_eq!((status, said.as_str()), (0, ""));
}

#[test]
fn whoever_follows_may_go_and_come_back() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(SLOW, 2);
    let pieces = &ensemble.path;
    let name = cluster.name(pieces);
    // Ctrl-C leaves the jobs alone.
    let first = cluster.submit(pieces, "");
    let piece = Held::making(pieces, "0");
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
    assert_eq!(cluster.arrays(&name), 1);
    cluster.ask(&format!("scancel --name={name}"));
    piece.goes_on();
    let (status, said) = end(third);
    assert_eq!(status, 3, "{said}");
    assert!(said.contains("somebody has cancelled jobs: "), "{said}");
    // Ctrl-C takes the jobs with it, if asked.
    let fourth = cluster.submit(pieces, "--cancel-on-interrupt");
    until("another array", || cluster.arrays(&name) == 2);
    Held::making(pieces, "0");
    signal("-TERM", &[fourth.id().to_string()]);
    let (status, said) = end(fourth);
    assert_eq!(status, 130, "{said}");
    assert!(said.contains("are cancelled"), "{said}");
    until("end of all jobs", || {
        let line = format!("squeue --noheader --name={name},{name}-merge");
        cluster.ask(&line).is_empty()
    });
    ensemble.is_made_by(cluster.submit(pieces, ""));
}

/// The document shows commands for a cluster, which other tests of documents leave out.
#[test]
fn the_document_can_be_followed() {
    let Some(cluster) = cluster() else { return };
    let page = fs::read_to_string("docs/cluster.md").unwrap();
    let section = page.split("## With Slurm\n").nth(1).unwrap();
    let block = section.split("```sh\n").nth(1).unwrap();
    let block = block.split("```").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let link = |from: &Path, to: &str| {
        std::os::unix::fs::symlink(from.canonicalize().unwrap(), folder.path().join(to)).unwrap();
    };
    link(Path::new("examples"), "examples");
    link(Path::new(env!("CARGO_BIN_EXE_stochc")), "stochc");
    let mut shell = cluster.command("bash -ec");
    let path = std::env::var("PATH").unwrap();
    shell.env("PATH", format!("{}:{path}", folder.path().display()));
    let said = shell
        .arg(block)
        .current_dir(folder.path())
        .output()
        .unwrap();
    let out = String::from_utf8(said.stdout).unwrap();
    assert!(
        said.status.success(),
        "{out}{}",
        String::from_utf8_lossy(&said.stderr)
    );
    assert!(out.contains("`results/slurm` is whole: 1000 runs"), "{out}");
    assert!(out.contains("Mean time to completion"), "{out}");
}

#[test]
fn a_cluster_that_is_killed_leaves_nothing() {
    // In its own processes.
    let Some(mut cluster) = Cluster::start() else {
        crate::skipped::skipped("slurm-wlm", "slurmctld");
        return;
    };
    let folder = cluster.folder().to_owned();
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
