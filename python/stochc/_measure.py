"""Estimates, plans and trades."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

from . import _arguments, _html, _native
from ._arguments import MOST_RUNS, MOST_SEED, MOST_TICKS, Path, told, whole
from ._ensemble import Programs, _listed  # pyright: ignore[reportPrivateUsage]
from ._errors import ProgramError, UsageError
from ._program import Program, Source, chosen
from ._progress import Progress, shown
from ._requests import EstimateRequest, PlanRequest, RatedPrograms, TestRequest, TradeRequest


@dataclass(frozen=True)
class Estimates:
    """Estimated completion times of programs, and the captures that dominate them."""

    programs: tuple[dict[str, Any], ...]
    """Estimate of each program, in the form of `stochc estimate --json`. Times are in ticks, fractions from 0 to 1."""
    text: str
    """Estimates as text, as `stochc estimate` prints them."""

    def __str__(self) -> str:
        return self.text.rstrip()

    def _repr_html_(self) -> str:
        rows: list[list[object]] = []
        for it in self.programs:
            total: dict[str, float | None] = it["total"] or {}
            times = [total.get(name) for name in ("mean", "half_width", "p10", "median", "p90")]
            rows.append([it["program"], *times])
        return _html.table(["program", "mean [ticks]", "±", "p10", "median", "p90"], rows)


@dataclass(frozen=True)
class Verdicts:
    """Verdicts about the claims of programs."""

    claims: tuple[dict[str, Any], ...]
    """Tested claims, in the form of `stochc test --json`."""
    text: str
    """Verdicts as text, as `stochc test` prints them."""

    @property
    def hold(self) -> bool:
        """Whether all claims hold."""
        return all(claim["verdict"] == "holds" for claim in self.claims)

    def __str__(self) -> str:
        return self.text.rstrip()

    def _repr_html_(self) -> str:
        names = ["program", "claim", "verdict", "estimate", "low", "high", "runs"]
        return _html.table(names, [[claim[name] for name in names] for claim in self.claims])


@dataclass(frozen=True)
class Plan:
    """Planned program that builds a shape, as source text."""

    text: str
    """Source text of the program."""
    plan: dict[str, Any]
    """Order of captures, in the form of `stochc plan --json`."""
    explanation: str
    """Explanation of the plan as text."""
    assembly: str
    """Name of the assembly that builds the shape."""
    sources: dict[str, str]
    """Sources of the program by path, its own first."""

    def compile(self) -> Program:
        """Compiles the program that builds the shape.

        Raises:
            ProgramError: the program claims other shapes that are not built yet.
        """
        found = _native.load_texts(list(self.sources.items()))
        return chosen([Program(it) for it in found], self.assembly)

    def __str__(self) -> str:
        return self.text.rstrip()

    def _repr_html_(self) -> str:
        try:
            return self.compile()._repr_html_()  # pyright: ignore[reportPrivateUsage]
        except ProgramError:
            return _html.text(str(self))


@dataclass(frozen=True)
class Trade:
    """Speed and accuracy of settings."""

    data: dict[str, Any]
    """All results, in the form of `trade.json`."""
    text: str
    """Results as text, as `stochc trade` prints them."""
    svg: str
    """Figure of the trade, as SVG."""

    def __str__(self) -> str:
        return self.text.rstrip()

    def _repr_html_(self) -> str:
        return _html.picture(self.svg, "error and time of each setting")


def estimate(
    programs: Programs,
    *,
    rates: Path | Iterable[Path] = (),
    runs: int | None = None,
    max_ticks: int = 1_000_000,
    seed: int = 1,
    threads: int | None = None,
    allow_import: Source | Iterable[Source] = (),
    progress: Progress = None,
) -> Estimates:
    """Estimates the completion times of programs with the rate model, and the captures that dominate them.

    Waiting times are summed along the dependency graph. With `runs`, programs are run with the rate model instead.

    Args:
        programs: programs, sources or files.
        rates: files of rates. Scenes without rates are calibrated first, except those whose
            rates need a held-out error.
        runs: number of runs of each program. Default: sum waiting times along the dependency graph, without runs.
        max_ticks: tick limit of a run.
        seed: seed of the runs.
        threads: number of simultaneous runs.
        allow_import: as in `check`.
        progress: as in `simulate`.

    >>> import stochc
    >>> found = stochc.estimate(stochc.EXAMPLE, runs=20)
    >>> found.programs[0]["program"], found.programs[0]["completed"]
    ('pair', 20)
    """
    request: EstimateRequest = {
        "runs": _arguments.maybe("runs", runs, 2, MOST_RUNS),
        "rated": _rated(programs, rates, max_ticks, seed, threads, allow_import),
    }
    with shown(progress) as show:
        found, text = _native.estimate(request, show)
    return Estimates(tuple(json.loads(found)), text)


def test(
    programs: Programs,
    *,
    alpha: float = 0.05,
    margin: float | None = None,
    model: Literal["rigid", "rapier", "rate", "shuffle"] | None = None,
    rates: Path | Iterable[Path] = (),
    runs: int = 1000,
    max_ticks: int = 1_000_000,
    seed: int = 1,
    threads: int | None = None,
    allow_import: Source | Iterable[Source] = (),
    progress: Progress = None,
) -> Verdicts:
    """Decides the claims (`expect`) of programs with as many runs as needed.

    Args:
        programs: programs, sources or files.
        alpha: largest probability that any claim is decided wrongly.
        margin: allow any decision about a probability that differs from its bound by less than this.
        model: model of the motion of blocks. Default: the rate model if its errors cannot change the verdict, otherwise `rigid`.
        rates: files of rates. Scenes without rates are calibrated first, except those whose
            rates need a held-out error.
        runs: largest number of runs of each program.
        max_ticks: tick limit of a run.
        seed: seed of the random numbers.
        threads: number of simultaneous runs.
        allow_import: as in `check`.
        progress: as in `simulate`.

    >>> import stochc
    >>> claim = "expect complete within 100000 ticks with probability >= 0.5"
    >>> one = "assembly one { seed plate 1 x 1 { M at (0, 0) } phase grow { M.up -> A } " + claim + " }"
    >>> found = stochc.test(stochc.compile(one))
    >>> found.hold, found.claims[0]["runs"]
    (True, 0)
    """
    request: TestRequest = {
        "alpha": _within("alpha", alpha, "a part", 0.4999) or 0.05,
        "margin": _within("margin", margin, "a part", 1.0) or 0.0,
        "model": _maybe_word("model", model),
        "runs": whole("runs", runs, 1, MOST_RUNS),
        "rated": _rated(programs, rates, max_ticks, seed, threads, allow_import),
    }
    with shown(progress) as show:
        found, text = _native.test(request, show)
    return Verdicts(tuple(json.loads(found)), text)


def plan(
    target: Path,
    *,
    complete: bool = False,
    run: int | None = None,
    program: str | None = None,
    dead: str | Iterable[str] = (),
    shape: str | None = None,
    model: int | None = None,
    plate: str | None = None,
    offset: str | None = None,
    scene: str | None = None,
    free: int | None = None,
    name: str | None = None,
    drop_loose: bool = False,
    supports: bool = False,
    time: float | None = None,
    tries: int | None = None,
    minimize: Literal["mean", "p90"] = "mean",
    seed: int = 1,
    keep_scaffolds: bool = False,
    race: int | None = None,
    rates: Path | Iterable[Path] = (),
    allow_import: Source | Iterable[Source] = (),
    progress: Progress = None,
) -> Plan:
    """Plans a program that builds a shape fast and without jams.

    Args:
        target: program with a shape (`.sa`), MagicaVoxel scene (`.vox`), or layers drawn as text (`.txt`). With `run`, a results folder.
        complete: complete the program: plan the phases that claim a shape but do not build it.
        run: plan the rest of this run of the folder. Its final structure becomes pre-attached; blocks outside the shape are released.
        program: name of the program of the run. Required if the folder has several.
        dead: names of failed blocks, which no longer capture or forward messages.
        shape: name of the shape.
        model: build only this model of a `.vox` file, counted from 0.
        plate: seed plate, such as `"3 x 3 at (1, 1)"`.
        offset: displacement of the shape to the east and to the north [cells], such as `"2, 1"`.
        scene: name of the scene, possibly in a file: `"lab.sa:tank"`.
        free: number of free blocks. The scene is scaled to keep their density.
        name: name of the assembly.
        drop_loose: whether to omit parts that are not attached to a capturing block of the plate.
        supports: whether to add the smallest number of cells that support such parts.
        time: duration of the search [s].
        tries: number of plans that the search tries.
        minimize: the mean completion time, or its 90th percentile.
        seed: seed of the random numbers.
        keep_scaffolds: whether scaffolds remain instead of being removed.
        race: number of simulated runs of the plan and of each baseline plan. The fastest, including jams, is returned.
        rates: files of rates by `stochc calibrate`.
        allow_import: as in `check`.
        progress: as in `simulate`.
    """
    if minimize not in ("mean", "p90"):
        raise UsageError(f"minimize: give 'mean' or 'p90', not {told(minimize)}")
    maybe = _maybe_word
    of_whole = {
        "model": model,
        "plate": plate,
        "offset": offset,
        "drop_loose": drop_loose or None,
        "supports": supports or None,
        "keep_scaffolds": keep_scaffolds or None,
        "race": race,
    }
    if drop_loose:
        _alone("drop_loose", supports=supports or None)
    if _arguments.yes("complete", complete):
        _alone("complete", run=run, scene=scene, free=free, name=name, **of_whole)
    if run is not None:
        _alone("run", **of_whole)
    elif program is not None or dead:
        raise UsageError("program, dead: these require `run`")
    if time is not None:
        _alone("time", tries=tries)
    request: PlanRequest = {
        "target": _arguments.path("target", target),
        "completes": complete,
        "run": _arguments.maybe("run", run, 0, MOST_SEED),
        "program": maybe("program", program),
        "dead": _arguments.words("dead", dead),
        "shape": maybe("shape", shape),
        "model": _arguments.maybe("model", model, 0, 2**32 - 1),
        "plate": maybe("plate", plate),
        "offset": maybe("offset", offset),
        "scene": maybe("scene", scene),
        "free": _arguments.maybe("free", free, 1, 2**32 - 1),
        "name": maybe("name", name),
        "drops_loose": _arguments.yes("drop_loose", drop_loose),
        "adds_supports": _arguments.yes("supports", supports),
        "imports": _arguments.paths("allow_import", allow_import),
        "time": _within("time", time, "seconds", 1e9),
        "tries": _arguments.maybe("tries", tries, 1, 10**9),
        "is_p90": minimize == "p90",
        "seed": whole("seed", seed, 0, MOST_SEED),
        "keeps_scaffolds": _arguments.yes("keep_scaffolds", keep_scaffolds),
        "race": _arguments.maybe("race", race, 8, 100_000),
        "rates": _arguments.paths("rates", rates),
    }
    with shown(progress) as show:
        texts, assembly, found, explained = _native.plan(request, show)
    return Plan(texts[0][1], json.loads(found), explained, assembly, dict(texts))


def _rated(
    programs: Programs,
    rates: Path | Iterable[Path],
    max_ticks: int,
    seed: int,
    threads: int | None,
    allow_import: Source | Iterable[Source],
) -> RatedPrograms:
    """Checks the arguments of an estimate and of a test."""
    return {
        "rates": _arguments.paths("rates", rates),
        "max_ticks": whole("max_ticks", max_ticks, 1, MOST_TICKS),
        "seed": whole("seed", seed, 0, MOST_SEED),
        "threads": _arguments.threads(threads),
        "programs": _listed(programs, ((), (), ()), allow_import),
    }


def _alone(name: str, /, **others: object) -> None:
    """Checks that an argument is not combined with arguments that it excludes."""
    given = [other for other, value in others.items() if value is not None]
    if given:
        raise UsageError(f"{given[0]}: cannot be combined with `{name}`")


def _maybe_word(name: str, value: object) -> str | None:
    return None if value is None else _arguments.word(name, value)


def trade(
    programs: Programs,
    *,
    runs: int | None = None,
    time: float | None = None,
    until: float | None = None,
    seed: int = 1,
    max_ticks: int = 1_000_000,
    finest: int = 32,
    threads: int | None = None,
    out: Path | None = None,
    resume: bool = False,
    allow_import: Source | Iterable[Source] = (),
    progress: Progress = None,
) -> Trade:
    """Compares the speed and accuracy of many settings with a converged reference.

    Args:
        programs: programs, sources or files.
        runs: number of runs of each program at each setting. Default: 30, or at most 10000 with `time` or `until`.
        time: start no run after this time [s].
        until: relative precision of every mean (half-width of the 95 % confidence interval). Requires `out`.
        seed: seed of the random numbers, equal for all settings.
        max_ticks: tick limit of a run.
        finest: largest number of substeps of the reference.
        threads: number of simultaneous runs.
        out: new or empty folder for the results, `trade.json` and `trade.svg`.
        resume: continue the trade in `out`.
        allow_import: as in `check`.
        progress: as in `simulate`.
    """
    if until is not None:
        _alone("until", time=time)
        if out is None:
            raise UsageError("until: name a folder with `out`")
    if resume and out is None:
        raise UsageError("resume: name a folder with `out`")
    request: TradeRequest = {
        "runs": _arguments.maybe("runs", runs, 2, MOST_RUNS),
        "time": _within("time", time, "seconds", 1e9),
        "until": _within("until", until, "a part", 1.0),
        "seed": whole("seed", seed, 0, MOST_SEED),
        "max_ticks": whole("max_ticks", max_ticks, 1, MOST_TICKS),
        "finest": whole("finest", finest, 1, 1000),
        "threads": _arguments.threads(threads),
        "out": _arguments.maybe_path("out", out),
        "resume": _arguments.yes("resume", resume),
        "programs": _listed(programs, ((), (), ()), allow_import),
    }
    with shown(progress) as show:
        data, text, svg = _native.trade(request, show)
    return Trade(json.loads(data), text, svg)


def _within(name: str, value: object, what: str, most: float) -> float | None:
    """Returns a number above 0 and at most `most`, or `None`."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TypeError(f"{name}: give {what}, not {told(value)}")
    if not 0 < value <= most:
        raise UsageError(f"{name}: give {what}, more than 0 and at most {most:g}, not {told(value)}")
    return float(value)
