"""Constants of a protocol: what C calls them, and the comments that stand where they are set."""

import ast
import inspect
from collections.abc import Iterable
from functools import cache
from importlib import import_module
from importlib.util import resolve_name

from innervate.dialect.source import Function
from innervate.firmware.errors import FirmwareError
from innervate.firmware.statements import comments_of


def names_of(functions: Iterable[Function], prefix: str) -> dict[str, str]:
    """Names in C by "module.NAME"; those of several meanings are called after their module.

    Under "" stands the prefix itself.

    Raises:
        FirmwareError: two of one name, and of modules of one name, have different values.
    """
    known = {
        f"{function.module}.{name}": value
        for function in functions
        for name, value in function.constants.items()
    }
    values: dict[str, set[int]] = {}
    for place, value in known.items():
        values.setdefault(place.rpartition(".")[2], set()).add(value)
    found, said = {"": prefix}, dict[str, int]()
    for place in known:
        *_, module, name = place.split(".")
        own = name if len(values[name]) == 1 else f"{module.upper()}_{name}"
        found[place] = f"{prefix.upper()}_{own}"
        if said.setdefault(own, known[place]) != known[place]:
            raise FirmwareError(f"{place}: another constant is called {own} in C, too")
    return found


def note_of(module: str, name: str) -> str:
    """The comment behind a constant where it is defined; "" = there is none."""
    owner, _, name = name.rpartition(".")
    if owner:
        return note_of(getattr(import_module(module), owner).__name__, name)
    notes, homes = _notes(module)
    if name in notes:
        return notes[name]
    return note_of(homes[name], name) if name in homes else ""


@cache
def _notes(module: str) -> tuple[dict[str, str], dict[str, str]]:
    """Of a module: comments of its constants by name, and where it has the others from."""
    source = import_module(module)
    comments = comments_of(source.__file__ or "")
    notes: dict[str, str] = {}
    homes: dict[str, str] = {}
    for node in ast.parse(inspect.getsource(source)).body:
        if isinstance(node, ast.Assign):
            note, alone = comments.get(node.lineno, ("", True))
            for target in node.targets:
                if isinstance(target, ast.Name):
                    notes[target.id] = "" if alone else note
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            home = resolve_name("." * node.level + node.module, source.__package__)
            homes |= {alias.name: home for alias in node.names}
    return notes, homes
