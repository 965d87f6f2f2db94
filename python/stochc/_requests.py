"""Validated arguments for the native part."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypedDict

if TYPE_CHECKING:
    from . import _native


class RunSettings(TypedDict):
    """Settings of runs."""

    model: str
    substeps: str
    solver_iterations: int | None
    precision: str
    without: str | None
    max_ticks: int
    rates: list[str]


class EnsembleRequest(TypedDict):
    """Arguments that determine an ensemble."""

    programs: list[_native.Program]
    runs: int
    seed: int
    vary: list[str]
    levels: list[tuple[str, str]]
    computed: RunSettings
    threads: int | None


class StorageOptions(TypedDict):
    """Number of runs of an ensemble, and their storage."""

    out: str | None
    resume: bool
    mixed_builds: bool
    record: str | None
    record_every: int


class RatedPrograms(TypedDict):
    """Programs with their rates, and settings of runs."""

    programs: list[_native.Program]
    rates: list[str]
    max_ticks: int
    seed: int
    threads: int | None


class EstimateRequest(TypedDict):
    """Arguments of an estimate."""

    rated: RatedPrograms
    runs: int | None


class TestRequest(TypedDict):
    """Arguments of a test of claims."""

    rated: RatedPrograms
    alpha: float
    margin: float
    model: str | None
    runs: int


class PlanRequest(TypedDict):
    """Arguments of a plan."""

    target: str
    completes: bool
    run: int | None
    program: str | None
    dead: list[str]
    shape: str | None
    model: int | None
    plate: str | None
    offset: str | None
    scene: str | None
    free: int | None
    name: str | None
    drops_loose: bool
    adds_supports: bool
    imports: list[str]
    time: float | None
    tries: int | None
    is_p90: bool
    seed: int
    keeps_scaffolds: bool
    race: int | None
    rates: list[str]


class TradeRequest(TypedDict):
    """Arguments of a trade."""

    programs: list[_native.Program]
    runs: int | None
    time: float | None
    until: float | None
    seed: int
    max_ticks: int
    finest: int
    threads: int | None
    out: str | None
    resume: bool
