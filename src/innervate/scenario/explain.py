"""From raw tables to a model, with errors in the user's words.

msgspec says what failed and where; the sentence is built from the field's own description.
"""

import difflib
import re
import sys
from collections.abc import Hashable, Iterator
from functools import lru_cache
from typing import Any, Literal, TypeVar, cast, get_args, get_origin, get_type_hints

import msgspec
from msgspec import inspect

from innervate.scenario.errors import ScenarioError
from innervate.scenario.lines import Key
from innervate.scenario.source import Source, dotted, shown, table_name

_AT = re.compile(r" - at `\$(.*?)`$", re.DOTALL)
_STEP = re.compile(r"\.([A-Za-z_0-9]+)|\[(\d+)\]")
_QUOTED = re.compile(r"`([^`]*)`", re.DOTALL)
_LIMIT = re.compile(r"(<=|<) ([0-9.e+]+)")

Model = TypeVar("Model")


def convert(source: Source, raw: dict[str, Any], model: type[Model]) -> Model:
    """The raw tables as `model`.

    Raises:
        ScenarioError: an unknown key (with the nearest known one), a missing key, a value of the
            wrong type or out of range.
    """
    _refuse_unknown(source, raw, _described(cast(Hashable, model)), ())
    try:
        return msgspec.convert(raw, model)
    except msgspec.ValidationError as error:
        raise _in_words(source, raw, model, str(error)) from None


@lru_cache(maxsize=32)
def _described(model: Hashable) -> inspect.Type:
    """A model's keys and types; to find them takes longer than all else that is read."""
    return inspect.type_info(model)


def nearest(word: str, known: list[str]) -> str:
    """'; did you mean "..."?' for the nearest known word, or the known ones in a row."""
    close = difflib.get_close_matches(word[:100], known, 1, 0.6)
    if close:
        return f'; did you mean "{close[0]}"?'
    return f"; it knows {', '.join(known)}"


def _structs(kind: inspect.Type | None) -> Iterator[inspect.StructType]:
    """The struct types a value of this type may have."""
    if isinstance(kind, inspect.Metadata):
        yield from _structs(kind.type)
    elif isinstance(kind, inspect.StructType):
        yield kind
    elif isinstance(kind, inspect.UnionType):
        for inner in kind.types:
            yield from _structs(inner)


def _items(kind: inspect.Type | None, index: int) -> inspect.Type | None:
    """Type of element `index` if the type is a list or tuple."""
    if isinstance(kind, inspect.Metadata):
        return _items(kind.type, index)
    if isinstance(kind, inspect.ListType):
        return kind.item_type
    if isinstance(kind, inspect.TupleType):
        return kind.item_types[index] if index < len(kind.item_types) else None
    if isinstance(kind, inspect.UnionType):
        for inner in kind.types:
            found = _items(inner, index)
            if found is not None:
                return found
    return None


def _refuse_unknown(source: Source, value: Any, kind: inspect.Type | None, key: Key) -> None:
    if isinstance(value, list | tuple):
        for index, inner in enumerate(value):
            _refuse_unknown(source, inner, _items(kind, index), (*key, index))
    elif isinstance(value, dict):
        for struct in _structs(kind):
            fields = {field.encode_name: field.type for field in struct.fields}
            for name, inner in value.items():
                if name not in fields:
                    hint = nearest(name, list(fields))
                    message = f"{table_name(key)} has no key {shown(name)}{hint}"
                    raise source.error((*key, name), message)
                _refuse_unknown(source, inner, fields[name], (*key, name))


def _in_words(source: Source, raw: Any, model: type, text: str) -> ScenarioError:
    match = _AT.search(text)
    key: Key = ()
    if match is not None:
        at = match[1].partition("[...]")[0]
        key = tuple(m[1] if m[1] else int(m[2]) for m in _STEP.finditer(at))
        text = text[: match.start()]
    if "missing required field" in text:
        name = (_QUOTED.findall(text) or ["?"])[-1]
        wanted = _wanted(model, (*key, name))
        return source.error(key, f'{table_name(key)} lacks "{name}"; give it {wanted}')
    value = raw
    for part in key:
        value = value[part]
    if match is not None and "[...]" in match[1]:  # msgspec does not say which
        key, value = next(
            ((*key, name), one) for name, one in value.items() if not _fits(one, text)
        )
        return source.error(key, f"{dotted(key)} must be a whole number, not {shown(value)}")
    limit = _LIMIT.search(text)
    if limit is not None and isinstance(value, int | float) and not isinstance(value, bool):
        return source.error(key, f"{dotted(key)} must be at most {limit[2]}, not {shown(value)}")
    wanted = _wanted(model, key) or text
    hint = ""
    if isinstance(value, str) and text.startswith("Invalid enum"):
        close = difflib.get_close_matches(value, re.findall(r'"(\w+)"', wanted), 1)
        hint = f'; did you mean "{close[0]}"?' if close else ""
    return source.error(key, f"{dotted(key)} must be {wanted}, not {shown(value)}{hint}")


def _fits(value: Any, text: str) -> bool:
    """True if a value of a table of numbers is not what msgspec speaks of."""
    if isinstance(value, list):
        return "`int`, got `array`" not in text and all(type(one) is int for one in value)
    return type(value) is int


def _wanted(model: type, key: Key) -> str:
    """Description of the innermost described type on the way to a key."""
    kind: inspect.Type | None = inspect.type_info(model)
    words = ""
    for place, part in enumerate(key):
        assert kind is not None
        choices: list[str] = []
        if isinstance(part, int):
            kind = _items(kind, part)
        else:
            found = [(f, s) for s in _structs(kind) for f in s.fields if f.encode_name == part]
            kind = found[0][0].type if found else None
            choices = _choices(found[0][1].cls, found[0][0].name) if found else []
        if kind is None:
            return words
        words = _description(kind, key[: place + 1]) or alternatives(choices) or words
    return words


def _choices(table: type, name: str) -> list[str]:
    """The values that a key can have, in the order in which they are declared; else none."""
    # Not of msgspec's own view of the type: it sorts them.
    names = vars(sys.modules[table.__module__])
    left: list[Any] = [get_type_hints(table, names, {}, include_extras=True)[name]]
    while left:
        hint = left.pop(0)
        if get_origin(hint) is Literal:
            return [shown(value) for value in get_args(hint)]
        left += get_args(hint)
    return []


def _description(kind: inspect.Type, key: Key) -> str:
    """A type in words: its own description, else what it says by itself."""
    if isinstance(kind, inspect.Metadata):
        extra = kind.extra_json_schema or {}
        return str(extra.get("description", "")) or _description(kind.type, key)
    if isinstance(kind, inspect.UnionType):
        return next((words for one in kind.types if (words := _description(one, key))), "")
    if isinstance(kind, inspect.BoolType):
        return "true or false"
    if isinstance(kind, inspect.StructType):
        return f"a table {table_name(key)}" if len(key) == 1 else "a table"
    if isinstance(kind, inspect.ListType) and isinstance(kind.item_type, inspect.StructType):
        return f"tables [[{dotted(key)}]]"
    return ""


def alternatives(words: list[str]) -> str:
    """Words in a row: "a, b or c"."""
    return " or ".join(part for part in (", ".join(words[:-1]), *words[-1:]) if part)
