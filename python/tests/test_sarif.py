"""Reports of the command in SARIF, held against the published schema."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any

import jsonschema
import pytest
from conftest import ROOT

SCHEMA = json.loads((ROOT / "python" / "tests" / "sarif" / "sarif-schema-2.1.0.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft7Validator(SCHEMA, format_checker=jsonschema.Draft7Validator.FORMAT_CHECKER)


def errors(document: Any) -> list[str]:
    return [f"{error.json_path}: {error.message}" for error in VALIDATOR.iter_errors(document)]


@pytest.mark.parametrize(
    "run",
    [
        {},
        {"tool": {"driver": {"name": "a"}}, "results": [{"message": {"text": "m"}, "level": "bad"}]},
        {
            "tool": {"driver": {"name": "a"}},
            "results": [
                {"message": {"text": "m"}, "locations": [{"physicalLocation": {"artifactLocation": {"uri": "a b"}}}]}
            ],
        },
    ],
)
def test_the_schema_refuses_what_is_none(run: dict[str, Any]) -> None:
    assert errors({"version": "2.1.0", "runs": [run]})


def test_every_report_follows_the_schema(
    tmp_path: Path, command: Callable[..., CompletedProcess[str]]
) -> None:
    """The programs that pages show as wrong, and those of the tests, in one report and in one each."""
    programs = sorted((ROOT / "tests" / "findings").glob("*.sa"))
    for page in sorted((ROOT / "compiler" / "src" / "diagnostic" / "pages").glob("*.md")):
        _, marker, rest = page.read_text(encoding="utf-8").partition("Wrong:\n\n```sa\n")
        if marker:
            program = tmp_path / f"{page.stem}.sa"
            program.write_text(rest.partition("```")[0], encoding="utf-8")
            programs.append(program)
    named = tmp_path / "zwei türme.sa"
    named.write_text("assembly a { /* µ */ seed plate 1 x 1 { } }", encoding="utf-8")
    programs.append(named)
    assert len(programs) > 40

    report = json.loads(command("check", *programs, "--format", "sarif", status=1).stdout)
    assert errors(report) == []
    (run,) = report["runs"]
    assert len(run["results"]) > 40
    uris = [result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] for result in run["results"]]
    assert any(uri.endswith("zwei%20t%C3%BCrme.sa") for uri in uris)
