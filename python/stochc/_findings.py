"""What is wrong or doubtful in a program."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Position:
    """A place in a text."""

    offset: int
    """In bytes of UTF-8, from 0."""
    line: int
    """From 1."""
    column: int
    """In characters, from 1."""


@dataclass(frozen=True)
class Span:
    """A piece of a file, and its part in a finding."""

    file: str
    start: Position
    end: Position
    """Behind the last character."""
    text: str
    """What is there; of an edit, what takes its place."""


@dataclass(frozen=True)
class Fix:
    """A change of the text that mends a finding."""

    title: str
    safe: bool
    """Whether the program surely means the same afterwards, or was right in one way only."""
    edits: tuple[Span, ...]
    """Each text takes the place of its span; they do not overlap."""


@dataclass(frozen=True)
class Finding:
    """Something wrong or doubtful."""

    code: str
    """Its kind, which `stochc.explain` takes."""
    severity: str
    """`"error"` or `"warning"`."""
    title: str
    """In one line."""
    count: int
    """How many times one statement has been found wrong in this way, as in a loop."""
    help: str | None
    """What to do."""
    spans: tuple[Span, ...]
    """The places it speaks of, the one to look at first at the front."""
    fix: Fix | None

    def __str__(self) -> str:
        place = ""
        if self.spans:
            first = self.spans[0]
            place = f"{first.file}:{first.start.line}:{first.start.column}: "
        return f"{place}{self.severity}[{self.code}]: {self.title}"


@dataclass(frozen=True)
class Proof:
    """Properties of a program in every order of its captures and releases."""

    completes: bool
    """Whether every order completes, if no timeout ends the run."""
    no_cell_blocked: bool
    """Whether every captured cell stays accessible until its block is captured."""
    no_cell_used_twice: bool
    """Whether no two blocks share a cell."""
    shapes: list[str]
    """The shapes that phases claim and build, in program order."""
    has_timeout: bool
    """Whether a phase has a timeout."""
    unproved: list[str]
    """The reasons why one of the above has not been proved."""


def _span(value: dict[str, Any]) -> Span:
    start, end = Position(**value["start"]), Position(**value["end"])
    return Span(value["file"], start, end, value["text"])


def finding(value: dict[str, Any]) -> Finding:
    """A finding from its JSON."""
    fix = value["fix"]
    return Finding(
        code=value["code"],
        severity=value["severity"],
        title=value["title"],
        count=value["count"],
        help=value["help"],
        spans=tuple(_span(it) for it in value["labels"]),
        fix=fix and Fix(fix["title"], fix["safe"], tuple(_span(it) for it in fix["edits"])),
    )
