"""What Numba does beside compiling, left out while a loop of hundreds of functions is compiled.

For every pass over every function Numba writes out its arguments' types, measures time that nobody
reads, and colours the messages of attempts that do not matter; it looks for variables in all that
an instruction holds, asks again what it was told before, and compiles a function once more for
callers that are themselves to be inlined. After each of nine passes it works out which variables
are alive where, of which it asks after three; and it goes through all kinds of numbers that NumPy
can add for every sum of two integers. Without it a loop takes three tenths less processor time, and
does the same.

This reaches into Numba's insides, and only `linking` loads it, where it knows that they are these:
what a Numba of today does not have stays as it is.
"""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import cache
from typing import Any

from llvmlite.binding import ffi
from numba.core import compiler_machinery, errors, event, ir, itanium_mangler, transforms
from numba.core.postproc import PostProcessor, VariableLifetime
from numba.core.targetconfig import TargetConfig
from numba.core.types import Integer, Record
from numba.core.typing.npydecl import NumpyRulesArrayOperator
from numba.core.typing.templates import _OverloadFunctionTemplate

NEVER_HELD = frozenset({str, int, bool, float, type(None), ir.Loc})  # these hold no variable

_numbas_words = Record.__repr__
_numbas_lifetimes = PostProcessor.run
_numbas_elementwise = NumpyRulesArrayOperator.generic


@contextmanager
def spared() -> Iterator[None]:
    """Compile without what is only for those who work on Numba."""
    with ExitStack() as until_compiled:
        for owner, name, instead in _instead():
            if hasattr(owner, name):
                until_compiled.callback(setattr, owner, name, getattr(owner, name))
                setattr(owner, name, instead)
        yield


def _instead() -> list[tuple[Any, str, Any]]:
    """Whose attribute, its name, and what stands there meanwhile."""
    return [
        (event, "broadcast", _nothing),
        (getattr(ffi.lib, "_lock", None), "_cblist", []),  # tells events of each call of LLVM
        (type(errors.termcolor()), "_markup", _plain),
        (compiler_machinery, "enforce_no_dels", _nothing),  # checks Numba's own passes
        (Record, "__repr__", _words),
        (TargetConfig, "values", _values),
        (ir.Inst, "_rec_list_vars", _variables),
        (itanium_mangler, "_escape_string", _escaped),
        (_OverloadFunctionTemplate, "_get_impl", _compiled_for),
        (PostProcessor, "run", _lifetimes),
        (NumpyRulesArrayOperator, "generic", _elementwise),
    ]


def _nothing(*_: Any) -> None:
    pass


def _plain(_scheme: Any, message: str, *_: Any, **__: Any) -> str:
    return message


_escaped = cache(itanium_mangler._escape_string)


def _words(record: Any) -> str:
    """A record of dozens of fields, written out once: it does not change."""
    if not hasattr(record, "_innervate_words"):
        record._innervate_words = _numbas_words(record)
    return str(record._innervate_words)


def _values(config: Any) -> dict[str, Any]:
    """All options, those that were not set as they are by default, in their order."""
    return {**_defaults(config.__class__), **config._values}


@cache
def _defaults(kind: Any) -> dict[str, Any]:
    return {name: option.default for name, option in kind.options.items()}


def _compiled_for(template: Any, args: Any, kws: Any) -> Any:
    """A function for arguments of these types, whoever calls it."""
    key = template.context, tuple(args), tuple(kws.items())
    return template._impl_cache.get(key) or template._build_impl(key, args, kws)


def _lifetimes(processor: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
    """Where variables are alive is worked out when somebody asks; generators ask at once."""
    function = processor.func_ir
    if function.is_generator:
        _numbas_lifetimes(processor, emit_dels, extend_lifetimes)
        return
    function.blocks = transforms.canonicalize_cfg(function.blocks)
    function.variable_lifetime = VariableLifetime(function.blocks)
    function.generator_info = None
    if emit_dels:
        processor._insert_var_dels(extend_lifetimes=extend_lifetimes)


def _elementwise(template: Any, args: Any, kws: Any) -> Any:
    """How NumPy would do it element by element; numbers have no elements."""
    if all(isinstance(kind, Integer) for kind in args):
        return None
    return _numbas_elementwise(template, args, kws)


def _variables(_instruction: Any, held: Any) -> list[Any]:
    """All variables in what an instruction holds, in their order."""
    found: list[Any] = []
    _gather(held, found)
    return found


def _gather(held: Any, found: list[Any]) -> None:
    kind = type(held)
    if kind in NEVER_HELD:
        return
    if kind is ir.Var:
        found.append(held)
    elif isinstance(held, ir.Inst):
        found.extend(held.list_vars())
    elif isinstance(held, dict):
        for value in held.values():
            _gather(value, found)
    elif isinstance(held, list | tuple):
        for value in held:
            _gather(value, found)
