"""Compiler, verifier and simulator for stochastic modular robots.

Each function corresponds to the command of `stochc` with the same name. It makes the same checks, the same runs bit
for bit, and the same files byte for byte. `docs/guides/python.md` is an introduction.

>>> import stochc
>>> ensemble = stochc.simulate(stochc.EXAMPLE, runs=3, model="shuffle")
>>> ensemble.complete
True
"""

from ._ensemble import (
    Axes,
    Ensemble,
    Programs,
    Replay,
    Run,
    merge,
    open,
    prepare,
    replay,
    report,
    shard,
    simulate,
    status,
    sweep,
)
from ._diagnostics import Diagnostic, Fix, Position, Proof, Span
from ._errors import (
    DiagnosticWarning,
    InternalError,
    Interrupted,
    ProgramError,
    RunError,
    StochcError,
    StochcWarning,
    UsageError,
)
from ._measure import Estimates, Plan, Trade, Verdicts, estimate, plan, test, trade
from ._program import Checked, Program, Source, check, compile, compile_all, explain
from ._progress import Progress
from ._table import Column, Table

EXAMPLE = """\
assembly pair {
    seed plate 3 x 3 { M at (1, 1) }
    phase grow { M.up -> A }
}
"""
"""Source of a small example program."""

__all__ = [
    "EXAMPLE",
    "Axes",
    "Checked",
    "Column",
    "Diagnostic",
    "DiagnosticWarning",
    "Ensemble",
    "Estimates",
    "Fix",
    "InternalError",
    "Interrupted",
    "Plan",
    "Position",
    "Program",
    "ProgramError",
    "Proof",
    "Programs",
    "Progress",
    "Replay",
    "Run",
    "RunError",
    "Source",
    "Span",
    "StochcError",
    "StochcWarning",
    "Table",
    "Trade",
    "UsageError",
    "Verdicts",
    "check",
    "compile",
    "compile_all",
    "estimate",
    "explain",
    "merge",
    "open",
    "plan",
    "prepare",
    "replay",
    "report",
    "shard",
    "simulate",
    "status",
    "sweep",
    "test",
    "trade",
]
