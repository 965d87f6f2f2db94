"""Fixtures that tests share."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"


@pytest.fixture
def tower() -> str:
    """Returns the path of a program with phases, captures and releases, relative to the root."""
    return "examples/five_tower_reconfigured.sa"


@pytest.fixture(autouse=True)
def at_root(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs tests in a fixed folder, because manifests contain paths as the caller gives them."""
    monkeypatch.chdir(ROOT)


@pytest.fixture
def command() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Returns a function that runs the `stochc` command. The variable `STOCHC` contains its path."""
    program = os.environ.get("STOCHC", str(ROOT / "target" / "debug" / "stochc"))

    def run(*arguments: str | Path, status: int = 0) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            [program, *map(str, arguments)], capture_output=True, text=True, cwd=ROOT, check=False
        )
        assert done.returncode == status, done.stderr
        return done

    return run
