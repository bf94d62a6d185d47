"""Compiling a loop of hundreds of functions as one program.

Numba makes machine code of every function by itself, with all that it calls linked in and
optimised anew each time: a loop over a large protocol takes minutes. Within `as_one`, functions
that are called by the loop stay as they are until the loop itself is compiled; then all of them
are linked once, and optimised once. This reaches into Numba's code library: where that has
changed, everything is compiled as Numba does it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba import _dynfunc
from numba.core.codegen import CPUCodeLibrary
from numba.core.cpu import CPUContext

NEEDED = ("_linking_libraries", "_final_module", "_finalized", "_reload_init")

NOT_CALLED = "linked into the loop that calls it; not to be called from Python"

_top: list[str] = []
_numbas_finalize = CPUCodeLibrary.finalize
_numbas_executable = CPUContext.get_executable


@contextmanager
def as_one(name: str) -> Iterator[None]:
    """Compile the function of this qualified name with all that it calls as one program."""
    CPUCodeLibrary.finalize = _finalize
    CPUContext.get_executable = _get_executable
    _top.append(name)
    try:
        yield
    finally:
        _top.pop()


def _finalize(library: Any) -> None:
    """What Numba does when the code of a function is complete."""
    if not all(hasattr(library, name) for name in NEEDED):
        _numbas_finalize(library)
    elif _top and library.name != _top[-1]:
        library._innervate_deferred = True
        library._finalized = True
    else:
        _link_deferred(library)
        _numbas_finalize(library)


def _get_executable(context: Any, library: Any, description: Any, environment: Any) -> Any:
    """The function that Python could call; of deferred code a name that Numba knows it by."""
    if _top and library.name != _top[-1]:
        module, name = description.lookup_module(), description.qualname
        return _dynfunc.make_function(module, name, NOT_CALLED, 1, environment, (library,))
    return _numbas_executable(context, library, description, environment)


def _link_deferred(library: Any) -> None:
    """Whatever the deferred ones call is linked here, as they were not linked themselves."""
    seen = set(library._linking_libraries)
    waiting = list(library._linking_libraries)
    while waiting:
        called = waiting.pop()
        if getattr(called, "_innervate_deferred", False):
            for further in called._linking_libraries:
                if further not in seen:
                    seen.add(further)
                    waiting.append(further)
                    library._linking_libraries.append(further)
