"""Programs: diagnostics and compilation."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import Any, TypeAlias

from . import _arguments, _html, _native
from ._diagnostics import Diagnostic, Proof, diagnostic
from ._errors import ProgramError, UsageError

Source: TypeAlias = str | os.PathLike[str]
"""Source text of a program, or the path of its file. A string with a `{` or several lines is a source text."""

_TEXT = "text.sa"
"""File name of a source text in diagnostics."""


def _source(source: Source) -> tuple[str, str | None]:
    """Returns the path of a file, or a source text and its name."""
    if isinstance(source, str):
        text = _arguments.word("source", source)
        if "{" in text or "\n" in text.strip("\n"):
            return text, _TEXT
    return _arguments.path("source", source), None


class Checked:
    """Result of checking a program. Printing it shows the output of `stochc check`.

    >>> import stochc
    >>> checked = stochc.check("assembly pair { }")
    >>> checked.ok
    False
    >>> print(checked.diagnostics[0])
    text.sa:1:10: error[missing-plate]: assembly `pair` has no seed plate
    """

    __slots__ = ("_drawn", "diagnostics", "ok", "programs", "proofs")

    diagnostics: tuple[Diagnostic, ...]
    """Diagnostics in source order."""
    ok: bool
    """Whether there are no errors."""
    programs: tuple[Program, ...]
    """Assemblies and aggregates of the source. Empty if there are errors."""
    proofs: dict[str, Proof]
    """Proof of each assembly, by name. Empty if there are errors."""

    def __init__(self, found: tuple[str, str, bool, list[_native.Program]]) -> None:
        text, self._drawn, is_wrong, programs = found
        document = json.loads(text)
        self.diagnostics = tuple(diagnostic(it) for it in document["diagnostics"])
        proved = ((it["name"], it["proved"]) for it in document["programs"])
        self.proofs = {name: Proof(**proof) for name, proof in proved if proof}
        self.ok = not is_wrong
        self.programs = tuple(Program(it) for it in programs)

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """Diagnostics that are errors."""
        return tuple(it for it in self.diagnostics if it.severity == "error")

    @property
    def warnings(self) -> tuple[Diagnostic, ...]:
        """Diagnostics that are warnings."""
        return tuple(it for it in self.diagnostics if it.severity != "error")

    def raise_if_wrong(self) -> None:
        """Raises a `ProgramError` if there are errors."""
        if not self.ok:
            raise ProgramError(self._drawn.rstrip(), self.diagnostics)

    def __str__(self) -> str:
        return self._drawn.rstrip() or "no assembly or aggregate"

    def __repr__(self) -> str:
        verdict = "ok" if self.ok else "wrong"
        return f"<stochc.Checked {verdict}: {len(self.diagnostics)} diagnostics>"


class Program:
    """Compiled program, returned by `stochc.compile`.

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
        """Name of the program in tables: its assembly or aggregate, and the values of a sweep."""
        return self._native.name

    @property
    def assembly(self) -> str:
        """Name of the program's assembly or aggregate."""
        return self._native.assembly

    @property
    def phases(self) -> tuple[str, ...]:
        """Names of the program's phases in order. Pre-attached blocks form the first phase."""
        return tuple(self._native.phases)

    @property
    def captures(self) -> int:
        """Number of captures. For an aggregate, number of blocks. Papers call it "total units involved"."""
        return self._native.captures

    @property
    def tick(self) -> float:
        """Length of a tick in the program's scene [s]."""
        return self._native.tick

    @property
    def scene(self) -> dict[str, Any]:
        """Scene of the program in the form that a manifest uses, in SI units."""
        scene: dict[str, Any] = json.loads(self._native.scene_json())
        return scene

    @property
    def digest(self) -> str:
        """SHA-256 of the program's source, all imports, and its scene."""
        return self._native.digest

    @property
    def sources(self) -> dict[str, str]:
        """Sources of the program by path, its own first. Empty if it was read as a compiled program."""
        return dict(self._native.sources)

    def structure(self) -> str:
        """Returns the structure at the end of each phase as text. The text is empty without the source."""
        return self._native.structure_text() or ""

    def svg(self) -> str | None:
        """Returns the structure as a drawing (SVG)."""
        return self._native.structure_svg()

    def graph(self) -> str:
        """Returns the dependency graph as text."""
        return self._native.graph_text()

    def table(self) -> str:
        """Returns the event tables of all blocks as text."""
        return self._native.table_text()

    def executable(self) -> bytes:
        """Returns the program as the content of an executable file, which `stochc` and `stochc.compile` read."""
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
        # Its text is dark and needs a light background, in dark notebooks as well.
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
    parameters: str | Iterable[str] = (),
) -> Checked:
    """Checks a program and proves its properties.

    Args:
        source: source text, or the path of a file.
        allow: codes of warnings to suppress; `"warnings"` for all of them.
        warn: codes of warnings to report, which is the default.
        deny: codes of warnings to report as errors.
        allow_import: additional folders that the program may import from.
        parameters: values of parameters of programs or scenes, such as `"height=8"`.

    >>> import stochc
    >>> stochc.check(stochc.EXAMPLE).ok
    True
    """
    text, name = _source(source)
    levels = _arguments.levels(allow, warn, deny)
    imports = _arguments.paths("allow_import", allow_import)
    return Checked(_native.check(text, name, levels, imports, _arguments.words("parameters", parameters)))


def compile_all(
    source: Source,
    *,
    allow: str | Iterable[str] = (),
    warn: str | Iterable[str] = (),
    deny: str | Iterable[str] = (),
    allow_import: Source | Iterable[Source] = (),
    parameters: str | Iterable[str] = (),
) -> list[Program]:
    """Compiles all programs of a source or a file. The arguments are those of `check`.

    Raises:
        ProgramError: a program has errors.
        UsageError: the file cannot be read, or contains no program.
    """
    text, name = _source(source)
    levels = _arguments.levels(allow, warn, deny)
    imports = _arguments.paths("allow_import", allow_import)
    values = _arguments.words("parameters", parameters)
    return [Program(it) for it in _native.load(text, name, levels, imports, values)]


def compile(
    source: Source,
    assembly: str | None = None,
    *,
    allow: str | Iterable[str] = (),
    warn: str | Iterable[str] = (),
    deny: str | Iterable[str] = (),
    allow_import: Source | Iterable[Source] = (),
    parameters: str | Iterable[str] = (),
) -> Program:
    """Compiles the program of a source or a file. `assembly` selects one of several.

    Other arguments and exceptions are those of `compile_all`.

    >>> import stochc
    >>> stochc.compile(stochc.EXAMPLE)
    <stochc.Program pair: 1 captures, scene hemisphere>
    """
    found = compile_all(
        source, allow=allow, warn=warn, deny=deny, allow_import=allow_import, parameters=parameters
    )
    return chosen(found, assembly)


def chosen(found: list[Program], assembly: str | None) -> Program:
    """Returns the program of an assembly. Without a name, returns the only one."""
    wanted = found
    if assembly is not None:
        assembly = _arguments.word("assembly", assembly)
        wanted = [it for it in found if it.assembly == assembly]
    if len(wanted) == 1:
        return wanted[0]
    names = ", ".join(f"`{it.assembly}`" for it in found)
    if assembly is None:
        raise UsageError(f"assembly: name one of {names}, or use compile_all")
    raise UsageError(f"assembly: there is no `{assembly}`; choose from {names}")


def explain(code: str) -> str:
    """Returns the page that explains a diagnostic, as Markdown.

    >>> import stochc
    >>> stochc.explain("cycle").splitlines()[0]
    '# cycle: events wait for each other in a cycle'
    """
    return _native.explain(_arguments.word("code", code))
