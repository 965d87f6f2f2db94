"""Tables that Polars, pandas, DuckDB and PyArrow read without a copy."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _html
from ._arguments import whole

if TYPE_CHECKING:
    from . import _native


@dataclass(frozen=True)
class Column:
    """Description of a column."""

    name: str
    type: str
    """`int32`, `int64`, `uint64`, `float64`, `bool`, `text`, or `list of` one of these."""
    unit: str
    """Unit of the values. Empty if they have no unit."""
    meaning: str
    null: str | None
    """Condition for null values. `None` if values are never null."""


class Table:
    """Table with rows and columns in Arrow's memory format.

    It supports the Arrow PyCapsule interface: `polars.DataFrame(table)`, `pyarrow.table(table)`,
    `pandas.DataFrame.from_arrow(table)`, and queries of DuckDB that name the variable of the table. The unit and
    the meaning of each column are metadata of its field.

    >>> import stochc
    >>> runs = stochc.simulate(stochc.EXAMPLE, runs=3, model="shuffle").runs
    >>> len(runs), runs.name
    (3, 'runs')
    >>> runs.column("ticks").unit
    'ticks'
    >>> [row["run"] for row in runs]
    [0, 1, 2]
    """

    __slots__ = ("_columns", "_name", "_native", "_row")

    def __init__(self, native: _native.Table) -> None:
        shape = json.loads(native.shape_json())
        self._native = native
        self._name: str = shape["name"]
        self._row: str = shape["row"]
        self._columns = tuple(Column(**column) for column in shape["columns"])

    @property
    def name(self) -> str:
        """Name of the table. Its file in a results folder is `NAME.parquet`."""
        return self._name

    @property
    def row(self) -> str:
        """Description of a row."""
        return self._row

    @property
    def columns(self) -> tuple[Column, ...]:
        """Columns of the table in order."""
        return self._columns

    def column(self, name: str) -> Column:
        """Returns the column with a name."""
        for column in self._columns:
            if column.name == name:
                return column
        names = ", ".join(column.name for column in self._columns)
        raise KeyError(f"{self._name} has no column {name!r}; its columns are {names}")

    def __len__(self) -> int:
        return len(self._native)

    def rows(self, first: int = 0, most: int = 1_000_000) -> list[dict[str, Any]]:
        """Returns rows as dictionaries, starting at row `first`. For small tables without another library."""
        first = whole("first", first, 0, 2**62)
        most = whole("most", most, 0, 2**62)
        names = [column.name for column in self._columns]
        rows = json.loads(self._native.rows_json(first, most))
        return [dict(zip(names, row, strict=True)) for row in rows]

    def __iter__(self) -> Iterator[dict[str, Any]]:
        size = 10_000
        for first in range(0, len(self), size):
            yield from self.rows(first, size)

    def __arrow_c_schema__(self) -> object:
        """Returns the schema, for the Arrow PyCapsule interface."""
        return self._native.__arrow_c_schema__()

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """Returns the rows, for the Arrow PyCapsule interface. Ignores `requested_schema`."""
        return self._native.__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        return f"<stochc.Table {self._name}: {len(self)} rows, {len(self._columns)} columns>"

    def __reduce__(self) -> str:
        raise TypeError("a table cannot be pickled: pickle the ensemble, or pyarrow.table(table)")

    def _repr_html_(self) -> str:
        shown = 10
        names = [column.name for column in self._columns]
        titles = [
            column.meaning + (f" [{column.unit}]" if column.unit else "") for column in self._columns
        ]
        rows = [list(row.values()) for row in self.rows(0, shown)]
        more = len(self) - len(rows)
        rest = f"<p>and {more} more rows</p>" if more > 0 else ""
        return _html.table(names, rows, titles) + rest
