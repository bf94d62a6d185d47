"""Numbers that have a name: constants of modules, and what holds where an argument is left out.

Limits, thresholds, times and units are looked at here once; nothing else may ever come to them.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from tests.recorded.data import DOTS, plain

SOURCES = Path(__file__).resolve().parents[2] / "src"
GIVEN = re.compile(r"^([A-Z_][A-Z0-9_]*(?:, [A-Z_][A-Z0-9_]*)*)(?:: [^=\n]+)? = ", re.MULTILINE)
ELSEWHERE = {"protocol", "dialect", "pages", "static"}  # the explorers look at the first two


def found() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Every folder of modules, and its numbers."""
    for folder in sorted({path.parent for path in SOURCES.rglob("*.py")}):
        place = folder.relative_to(SOURCES)
        if not ELSEWHERE & set(place.parts) and (folder / "__init__.py").exists():
            yield place.as_posix(), partial(numbers, folder)


def numbers(folder: Path) -> dict[str, Any]:
    """Of each module of a folder, by module and name; what is no plain data is left out."""
    made = {}
    for path in sorted(folder.glob("*.py")):
        if path.stem == "__main__":
            continue
        name = ".".join(path.relative_to(SOURCES).with_suffix("").parts)
        module = import_module(name.removesuffix(".__init__"))
        for key, value in (*constants(module, path), *defaults(module)):
            if has_number(value) and key != "TYPE_CHECKING":
                with suppress(TypeError):
                    made[f"{path.stem}.{key}"] = unsaid(plain(value))
    return made


def constants(module: ModuleType, path: Path) -> Iterator[tuple[str, Any]]:
    """Those that are given a value in the module itself."""
    given = ", ".join(GIVEN.findall(path.read_text(encoding="utf-8"))).split(", ")
    for name in filter(partial(hasattr, module), given):
        yield name, getattr(module, name)


def defaults(module: ModuleType) -> Iterator[tuple[str, Any]]:
    """Of the module's own functions, and of the fields of its classes."""
    for name, one in vars(module).items():
        if getattr(one, "__module__", "") != module.__name__:
            continue
        if inspect.isfunction(one):
            yield from left_out(name, one)
        elif inspect.isclass(one):
            for inner, method in vars(one).items():
                if inspect.isfunction(method):
                    yield from left_out(f"{name}.{inner}", method)
            fields = dataclasses.fields(one) if dataclasses.is_dataclass(one) else ()
            usual = {field.name: field.default for field in fields}
            for key, value in (usual | getattr(one, "_field_defaults", {})).items():
                yield f"{name}({key})", value


def left_out(name: str, function: Callable[..., Any]) -> Iterator[tuple[str, Any]]:
    """The arguments of a function that may be."""
    code, given = function.__code__, function.__defaults__ or ()
    last = code.co_varnames[code.co_argcount - len(given) : code.co_argcount]
    usual = dict(zip(last, given, strict=True)) | (function.__kwdefaults__ or {})
    return ((f"{name}({key})", value) for key, value in usual.items())


def has_number(value: Any) -> bool:
    """True for numbers, and for what has one in it, however deep."""
    if isinstance(value, int | float | np.ndarray):
        return True
    if isinstance(value, dict):
        return has_number((*value, *value.values()))
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return has_number([getattr(value, field.name) for field in dataclasses.fields(value)])
    return isinstance(value, tuple | list | set | frozenset | range) and any(map(has_number, value))


def unsaid(value: Any) -> Any:
    """Plain data without its sentences, which may be said in other words."""
    if isinstance(value, dict):
        return {key: unsaid(inner) for key, inner in value.items() if " " not in key}
    if isinstance(value, list):
        return [unsaid(inner) for inner in value]
    return DOTS if isinstance(value, str) and " " in value else value
