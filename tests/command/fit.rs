//! Tests fits of scene parameters to measured times.
use std::fs;

use serde_json::Value;
use stochc::report::figures::Medium;

use crate::layout;
use crate::stochc::{path, stochc_with};

/// Returns the source of two programs in a small scene. `free` is the number of free blocks.
fn programs(free: u32) -> String {
    format!(
        "scene small from hemisphere {{ free {free} uniform  enclosure hemisphere {{ radius 1m  wall 25 N/m }} }}
assembly one in small {{ seed plate 3 x 3 {{ M at (1, 1) }}
allow soft-contact \"the arena is small\"
phase grow {{ M.up -> A }} }}
assembly two in small {{ seed plate 3 x 3 {{ M at (1, 1) }}
allow soft-contact \"the arena is small\"
phase grow {{ M.up -> A  A.up -> B }} }}
"
    )
}

/// Returns the times of a simulation with 20 free blocks, as a table of measured times.
fn measured(folder: &std::path::Path) -> String {
    let truth = path(folder, "truth.sa");
    fs::write(&truth, programs(20)).unwrap();
    let outcome = stochc_with("simulate --runs 200 --seed 900 --quiet --json", &[&truth]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let table: Value = serde_json::from_str(&outcome.out).unwrap();
    let rows = table["programs"].as_array().unwrap().iter().map(|program| {
        let time = &program["time"];
        format!(
            "{},200,{},{}\n",
            program["name"].as_str().unwrap(),
            time["mean"],
            time["sd"]
        )
    });
    "program,n,mean_ticks,sd_ticks\n".to_owned() + &rows.collect::<String>()
}

#[test]
fn recovers_a_parameter_and_predicts_held_out_programs() {
    let folder = tempfile::tempdir().unwrap();
    let (file, data, out) = (
        path(folder.path(), "small.sa"),
        path(folder.path(), "times.csv"),
        path(folder.path(), "out"),
    );
    fs::write(&data, measured(folder.path())).unwrap();
    // The fit starts from another number of free blocks.
    fs::write(&file, programs(8)).unwrap();
    let options = [
        &file,
        "--data",
        &data,
        "--vary",
        "free=8..60 log",
        "--hold-out",
        "two",
        "--out",
        &out,
    ];
    let outcome = stochc_with("fit --quiet --runs 16 --points 10", &options);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(outcome.out.contains("free"), "{}", outcome.out);
    let fit: Value =
        serde_json::from_str(&fs::read_to_string(path(folder.path(), "out/fit.json")).unwrap())
            .unwrap();
    let number = &fit["numbers"][0];
    let [low, high] = [0, 1].map(|i| number["interval"][i].as_f64().unwrap());
    assert!(
        low < 20.0 && 20.0 < high,
        "{low} .. {high}\n{}",
        outcome.out
    );
    assert!(
        high - low < 20.0,
        "{low} .. {high}: the times constrain the parameter"
    );
    let two = &fit["predictions"][1];
    assert_eq!(
        (&two["program"], &two["is_fitted"]),
        (&"two".into(), &false.into())
    );
    let mean = two["observed"]["mean"].as_f64().unwrap();
    let [low, high] = ["low", "high"].map(|end| two["mean"][end].as_f64().unwrap());
    assert!(low < mean && mean < high, "{low} .. {high}, {mean}");
    let picture = fs::read_to_string(path(folder.path(), "out/fit.svg")).unwrap();
    layout::check("fit", &picture, Medium::Screen);
    // Repeating the command prints the same text, but it does not write to the same folder.
    let again = stochc_with("fit --quiet --runs 16 --points 10", &options[..7]);
    assert_eq!((again.status, &again.out), (0, &outcome.out));
    assert_eq!(
        stochc_with("fit --quiet --runs 16 --points 10", &options).status,
        2
    );
}

#[test]
fn recovers_a_parameter_from_waiting_times() {
    let folder = tempfile::tempdir().unwrap();
    let [truth, file, other, runs] =
        ["truth.sa", "small.sa", "other.sa", "runs"].map(|name| path(folder.path(), name));
    fs::write(&truth, programs(20)).unwrap();
    fs::write(&file, programs(8)).unwrap();
    let simulate = "simulate --runs 100 --seed 900 --max-ticks 350 --quiet --out";
    assert_eq!(stochc_with(simulate, &[&runs, &truth]).status, 3);
    let options = [&*file, "--data", &runs, "--vary", "free=8..60 log"];
    let outcome = stochc_with("fit --quiet --points 12 --json", &options);
    assert_eq!((outcome.status, &*outcome.err), (0, ""), "{}", outcome.out);
    let (low, high) = fitted(&outcome.out);
    assert!(
        low < 20.0 && 20.0 < high && high - low < 20.0,
        "{low} .. {high}"
    );
    // There is one measurement per capture, and none of a whole run.
    let fit: Value = serde_json::from_str(&outcome.out).unwrap();
    let observed = fit["predictions"].as_array().unwrap().iter();
    let observed: Vec<&Value> = observed.map(|it| &it["observed"]).collect();
    let captures: Vec<&Value> = observed.iter().map(|it| &it["capture"]).collect();
    let first = "grow: M.up -> A";
    assert_eq!(captures, [first, first, "grow: A.up -> B"]);
    // Every run waited for its first block. The face of `A` is switched on at the tick of its
    // capture, so the runs that captured `A` waited for `B`. Stopped runs have censored waits.
    let [n, stopped] = ["n", "stopped"].map(|key| {
        let counts = observed.iter().map(|it| it[key].as_u64().unwrap());
        counts.collect::<Vec<_>>()
    });
    assert_eq!(n[..2], [100, 100]);
    assert_eq!(n[2], 100 - stopped[1], "{stopped:?}");
    assert!(stopped.iter().all(|it| *it > 10), "{stopped:?}");

    // Waits for `B` begin late, so this limit ends many of them before their horizon.
    let outcome = stochc_with("fit --quiet --points 12 --max-ticks 350 --json", &options);
    assert_eq!((outcome.status, &*outcome.err), (0, ""), "{}", outcome.out);
    let (low, high) = fitted(&outcome.out);
    assert!(low < 20.0 && 20.0 < high, "{low} .. {high}");

    let source = programs(8).replace("A.up -> B", "A.north -> B");
    fs::write(&other, source).unwrap();
    let options = [&*other, "--data", &runs, "--vary", "free=8..60 log"];
    let outcome = stochc_with("fit --quiet --runs 4 --points 8", &options);
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    let reason = "no simulated run of `two` has the measured capture `grow: A.up -> B`";
    assert!(outcome.err.contains(reason), "{}", outcome.err);
}

/// The timeout of the simulated program ends many waits for `B` before their horizon. The fit is
/// then as without the timeout. A shorter timeout ends all these waits.
#[test]
fn waits_that_a_timeout_ends_are_censored() {
    let folder = tempfile::tempdir().unwrap();
    let [truth, file, runs] =
        ["truth.sa", "small.sa", "runs"].map(|name| path(folder.path(), name));
    fs::write(&truth, programs(20)).unwrap();
    let simulate = "simulate --runs 100 --seed 900 --quiet --out";
    assert_eq!(stochc_with(simulate, &[&runs, &truth]).status, 0);
    let options = [&*file, "--data", &runs, "--vary", "free=12..40 log"];
    let fit = |phase: &str| {
        fs::write(&file, programs(12).replace("grow {", phase)).unwrap();
        stochc_with("fit --points 12 --json --quiet", &options)
    };
    let (low, high) = fitted(&fit("grow {").out);
    let outcome = fit("grow timeout 900 ticks {");
    assert_eq!((outcome.status, &*outcome.err), (0, ""), "{}", outcome.out);
    let median = outcome.json()["numbers"][0]["median"].as_f64().unwrap();
    assert!(low < median && median < high, "{median}: {low} .. {high}");
    let stopped = &outcome.json()["stopped"];
    assert!(stopped.as_u64().unwrap() < 20, "{stopped}");
    let outcome = fit("grow timeout 100 ticks {");
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let reason = "too many simulated runs end early: a phase reaches its `timeout`";
    assert!(outcome.err.contains(reason), "{}", outcome.err);
    assert!(!outcome.err.contains("--max-ticks"), "{}", outcome.err);
}

/// The timeout ends most runs before they wait for `B`.
#[test]
fn rare_captures_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let [truth, file, runs] =
        ["truth.sa", "small.sa", "runs"].map(|name| path(folder.path(), name));
    let programs = |free| programs(free).replace("grow {", "grow timeout 150 ticks {");
    fs::write(&truth, programs(30)).unwrap();
    fs::write(&file, programs(8)).unwrap();
    let simulate = "simulate --runs 100 --seed 900 --quiet --out";
    assert_eq!(stochc_with(simulate, &[&runs, &truth]).status, 3);
    let options = [&*file, "--data", &runs, "--vary", "free=8..30 log"];
    let outcome = stochc_with("fit --points 12 --runs 6", &options);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let note = "note: left out `two, grow: A.up -> B`: it has too few simulated waiting times";
    assert!(outcome.err.contains(note), "{}", outcome.err);
    let out = outcome.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(out.contains("two, grow: M.up -> A"), "{out}");
    assert!(!out.contains("A.up -> B"), "{out}");
}

#[test]
fn mismatched_inputs_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let (file, data) = (
        path(folder.path(), "small.sa"),
        path(folder.path(), "times.csv"),
    );
    fs::write(&file, programs(8)).unwrap();
    let good = "program,ticks\none,10\none,20\ntwo,20\ntwo,30\n";
    for (table, vary, more, reason) in [
        (
            "program,ticks\none,10\none,20\n",
            "free=8..60",
            "",
            "the data have no times of `two`",
        ),
        (
            &*format!("{good}three,1\nthree,2\n"),
            "free=8..60",
            "",
            "no file declares it",
        ),
        ("a,b\n1,2\n", "free=8..60", "", "its columns are `a,b`"),
        (
            "program,ticks\none,ten\n",
            "free=8..60",
            "",
            "line 2: `ten` is not a number above 0 and up to 1e15",
        ),
        (good, "frei=8..60", "", "no number `frei`"),
        (good, "free=60..8", "", "is not a range"),
        (good, "free=-5..60", "", "free"),
        (good, "free=8..60", "--vary free=8..60", "given twice"),
        (
            good,
            "free=8..60",
            "--hold-out none",
            "no file declares `none`",
        ),
        (
            good,
            "free=8..60",
            "--predict none",
            "--predict: no file declares `none`",
        ),
        (
            good,
            "free=8..60",
            "--predict two",
            "write `--hold-out two`",
        ),
        (
            "program,ticks,stopped\none,10,no\none,20,no\ntwo,20,no\ntwo,30,never\n",
            "free=8..60",
            "",
            "`never` in `stopped` is neither `true` nor `false`",
        ),
        (
            "program,ticks,stopped\none,10,no\none,900,yes\ntwo,20,no\ntwo,900,yes\n",
            "free=8..60",
            "--max-ticks 800",
            "runs of `one` were observed for 900 ticks",
        ),
        (
            good,
            "free=8..60",
            "--hold-out one --hold-out two",
            "no program is left to fit to",
        ),
        (good, "free=8..60", "--vary bond.pull=1..9,N", "bond.pull"),
        (
            good,
            "free=8..9",
            "",
            "a whole number, and its range needs at least five",
        ),
        (good, "free=8.5..60", "", "must be a whole number"),
    ] {
        fs::write(&data, table).unwrap();
        let mut options = vec![&*file, "--data", &data, "--vary", vary];
        options.extend(more.split_whitespace());
        let outcome = stochc_with("fit --quiet", &options);
        assert_eq!(outcome.status, 2, "{vary} {more}: {}", outcome.err);
        assert!(outcome.err.contains(reason), "{reason}: {}", outcome.err);
    }
    fs::write(&data, good).unwrap();
    let twice = [&*file, &file, "--data", &data, "--vary", "free=8..60"];
    let outcome = stochc_with("fit --quiet", &twice);
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    let reason = "two programs are called `one`";
    assert!(outcome.err.contains(reason), "{}", outcome.err);
    let outcome = stochc_with(
        "fit --quiet --vary free=8..60",
        &[&file, "--data", "no.csv"],
    );
    assert!(
        outcome.status == 2 && outcome.err.contains("cannot read no.csv: file not found"),
        "{}",
        outcome.err
    );
}

#[test]
fn unreachable_times_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let (file, data) = (
        path(folder.path(), "small.sa"),
        path(folder.path(), "times.csv"),
    );
    fs::write(&file, programs(8)).unwrap();
    fs::write(&data, "program,ticks\none,10\none,20\ntwo,20\ntwo,30\n").unwrap();
    let options = [&*file, "--data", &data, "--vary", "free=8..20"];
    let outcome = stochc_with("fit --quiet --runs 4 --points 8 --max-ticks 2", &options);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let reason = "`one`: too many simulated runs end early: they reach `--max-ticks`";
    assert!(outcome.err.contains(reason), "{}", outcome.err);
}

#[test]
fn an_impossible_scene_at_a_point_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let (file, data) = (
        path(folder.path(), "small.sa"),
        path(folder.path(), "times.csv"),
    );
    fs::write(&file, programs(20)).unwrap();
    fs::write(
        &data,
        "program,n,mean_ticks,sd_ticks\none,200,300,200\ntwo,200,600,300\n",
    )
    .unwrap();
    let outcome = stochc_with(
        "fit --quiet --runs 4",
        &[&file, "--data", &data, "--vary", "free=40..100"],
    );
    assert_eq!(outcome.status, 1, "{}", outcome.err);
    assert!(outcome.err.contains("which holds 60"), "{}", outcome.err);
}

/// Table of times of two programs with 20 free blocks. Runs were stopped at 350 ticks: a third of
/// the runs of one program, and most of the other.
const STOPPED: &str = "examples/fit/stopped.csv";

fn fitted(output: &str) -> (f64, f64) {
    let fit: Value = serde_json::from_str(output).unwrap();
    let number = &fit["numbers"][0];
    let [low, high] = [0, 1].map(|i| number["interval"][i].as_f64().unwrap());
    (low, high)
}

#[test]
fn recovers_a_parameter_from_censored_runs() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (path(folder.path(), "small.sa"), path(folder.path(), "out"));
    fs::write(&file, programs(8)).unwrap();
    let vary = ["--vary", "free=8..60 log"];
    let options = [&*file, "--data", STOPPED, "--out", &out, vary[0], vary[1]];
    let outcome = stochc_with("fit --quiet --points 12 --json", &options);
    assert_eq!((outcome.status, &*outcome.err), (0, ""), "{}", outcome.out);
    let (low, high) = fitted(&outcome.out);
    assert!(
        low < 20.0 && 20.0 < high && high - low < 25.0,
        "{low} .. {high}"
    );
    let fit: Value = serde_json::from_str(&outcome.out).unwrap();
    let two = &fit["predictions"][1];
    assert_eq!(two["observed"]["horizon"], 350.0);
    let share = two["observed"]["incomplete"].as_f64().unwrap();
    let [low, high] = ["low", "high"].map(|end| two["incomplete"][end].as_f64().unwrap());
    assert!(low < share && share < high, "{low} .. {high}, {share}");

    // Without the column `stopped`, these runs count as completed, and the interval misses the true
    // value.
    let table = fs::read_to_string(STOPPED).unwrap();
    let rows = table.lines().map(|line| match line.rsplit_once(',') {
        Some((rest, _)) if !line.starts_with('#') => format!("{rest}\n"),
        _ => format!("{line}\n"),
    });
    let clipped = path(folder.path(), "clipped.csv");
    fs::write(&clipped, rows.collect::<String>()).unwrap();
    let options = [&*file, "--data", &clipped, vary[0], vary[1]];
    let outcome = stochc_with("fit --quiet --points 12 --json", &options);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    for warned in [
        " times of `one` are 350; if these runs were stopped",
        "of `two` are 350",
    ] {
        assert!(outcome.err.contains(warned), "{}", outcome.err);
    }
    let (low, _) = fitted(&outcome.out);
    assert!(low > 20.0, "{low}");
}

#[test]
fn a_program_without_times_is_predicted_and_the_fitted_scene_is_a_program() {
    let folder = tempfile::tempdir().unwrap();
    let (file, data, out) = (
        path(folder.path(), "small.sa"),
        path(folder.path(), "times.csv"),
        path(folder.path(), "out"),
    );
    fs::write(&file, programs(8)).unwrap();
    fs::write(&data, "program,n,mean_ticks,sd_ticks\none,200,337,217\n").unwrap();
    let vary = ["--vary", "free=8..60 log"];
    let options = [&*file, "--data", &data, "--out", &out, vary[0], vary[1]];
    let all = "fit --points 10 --predict two --predict-runs 50";
    let outcome = stochc_with(&format!("{all} --dry-run"), &options[..3]);
    assert_eq!(outcome.status, 2, "{}", outcome.err);
    let dry = stochc_with(&format!("{all} --dry-run"), &options);
    assert_eq!((dry.status, &*dry.err), (0, ""), "{}", dry.out);
    // On a slow computer, the sampled runs are stopped, and the forecast is a lower bound.
    let forecast =
        |text: &str| text.contains("640 runs, about ") || text.contains("640 runs, at least ");
    assert!(forecast(&dry.out), "{}", dry.out);
    assert!(dry.out.contains(" of CPU time"), "{}", dry.out);
    assert!(!fs::exists(&out).unwrap());

    let outcome = stochc_with(all, &options);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(forecast(&outcome.err), "{}", outcome.err);
    assert!(outcome.out.contains("not measured"), "{}", outcome.out);
    let fit = fs::read_to_string(path(folder.path(), "out/fit.json")).unwrap();
    let fit: Value = serde_json::from_str(&fit).unwrap();
    let two = &fit["predictions"][1];
    assert_eq!((&two["n"], &two["observed"]), (&50.into(), &Value::Null));
    // The true value is from 200 runs.
    let [low, high] = ["low", "high"].map(|end| two["mean"][end].as_f64().unwrap());
    assert!(low < 580.0 && 580.0 < high, "{low} .. {high}");
    let picture = fs::read_to_string(path(folder.path(), "out/fit.svg")).unwrap();
    layout::check("fit", &picture, Medium::Screen);

    let scene = fs::read_to_string(path(folder.path(), "out/fitted.sa")).unwrap();
    // The number of free blocks must be an integer.
    let median = fit["numbers"][0]["median"].as_f64().unwrap().round();
    assert!(
        scene.contains(&format!("    free {median} uniform\n")),
        "{scene}"
    );
    assert!(scene.contains("scene small_fitted {"), "{scene}");
    let user = path(folder.path(), "out/user.sa");
    let program = "import \"fitted.sa\"\nassembly a in small_fitted { seed plate 1 x 1 { M at (0, 0) }  phase p { M.up -> A } }\n";
    fs::write(&user, program).unwrap();
    let outcome = stochc_with("simulate --runs 1 --quiet", &[&user]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
}
