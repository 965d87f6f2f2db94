"""Exceptions of stochc. Their messages are those of the `stochc` command."""

from __future__ import annotations

import json
import re
import sys
import warnings
from types import FrameType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._diagnostics import Diagnostic


class StochcError(Exception):
    """Failure with its reason and a suggestion.

    `text` is the message of the `stochc` command.
    """

    def __init__(self, text: str = "") -> None:
        super().__init__(text)
        self.text = text


class ProgramError(StochcError):
    """A program has errors, or cannot be run. `diagnostics` are the diagnostics, if available."""

    def __init__(self, text: str = "", diagnostics: tuple[Diagnostic, ...] = ()) -> None:
        super().__init__(text)
        self.diagnostics = diagnostics

    def __str__(self) -> str:
        # Rendered diagnostics begin on a separate line.
        return f"\n{self.text}" if self.diagnostics else self.text

    def __reduce__(self) -> tuple[type[ProgramError], tuple[str, tuple[Diagnostic, ...]]]:
        return (type(self), (self.text, self.diagnostics))


class UsageError(StochcError, ValueError):
    """An argument is invalid, or a file or folder cannot be read or written."""


class RunError(StochcError):
    """Runs or shards are missing or did not complete."""


class Interrupted(StochcError):
    """The work was interrupted."""


class InternalError(StochcError, RuntimeError):
    """A defect of stochc itself."""


class StochcWarning(UserWarning):
    """Warning about an ensemble or a folder."""


class DiagnosticWarning(StochcWarning):
    """A program is valid, but has warnings."""


_KINDS: dict[str, type[StochcError]] = {
    "usage": UsageError,
    "run": RunError,
    "interrupted": Interrupted,
}


_FLAGS = ("resume", "mixed-builds")
_OPTIONS = ("max-ticks", "out", "record", "runs", "substeps", "threads", "vary")


def _in_python(text: str) -> str:
    """Returns a message of the `stochc` command with its options in Python syntax."""

    def written(found: re.Match[str]) -> str:
        name = found[1]
        if name in _FLAGS:
            return f"`{name.replace('-', '_')}=True`"
        return f"`{name.replace('-', '_')}`" if name in _OPTIONS else found[0]

    text = re.sub(r"`--([a-z-]+)`", written, text)
    text = re.sub(r"`stochc resume [^`]*`", "`resume=True`", text)
    return re.sub(r"^--([a-z]+): ", r"\1: ", text)


def made(kind: str, text: str, diagnostics: str) -> StochcError:
    """Returns the exception for a failure of the native part."""
    text = _in_python(text.removeprefix("error: ").rstrip())
    if kind == "program":
        from ._diagnostics import diagnostic

        found: list[dict[str, Any]] = json.loads(diagnostics)
        return ProgramError(text, tuple(diagnostic(it) for it in found))
    if kind == "defect":
        return InternalError(
            f"a defect of stochc: {text}; please report it with your call"
        )
    return _KINDS[kind](text)


def warn(kind: str, text: str) -> None:
    """Issues a warning of the native part. Its location is the first caller outside of this package."""
    category = DiagnosticWarning if kind == "diagnostics" else StochcWarning
    text = text.removeprefix("warning: ")
    level = 1
    frame: FrameType | None = sys._getframe()  # pyright: ignore[reportPrivateUsage]
    while frame is not None and frame.f_globals.get("__name__", "").split(".")[0] == "stochc":
        level, frame = level + 1, frame.f_back
    warnings.warn(text, category, stacklevel=level)
