"""Executes a notebook, and writes it and its figures to a folder."""

from __future__ import annotations

import base64
import re
import sys
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient


def main(notebook: Path, folder: Path) -> None:
    book: Any = nbformat.read(notebook, as_version=4)  # type: ignore[no-untyped-call, unused-ignore]
    stored = [cell.get("outputs") for cell in book.cells if cell.cell_type == "code"]
    if any(stored):
        sys.exit(f"{notebook} contains outputs: clear them, they are made again")
    client = NotebookClient(book, timeout=600, kernel_name="python3", resources={"metadata": {"path": str(notebook.parent)}})
    client.execute()
    figures = folder / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    number = 0
    for cell in book.cells:
        for output in cell.get("outputs", []):
            html = output.get("data", {}).get("text/html", "")
            for found in re.findall(r'src="data:image/svg\+xml;base64,([^"]*)"', html):
                number += 1
                (figures / f"{number}.svg").write_bytes(base64.b64decode(found))
    nbformat.write(book, folder / notebook.name)  # type: ignore[no-untyped-call, unused-ignore]
    print(f"{notebook}: {len(stored)} cells, {number} figures in {figures}")
    if number < 3:
        sys.exit("it shows fewer figures than it should")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
