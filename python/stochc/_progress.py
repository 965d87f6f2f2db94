"""How far work is: a bar in a terminal and in Jupyter."""

from __future__ import annotations

import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from html import escape
from importlib import import_module
from importlib.util import find_spec
from typing import Any, TypeAlias

from ._arguments import told

Show: TypeAlias = Callable[[float, str], object]
"""Is told the share that is done, 0 to 1, and a line on it, in the thread that has called."""

Progress: TypeAlias = bool | None | Show
"""Whether and how to show progress; `None`: in a terminal and in Jupyter."""


@contextmanager
def shown(progress: Progress) -> Generator[Show | None, None, None]:
    """What is told of progress while work is done; `None`: nothing is."""
    if progress is not None and not isinstance(progress, bool):
        if not callable(progress):
            raise TypeError(f"progress: give True, False or a function, not {told(progress)}")
        yield progress
        return
    if progress is None:
        progress = _in_jupyter() or _is_terminal()
    # Programs without a window or a terminal may have no stream for it.
    if not progress or sys.stderr is None or sys.stderr.closed:
        yield None
        return
    bar = _widget() or _tqdm() or _Line()
    try:
        yield bar.show
    finally:
        bar.close()


def _is_terminal() -> bool:
    stream = sys.stderr
    return stream is not None and not stream.closed and stream.isatty()


def _in_jupyter() -> bool:
    shell: Any = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return type(shell).__name__ == "ZMQInteractiveShell"


class _Line:
    """One line that is written again and again."""

    def __init__(self) -> None:
        self._length = 0

    def show(self, share: float, text: str) -> None:
        """Writes it anew."""
        line = f"{share:4.0%} {text}"[:100]
        sys.stderr.write("\r" + line.ljust(self._length))
        sys.stderr.flush()
        self._length = len(line)

    def close(self) -> None:
        """Ends it."""
        if self._length:
            sys.stderr.write("\n")


class _Widget:
    """A bar of HTML in a notebook, which is drawn in its place."""

    def __init__(self, show: Any, html: Any) -> None:
        self._html = html
        self._handle = show(html(""), display_id=True)

    def show(self, share: float, text: str) -> None:
        """Draws it anew."""
        bar = f'<progress max="1" value="{share:.3f}" style="vertical-align:middle"></progress>'
        self._handle.update(self._html(f"{bar} {escape(text)}"))

    def close(self) -> None:
        """Leaves it as it is."""


def _widget() -> _Widget | None:
    """A bar in a notebook, unless tqdm has one that is as good."""
    if not _in_jupyter() or find_spec("tqdm") and find_spec("ipywidgets"):
        return None
    shown_by: Any = import_module("IPython.display")
    return _Widget(shown_by.display, shown_by.HTML)


class _Bar:
    """A bar of tqdm."""

    def __init__(self, bar: Any) -> None:
        self._bar = bar

    def show(self, share: float, text: str) -> None:
        """Draws it anew."""
        self._bar.n = round(1000 * share)
        self._bar.set_description_str(text, refresh=False)
        self._bar.refresh()

    def close(self) -> None:
        """Leaves it as it is."""
        self._bar.close()


def _tqdm() -> _Bar | None:
    """A bar of tqdm, if that is installed."""
    import warnings

    try:
        with warnings.catch_warnings():
            # It asks for widgets where there are none.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm  # type: ignore[import-untyped, unused-ignore]  # pyright: ignore
    except ImportError:
        return None
    try:
        return _Bar(tqdm(total=1000, bar_format="{bar:24} {desc}"))  # pyright: ignore
    except ImportError:
        return None
