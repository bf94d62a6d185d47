"""Constants of a protocol: what C calls them, and the comments that stand where they are set."""

import ast
import inspect
from collections.abc import Iterable
from functools import cache
from importlib import import_module
from importlib.util import resolve_name

from innervate.dialect.source import Function
from innervate.firmware.statements import comments_of


def names_of(functions: Iterable[Function], prefix: str) -> dict[str, str]:
    """Names in C by "module.NAME"; those of several meanings are called after their module.

    Under "" stands the prefix itself.
    """
    modules = {function.module: function.constants for function in functions}
    values: dict[str, set[int]] = {}
    for constants in modules.values():
        for name, value in constants.items():
            values.setdefault(name, set()).add(value)
    found = {"": prefix}
    for module, constants in modules.items():
        short = module.rpartition(".")[2].upper()
        for name in constants:
            own = name if len(values[name]) == 1 else f"{short}_{name}"
            found[f"{module}.{name}"] = f"{prefix.upper()}_{own}"
    return found


def note_of(module: str, name: str) -> str:
    """The comment behind a constant where it is defined; "" = there is none."""
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
