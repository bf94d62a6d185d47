"""The work of the papers' figures in their full size, which tests have no time to run.

Of every piece its name, and what is called with which values; long lists by a digest.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from types import FunctionType, MethodType
from typing import Any

from innervate.papers import book
from innervate.papers.experiment import Point
from tests.recorded.data import plain, shortened


def found() -> Iterator[tuple[str, Callable[[], Any]]]:
    """System and figure, and all of its work."""
    for system in book.books():
        for figure in book.book_of(system).FIGURES:
            yield f"{system} {figure}", partial(work, system, figure)


def work(system: str, figure: str) -> Any:
    """The pieces of a figure: names, what is called, seconds that they are taken to need."""
    made = book.book_of(system).experiment(figure).points(False)
    return {
        "names": plain([point.key for point in made]),
        "calls": shortened([asked(point.work) for point in one_of_each(made)]),
        "cost_s": plain(sum(point.cost_s for point in made)),
    }


def one_of_each(made: list[Point]) -> list[Point]:
    """Of pieces that differ by their seed alone the last."""
    return list({point.key.rpartition(" seed ")[0] or point.key: point for point in made}.values())


def asked(value: Any) -> Any:
    """A call that is made later, as plain data: the function's name, then its values."""
    if isinstance(value, partial):
        named = {name: asked(inner) for name, inner in value.keywords.items()}
        return [asked(value.func), *map(asked, value.args), *([named] if named else [])]
    if isinstance(value, MethodType):
        return [asked(value.__func__), asked(value.__self__)]
    if isinstance(value, FunctionType | type):
        return f"{value.__module__}.{value.__qualname__}"
    if dataclasses.is_dataclass(value):
        return {one.name: asked(getattr(value, one.name)) for one in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {str(key): asked(inner) for key, inner in value.items()}
    return [asked(inner) for inner in value] if isinstance(value, list | tuple) else plain(value)
