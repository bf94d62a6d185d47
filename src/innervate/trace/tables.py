"""The tables of a run: their columns declared once, and written as Parquet.

Polars is imported inside functions, so that reading a declaration stays cheap.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import polars


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its name, its polars type by name, its unit and its meaning."""

    name: str
    kind: str
    unit: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Table:
    """A table: its name (also its file's), what a row is, and its columns."""

    name: str
    row: str
    columns: tuple[Column, ...]


_TIME = Column("time_us", "Int64", "us", "when, true time")
_CELL = Column("cell", "Int32", "cell", "who")

ROUTES = Table(
    "routes",
    "a cell changed its parent port",
    (
        _TIME,
        _CELL,
        Column("old", "Int8", "port", "parent port before; -1 none"),
        Column("new", "Int8", "port", "parent port after; -1 none"),
        Column("balancing", "Boolean", "", "only to balance the load"),
    ),
)
LINKS = Table(
    "links",
    "a cell found a port broken, or working again",
    (
        _TIME,
        _CELL,
        Column("port", "Int8", "port", "which of its ports"),
        Column("to", "Int32", "cell", "the cell on the other side; the number of cells = the PC"),
        Column("broken", "Boolean", "", "true broken, false works again"),
    ),
)
OUTAGES = Table(
    "outages",
    "the number of cells without a route, or of cells cut off, changed",
    (
        _TIME,
        Column(
            "unrouted", "Int32", "cells", "cells connected to the PC without a route, from now on"
        ),
        Column(
            "cut_off", "Int32", "cells", "cells on that no cable joins with the PC, from now on"
        ),
    ),
)
LOOPS = Table(
    "loops",
    "a forwarding loop stood",
    (
        Column("opened_us", "Int64", "us", "when it closed into a ring"),
        Column("closed_us", "Int64", "us", "when it fell apart; null = stood at the end"),
        Column("cell", "Int32", "cell", "one of its cells"),
        Column("length", "Int32", "cells", "cells in it"),
    ),
)
RECEIVED = Table(
    "received",
    "the PC received a tactile sample",
    (
        _TIME,
        Column("interface", "Int16", "port", "interface port it came in on"),
        Column("cell", "Int32", "cell", "who measured it"),
        Column("seq", "Int16", "number", "counts the cell's samples, 0..255"),
        Column("hops", "Int16", "hops", "cells that forwarded it"),
        Column("latency_us", "Int64", "us", "since it was measured"),
        Column("proximity", "Int32", "raw", "nearness of an object, 0 far"),
        Column("force_0", "Int32", "mN", "first force sensor"),
        Column("force_1", "Int32", "mN", "second force sensor"),
        Column("force_2", "Int32", "mN", "third force sensor"),
        Column("temperature", "Int16", "0.5 degC", "from 20 degC"),
        Column("accel_x", "Int16", "raw", "acceleration along x"),
        Column("accel_y", "Int16", "raw", "acceleration along y"),
        Column("accel_z", "Int16", "raw", "acceleration along z"),
    ),
)
TABLES = (ROUTES, LINKS, OUTAGES, LOOPS, RECEIVED)


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
