"""Node files as text."""

from __future__ import annotations

import json

from innervate.live.deployment import Table


def text(head: Table, tables: dict[str, Table], links: list[Table]) -> str:
    """A node file."""
    lines = _lines(head)
    for name, table in tables.items():
        lines += ["", f"[{name}]", *_lines(table)]
    for link in links:
        lines += ["", "[[link]]", *_lines(link)]
    return "\n".join(lines) + "\n"


def _lines(table: Table) -> list[str]:
    return [f"{key} = {json.dumps(value)}" for key, value in table.items()]
