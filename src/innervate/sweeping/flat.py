"""A run's summary as one flat row: `data.loss_ratio`, `recoveries.routed_ms`, ..."""

import json
from collections.abc import Mapping
from typing import Any

# Not of the network: the machine's, or columns of their own.
ASIDE = frozenset({"wall_s", "events_per_s", "kind", "name", "seed"})
LIST_MAX = 64  # longer lists of values are left out
TABLES_MAX = 16  # elements of a list of tables with columns of their own

Row = dict[str, Any]


def flat(summary: Mapping[str, Any]) -> Row:
    """All figures of a summary by dotted name.

    A list of tables (`recoveries`) gives the mean over its elements under the plain name
    (`recoveries.routed_ms`), the greatest as `recoveries.max.routed_ms`, and every element's own
    as `recoveries.0.routed_ms`; what never happened counts in neither. Other lists become text.
    """
    row: Row = {}
    for name, value in summary.items():
        if name not in ASIDE:
            _put(row, name, value)
    return row


def _put(row: Row, name: str, value: Any) -> None:
    if isinstance(value, dict):
        for inner, part in value.items():
            _put(row, f"{name}.{inner}", part)
    elif isinstance(value, list | tuple):
        if value and all(isinstance(item, dict) for item in value):
            _put_tables(row, name, value)
        elif len(value) <= LIST_MAX:
            row[name] = json.dumps(value, ensure_ascii=False)
    elif value is None or isinstance(value, bool | int | float | str):
        row[name] = value
    else:
        row[name] = value.item() if hasattr(value, "item") else str(value)


def _put_tables(row: Row, name: str, tables: list[dict[str, Any]] | tuple[Any, ...]) -> None:
    row[f"{name}.count"] = len(tables)
    rows = [flat(table) for table in tables]
    for key in dict.fromkeys(key for one in rows for key in one):
        values = [one[key] for one in rows if _is_number(one.get(key))]
        if values:
            row[f"{name}.{key}"] = sum(values) / len(values)
            row[f"{name}.max.{key}"] = max(values)
        elif all(one.get(key) is None for one in rows):
            row[f"{name}.{key}"] = row[f"{name}.max.{key}"] = None
    if len(tables) > 1:
        for i, one in enumerate(rows[:TABLES_MAX]):
            for key, value in one.items():
                row[f"{name}.{i}.{key}"] = value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
