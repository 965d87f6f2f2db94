"""HTML for notebooks, in the notebook's light or dark colours."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from html import escape


def picture(svg: str, title: str) -> str:
    """Returns an SVG as an image, which isolates its styles from the notebook."""
    data = base64.b64encode(svg.encode()).decode()
    return f'<img alt="{escape(title)}" style="max-width:100%" src="data:image/svg+xml;base64,{data}"/>'


def text(lines: str) -> str:
    """Returns text as preformatted HTML."""
    return f"<pre>{escape(lines)}</pre>"


def table(header: Sequence[str], rows: Iterable[Sequence[object]], titles: Sequence[str] = ()) -> str:
    """Returns a table as HTML, with right-aligned numbers."""
    hints = list(titles) + [""] * (len(header) - len(titles))
    head = "".join(
        f'<th scope="col" title="{escape(hint)}">{escape(name)}</th>'
        for name, hint in zip(header, hints, strict=True)
    )
    body = "".join(f"<tr>{''.join(_cell(it) for it in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(value: object) -> str:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    text = "–" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
    align = "right" if is_number else "left"
    return f'<td style="text-align:{align}">{escape(text)}</td>'


def page(html: str, title: str, height: int = 640) -> str:
    """Returns a page as an embedded frame that cannot make network requests."""
    return (
        f'<iframe title="{escape(title)}" srcdoc="{escape(html)}" sandbox="allow-scripts" '
        f'style="width:100%;height:{height}px;border:0"></iframe>'
    )
