"""Runs each code block of docs/guides/python.md."""

from __future__ import annotations

import re
from typing import Any

import pytest
from conftest import ROOT


@pytest.mark.filterwarnings("ignore::stochc.StochcWarning")
def test_blocks_of_the_document_run() -> None:
    text = (ROOT / "docs" / "guides" / "python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    assert len(blocks) > 3
    known: dict[str, Any] = {}
    for number, block in enumerate(blocks):
        exec(compile(block, f"block {number + 1}", "exec"), known)
