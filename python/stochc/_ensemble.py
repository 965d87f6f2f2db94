"""Ensembles: many runs of programs, stored in a folder or in memory, and their results."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, TypeAlias

from . import _arguments, _html, _native
from ._arguments import MOST_RUNS, MOST_SEED, MOST_TICKS, Path, told, whole
from ._errors import UsageError
from ._program import Program, Source, compile_all
from ._progress import Progress, shown
from ._requests import EnsembleRequest, StorageOptions
from ._table import Table

Programs: TypeAlias = Source | Program | Iterable[Source | Program]
"""One or several programs, sources or files."""

Axes: TypeAlias = Mapping[str, str | float | Sequence[float]]
"""Scene parameters with their values, such as `{"free": [50, 100], "bond.pull": "2..12 N/5 log"}`."""


def _listed(
    programs: Programs, levels: tuple[Any, Any, Any], allow_import: Source | Iterable[Source]
) -> list[_native.Program]:
    each: list[Source | Program]
    if isinstance(programs, (str, os.PathLike, Program)):
        each = [programs]
    elif isinstance(programs, Iterable):  # pyright: ignore[reportUnnecessaryIsInstance]
        each = list(programs)
    else:
        raise TypeError(f"programs: give programs, sources or paths, not {told(programs)}")
    if not each:
        raise UsageError("programs: give at least one")
    found: list[_native.Program] = []
    for it in each:
        if isinstance(it, Program):
            found.append(it._native)  # pyright: ignore[reportPrivateUsage]
        else:
            allow, warn, deny = levels
            read = compile_all(it, allow=allow, warn=warn, deny=deny, allow_import=allow_import)
            found.extend(program._native for program in read)  # pyright: ignore[reportPrivateUsage]
    return found


def _ensemble_request(
    programs: Programs,
    *,
    runs: int,
    seed: int,
    model: str,
    vary: Axes | None,
    rates: Path | Iterable[Path],
    substeps: int | str,
    solver_iterations: int | None,
    precision: str,
    without: str | None,
    max_ticks: int,
    threads: int | None,
    allow: str | Iterable[str],
    warn: str | Iterable[str],
    deny: str | Iterable[str],
    allow_import: Source | Iterable[Source],
) -> EnsembleRequest:
    levels = (allow, warn, deny)
    return {
        "runs": whole("runs", runs, 1, MOST_RUNS),
        "seed": whole("seed", seed, 0, MOST_SEED),
        "vary": [] if vary is None else _arguments.axes(vary),
        "levels": _arguments.levels(*levels),
        "computed": {
            "model": _arguments.word("model", model),
            "substeps": _arguments.substeps(substeps),
            "solver_iterations": _arguments.maybe("solver_iterations", solver_iterations, 1, 1000),
            "precision": _arguments.word("precision", precision),
            "without": None if without is None else _arguments.word("without", without),
            "max_ticks": whole("max_ticks", max_ticks, 1, MOST_TICKS),
            "rates": _arguments.paths("rates", rates),
        },
        "threads": _arguments.threads(threads),
        "programs": _listed(programs, levels, allow_import),
    }


class Run:
    """Run of an ensemble."""

    __slots__ = ("ensemble", "number", "program")

    ensemble: Ensemble
    program: str | None
    """Name of the run's program. `None` if the ensemble has only one."""
    number: int
    """Number of the run, from 0."""

    def __init__(self, ensemble: Ensemble, number: int, program: str | None) -> None:
        self.ensemble, self.number, self.program = ensemble, number, program

    @property
    def record(self) -> dict[str, Any]:
        """Record of the run, in the form of `stochc show DIR --run N --json`. Times are in ticks.

        A missing run is made.
        """
        native = self.ensemble._native  # pyright: ignore[reportPrivateUsage]
        record: dict[str, Any] = json.loads(native.record(self.program, self.number))
        return record

    @property
    def ticks(self) -> int:
        """Duration of the run [ticks]."""
        ticks: int = self.record["ticks"]
        return ticks

    def replay(self) -> Replay:
        """Returns the replay page of the run. Uses the recording in the folder, or repeats the run."""
        native = self.ensemble._native  # pyright: ignore[reportPrivateUsage]
        return Replay(native.replay(self.program, self.number), str(self))

    def save_replay(self, path: Path) -> None:
        """Writes the replay page of the run to a file."""
        native = self.ensemble._native  # pyright: ignore[reportPrivateUsage]
        native.write_replay(self.program, self.number, _arguments.path("path", path))

    def export(
        self, path: Path, format: Literal["parquet", "gltf"] = "parquet", every: int | None = None
    ) -> None:
        """Repeats the run and writes the positions of all blocks.

        Args:
            path: file to write.
            format: `parquet` is a table. `gltf` is an animation for 3D applications (a `.glb` file).
            every: ticks between two records. Default: 1 for a table, 8 for an animation.
        """
        if format not in ("parquet", "gltf"):
            raise UsageError(f"format: give 'parquet' or 'gltf', not {told(format)}")
        is_table = format == "parquet"
        ticks = whole("every", (1 if is_table else 8) if every is None else every, 1, 1_000_000)
        native = self.ensemble._native  # pyright: ignore[reportPrivateUsage]
        chosen = (self.program, self.number)
        native.export(chosen, is_table, ticks, _arguments.path("path", path))

    def __str__(self) -> str:
        of = f"{self.program}, " if self.program else ""
        return f"{of}run {self.number}"

    def __repr__(self) -> str:
        return f"<stochc.Run {self}>"

    def _repr_html_(self) -> str:
        return self.replay().frame()


class Replay:
    """Replay page of a run. It makes no network requests."""

    __slots__ = ("html", "title")

    html: str
    """HTML of the page."""
    title: str

    def __init__(self, html: str, title: str) -> None:
        self.html, self.title = html, title

    def __repr__(self) -> str:
        return f"<stochc.Replay of {self.title}: {len(self.html)} characters>"

    def frame(self, height: int = 640) -> str:
        """Returns an element for another page, with this height [pixels]."""
        pixels = whole("height", height, 1, 100_000)
        return _html.page(self.html, f"replay of {self.title}", pixels)

    def _repr_html_(self) -> str:
        return self.frame()


class Ensemble:
    """Runs of one or more programs, with their results. Printing an ensemble shows the output of `stochc show`.

    >>> import stochc
    >>> ensemble = stochc.simulate(stochc.EXAMPLE, runs=5, model="shuffle")
    >>> ensemble
    <stochc.Ensemble of pair: 5 of 5 runs>
    >>> [row["mean"] for row in ensemble.summary]
    [1.0]
    """

    __slots__ = ("_native",)

    def __init__(self, native: _native.Ensemble) -> None:
        self._native = native

    @property
    def folder(self) -> str | None:
        """Results folder of the ensemble. `None` if the ensemble is in memory."""
        folder = self._native.folder
        return None if folder is None else str(folder)

    @property
    def programs(self) -> tuple[Program, ...]:
        """Programs of the ensemble, in order."""
        return tuple(Program(it) for it in self._native.programs)

    @property
    def seed(self) -> int:
        """Seed of the random numbers."""
        return self._native.seed

    @property
    def model(self) -> str:
        """Physical model."""
        return self._native.model

    @property
    def identity(self) -> str:
        """SHA-256 of everything that determines a run."""
        return self._native.identity

    @property
    def complete(self) -> bool:
        """Whether all requested runs are finished."""
        finished, total = self._native.counts()
        return finished == total

    def __len__(self) -> int:
        """Number of finished runs of all programs."""
        return self._native.counts()[0]

    @property
    def runs(self) -> Table:
        """Table with a row for each run: outcome and times [ticks]. The same as `runs.parquet`."""
        return Table(self._native.table("runs"))

    @property
    def phases(self) -> Table:
        """Table with a row for each phase that a run has reached, with its times [ticks]."""
        return Table(self._native.table("phases"))

    @property
    def bonds(self) -> Table:
        """Table with a row for each capture, and for each face still open at the end of a run. Times are in ticks."""
        return Table(self._native.table("bonds"))

    @property
    def releases(self) -> Table:
        """Table with a row for each release, with its times [ticks]."""
        return Table(self._native.table("releases"))

    @property
    def unplanned(self) -> Table:
        """Table with a row for each unplanned capture, with its times [ticks]."""
        return Table(self._native.table("unplanned"))

    @property
    def summary(self) -> Table:
        """Table with a row for each program or point of a sweep: outcomes and completion times [ticks]."""
        return Table(self._native.summary())

    @property
    def survival(self) -> Table:
        """Table with the fraction of incomplete runs after each completion time [ticks], by Kaplan-Meier."""
        return Table(self._native.survival())

    def results(self, *, captures: bool = False) -> Any:
        """Returns all results and comparisons, in the form of `stochc show --format json`. `captures` includes every capture."""
        return json.loads(self._native.results(_arguments.yes("captures", captures), None))

    def text(self, *, captures: bool = False, width: int = 80) -> str:
        """Returns the output of `stochc show` for this line width [columns]."""
        columns = whole("width", width, 40, 10_000)
        return self._native.results(_arguments.yes("captures", captures), columns)

    def pictures(self) -> dict[str, str]:
        """Returns the figures (SVG) by title: the completion curves, or the figures of a sweep."""
        return {title: svg for _, title, svg in self._native.pictures()}

    def run(self, number: int | None = None, program: str | None = None) -> Run:
        """Returns the run with a number, from 0. Without a number, returns the run with the median completion time.

        If there are several programs, `program` is required.
        """
        names = [it.name for it in self._native.programs]
        if number is not None:
            number = whole("number", number, 0, self._native.runs_requested - 1)
        if program is None and len(names) > 1:
            listed = ", ".join(f"`{name}`" for name in names[:10])
            raise UsageError(f"program: name one of {listed}{', ...' if len(names) > 10 else ''}")
        if program is not None and _arguments.word("program", program) not in names:
            raise UsageError(f"program: there is no `{program}`; choose from {', '.join(names[:10])}")
        if number is None:
            number = self._native.median_run(program)
        return Run(self, number, program)

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        folder = self.folder
        if folder is None:
            raise TypeError("an ensemble in memory cannot be pickled: use `out=`, or pass its tables")
        return (open, (folder,))

    def __repr__(self) -> str:
        names = [it.name for it in self._native.programs]
        which = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
        finished, total = self._native.counts()
        return f"<stochc.Ensemble of {which}: {finished} of {total} runs>"

    def __str__(self) -> str:
        return self.text().rstrip()

    def _repr_html_(self) -> str:
        summary = self.summary
        left_out = {"runs", "captures", "blocks_used", "tick", "horizon"}
        columns = [it for it in summary.columns if it.name not in left_out]
        most = 60
        rows = [[row[it.name] for it in columns] for row in summary.rows(0, most)]
        names = [it.name + (f" [{it.unit}]" if it.unit else "") for it in columns]
        more = len(summary) - len(rows)
        rest = f"<p>and {more} more</p>" if more > 0 else ""
        figures = [_html.picture(svg, title) for _, title, svg in self._native.pictures()]
        return _html.table(names, rows, [it.meaning for it in columns]) + rest + "".join(figures)


def simulate(
    programs: Programs,
    *,
    runs: int = 50,
    seed: int = 1,
    model: Literal["rigid", "rapier", "rate", "shuffle"] = "rigid",
    vary: Axes | None = None,
    rates: Path | Iterable[Path] = (),
    substeps: int | str = "2/8",
    solver_iterations: int | None = None,
    precision: Literal["single", "double"] = "single",
    without: Literal["rotation", "corners", "friction", "block-contact"] | None = None,
    max_ticks: int = 1_000_000,
    threads: int | None = None,
    out: Path | None = None,
    resume: bool = False,
    mixed_builds: bool = False,
    record: int | str | Iterable[int] | None = None,
    record_every: int = 4,
    allow: str | Iterable[str] = (),
    warn: str | Iterable[str] = (),
    deny: str | Iterable[str] = (),
    allow_import: Source | Iterable[Source] = (),
    progress: Progress = None,
) -> Ensemble:
    """Simulates programs many times. The runs equal those of `stochc simulate` with the same options, bit for bit.

    The interpreter's lock is released. Ctrl-C stops the runs within a tick. Finished runs remain in `out`.

    Args:
        programs: programs, sources or files. Several are compared.
        runs: number of runs of each program.
        seed: seed of the random numbers.
        model: physical model. `rigid`: rigid bodies. `rapier`: rigid bodies by a general engine. `rate`: no motion,
            waiting times drawn from calibrated rates. `shuffle`: no physics, for testing event tables.
        vary: scene parameters or settings, with their values. Every combination is simulated.
        rates: files with rates for the model `rate`. Scenes without rates are calibrated first,
            except those whose rates need a held-out error.
        substeps: steps of the model per tick. `"2/8"` means two, and eight for blocks near magnetized faces.
            In a scene with a fluid, all blocks take eight.
        solver_iterations: iterations of the contact solver per step.
        precision: floating-point precision. `double` requires `rigid`.
        without: physical term to leave out, with `rigid`.
        max_ticks: tick limit of a run. The time of a run that reaches it is right-censored.
        threads: number of simultaneous runs. Default: the number of cores.
        out: new or empty results folder. Default: results stay in memory.
        resume: resume the same ensemble in `out`.
        mixed_builds: resume even if another build of stochc has made some runs.
        record: runs whose trajectories are recorded in `out`: `17`, `"0..4"`, `[0, 5]` or `"all"`.
        record_every: ticks between two frames of a recording.
        allow, warn, deny, allow_import: as in `check`.
        progress: whether to show progress, or a function that receives it. Default: only in a terminal and in Jupyter.

    Raises:
        ProgramError: a program has errors, or cannot be simulated.
        UsageError: an argument is invalid or not used by the model, or a folder cannot be used.

    >>> import stochc
    >>> print(stochc.simulate(stochc.EXAMPLE, runs=2, model="shuffle", progress=False).complete)
    True
    """
    request = _ensemble_request(
        programs,
        runs=runs,
        seed=seed,
        model=model,
        vary=vary,
        rates=rates,
        substeps=substeps,
        solver_iterations=solver_iterations,
        precision=precision,
        without=without,
        max_ticks=max_ticks,
        threads=threads,
        allow=allow,
        warn=warn,
        deny=deny,
        allow_import=allow_import,
    )
    storage: StorageOptions = {
        "out": _arguments.maybe_path("out", out),
        "resume": _arguments.yes("resume", resume),
        "mixed_builds": _arguments.yes("mixed_builds", mixed_builds),
        "record": _arguments.selection(record),
        "record_every": whole("record_every", record_every, 1, 1_000_000),
    }
    for name, given in (("resume", resume or mixed_builds), ("record", storage["record"])):
        if given and out is None:
            raise UsageError(f"{name}: name a folder with `out`")
    with shown(progress) as show:
        return Ensemble(_native.simulate(request, storage, show))


def sweep(programs: Programs, vary: Axes, **options: Any) -> Ensemble:
    """Simulates programs at every combination of scene parameters. The options are those of `simulate`.

    >>> import stochc
    >>> ensemble = stochc.sweep(stochc.EXAMPLE, {"free": [50, 100]}, runs=2, model="shuffle")
    >>> [(row["scene_free"], row["completed"]) for row in ensemble.summary]
    [(50.0, 2), (100.0, 2)]
    """
    return simulate(programs, vary=vary, **options)


def open(folder: Path) -> Ensemble:
    """Reads a results folder, finished or not, without changing it."""
    return Ensemble(_native.open(_arguments.path("folder", folder)))


def replay(run: Run | Ensemble | Path, number: int | None = None, program: str | None = None) -> Replay:
    """Returns the replay of a run of an ensemble or folder. Without a number, returns the replay of the median run."""
    if isinstance(run, Run):
        return run.replay()
    ensemble = run if isinstance(run, Ensemble) else open(run)
    return ensemble.run(number, program).replay()


def prepare(programs: Programs, out: Path, shards: int, **options: Any) -> int:
    """Splits an ensemble into shards in the folder `out`, for `shard` and `merge`.

    The options are those of `simulate` that determine the runs. Returns the total number of runs.
    """
    from inspect import signature

    known = signature(_ensemble_request).parameters
    for name in options:
        if name not in known or name == "programs":
            raise TypeError(f"prepare() has no option {name!r}")
    defaults = signature(simulate).parameters
    given = {name: options.get(name, defaults[name].default) for name in known if name != "programs"}
    pieces = whole("shards", shards, 1, 100_000)
    return _native.prepare(_ensemble_request(programs, **given), _arguments.path("out", out), pieces)


def shard(
    folder: Path, number: int, *, threads: int | None = None, progress: Progress = None
) -> int:
    """Makes the missing runs of a shard of an ensemble. Returns the number of runs in the shard.

    Any process may run any shard, in any order and repeatedly. Shards are written atomically.

    Args:
        folder: folder of `prepare`, or of `stochc shard new`.
        number: number of the shard, from 0.
        threads: number of simultaneous runs. Default: the number of cores.
        progress: as in `simulate`.
    """
    place, piece = _arguments.path("folder", folder), whole("number", number, 0, MOST_RUNS)
    at_once = _arguments.threads(threads)
    with shown(progress) as show:
        return _native.shard(place, piece, at_once, show)


def status(folder: Path) -> dict[str, Any]:
    """Returns the state of all shards, in the form of `stochc shard status --json`. `missing` lists missing shards."""
    status: dict[str, Any] = json.loads(_native.status(_arguments.path("folder", folder)))
    return status


def merge(folder: Path) -> Ensemble:
    """Merges the shards of an ensemble. The files equal those without shards, byte for byte.

    Raises:
        RunError: shards are missing. The message lists them.
    """
    return Ensemble(_native.merge(_arguments.path("folder", folder)))


def report(
    folders: Path | Ensemble | Iterable[Path | Ensemble],
    out: Path | None = None,
    *,
    figures: str | None = None,
    figure_format: str | Iterable[str] = "svg",
) -> str:
    """Writes the HTML report on one or more results folders. Returns its path.

    The default path is `report.html`: in the results folder if there is only one, otherwise in the current folder.

    Args:
        folders: results folders, or ensembles made with `out=`.
        out: path of the page.
        figures: width of figures for print with 7 pt type, such as `89mm`. Default: figures for a screen.
        figure_format: file format of the figures, `svg` or `pdf`, or several.

    Raises:
        UsageError: a folder cannot be read, an argument is invalid, or the page would overwrite another file.
    """
    each: list[Path | Ensemble]
    if isinstance(folders, (str, os.PathLike, Ensemble)):
        each = [folders]
    elif isinstance(folders, Iterable):  # pyright: ignore[reportUnnecessaryIsInstance]
        each = list(folders)
    else:
        raise TypeError(f"folders: give results folders, not {told(folders)}")
    places: list[str] = []
    for it in each:
        place = it.folder if isinstance(it, Ensemble) else it
        if place is None:
            raise UsageError("a report requires a folder: make the ensemble with `out=`")
        places.append(_arguments.path("folders", place))
    if not places:
        raise UsageError("folders: give at least one")
    width = None if figures is None else _arguments.word("figures", figures)
    formats = list(dict.fromkeys(_arguments.words("figure_format", figure_format)))
    if not formats:
        raise UsageError("figure_format: give at least one")
    return str(_native.report(places, _arguments.maybe_path("out", out), width, formats))
