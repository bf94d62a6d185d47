"""The tables of a run: their columns declared once, and written as Parquet.

Polars is imported inside functions, so that reading a declaration stays cheap.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import polars


class Column(NamedTuple):
    """A column: its name, its polars type by name, its unit and its meaning.

    `field` of the simulation's rows holds it where that is called otherwise.
    """

    name: str
    kind: str
    unit: str
    meaning: str
    field: str = ""


@dataclass(frozen=True, slots=True)
class Table:
    """A table: its name (also its file's), what a row is, and its columns.

    In recordings it is called as it is, or by its `topic`; `rows` of a result hold it, where its
    columns are taken from there as they are.
    """

    name: str
    row: str
    columns: tuple[Column, ...]
    topic: str = ""
    rows: str = ""


TIME = Column("time_us", "Int64", "us", "when, true time", "time")


def reports(who: Column) -> Table:
    """The table of what nodes reported, where codes are a network's own."""
    details = (Column("a", "Int32", "", "first detail"), Column("b", "Int32", "", "second detail"))
    columns = (TIME, who, Column("code", "Int8", "code", "what"), *details)
    row = f"a {who.unit} reported something (codes: protocol/constants.py)"
    return Table("reports", row, columns, rows="rows")


def taken(table: Table, rows: Any) -> dict[str, Any]:
    """One array for every column that an array of records has a field for."""
    import numpy as np

    fields = {column.name: column.field or column.name for column in table.columns}
    # Fields of records lie apart in memory; polars wants each in one piece.
    return {name: np.ascontiguousarray(rows[field])
            for name, field in fields.items() if field in rows.dtype.names}  # fmt: skip


def frame(table: Table, columns: Mapping[str, Any]) -> polars.DataFrame:
    """A polars frame of a table from one array per column.

    Raises:
        ValueError: the columns are not those declared.
    """
    import polars

    names = [column.name for column in table.columns]
    if sorted(columns) != sorted(names):
        raise ValueError(f"table {table.name} has columns {names}, not {sorted(columns)}")
    series = [
        polars.Series(column.name, columns[column.name], dtype=getattr(polars, column.kind))
        for column in table.columns
    ]
    return polars.DataFrame(series)


def arrays(frame: polars.DataFrame) -> dict[str, Any]:
    """A frame as NumPy arrays by the names of its columns; where values may lack, as floats."""
    return {series.name: series.to_numpy() for series in frame}


def to_pandas(frame: polars.DataFrame) -> Any:
    """A frame as one of pandas, which has to be installed; pyarrow need not be."""
    pandas: Any = import_module("pandas")
    return pandas.DataFrame(arrays(frame))


def write(table: Table, columns: Mapping[str, Any], folder: Path) -> Path:
    """Write a table as `<name>.parquet` into a folder; the file comes back."""
    path = folder / f"{table.name}.parquet"
    packed = io.BytesIO()  # written by ourselves, a full disk is an OSError that says so
    frame(table, columns).write_parquet(packed, compression="zstd", statistics=True)
    path.write_bytes(packed.getbuffer())
    return path


def read(table: Table, folder: Path) -> polars.LazyFrame:
    """A table of a run folder, read when it is asked for."""
    import polars

    return polars.scan_parquet(folder / f"{table.name}.parquet")
