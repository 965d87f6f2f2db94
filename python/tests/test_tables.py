"""Tests the exchange of tables with other libraries."""

from __future__ import annotations

from pathlib import Path

import duckdb
import pandas
import polars
import pyarrow
import pyarrow.parquet
import pytest

import stochc

NAMES = ["runs", "phases", "bonds", "releases", "unplanned"]


@pytest.fixture
def ensemble(tower: str, tmp_path: Path) -> stochc.Ensemble:
    return stochc.simulate(tower, runs=5, model="shuffle", seed=3, out=tmp_path / "results")


@pytest.mark.parametrize("name", NAMES)
def test_tables_are_those_of_the_folder(ensemble: stochc.Ensemble, name: str) -> None:
    table = getattr(ensemble, name)
    ours = pyarrow.table(table)
    theirs = pyarrow.parquet.read_table(f"{ensemble.folder}/{name}.parquet")
    assert ours.column_names == theirs.column_names
    for column in ours.column_names:
        assert ours[column].to_pylist() == theirs[column].to_pylist(), column
        assert ours.schema.field(column).type == theirs.schema.field(column).type, column
    assert len(table) == ours.num_rows
    assert [list(row.values()) for row in table] == [list(row.values()) for row in ours.to_pylist()]


def test_units_and_meanings_travel(ensemble: stochc.Ensemble) -> None:
    schema = pyarrow.schema(ensemble.bonds)
    assert schema.field("wait").metadata[b"unit"] == b"ticks"
    assert b"`magnetized`" in schema.field("wait").metadata[b"meaning"]
    assert schema.metadata[b"stochc.ensemble"].decode() == ensemble.identity
    for name in [*NAMES, "summary", "survival"]:
        table: stochc.Table = getattr(ensemble, name)
        fields = pyarrow.schema(table)
        for column in table.columns:
            metadata = fields.field(column.name).metadata
            assert metadata[b"meaning"].decode() == column.meaning
            assert metadata.get(b"unit", b"").decode() == column.unit


def test_polars_pandas_and_duckdb_take_them(ensemble: stochc.Ensemble) -> None:
    bonds = ensemble.bonds
    rows = len(bonds)
    waits = sum(row["wait"] for row in bonds)
    assert rows > 5
    frame = polars.DataFrame(bonds)
    assert (frame.height, frame["wait"].sum()) == (rows, waits)
    table = pandas.DataFrame.from_arrow(bonds)
    assert (len(table), table["wait"].sum()) == (rows, waits)
    reader = pyarrow.RecordBatchReader.from_stream(bonds)  # noqa: F841: the query names it
    found = duckdb.sql("select count(*), sum(wait) from reader").fetchall()
    assert found == [(rows, waits)]
    found = duckdb.sql("select count(*) from bonds").fetchall()
    assert found == [(rows,)]


def test_the_memory_is_shared(ensemble: stochc.Ensemble) -> None:
    bonds = ensemble.bonds

    def address(table: pyarrow.Table) -> int:
        buffer = table["wait"].chunk(0).buffers()[1]
        assert buffer is not None
        return buffer.address

    first, second = pyarrow.table(bonds), pyarrow.table(bonds)
    assert address(first) == address(second)
    del bonds
    assert first["wait"].to_pylist() == second["wait"].to_pylist()


def test_empty_tables_have_columns(tmp_path: Path) -> None:
    ensemble = stochc.simulate(stochc.EXAMPLE, runs=1, model="shuffle")
    releases = pyarrow.table(ensemble.releases)
    assert releases.num_rows == 0
    assert "released" not in releases.column_names
    assert len(releases.column_names) == len(ensemble.releases.columns)
    assert polars.DataFrame(ensemble.releases).height == 0
    assert ensemble.releases.rows() == []


def test_a_sweep_has_columns_for_its_numbers() -> None:
    over = {"free": [40, 60], "tick": "10,20 ms"}
    ensemble = stochc.sweep(stochc.EXAMPLE, over, runs=2, model="shuffle")
    points = [(row["scene_free"], row["scene_tick"]) for row in ensemble.summary]
    assert points == [(40.0, 10.0), (40.0, 20.0), (60.0, 10.0), (60.0, 20.0)]
    assert pyarrow.schema(ensemble.runs).field("scene_tick").metadata[b"unit"] == b"ms"


def test_survival_falls_to_none(ensemble: stochc.Ensemble) -> None:
    rows = list(ensemble.survival)
    shares = [row["incomplete"] for row in rows]
    assert shares == sorted(shares, reverse=True)
    assert shares[-1] == 0.0
    assert rows[0]["at_risk"] == 5
