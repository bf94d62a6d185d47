"""Compiling a loop of hundreds of functions as one program.

Numba makes machine code of every function by itself, with all that it calls linked in and
optimised anew each time: a loop over a large protocol takes minutes. Within `as_one`, functions
that are called by the loop stay as they are until the loop itself is compiled; then all of them
are linked once, and optimised once.

A loop's world is a tuple of dozens of bare addresses (see tables.py). Numba takes it apart, field
by field, wherever a name for it comes or goes, to find what has references to count: nothing.
Within `as_one` such values are left alone: a tenth less time for the skin's loop.

A world is handed on by value, two numbers for each of its tables: to write them out for a call cost
a loop over small handlers half its time. What is linked into a loop belongs to it alone, which the
optimiser is told: a function is then handed only what it uses.

Numba's own runtime is compiled before the first loop is: were it left to be linked later, it would
never be, and whatever makes an array in this process would end it.

This reaches into Numba's insides: where they have changed, everything is compiled as Numba does it.
"""

import gc
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import cache
from typing import Any

import numba
from llvmlite.binding import Linkage
from numba import _dynfunc
from numba.core.codegen import CPUCodeLibrary
from numba.core.compiler_lock import global_compiler_lock
from numba.core.cpu import CPUContext
from numba.core.registry import cpu_target
from numba.core.runtime.context import NRTContext

KNOWN = 0, 68  # the newest Numba whose insides `spared` knows
NEEDED = ("_linking_libraries", "_final_module", "_finalized", "_reload_init")

NOT_CALLED = "linked into the loop that calls it; not to be called from Python"

_top: list[str] = []
_numbas_finalize = CPUCodeLibrary.finalize
_numbas_executable = CPUContext.get_executable
_numbas_optimize: Any = getattr(CPUCodeLibrary, "_optimize_final_module", None)
_numbas_count: Any = getattr(NRTContext, "_call_incref_decref", None)


@contextmanager
def as_one(name: str) -> Iterator[None]:
    """Compile the function of this qualified name with all that it calls as one program."""
    with global_compiler_lock:  # another thread's loop is none of what this one calls
        cpu_target.target_context.refresh()
        CPUCodeLibrary.finalize = _finalize
        CPUContext.get_executable = _get_executable
        if _numbas_count is not None:
            NRTContext._call_incref_decref = _count
        if _numbas_optimize is not None:
            CPUCodeLibrary._optimize_final_module = _optimize
        _top.append(name)
        collects = gc.isenabled()
        gc.disable()  # a tenth of the time went into looking for what is in use to the end
        try:
            with _spared():
                yield
        finally:
            _top.pop()
            if collects:
                gc.enable()


def _spared() -> AbstractContextManager[None]:
    """What is left out of compiling; nothing, with a Numba whose insides may be others."""
    if numba.version_info.short > KNOWN:
        return nullcontext()
    from innervate.kernel.spared import spared

    return spared()


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


def _optimize(library: Any) -> None:
    """Before Numba optimises a loop: nobody else calls what was linked into it."""
    if _top and library.name == _top[-1]:
        for function in library._final_module.functions:
            if function.linkage == Linkage.linkonce_odr:
                function.linkage = Linkage.internal
    _numbas_optimize(library)


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


def _count(runtime: Any, builder: Any, kind: Any, *rest: Any) -> None:
    """One reference more or less to what a value holds, if it can hold any."""
    if not _top or _is_counted(runtime._context, kind):
        _numbas_count(runtime, builder, kind, *rest)


@cache
def _is_counted(context: Any, kind: Any) -> bool:
    return bool(context.data_model_manager[kind].contains_nrt_meminfo())
