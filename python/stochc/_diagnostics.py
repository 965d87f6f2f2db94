"""Diagnostics of a program."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Position:
    """Position in a source."""

    offset: int
    """Offset in bytes of UTF-8, from 0."""
    line: int
    """Line from 1."""
    column: int
    """Column in characters, from 1."""


@dataclass(frozen=True)
class Span:
    """Range of a file, as part of a diagnostic or edit."""

    file: str
    start: Position
    end: Position
    """Position after the last character."""
    text: str
    """Label of the range; for an edit, the new text."""


@dataclass(frozen=True)
class Fix:
    """Edits that fix a diagnostic."""

    title: str
    safe: bool
    """Whether the meaning certainly stays the same, or only one fix is possible."""
    edits: tuple[Span, ...]
    """Edits, which do not overlap. Each text replaces its range."""


@dataclass(frozen=True)
class Diagnostic:
    """Diagnostic: an error or a warning."""

    code: str
    """Code, for `stochc.explain`."""
    severity: str
    """`"error"` or `"warning"`."""
    title: str
    """Title in one line."""
    count: int
    """Number of occurrences of the same diagnostic at one statement, for example in a loop."""
    help: str | None
    """Help."""
    spans: tuple[Span, ...]
    """Labelled ranges, the primary one first."""
    fix: Fix | None

    def __str__(self) -> str:
        place = ""
        if self.spans:
            first = self.spans[0]
            place = f"{first.file}:{first.start.line}:{first.start.column}: "
        return f"{place}{self.severity}[{self.code}]: {self.title}"


@dataclass(frozen=True)
class Proof:
    """Proved properties of a program in every order of its captures and releases."""

    completes: bool
    """Whether every order completes, if no timeout ends the run."""
    no_cell_blocked: bool
    """Whether every captured cell stays accessible until its block is captured."""
    no_cell_used_twice: bool
    """Whether no two blocks share a cell."""
    shapes: list[str]
    """Shapes that phases claim and build, in program order."""
    has_timeout: bool
    """Whether a phase has a timeout."""
    unproved: list[str]
    """Reasons why one of the above has not been proved."""


def _span(value: dict[str, Any]) -> Span:
    start, end = Position(**value["start"]), Position(**value["end"])
    return Span(value["file"], start, end, value["text"])


def diagnostic(value: dict[str, Any]) -> Diagnostic:
    """Returns a diagnostic from its JSON."""
    fix = value["fix"]
    return Diagnostic(
        code=value["code"],
        severity=value["severity"],
        title=value["title"],
        count=value["count"],
        help=value["help"],
        spans=tuple(_span(it) for it in value["labels"]),
        fix=fix and Fix(fix["title"], fix["safe"], tuple(_span(it) for it in fix["edits"])),
    )
