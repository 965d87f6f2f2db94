"""What goes wrong, as exceptions that print as the command's messages do."""

from __future__ import annotations

import json
import re
import sys
import warnings
from types import FrameType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ._findings import Finding


class StochcError(Exception):
    """Something could not be done; the text says why, and the way out.

    `text` is what the `stochc` command prints.
    """

    def __init__(self, text: str = "") -> None:
        super().__init__(text)
        self.text = text


class ProgramError(StochcError):
    """A program is wrong, or cannot be run; `findings` say where, if they are known."""

    def __init__(self, text: str = "", findings: tuple[Finding, ...] = ()) -> None:
        super().__init__(text)
        self.findings = findings

    def __str__(self) -> str:
        # Drawings begin on a line of their own.
        return f"\n{self.text}" if self.findings else self.text

    def __reduce__(self) -> tuple[type[ProgramError], tuple[str, tuple[Finding, ...]]]:
        return (type(self), (self.text, self.findings))


class UsageError(StochcError, ValueError):
    """An argument is wrong, or a file or folder cannot be read or written."""


class RunError(StochcError):
    """Runs or pieces are missing or did not come to an end."""


class Interrupted(StochcError):
    """The work was stopped before its end."""


class InternalError(StochcError, RuntimeError):
    """A defect of stochc itself."""


class StochcWarning(UserWarning):
    """Something about an ensemble or a folder that is no reason to stop."""


class FindingWarning(StochcWarning):
    """A program is right, and something in it is doubtful."""


_KINDS: dict[str, type[StochcError]] = {
    "usage": UsageError,
    "run": RunError,
    "interrupted": Interrupted,
}


_FLAGS = ("resume", "mixed-builds")
_OPTIONS = ("max-ticks", "out", "record", "runs", "substeps", "threads", "vary")


def _in_python(text: str) -> str:
    """A message of the command, with options as Python writes them."""

    def written(found: re.Match[str]) -> str:
        name = found[1]
        if name in _FLAGS:
            return f"`{name.replace('-', '_')}=True`"
        return f"`{name.replace('-', '_')}`" if name in _OPTIONS else found[0]

    text = re.sub(r"`--([a-z-]+)`", written, text)
    return re.sub(r"^--([a-z]+): ", r"\1: ", text)


def made(kind: str, text: str, findings: str) -> StochcError:
    """The exception for a failure of the native part."""
    text = _in_python(text.removeprefix("error: ").rstrip())
    if kind == "program":
        from ._findings import finding

        found: list[dict[str, Any]] = json.loads(findings)
        return ProgramError(text, tuple(finding(it) for it in found))
    if kind == "defect":
        return InternalError(
            f"a defect of stochc: {text}; please report it with what you have called"
        )
    return _KINDS[kind](text)


def warn(kind: str, text: str) -> None:
    """Warns of what the native part has told, in the name of the first caller outside of this package."""
    category = FindingWarning if kind == "findings" else StochcWarning
    text = text.removeprefix("warning: ")
    level = 1
    frame: FrameType | None = sys._getframe()  # pyright: ignore[reportPrivateUsage]
    while frame is not None and frame.f_globals.get("__name__", "").split(".")[0] == "stochc":
        level, frame = level + 1, frame.f_back
    warnings.warn(text, category, stacklevel=level)
