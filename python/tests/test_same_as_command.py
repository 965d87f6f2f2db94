"""Checks that Python and the command write the same files, byte for byte."""

from __future__ import annotations

import dataclasses
import filecmp
import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import stochc

Command = Callable[..., subprocess.CompletedProcess[str]]


def files(folder: Path) -> dict[str, Path]:
    return {
        str(path.relative_to(folder)): path
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock"
    }


def assert_same(one: Path, other: Path, unordered: tuple[str, ...] = ()) -> None:
    ours, theirs = files(one), files(other)
    assert ours.keys() == theirs.keys()
    for name, path in ours.items():
        if name in unordered:
            continue
        assert filecmp.cmp(path, theirs[name], shallow=False), name


@pytest.mark.parametrize(
    ("flags", "options"),
    [
        (["--model", "shuffle"], {"model": "shuffle"}),
        (["--model", "rigid", "--max-ticks", "3000"], {"max_ticks": 3000}),
        (
            ["--model", "rigid", "--substeps", "2/4", "--max-ticks", "300"],
            {"model": "rigid", "substeps": "2/4", "max_ticks": 300},
        ),
        (["--model", "rate"], {"model": "rate"}),
        (
            ["--precision", "double", "--without", "corners", "--max-ticks", "500"],
            {"precision": "double", "without": "corners", "max_ticks": 500},
        ),
        (
            ["--model", "shuffle", "--vary", "free=40..60/3", "--vary", "tick=10,20 ms"],
            {"model": "shuffle", "vary": {"free": "40..60/3", "tick": "10,20 ms"}},
        ),
    ],
)
def test_folders_are_the_same(
    flags: list[str], options: dict[str, Any], tower: str, command: Command, tmp_path: Path
) -> None:
    out = tmp_path / "command"
    common = ["--runs", "3", "--seed", "7", "--threads", "1", "--quiet", "--out", out]
    programs = [tower, "examples/line.sa"]
    done = subprocess.CompletedProcess[str]
    stopped = "--max-ticks" in flags
    done = command("sweep" if "--vary" in flags else "simulate", *programs, *common, *flags, status=3 if stopped else 0)
    ours = stochc.simulate(programs, runs=3, seed=7, threads=1, out=tmp_path / "python", **options)
    assert_same(tmp_path / "python", out)
    assert ours.text() + "\n" == done.stdout or str(ours) == done.stdout.rstrip()
    results = command("show", out, "--json", status=3 if stopped else 0)
    assert ours.results() == json.loads(results.stdout)
    # An ensemble in memory is the same.
    in_memory = stochc.simulate(programs, runs=3, seed=7, **options)
    assert in_memory.results() == ours.results()


def test_the_other_engine_computes_the_same(command: Command, tmp_path: Path) -> None:
    program, out = "examples/microns.sa", tmp_path / "command"
    command(
        "simulate", program, "--model", "rapier", "--runs", "2", "--max-ticks", "300", "--threads", "1", "--quiet", "--out", out,
        status=3,
    )  # fmt: skip
    stochc.simulate(program, model="rapier", runs=2, max_ticks=300, threads=1, out=tmp_path / "python")
    assert_same(tmp_path / "python", out)


def test_recordings_replays_and_exports_are_the_same(tower: str, command: Command, tmp_path: Path) -> None:
    out = tmp_path / "command"
    command(
        "simulate", tower, "--runs", "2", "--max-ticks", "400", "--record", "1", "--threads", "1", "--quiet", "--out", out, status=3
    )
    ours = stochc.simulate(
        tower, runs=2, max_ticks=400, record=1, threads=1, out=tmp_path / "python"
    )
    assert_same(tmp_path / "python", out)
    page, table = tmp_path / "replay.html", tmp_path / "run.parquet"
    ours.run(1).save_replay(page)
    ours.run(1).export(table)
    command("replay", out, "--run", "1", "--out", tmp_path / "its.html")
    command("export", out, "--run", "1", "--format", "parquet", "--out", tmp_path / "its.parquet")
    assert page.read_bytes() == (tmp_path / "its.html").read_bytes()
    assert table.read_bytes() == (tmp_path / "its.parquet").read_bytes()
    assert ours.run(1).replay().html.encode() == page.read_bytes()
    alone = command(
        "trace", tower, "--run", "1", "--max-ticks", "400", "--json", "--quiet", status=3
    )
    assert {"format": 1, "runs": [ours.run(1).record]} == json.loads(alone.stdout)


def test_reports_are_the_same(tower: str, command: Command, tmp_path: Path) -> None:
    folder = tmp_path / "results"
    # The reports are next to their folders, with the same name, which they contain.
    page, its = (tmp_path / name / "report.html" for name in ("python", "command"))
    page.parent.mkdir()
    its.parent.mkdir()
    ours = stochc.simulate(tower, runs=4, model="shuffle", out=folder)
    before = {name: path.read_bytes() for name, path in files(folder).items()}
    assert stochc.report(ours, out=page) == str(page)
    assert before == {name: path.read_bytes() for name, path in files(folder).items()}
    command("report", folder, "--out", its, "--quiet")
    assert page.read_bytes() == its.read_bytes()
    stochc.report(ours, page, figures="89mm", figure_format=["svg", "pdf"])
    command("report", folder, "--out", its, "--figure-width", "89mm", "--figure-format", "svg,pdf", "--quiet")
    figures = {name: path.read_bytes() for name, path in files(page.parent).items()}
    assert figures == {name: path.read_bytes() for name, path in files(its.parent).items()}
    assert any(name.endswith(".pdf") for name in figures)


def test_pieces_are_the_same(tower: str, command: Command, tmp_path: Path) -> None:
    whole = stochc.simulate(tower, runs=7, model="shuffle", threads=1, out=tmp_path / "whole")
    assert stochc.prepare(tower, tmp_path / "cut", 3, runs=7, model="shuffle") == 7
    command("shard", "new", tower, "--runs", "7", "--model", "shuffle", "--shards", "3", "--out", tmp_path / "its")
    assert_same(tmp_path / "cut", tmp_path / "its")
    assert stochc.status(tmp_path / "cut")["missing"] == [0, 1, 2]
    with pytest.raises(stochc.RunError, match="shard"):
        stochc.merge(tmp_path / "cut")
    for piece in (2, 0, 1, 0):
        assert stochc.shard(tmp_path / "cut", piece) in (2, 3)
    merged = stochc.merge(tmp_path / "cut")
    assert merged.results() == whole.results()
    for table in ("runs", "bonds", "phases", "releases", "unplanned"):
        name = f"{table}.parquet"
        assert (tmp_path / "cut" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_diagnostics_are_the_same(command: Command, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.sa"
    wrong.write_text("assembly a { seed plate 3 x 3 { M at (1, 1) } phase p { M.up -> A, A.upp -> B } }\n")
    checked = stochc.check(wrong)
    told = json.loads(command("check", wrong, "--json", status=1).stdout)
    assert [(it.code, it.title, it.help) for it in checked.diagnostics] == [
        (it["code"], it["title"], it["help"]) for it in told["diagnostics"]
    ]
    drawn = command("check", wrong, status=1).stderr
    assert str(checked) == drawn.rstrip()
    with pytest.raises(stochc.ProgramError) as raised:
        stochc.simulate(wrong)
    assert str(raised.value).strip("\n") == drawn.rstrip()
    assert raised.value.diagnostics == checked.diagnostics


def test_proofs_are_the_same(command: Command, tower: str) -> None:
    checked = stochc.check(tower)
    [told] = json.loads(command("check", tower, "--json").stdout)["programs"]
    proof = checked.proofs[told["name"]]
    assert dataclasses.asdict(proof) == told["proved"]
    assert proof.completes
    status, _, _ = command("check", tower).stdout.partition("  longest serial chain")
    assert status.count("proved: ") >= 3
    assert str(checked).rstrip().endswith(status.rstrip())


def assert_same_plan(planned: stochc.Plan, printed: str) -> None:
    document = json.loads(printed)
    # The program also names its scene.
    assert document.pop("scene") in (None, "hemisphere")
    assert {"format": 1, "program": planned.text, "plan": planned.plan} == document


def test_estimates_and_plans_are_the_same(tower: str, command: Command) -> None:
    told = command("estimate", tower, "--runs", "50", "--json", "--quiet")
    estimates = list(stochc.estimate(tower, runs=50).programs)
    assert {"format": 1, "estimates": estimates} == json.loads(told.stdout)
    target = "examples/open_platform.sa"
    told = command("plan", target, "--tries", "5", "--json", "--quiet")
    planned = stochc.plan(target, tries=5)
    assert_same_plan(planned, told.stdout)
    assert planned.compile().captures > 0


@pytest.mark.filterwarnings("ignore")
def test_what_is_missing_is_planned_as_by_the_command(command: Command, tmp_path: Path) -> None:
    begun = tmp_path / "begun.sa"
    begun.write_text(
        "shape pair { layer 1 { # # } }\n"
        "assembly begun { seed plate 2 x 1 { A at (0, 0) } phase begin { A.up -> C } phase rest { yields pair } }\n"
    )
    told = command("plan", begun, "--complete", "--tries", "5", "--json", "--quiet")
    completed = stochc.plan(begun, complete=True, tries=5)
    assert_same_plan(completed, told.stdout)
    stopped = tmp_path / "stopped"
    stochc.simulate("examples/five_tower.sa", runs=1, max_ticks=2000, out=stopped)
    told = command("plan", stopped, "--run", "0", "--tries", "5", "--json", "--quiet")
    rest = stochc.plan(stopped, run=0, tries=5)
    assert_same_plan(rest, told.stdout)
    for wrong in ({"complete": True, "run": 0}, {"dead": ["A"]}, {"run": 0, "keep_scaffolds": True}, {"run": 0, "race": 8}, {"race": 7}):
        with pytest.raises(stochc.UsageError):
            stochc.plan(begun, **wrong)


def test_scaffolds_are_kept_or_taken_down_as_by_the_command(command: Command) -> None:
    asked = ("examples/planned/serpentine.sa", "--plate", "12 x 2", "--offset", "1, 0", "--tries", "300")
    programs = set()
    for options, keep in [((), False), (("--keep-scaffolds",), True)]:
        told = command("plan", *asked, "--json", "--quiet", *options)
        planned = stochc.plan(asked[0], plate="12 x 2", offset="1, 0", tries=300, keep_scaffolds=keep)
        assert_same_plan(planned, told.stdout)
        programs.add(planned.text)
    assert len(programs) == 2
