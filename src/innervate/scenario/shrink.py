"""Scenarios that are simpler than one that was drawn."""

from collections.abc import Iterator
from typing import Any

Tables = dict[str, Any]

KEPT = ("rule", "updates")  # what a scenario is about


def with_fewer_keys(tables: Tables) -> Iterator[Tables]:
    """The same with one setting less."""
    for name in ("protocol", "timing", "data", "channel"):
        for key in tables.get(name, {}):
            if key not in KEPT:
                rest = {k: v for k, v in tables[name].items() if k != key}
                yield tables | {name: rest}
