//! Tests submissions without failures, and submissions that Slurm rejects.
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::emulated::{Cluster, Ensemble, FAST, cluster, end, members, until};

#[test]
fn only_one_of_two_processes_submits() {
    let Some(cluster) = cluster() else { return };
    // The cluster allows five tasks per array.
    let ensemble = Ensemble::cut(FAST, 12);
    let name = cluster.name(&ensemble.path);
    let both = [(); 2].map(|()| cluster.start_submit(&ensemble.path, "--at-most 1"));
    let both = both.map(end);
    let submitted = both
        .iter()
        .filter(|(_, output)| output.contains("(shards: 12, tasks: 4)"));
    assert_eq!(submitted.count(), 1, "{both:?}");
    ensemble.is_made();
    let jobs = cluster.ask(&format!(
        "squeue --noheader --array --states=all --name={name} --format=%F|%K"
    ));
    assert_eq!(jobs.lines().count(), 4, "{jobs}");
    let (status, output) = cluster.submit(&ensemble.path, "");
    assert_eq!(status, 0, "{output}");
    assert!(output.contains("is complete: 12 runs"), "{output}");
}

/// Checks that the message of Slurm is printed.
#[test]
fn a_refusal_is_reported() {
    let Some(cluster) = cluster() else { return };
    let ensemble = Ensemble::cut(FAST, 2);
    let (status, output) = cluster.submit(&ensemble.path, "--partition nowhere");
    assert_eq!(status, 2, "{output}");
    assert!(
        output.contains("invalid partition specified: nowhere"),
        "{output}"
    );
    assert!(output.contains("--dry-run"), "{output}");
    assert_eq!(cluster.arrays(&cluster.name(&ensemble.path)), 0);
}

/// Checks the commands for a cluster in the documents. Other tests of documents skip them.
#[test]
fn the_document_can_be_followed() {
    let Some(cluster) = cluster() else { return };
    let page = fs::read_to_string("docs/guides/cluster.md").unwrap();
    let section = page.split("## Slurm\n").nth(1).unwrap();
    let block = section.split("```sh\n").nth(1).unwrap();
    let block = block.split("```").next().unwrap();
    let (submit, results) = block.split_at(block.find("stochc show").unwrap());
    let folder = tempfile::tempdir().unwrap();
    let link = |from: &Path, to: &str| {
        std::os::unix::fs::symlink(from.canonicalize().unwrap(), folder.path().join(to)).unwrap();
    };
    link(Path::new("examples"), "examples");
    link(Path::new(env!("CARGO_BIN_EXE_stochc")), "stochc");
    let run = |commands: &str| {
        let mut shell = cluster.command("bash -ec");
        let path = std::env::var("PATH").unwrap();
        shell.env("PATH", format!("{}:{path}", folder.path().display()));
        let shell = shell.arg(commands).current_dir(folder.path());
        let (status, output) = end(shell.spawn().unwrap());
        assert_eq!(status, 0, "{output}");
        output
    };
    let out = run(submit);
    assert!(out.contains("(shards: 10, tasks: 5)"), "{out}");
    until("merged ensemble", || {
        !folder.path().join("results/slurm/shards.json").exists()
    });
    let out = run(results);
    assert!(out.contains("Mean time"), "{out}");
}

#[test]
fn a_cluster_that_is_killed_leaves_nothing() {
    // This test uses its own cluster.
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
