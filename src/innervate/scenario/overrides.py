"""`--set a.b=c`: values given on the command line in place of the file's."""

import tomllib
from collections.abc import Iterable
from typing import Any

from innervate.scenario.errors import ScenarioError
from innervate.scenario.lines import Key
from innervate.scenario.source import Source, dotted, shown

Override = str | tuple[str, Any]


def parse_value(text: str) -> Any:
    """The value of a `--set`: TOML where it is TOML ("2.5", "true", "[1, 2]"), else a string."""
    if "\n" in text or "\r" in text:
        return text
    try:
        return tomllib.loads(f"v = {text}")["v"]
    except (ValueError, RecursionError):
        return text


def apply(source: Source, raw: dict[str, Any], overrides: Iterable[Override]) -> None:
    """Put every override into the raw tables, in order; `source` remembers them.

    Args:
        source: gets the text of each override at its key.
        raw: changed in place; tables that are missing are made.
        overrides: "a.b=c" texts, or (key, value) pairs. List elements go by index; the index
            after the last appends.

    Raises:
        ScenarioError: no "=", an empty key, or a key that leads through a value.
    """
    for override in overrides:
        if isinstance(override, str):
            name, equals, text = override.partition("=")
            if not equals:
                message = "write it as key=value, like protocol.k=3"
                raise ScenarioError(message, f"--set {override}")
            value = parse_value(text.strip())
        else:
            name, value = override
            override = f"{name}={shown(value)}"
        parts: list[str | int] = [_part(word) for word in name.strip().split(".")]
        if "" in parts:
            message = "a key is names with dots between, like protocol.k"
            raise ScenarioError(message, f"--set {override}")
        key: Key = tuple(parts)
        _forget(source, key)
        source.sets[key] = override
        _put(source, raw, key, value)


def _part(word: str) -> str | int:
    word = word.strip()
    return int(word) if word.isascii() and word.isdigit() and len(word) < 8 else word


def _forget(source: Source, key: Key) -> None:
    """Lines and sets below a key that is set anew say nothing any more."""
    for old in [k for k in source.lines if k[: len(key)] == key]:
        del source.lines[old]
    for old in [k for k in source.sets if k[: len(key)] == key]:
        del source.sets[old]


def _put(source: Source, raw: dict[str, Any], key: Key, value: Any) -> None:
    here: Any = raw
    for depth, part in enumerate(key):
        last = depth == len(key) - 1
        fresh: Any = [] if not last and isinstance(key[depth + 1], int) else {}
        name = dotted(key[:depth]) or "the scenario"
        if isinstance(here, list):
            if not isinstance(part, int) or part > len(here):
                message = f"{name} is a list of {len(here)}; its elements are addressed by number"
                raise source.error(key, f"{message} from 0, and {len(here)} appends")
            if part == len(here):
                here.append(fresh)
        elif isinstance(here, dict):
            part = str(part)
            here.setdefault(part, fresh)
        else:
            message = f"{name} is {shown(here)}, which has nothing inside; set {name} itself"
            raise source.error(key, message)
        if last:
            here[part] = value
        here = here[part]
