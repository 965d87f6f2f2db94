"""Diagnostics of a program, and the types of their parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Position:
    """Position in a source text."""

    offset: int
    """Offset from the start of the text, in bytes of UTF-8."""
    line: int
    """Line number, from 1."""
    column: int
    """Column number in characters, from 1."""


@dataclass(frozen=True)
class Span:
    """Range of a file that a diagnostic or an edit refers to."""

    file: str
    start: Position
    end: Position
    """Position after the last character."""
    text: str
    """Label of the range. For an edit, the new text."""


@dataclass(frozen=True)
class Fix:
    """Edits that fix a diagnostic."""

    title: str
    safe: bool
    """Whether the fix keeps the meaning of the program, or is the only possible one."""
    edits: tuple[Span, ...]
    """Edits that do not overlap. The text of each replaces its range."""


@dataclass(frozen=True)
class Diagnostic:
    """Error or warning about a program."""

    code: str
    """Code of the diagnostic, for `stochc.explain`."""
    severity: str
    """`"error"` or `"warning"`."""
    title: str
    """Title, one line of text."""
    count: int
    """Number of occurrences of the same diagnostic at one statement, for example in a loop."""
    help: str | None
    """Suggestion for the user. `None` if there is none."""
    spans: tuple[Span, ...]
    """Labelled ranges of the source, the primary one first."""
    fix: Fix | None

    def __str__(self) -> str:
        place = ""
        if self.spans:
            first = self.spans[0]
            place = f"{first.file}:{first.start.line}:{first.start.column}: "
        return f"{place}{self.severity}[{self.code}]: {self.title}"


@dataclass(frozen=True)
class Proof:
    """Properties of a program that are proved for every order of its captures and releases."""

    completes: bool
    """Whether every order completes, if no timeout, dead block or broken bond ends the run."""
    no_cell_blocked: bool
    """Whether every captured cell stays accessible until its block is captured."""
    no_cell_used_twice: bool
    """Whether no two blocks share a cell."""
    shapes: list[str]
    """Names of the shapes that phases claim and build, in program order."""
    has_timeout: bool
    """Whether a phase has a timeout."""
    has_dead_blocks: bool
    """Whether the scene has dead blocks."""
    has_breaking_bonds: bool
    """Whether bonds of the structure can break."""
    unproved: list[str]
    """Reasons why one of these properties is not proved."""


def _span(value: dict[str, Any]) -> Span:
    start, end = Position(**value["start"]), Position(**value["end"])
    return Span(value["file"], start, end, value["text"])


def diagnostic(value: dict[str, Any]) -> Diagnostic:
    """Returns the diagnostic that a JSON value describes."""
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
