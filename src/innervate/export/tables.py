"""A run's tables as files of their own: Parquet, or CSV for what reads nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from innervate.export import files
from innervate.export.errors import ExportError

if TYPE_CHECKING:
    import polars


def write(tables: Mapping[str, polars.LazyFrame], folder: Path, csv: bool = False) -> list[Path]:
    """Write every table as NAME.parquet or NAME.csv; the files come back.

    Raises:
        ExportError: the folder or a file cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ExportError(f"{folder}: {error.strerror}; name another folder") from None
    written = []
    for name, table in tables.items():
        path = folder / f"{name}.{'csv' if csv else 'parquet'}"
        with files.whole(path) as file:
            frame = table.collect()
            if csv:
                frame.write_csv(file)
            else:
                frame.write_parquet(file, compression="zstd", statistics=True)
        written.append(path)
    return written
