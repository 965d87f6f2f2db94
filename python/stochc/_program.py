"""Programs: what is wrong with them, and what they compile to."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import Any, TypeAlias

from . import _arguments, _html, _native
from ._errors import ProgramError, UsageError
from ._findings import Finding, Proof, finding

Source: TypeAlias = str | os.PathLike[str]
"""The text of a program, or the path of its file: a text is what has a `{` or more than one line."""

_TEXT = "text.sa"
"""What findings call a text."""


def _source(source: Source) -> tuple[str, str | None]:
    """A path, or a text and its name."""
    if isinstance(source, str):
        text = _arguments.word("source", source)
        if "{" in text or "\n" in text.strip("\n"):
            return text, _TEXT
    return _arguments.path("source", source), None


class Checked:
    """What is known of a program that was checked; it prints as `stochc check` does.

    >>> import stochc
    >>> checked = stochc.check("assembly pair { }")
    >>> checked.ok
    False
    >>> print(checked.findings[0])
    text.sa:1:10: error[missing-plate]: the assembly has no seed plate
    """

    __slots__ = ("_drawn", "findings", "ok", "programs", "proofs")

    findings: tuple[Finding, ...]
    """What is wrong or doubtful, in the order of the text."""
    ok: bool
    """Whether there is no error."""
    programs: tuple[Program, ...]
    """Its assemblies and aggregates, if there is no error."""
    proofs: dict[str, Proof]
    """The proof of each assembly, by its name, if there is no error."""

    def __init__(self, found: tuple[str, str, bool, list[_native.Program]]) -> None:
        text, self._drawn, is_wrong, programs = found
        document = json.loads(text)
        self.findings = tuple(finding(it) for it in document["diagnostics"])
        proved = ((it["name"], it["proved"]) for it in document["programs"])
        self.proofs = {name: Proof(**proof) for name, proof in proved if proof}
        self.ok = not is_wrong
        self.programs = tuple(Program(it) for it in programs)

    @property
    def errors(self) -> tuple[Finding, ...]:
        """The findings that are errors."""
        return tuple(it for it in self.findings if it.severity == "error")

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """The findings that are none."""
        return tuple(it for it in self.findings if it.severity != "error")

    def raise_if_wrong(self) -> None:
        """Raises a `ProgramError` if there are errors."""
        if not self.ok:
            raise ProgramError(self._drawn.rstrip(), self.findings)

    def __str__(self) -> str:
        return self._drawn.rstrip() or "no assembly or aggregate"

    def __repr__(self) -> str:
        verdict = "ok" if self.ok else "wrong"
        return f"<stochc.Checked {verdict}: {len(self.findings)} findings>"


class Program:
    """A program that is ready to run: what `stochc.compile` gives.

    >>> import stochc
    >>> program = stochc.compile(stochc.EXAMPLE)
    >>> program.name, program.captures, program.phases
    ('pair', 1, ('grow',))
    """

    __slots__ = ("_native",)

    def __init__(self, native: _native.Program) -> None:
        self._native = native

    @property
    def name(self) -> str:
        """What tables call it: its assembly or aggregate, and the values of a sweep."""
        return self._native.name

    @property
    def assembly(self) -> str:
        """The name of its assembly or aggregate."""
        return self._native.assembly

    @property
    def phases(self) -> tuple[str, ...]:
        """The names of its phases, in their order; blocks attached by hand are the first one."""
        return tuple(self._native.phases)

    @property
    def captures(self) -> int:
        """Captures that it makes, or blocks of an aggregate: the paper's "total units involved"."""
        return self._native.captures

    @property
    def tick(self) -> float:
        """The length of a tick of its scene [s]."""
        return self._native.tick

    @property
    def scene(self) -> dict[str, Any]:
        """Its scene as a manifest has it: all numbers in SI units."""
        scene: dict[str, Any] = json.loads(self._native.scene_json())
        return scene

    @property
    def digest(self) -> str:
        """SHA-256 of its text, all that it imports, and its scene."""
        return self._native.digest

    @property
    def sources(self) -> dict[str, str]:
        """The texts of its files by their paths, its own first; empty: it was compiled elsewhere."""
        return dict(self._native.sources)

    def structure(self) -> str:
        """The blocks that stand at the end of each phase, in words; empty: its text is not known."""
        return self._native.structure_text() or ""

    def svg(self) -> str | None:
        """The same as a picture (SVG)."""
        return self._native.structure_svg()

    def graph(self) -> str:
        """Its dependency graph: which event waits for which."""
        return self._native.graph_text()

    def table(self) -> str:
        """The event table of each block."""
        return self._native.table_text()

    def executable(self) -> bytes:
        """It as a file of compiled programs, which `stochc` and `stochc.compile` take without its text."""
        return self._native.executable()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Program):
            return NotImplemented
        return (self.name, self.digest) == (other.name, other.digest)

    def __hash__(self) -> int:
        return hash((self.name, self.digest))

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return (_restored, (self._native.to_json(),))

    def __repr__(self) -> str:
        return f"<stochc.Program {self.name}: {self.captures} captures, scene {self._native.scene}>"

    def _repr_html_(self) -> str:
        svg = self._repr_svg_()
        phases = ", ".join(self.phases)
        about = _html.table(
            ["program", "captures", "phases", "scene"],
            [[self.name, self.captures, phases, self._native.scene]],
        )
        return about + (_html.picture(svg, f"structure of {self.name}") if svg else "")

    def _repr_svg_(self) -> str | None:
        svg = self.svg()
        # Its letters are dark: they stand on paper, in a dark notebook too.
        return svg and svg.replace("<svg ", '<svg style="background:#fff" ', 1)


def _restored(text: str) -> Program:
    return Program(_native.Program.from_json(text))


def check(
    source: Source,
    *,
    allow: str | Iterable[str] = (),
    warn: str | Iterable[str] = (),
    deny: str | Iterable[str] = (),
    allow_import: Source | Iterable[Source] = (),
) -> Checked:
    """Looks for everything that is wrong or doubtful in a program, and proves what can be proved of it.

    Args:
        source: a text, or the path of a file.
        allow: codes of warnings that are not told; `"warnings"` are all of them.
        warn: codes of warnings that are told, as is the default.
        deny: codes of warnings that are errors.
        allow_import: folders from which the program may import besides its own.

    >>> import stochc
    >>> stochc.check(stochc.EXAMPLE).ok
    True
    """
    text, name = _source(source)
    levels = _arguments.levels(allow, warn, deny)
    return Checked(_native.check(text, name, levels, _arguments.paths("allow_import", allow_import)))


def compile_all(
    source: Source,
    *,
    allow: str | Iterable[str] = (),
    warn: str | Iterable[str] = (),
    deny: str | Iterable[str] = (),
    allow_import: Source | Iterable[Source] = (),
) -> list[Program]:
    """All programs of a text or a file; the arguments are those of `check`.

    Raises:
        ProgramError: it has errors.
        UsageError: it cannot be read, or has nothing to run.
    """
    text, name = _source(source)
    levels = _arguments.levels(allow, warn, deny)
    imports = _arguments.paths("allow_import", allow_import)
    return [Program(it) for it in _native.load(text, name, levels, imports)]


def compile(
    source: Source,
    assembly: str | None = None,
    *,
    allow: str | Iterable[str] = (),
    warn: str | Iterable[str] = (),
    deny: str | Iterable[str] = (),
    allow_import: Source | Iterable[Source] = (),
) -> Program:
    """The program of a text or a file; `assembly` says which one, if it has several.

    The other arguments and what is raised are those of `compile_all`.

    >>> import stochc
    >>> stochc.compile(stochc.EXAMPLE)
    <stochc.Program pair: 1 captures, scene hemisphere>
    """
    return chosen(compile_all(source, allow=allow, warn=warn, deny=deny, allow_import=allow_import), assembly)


def chosen(found: list[Program], assembly: str | None) -> Program:
    """The program of an assembly; without a name, the only one."""
    wanted = found
    if assembly is not None:
        assembly = _arguments.word("assembly", assembly)
        wanted = [it for it in found if it.assembly == assembly]
    if len(wanted) == 1:
        return wanted[0]
    names = ", ".join(f"`{it.assembly}`" for it in found)
    if assembly is None:
        raise UsageError(f"assembly: name one of {names}, or use compile_all")
    raise UsageError(f"assembly: there is no `{assembly}`, but {names}")


def explain(code: str) -> str:
    """The page that explains a kind of finding, by its code.

    >>> import stochc
    >>> stochc.explain("cycle").splitlines()[0]
    '# cycle: events that wait for each other in a cycle'
    """
    return _native.explain(_arguments.word("code", code))
