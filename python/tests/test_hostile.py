"""Checks that invalid input raises an exception with advice."""

from __future__ import annotations

import copy
import math
import multiprocessing
import os
import pickle
import shutil
import signal
import subprocess
import sys
import threading
import time
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import stochc

HUGE = 10**5000
STRANGE: list[Any] = [
    None, True, -1, 0, 1.5, math.nan, math.inf, -math.inf, HUGE, -HUGE, 2**63, 2**64, "", "x", "\0", "\ud800", "{", "a\nb",
    b"bytes", [], [[]], {}, {"a": 1}, object(), int, lambda: 1, Path(), Path("\0"), Path("/nowhere/at/all"), "/dev/zero", "/",
]  # fmt: skip

NUMBERS = ["runs", "seed", "max_ticks", "threads", "solver_iterations", "record_every"]
OTHERS = [
    "model", "vary", "rates", "substeps", "precision", "without", "resume", "mixed_builds", "record", "allow", "warn", "deny",
    "allow_import", "progress",
]  # fmt: skip
EXPECTED = (stochc.StochcError, TypeError)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", NUMBERS + OTHERS)
def test_strange_options(name: str, tmp_path: Path) -> None:
    for number, value in enumerate(STRANGE):
        if name == "threads" and value is None:
            continue
        # The model `shuffle` rejects the settings of `rigid`.
        model = "rigid" if name in ("substeps", "solver_iterations", "precision", "without") else "shuffle"
        options: dict[str, Any] = {"runs": 1, "model": model, "max_ticks": 100, name: value}
        if name in ("resume", "mixed_builds", "record"):
            options["out"] = tmp_path / f"{name}-{number}"
        try:
            stochc.simulate(stochc.EXAMPLE, **options)
        except EXPECTED as error:
            assert not isinstance(error, stochc.InternalError), (name, value)
            assert str(error), (name, value)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "call",
    [
        stochc.check, stochc.compile, stochc.compile_all, stochc.open, stochc.status, stochc.merge, stochc.report,
        stochc.replay, stochc.explain, stochc.plan, stochc.estimate, lambda it: stochc.simulate(it, runs=1),
        lambda it: stochc.shard(it, 0), lambda it: stochc.shard("/nowhere", it), lambda it: stochc.trade(it, runs=2),
        lambda it: stochc.trade(stochc.EXAMPLE, time=0 if it is None else it), lambda it: stochc.sweep(stochc.EXAMPLE, it),
        lambda it: stochc.sweep(stochc.EXAMPLE, {"free": it}, runs=1, model="shuffle"),
        lambda it: stochc.sweep(stochc.EXAMPLE, {it: 1}, runs=1, model="shuffle"),
        lambda it: stochc.prepare(stochc.EXAMPLE, "/nowhere/at/all", it),
        lambda it: stochc.plan("examples/open_platform.sa", tries=1, plate=it),
        lambda it: stochc.plan("examples/open_platform.sa", tries=1, offset=it),
        lambda it: stochc.plan("examples/open_platform.sa", budget=it),
        lambda it: stochc.plan("examples/open_platform.sa", tries=1, keep_scaffolds=it),
    ],
)  # fmt: skip
def test_strange_arguments(call: Any) -> None:
    for value in STRANGE:
        if value == "/" and call in (stochc.check,):
            continue
        try:
            call(value)
        except EXPECTED as error:
            assert not isinstance(error, stochc.InternalError), value
            assert str(error), value


@pytest.mark.parametrize("call", [stochc.simulate, stochc.trade, stochc.estimate])
def test_no_programs_are_refused(call: Any) -> None:
    with pytest.raises(stochc.UsageError, match="programs: give at least one"):
        call([])


def test_messages_say_the_way_out(tmp_path: Path) -> None:
    for wrong, said in [
        ({"runs": 0}, "runs: give a whole number from 1 to 10000000, not 0"),
        ({"seed": -1}, "seed: give a whole number from 0"),
        ({"runs": HUGE}, "runs: give a whole number"),
        ({"model": "none"}, "choose `rigid`, `rapier`, `rate`, `shuffle`"),
        ({"substeps": "1/3/5"}, "substeps: say from 1 to"),
        ({"model": "rate", "precision": "double"}, "precision: not used by the model `rate`"),
        ({"model": "shuffle", "substeps": 4}, "substeps: not used by the model `shuffle`"),
        ({"model": "rapier", "without": "corners"}, "without: not used by the model `rapier`"),
        ({"rates": ["lively.rates"]}, "rates: not used by the model `rigid`"),
        ({"record": "all"}, "record: name a folder with `out`"),
        ({"allow": "no-such-code"}, "`no-such-code` is not a code of a warning or error"),
        ({"vary": {"no_such": 1}}, "no_such"),
    ]:
        with pytest.raises(stochc.UsageError, match="^"):
            try:
                stochc.simulate(stochc.EXAMPLE, **wrong)  # type: ignore[arg-type]
            except stochc.UsageError as error:
                assert said in str(error), str(error)
                raise
    with pytest.raises(TypeError, match="runs: give a whole number, not nan"):
        stochc.simulate(stochc.EXAMPLE, runs=math.nan)  # type: ignore[arg-type]
    with pytest.raises(stochc.UsageError, match="time: cannot be combined with `until`"):
        stochc.trade(stochc.EXAMPLE, until=0.1, time=10)


def test_messages_speak_of_options_as_python_does(tmp_path: Path) -> None:
    out = tmp_path / "results"
    stochc.simulate(stochc.EXAMPLE, runs=3, model="shuffle", out=out)
    with pytest.raises(stochc.UsageError) as raised:
        stochc.simulate(stochc.EXAMPLE, runs=5, model="shuffle", out=out)
    assert "`resume=True`" in str(raised.value)
    assert stochc.simulate(stochc.EXAMPLE, runs=5, model="shuffle", out=out, resume=True).complete
    with pytest.raises(stochc.UsageError, match="^vary: "):
        stochc.sweep(stochc.EXAMPLE, {"no_such": 1})


def test_a_missing_file_is_a_wrong_argument(tmp_path: Path) -> None:
    for call in (stochc.check, stochc.compile):
        with pytest.raises(stochc.UsageError, match="cannot read .*missing.sa"):
            call(str(tmp_path / "missing.sa"))


def test_a_text_with_a_nul_has_diagnostics() -> None:
    assert not stochc.check("assembly \0 { }\n").ok


def test_a_folder_that_is_deleted_meanwhile(tmp_path: Path) -> None:
    out = tmp_path / "results"
    ensemble = stochc.simulate(stochc.EXAMPLE, runs=3, model="shuffle", out=out)
    again = pickle.dumps(ensemble)
    shutil.rmtree(out)
    # Open files are still readable. Files that must be opened again are not.
    assert len(ensemble.runs) == 3
    with pytest.raises(stochc.UsageError, match="contains no results"):
        pickle.loads(again)
    with pytest.raises(stochc.UsageError, match="contains no results"):
        stochc.report(ensemble)


def test_figures_that_there_are_not(tmp_path: Path) -> None:
    ensemble = stochc.simulate(stochc.EXAMPLE, runs=3, model="shuffle", out=tmp_path / "results")
    for wrong in ({"figures": "89"}, {"figures": "2mm"}, {"figure_format": "png"}, {"figure_format": []}):
        with pytest.raises(stochc.UsageError, match=f"^{next(iter(wrong))}: "):
            stochc.report(ensemble, **wrong)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    with pytest.raises(TypeError, match="^figures: "):
        stochc.report(ensemble, figures=89)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]


def test_a_folder_that_is_damaged_is_told_of(tmp_path: Path) -> None:
    out = tmp_path / "results"
    stochc.simulate(stochc.EXAMPLE, runs=3, model="shuffle", out=out)
    (out / "runs.parquet").write_bytes(b"")
    with pytest.warns(stochc.StochcWarning, match="runs.parquet"):
        stochc.open(out)


def test_doubts_about_a_program_are_warnings() -> None:
    doubtful = "assembly a { seed plate 2 x 1 { M at (0, 0)  N at (1, 0) } phase p { M.up -> A } }"
    checked = stochc.check(doubtful)
    assert checked.ok
    assert [diagnostic.code for diagnostic in checked.warnings] == ["unused-seed"]
    with pytest.warns(stochc.DiagnosticWarning, match="unused-seed"):
        stochc.compile(doubtful)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        stochc.compile(doubtful, allow="warnings")
    with pytest.raises(stochc.ProgramError, match="unused-seed"):
        stochc.compile(doubtful, deny="warnings")


@pytest.mark.parametrize("progress", [None, True])
def test_a_program_without_a_stream_for_errors(
    progress: bool | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    closed = open(os.devnull, "w")  # noqa: SIM115
    closed.close()
    for stream in (None, closed):
        monkeypatch.setattr(sys, "stderr", stream)
        assert stochc.simulate(stochc.EXAMPLE, runs=2, model="shuffle", progress=progress).results()


def test_threads_that_call_at_once(tower: str) -> None:
    def results(seed: int) -> Any:
        return stochc.simulate(tower, runs=3, seed=seed, model="shuffle").results()

    alone = [results(seed) for seed in range(6)]
    with ThreadPoolExecutor(6) as pool:
        assert list(pool.map(results, range(6))) == alone


def test_one_ensemble_in_many_threads(tower: str, tmp_path: Path) -> None:
    ensemble = stochc.simulate(tower, runs=8, model="shuffle", out=tmp_path / "results")
    alone = list(ensemble.bonds)
    with ThreadPoolExecutor(8) as pool:
        for bonds in pool.map(lambda _: list(ensemble.bonds), range(16)):
            assert bonds == alone


def test_the_lock_of_the_interpreter_is_released() -> None:
    ended = threading.Event()
    counted = 0

    def count() -> None:
        nonlocal counted
        while not ended.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count, daemon=True)
    thread.start()
    stochc.simulate("examples/line.sa", runs=4, threads=1, max_ticks=4000)
    ended.set()
    thread.join()
    assert counted > 10


def test_pickles(tower: str, tmp_path: Path) -> None:
    program = stochc.compile(tower)
    again: stochc.Program = pickle.loads(pickle.dumps(program))
    assert again == program
    assert hash(again) == hash(program)
    assert again.sources == program.sources
    ours = stochc.simulate(again, runs=2, model="shuffle")
    assert ours.results() == stochc.simulate(program, runs=2, model="shuffle").results()
    kept = stochc.simulate(program, runs=2, model="shuffle", out=tmp_path / "results")
    assert pickle.loads(pickle.dumps(kept)).results() == kept.results()
    assert copy.copy(kept).results() == kept.results()
    with pytest.raises(TypeError, match="use `out=`"):
        pickle.dumps(ours)
    with pytest.raises(TypeError, match="pickle the ensemble"):
        pickle.dumps(ours.runs)
    diagnostics = stochc.check("assembly a { }").diagnostics
    assert pickle.loads(pickle.dumps(diagnostics)) == diagnostics
    with pytest.raises(stochc.ProgramError) as raised:
        stochc.compile("assembly a { }")
    error = pickle.loads(pickle.dumps(raised.value))
    assert (str(error), error.diagnostics) == (str(raised.value), diagnostics)
    with pytest.raises(stochc.UsageError, match="it is not the manifest"):
        type(program._native).from_json("{}")  # pyright: ignore[reportPrivateUsage]


def _in_child(ensemble: stochc.Ensemble, sender: Any) -> None:
    fresh = stochc.simulate(stochc.EXAMPLE, runs=2, model="shuffle")
    sender.send((list(ensemble.bonds), fresh.complete))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_forks(tower: str, tmp_path: Path) -> None:
    ensemble = stochc.simulate(tower, runs=20, model="shuffle", out=tmp_path / "results")
    alone = list(ensemble.bonds)
    context = multiprocessing.get_context("fork")
    pipes = [context.Pipe(duplex=False) for _ in range(4)]
    children = [context.Process(target=_in_child, args=(ensemble, sender)) for _, sender in pipes]
    for child in children:
        child.start()
    assert list(ensemble.bonds) == alone
    for (receiver, _), child in zip(pipes, children, strict=True):
        assert receiver.recv() == (alone, True)
        child.join()
        assert child.exitcode == 0


INTERRUPTED = """
import sys, stochc
print("begun", flush=True)
try:
    stochc.simulate("examples/five_tower.sa", runs=100000, max_ticks=10**9, out=sys.argv[1])
except KeyboardInterrupt:
    print("stopped", flush=True)
"""


def test_an_interrupt_stops_within_a_tick_and_keeps_what_is_finished(tmp_path: Path) -> None:
    out = tmp_path / "results"
    child = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED, str(out)], stdout=subprocess.PIPE, text=True
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "begun\n"
    while not (out / "journal.jsonl").exists():
        time.sleep(0.05)
    child.send_signal(signal.SIGINT)
    # Without the interruption, this would take days.
    assert child.communicate(timeout=60)[0] == "stopped\n"
    assert child.returncode == 0
    assert not stochc.open(out).complete


def test_progress_is_told_in_the_calling_thread_and_may_stop_the_work() -> None:
    told: list[tuple[float, str]] = []
    thread = threading.get_ident()

    def show(share: float, text: str) -> None:
        assert threading.get_ident() == thread
        told.append((share, text))

    stochc.simulate("examples/line.sa", runs=3, max_ticks=2000, progress=show)
    assert told[-1][0] == 1.0
    assert "3 of 3 runs" in told[-1][1]
    assert all(0 <= share <= 1 for share, _ in told)

    class Enough(Exception):
        pass

    def stop(share: float, text: str) -> None:
        raise Enough

    with pytest.raises(Enough):
        stochc.simulate("examples/line.sa", runs=100000, progress=stop)


def test_progress_without_and_with_a_bar(capsys: pytest.CaptureFixture[str]) -> None:
    stochc.simulate(stochc.EXAMPLE, runs=3, model="shuffle")
    assert capsys.readouterr().err == ""
    stochc.simulate(stochc.EXAMPLE, runs=3, model="shuffle", progress=True)
    assert "3 of 3 runs" in capsys.readouterr().err
