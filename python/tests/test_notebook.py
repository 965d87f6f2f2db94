"""Tests the output of notebooks."""

from __future__ import annotations

import base64
import re
from html import escape
from pathlib import Path
from xml.etree import ElementTree

import pytest

import stochc


def pictures(html: str) -> list[str]:
    found = re.findall(r'src="data:image/svg\+xml;base64,([^"]*)"', html)
    return [base64.b64decode(it).decode() for it in found]


def test_a_program_shows_its_structure(tower: str) -> None:
    program = stochc.compile(tower)
    svg = program._repr_svg_()  # pyright: ignore[reportPrivateUsage]
    assert svg is not None
    ElementTree.fromstring(svg)
    html = program._repr_html_()  # pyright: ignore[reportPrivateUsage]
    assert pictures(html) == [svg]
    assert 'style="background:#fff"' in svg
    assert "captures" in html


@pytest.mark.filterwarnings("ignore")
def test_a_completed_program_is_compiled_among_others_and_with_what_it_imports(tmp_path: Path) -> None:
    castle = "shape pair { layer 1 { # # } }\nshape castle { layer 1..2 { # # } }\n"
    (tmp_path / "castle.sa").write_text(castle)
    begun = tmp_path / "begun.sa"
    phase = "phase low { yields pair }"
    begun.write_text(
        'import "castle.sa"\nassembly other { seed plate 1 x 1 { M at (0, 0) } phase grow { M.up -> T } }\n'
        f"assembly begun {{ seed plate 2 x 1 {{ A at (0, 0) }} {phase} }}\n"
    )
    planned = stochc.plan(begun, complete=True, tries=5)
    program = planned.compile()
    assert (program.assembly, program.captures) == ("begun", 2)
    assert list(program.sources.values()) == [planned.text, castle]
    assert pictures(planned._repr_html_()) == [program._repr_svg_()]  # pyright: ignore[reportPrivateUsage]
    # A second claim is an error until it is planned as well.
    begun.write_text(begun.read_text().replace(phase, phase + " phase high { yields castle }"))
    half = stochc.plan(begun, complete=True, tries=5)
    with pytest.raises(stochc.ProgramError, match="castle"):
        half.compile()
    assert half._repr_html_() == f"<pre>{escape(str(half))}</pre>"  # pyright: ignore[reportPrivateUsage]


def test_a_compiled_file_has_no_picture(tower: str, tmp_path: Path) -> None:
    compiled = tmp_path / "tower.sax"
    compiled.write_bytes(stochc.compile(tower).executable())
    program = stochc.compile(compiled)
    assert program.svg() is None
    assert program.sources == {}
    assert "<img" not in program._repr_html_()  # pyright: ignore[reportPrivateUsage]
    both = [stochc.simulate(it, runs=2, model="shuffle").results() for it in (program, tower)]
    assert both[0] == both[1]


def test_a_result_shows_its_table_and_its_curve(tower: str) -> None:
    ensemble = stochc.simulate([tower, "examples/line.sa"], runs=5, model="shuffle")
    html = ensemble._repr_html_()  # pyright: ignore[reportPrivateUsage]
    assert html.count("<tr>") == 3
    (curve,) = pictures(html)
    ElementTree.fromstring(curve)
    assert "prefers-color-scheme" in curve
    assert "not complete yet" in curve


def test_a_sweep_shows_its_figures() -> None:
    ensemble = stochc.sweep(stochc.EXAMPLE, {"free": [40, 50, 60]}, runs=3, model="shuffle")
    found = pictures(ensemble._repr_html_())  # pyright: ignore[reportPrivateUsage]
    assert found
    for picture in found:
        ElementTree.fromstring(picture)


HOSTILE = "<script>alert(1)</script>"


def test_texts_of_others_are_only_text(tmp_path: Path) -> None:
    folder = tmp_path / HOSTILE
    program = folder.with_name(folder.name + ".sa")
    program.parent.mkdir(parents=True)
    program.write_text(f"/// {HOSTILE}\n// {HOSTILE}\n{stochc.EXAMPLE}")
    ensemble = stochc.simulate(program, runs=2, model="shuffle", out=folder / "results")
    shown = [
        stochc.compile(program)._repr_html_(),  # pyright: ignore[reportPrivateUsage]
        ensemble._repr_html_(),  # pyright: ignore[reportPrivateUsage]
        Path(stochc.report(ensemble)).read_text(encoding="utf-8"),
        stochc.simulate(program, runs=1, max_ticks=50).run(0).replay().html,
    ]
    for page in shown:
        assert "<script>alert" not in page
    # The replay shows the source of the program, so the escaping is really tested.
    assert "alert(1)" in shown[-1]


def test_another_manifest_than_the_journal_has_is_refused(tmp_path: Path) -> None:
    folder = tmp_path / "results"
    stochc.simulate(stochc.EXAMPLE, runs=2, model="shuffle", out=folder)
    manifest = (folder / "manifest.json").read_text()
    (folder / "manifest.json").write_text(manifest.replace('"pair"', f'"{HOSTILE}"'))
    (folder / "checksums.json").unlink()
    with pytest.raises(stochc.UsageError):
        stochc.open(folder)


def test_a_run_shows_its_replay(tower: str) -> None:
    ensemble = stochc.simulate(tower, runs=1, max_ticks=100)
    html = ensemble.run(0)._repr_html_()  # pyright: ignore[reportPrivateUsage]
    assert html.startswith("<iframe ")
    assert 'sandbox="allow-scripts"' in html
    assert "default-src &#x27;none&#x27;" in html
    page = ensemble.run(0).replay().html
    assert not re.search(r"(src|href)=[\"']?https?:", page)


def test_a_table_shows_its_first_rows(tower: str) -> None:
    bonds = stochc.simulate(tower, runs=3, model="shuffle").bonds
    html = bonds._repr_html_()  # pyright: ignore[reportPrivateUsage]
    assert html.count("<tr>") == 11
    assert f"and {len(bonds) - 10} more rows" in html
    assert "[ticks]" in html
