"""Arguments, looked at before anything is done with them."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TypeAlias

from ._errors import UsageError

Path: TypeAlias = str | os.PathLike[str]
"""A file or a folder."""

MOST_RUNS = 10_000_000
MOST_TICKS = 2**64 - 1
MOST_SEED = 2**64 - 1


def whole(name: str, value: object, least: int, most: int) -> int:
    """A whole number within bounds."""
    if isinstance(value, bool):
        raise TypeError(f"{name}: give a whole number, not {told(value)}")
    try:
        number = operator.index(value)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    except TypeError:
        raise TypeError(f"{name}: give a whole number, not {told(value)}") from None
    if not least <= number <= most:
        raise UsageError(f"{name}: give a whole number from {least} to {most}, not {told(number)}")
    return number


def told(value: object) -> str:
    """A value as a message tells of it, whatever it is."""
    try:
        text = repr(value)
    except Exception:
        return f"this {type(value).__name__}, which cannot be shown"
    return text if len(text) <= 80 else f"{text[:80]}..."


def maybe(name: str, value: object, least: int, most: int) -> int | None:
    """The same, or nothing."""
    return None if value is None else whole(name, value, least, most)


def threads(value: object) -> int | None:
    """Runs at the same time."""
    return maybe("threads", value, 1, 1024)


def yes(name: str, value: object) -> bool:
    """Yes or no."""
    if not isinstance(value, bool):
        raise TypeError(f"{name}: give True or False, not {told(value)}")
    return value


def word(name: str, value: object) -> str:
    """A text."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: give a text, not {told(value)}")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise UsageError(f"{name}: {told(value)} is no Unicode") from None
    return value


def path(name: str, value: object) -> str:
    """A path as a text."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name}: give a path, not {told(value)}")
    text = word(name, os.fspath(value))  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
    if not text:
        raise UsageError(f"{name}: an empty path leads nowhere")
    if "\0" in text:
        raise UsageError(f"{name}: no path holds a NUL, as {told(text)} does")
    return text


def maybe_path(name: str, value: object) -> str | None:
    """The same, or nothing."""
    return None if value is None else path(name, value)


def paths(name: str, values: Path | Iterable[Path]) -> list[str]:
    """One or more paths."""
    if isinstance(values, (str, os.PathLike)):
        return [path(name, values)]
    return [path(name, value) for value in _listed(name, values)]


def words(name: str, values: str | Iterable[str]) -> list[str]:
    """One or more texts."""
    if isinstance(values, str):
        return [word(name, values)]
    return [word(name, value) for value in _listed(name, values)]


def _listed(name: str, values: object) -> list[object]:
    if isinstance(values, (bytes, bytearray)) or not isinstance(values, Iterable):
        raise TypeError(f"{name}: give one or a list of them, not {told(values)}")
    return list(values)  # pyright: ignore[reportUnknownVariableType, reportUnknownArgumentType]


def levels(
    allow: str | Iterable[str], warn: str | Iterable[str], deny: str | Iterable[str]
) -> list[tuple[str, str]]:
    """What becomes of warnings; `deny` has the last word, and then `warn`."""
    said = [("allow", allow), ("warn", warn), ("deny", deny)]
    return [(code, level) for level, codes in said for code in words(level, codes)]


def substeps(value: int | str) -> str:
    """Steps a tick: `4`, or `"1/8"`."""
    if isinstance(value, str):
        return word("substeps", value)
    return str(whole("substeps", value, 1, 2**32 - 1))


def selection(value: None | int | str | Iterable[int]) -> str | None:
    """Runs: `17`, `"0..4"`, `"all"`, or several numbers."""
    if value is None:
        return None
    if isinstance(value, str):
        return word("record", value)
    if isinstance(value, Iterable):
        numbers = [str(whole("record", it, 0, MOST_RUNS)) for it in value]
        if not numbers:
            return None
        return ",".join(numbers)
    return str(whole("record", value, 0, MOST_RUNS))


def axes(values: Mapping[str, str | float | Sequence[float]]) -> list[str]:
    """What a sweep varies, as the command line says it: `free=50..600/6`."""
    if not isinstance(values, Mapping):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"vary: give a dictionary of names and values, not {told(values)}")
    for name in values:
        if "=" in word("vary", name):
            raise UsageError(f"vary: no number is called {told(name)}")
    return [f"{name}={_values(name, said)}" for name, said in values.items()]


def _values(name: str, said: object) -> str:
    if isinstance(said, str):
        return word("vary", said)
    listed = [said] if isinstance(said, (int, float)) else _listed("vary", said)
    texts: list[str] = []
    for value in listed:
        if isinstance(value, bool):
            raise TypeError(f"vary: {name}: give numbers, not {told(value)}")
        try:
            number = float(value)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
        except (TypeError, ValueError, OverflowError):
            raise TypeError(f"vary: {name}: give numbers, not {told(value)}") from None
        texts.append(str(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number))
    if not texts:
        raise UsageError(f"vary: {name}: give one value at least")
    return ",".join(texts)
