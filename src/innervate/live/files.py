"""Node files as text: what `live up` writes and nodes read."""

import json

from innervate.live.deployment import Table


def text(head: Table, tables: dict[str, Table], links: list[Table]) -> str:
    """The text of a node file: keys of its head, tables, one [[link]] a cable."""
    lines = _lines(head)
    for name, table in tables.items():
        lines += ["", f"[{name}]", *_lines(table)]
    for link in links:
        lines += ["", "[[link]]", *_lines(link)]
    return "\n".join(lines) + "\n"


def _lines(table: Table) -> list[str]:
    return [f"{key} = {json.dumps(value)}" for key, value in table.items()]
