"""Progress bars for terminals and Jupyter."""

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
"""Function that receives the completed fraction, from 0 to 1, and a line of text. It runs in the calling thread."""

Progress: TypeAlias = bool | None | Show
"""Whether to show progress, or a function that receives it. `None` shows it in a terminal and in Jupyter."""


@contextmanager
def shown(progress: Progress) -> Generator[Show | None, None, None]:
    """Yields the function that shows progress. Yields `None` if progress is not shown."""
    if progress is not None and not isinstance(progress, bool):
        if not callable(progress):
            raise TypeError(f"progress: give True, False or a function, not {told(progress)}")
        yield progress
        return
    if progress is None:
        progress = _in_jupyter() or _is_terminal()
    # Programs without a terminal may have no stderr.
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
    """Progress line that is overwritten in place."""

    def __init__(self) -> None:
        self._length = 0

    def show(self, share: float, text: str) -> None:
        """Overwrites the line."""
        line = f"{share:4.0%} {text}"[:100]
        sys.stderr.write("\r" + line.ljust(self._length))
        sys.stderr.flush()
        self._length = len(line)

    def close(self) -> None:
        """Ends the line."""
        if self._length:
            sys.stderr.write("\n")


class _Widget:
    """HTML progress bar in a notebook, updated in place."""

    def __init__(self, show: Any, html: Any) -> None:
        self._html = html
        self._handle = show(html(""), display_id=True)

    def show(self, share: float, text: str) -> None:
        """Redraws the bar."""
        bar = f'<progress max="1" value="{share:.3f}" style="vertical-align:middle"></progress>'
        self._handle.update(self._html(f"{bar} {escape(text)}"))

    def close(self) -> None:
        """Leaves the bar in its last state."""


def _widget() -> _Widget | None:
    """Returns a progress bar for a notebook, unless tqdm provides one."""
    if not _in_jupyter() or find_spec("tqdm") and find_spec("ipywidgets"):
        return None
    shown_by: Any = import_module("IPython.display")
    return _Widget(shown_by.display, shown_by.HTML)


class _Bar:
    """Progress bar of tqdm."""

    def __init__(self, bar: Any) -> None:
        self._bar = bar

    def show(self, share: float, text: str) -> None:
        """Redraws the bar."""
        self._bar.n = round(1000 * share)
        self._bar.set_description_str(text, refresh=False)
        self._bar.refresh()

    def close(self) -> None:
        """Leaves the bar in its last state."""
        self._bar.close()


def _tqdm() -> _Bar | None:
    """Returns a progress bar of tqdm. Returns `None` if tqdm is not installed."""
    import warnings

    try:
        with warnings.catch_warnings():
            # tqdm warns if there are no widgets.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm  # type: ignore[import-untyped, unused-ignore]  # pyright: ignore
    except ImportError:
        return None
    try:
        return _Bar(tqdm(total=1000, bar_format="{bar:24} {desc}"))  # pyright: ignore
    except ImportError:
        return None
