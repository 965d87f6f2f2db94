"""Validation of Python arguments."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TypeAlias

from ._errors import UsageError

Path: TypeAlias = str | os.PathLike[str]
"""Path of a file or a folder, as an argument."""

MOST_RUNS = 10_000_000
MOST_TICKS = 2**64 - 1
MOST_SEED = 2**64 - 1


def whole(name: str, value: object, least: int, most: int) -> int:
    """Checks that a value is an integer within bounds, and returns it."""
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
    """Returns a value of any type as text for a message."""
    try:
        text = repr(value)
    except Exception:
        return f"this {type(value).__name__}, which cannot be shown"
    return text if len(text) <= 80 else f"{text[:80]}..."


def maybe(name: str, value: object, least: int, most: int) -> int | None:
    """Checks that a value is an integer within bounds or `None`, and returns it."""
    return None if value is None else whole(name, value, least, most)


def threads(value: object) -> int | None:
    """Checks the argument `threads`, and returns it."""
    return maybe("threads", value, 1, 1024)


def yes(name: str, value: object) -> bool:
    """Checks that a value is a bool, and returns it."""
    if not isinstance(value, bool):
        raise TypeError(f"{name}: give True or False, not {told(value)}")
    return value


def word(name: str, value: object) -> str:
    """Checks that a value is a string, and returns it."""
    if not isinstance(value, str):
        raise TypeError(f"{name}: give a text, not {told(value)}")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise UsageError(f"{name}: {told(value)} is not valid Unicode") from None
    return value


def path(name: str, value: object) -> str:
    """Checks that a value is a path, and returns it as a string."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name}: give a path, not {told(value)}")
    text = word(name, os.fspath(value))  # pyright: ignore[reportUnknownArgumentType, reportUnknownVariableType]
    if not text:
        raise UsageError(f"{name}: the path is empty")
    if "\0" in text:
        raise UsageError(f"{name}: {told(text)} contains a NUL character")
    return text


def maybe_path(name: str, value: object) -> str | None:
    """Checks that a value is a path or `None`, and returns the path as a string."""
    return None if value is None else path(name, value)


def paths(name: str, values: Path | Iterable[Path]) -> list[str]:
    """Checks that a value is a path or several, and returns a list of strings."""
    if isinstance(values, (str, os.PathLike)):
        return [path(name, values)]
    return [path(name, value) for value in _listed(name, values)]


def words(name: str, values: str | Iterable[str]) -> list[str]:
    """Checks that a value is a string or several, and returns a list."""
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
    """Returns the levels of warnings. `deny` has precedence over `warn`, and `warn` over `allow`."""
    levels = [("allow", allow), ("warn", warn), ("deny", deny)]
    return [(code, level) for level, codes in levels for code in words(level, codes)]


def substeps(value: int | str) -> str:
    """Returns the steps per tick as text. The value may be `4` or `"1/8"`."""
    if isinstance(value, str):
        return word("substeps", value)
    return str(whole("substeps", value, 1, 2**32 - 1))


def selection(value: None | int | str | Iterable[int]) -> str | None:
    """Returns a selection of runs as text. The value may be `17`, `"0..4"`, `"all"`, or several numbers."""
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
    """Returns the axes of a sweep in the syntax of the command line, such as `free=50..600/6`."""
    if not isinstance(values, Mapping):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"vary: give a dictionary of names and values, not {told(values)}")
    for name in values:
        if "=" in word("vary", name):
            raise UsageError(f"vary: there is no parameter {told(name)}")
    return [f"{name}={_values(name, given)}" for name, given in values.items()]


def _values(name: str, given: object) -> str:
    if isinstance(given, str):
        return word("vary", given)
    listed = [given] if isinstance(given, (int, float)) else _listed("vary", given)
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
        raise UsageError(f"vary: {name}: give at least one value")
    return ",".join(texts)
