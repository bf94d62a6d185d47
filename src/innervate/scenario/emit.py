"""A scenario as TOML text, defaults and overrides written out."""

import json
import re
from collections.abc import Collection
from typing import Any

import msgspec

from innervate.network import networks
from innervate.scenario.lines import Key
from innervate.scenario.load import Scenario

ALWAYS = ("kind", "schema", "name", "seed")  # written even if they were not given
_BARE = re.compile(r"[A-Za-z0-9_-]+")


def dump(scenario: Scenario, whole: bool = True) -> str:
    """TOML that loads to the same scenario, with defaults, or (not `whole`) what was given alone.

    Relative paths in it become full ones, since the text may be kept elsewhere.
    """
    tables = msgspec.to_builtins(scenario.model)
    networks()[scenario.kind].anchor(tables, scenario.source)
    if not whole:
        given = scenario.source.given | {(name,) for name in ALWAYS}
        tables = _given(tables, (), given)
    return to_toml(tables)


def _given(value: Any, key: Key, given: Collection[Key]) -> Any:
    """What of a value was given; lists stay as they are but for tables in them."""
    if isinstance(value, dict):
        return {name: _given(inner, (*key, name), given) for name, inner in value.items()
                if (*key, name) in given}  # fmt: skip
    if isinstance(value, list | tuple):
        return [_given(inner, (*key, index), given) for index, inner in enumerate(value)]
    return value


def to_toml(tables: dict[str, Any]) -> str:
    """TOML of nested tables; None and empty lists are left out.

    Plain values come first, then [tables], then [[lists of tables]], each in the given order.
    """
    lines: list[str] = []
    later: list[tuple[str, dict[str, Any]]] = []
    for key, value in tables.items():
        if isinstance(value, dict):
            later.append((f"[{_key(key)}]", value))
        elif isinstance(value, list | tuple) and value and isinstance(value[0], dict):
            later.extend((f"[[{_key(key)}]]", item) for item in value)
        elif _present(value):
            lines.append(f"{_key(key)} = {inline(value)}")
    for head, table in later:
        lines += ["", head]
        lines += [f"{_key(k)} = {inline(v)}" for k, v in table.items() if _present(v)]
    return "\n".join(lines).strip("\n") + "\n"


def _present(value: Any) -> bool:
    return value is not None


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else inline(key)


def inline(value: Any) -> str:
    """A value as TOML in one line: 2.5, true, "text", [1, 2], { a = 1 }."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, dict):
        inside = ", ".join(f"{_key(k)} = {inline(v)}" for k, v in value.items() if _present(v))
        return f"{{ {inside} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(inline(item) for item in value)}]"
    return repr(value)
