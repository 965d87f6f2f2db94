"""Tests verdicts about claims."""

import pytest

import stochc

PAIR = """assembly pair {{
    seed plate 3 x 3 {{ M at (1, 1) }}
    {claims}
    phase grow {{ M.up -> A }}
}}
"""


def verdicts(claims: str, **options: object) -> stochc.Verdicts:
    program = stochc.compile(PAIR.format(claims=claims))
    return stochc.test(program, progress=False, **options)  # type: ignore[arg-type]


def test_claims_have_verdicts() -> None:
    right = "expect complete within 100000 ticks with probability >= 0.5"
    wrong = "expect mean completion <= 2 ticks"
    found = verdicts(f"{right}\n    {wrong}", model="rate", seed=3)
    assert [claim["verdict"] for claim in found.claims] == ["holds", "fails"]
    assert not found.hold
    assert "FAILS" in str(found)
    assert "<table" in found._repr_html_()
    assert verdicts(right).hold


def test_wrong_arguments_are_reported() -> None:
    with pytest.raises(stochc.UsageError, match="no claims"):
        verdicts("")
    claim = "expect complete within 100000 ticks with probability >= 0.5"
    for options in ({"alpha": 0.6}, {"model": "rates"}, {"runs": 0}):
        with pytest.raises(stochc.UsageError):
            verdicts(claim, **options)
