"""Compilation: which plain functions Numba may compile, and where compiled code is kept.

Numba's own cache does not notice an edit in another file, so the cache folder carries a hash of
every source that can end up in compiled code, of where it lies, and of the compiler's version.
"""

import contextlib
import hashlib
import inspect
import os
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from importlib import metadata
from pathlib import Path
from types import ModuleType
from typing import Any

from innervate.kernel import ready
from innervate.kernel.cache import alone, cache_root
from innervate.kernel.ready import Loop
from innervate.kernel.sources import NAME_LENGTH, ROOT, hash_of, homes, source_files
from innervate.kernel.stop import ends_at_once

CACHE_FOLDERS_MAX = 8

_registered: set[Callable[..., Any]] = set()
_foreign: set[Path] = set()  # files of other packages that the next loop is compiled from
_numbers: set[str] = set()  # that functions of such files take: module, name, value
_not_kept: list[str] = []  # what was compiled and could not be written


def register(*modules: ModuleType, hot: bool = True) -> None:
    """Let compiled code call every function that these modules define; each only once."""
    for module in modules:
        for function in vars(module).values():
            if inspect.isfunction(function) and function.__module__ == module.__name__:
                register_functions(function, hot=hot)


def modules_of(entry: ModuleType) -> list[ModuleType]:
    """All modules whose functions a protocol's functions call, directly or not."""
    found = [entry]
    for module in found:
        for thing in vars(module).values():
            if inspect.isfunction(thing):
                thing = sys.modules[thing.__module__]
            if inspect.ismodule(thing) and thing not in found:
                found.append(thing)
    return found


def bound(name: str, /, *functions: Iterable[Callable[..., Any]], **named: Any) -> ModuleType:
    """Functions under one roof, that compiled code can be handed: a module that is no file.

    Compiled code takes no other object of functions as an argument. Of equal names the first
    counts. `named` are functions, or modules of them, by other names than their own.
    """
    made = ModuleType(name)
    vars(made).update(named)
    for function in (one for some in functions for one in some):
        vars(made).setdefault(function.__name__, function)
    return made


def register_functions(*functions: Callable[..., Any], hot: bool = True) -> None:
    """Let compiled code call these plain functions; hot ones become part of their callers.

    Nothing else calls them: without a wrapper for C each, a loop compiles a fifth faster.
    """
    from numba.extending import register_jitable

    from innervate.kernel import lowering  # noqa: F401 - what it tells Numba of our tables

    for function in functions:
        _note(function)
        if function not in _registered:
            register_jitable(forceinline=hot, no_cfunc_wrapper=True)(function)
            _registered.add(function)


def _note(function: Callable[..., Any]) -> None:
    """A function of a network elsewhere makes its file part of what is compiled next."""
    path = Path(function.__code__.co_filename)
    if not path.is_absolute():
        return  # written out as the program runs: `told` says what it is
    if not path.is_relative_to(ROOT):
        _foreign.add(path)
        _numbers.update(_taken(function))
    elif not _is_hashed(path):
        raise RuntimeError(f"{path} is compiled, and no part of what the cache is known by")


def _taken(function: Callable[..., Any]) -> Iterator[str]:
    """Numbers that compiled code takes from a function's module, or from modules named there."""
    used, known = function.__code__.co_names, function.__globals__
    for home in (known, *(vars(known[n]) for n in used if inspect.ismodule(known.get(n)))):
        for name in used:
            if isinstance(home.get(name), int | float | tuple):
                yield f"{home.get('__name__')}.{name} {told(home[name])}"


@cache
def _is_hashed(path: Path) -> bool:
    return any(map(path.is_relative_to, homes(ROOT)))


def source_hash(root: Path = ROOT) -> str:
    """Hash of all sources that compiled code can come from, of what compiles it, and of where.

    Args:
        root: of the toolkit's sources.

    Numba takes nothing from its cache that was compiled from files elsewhere: of the same version
    in another environment nothing is compiled yet.
    """
    begun = f"{root}\0{sys.version_info[:3]} {metadata.version('numba')}"
    return hash_of(begun, source_files(root), root)


def open_cache() -> Path:
    """Point Numba at the cache folder of the present sources; forget the oldest others.

    What is compiled from a network elsewhere has a folder in it for each state of its files and of
    the numbers that they take from others: who edits a protocol compiles that, and what the
    toolkit's own loops were compiled to stays.
    """
    folder = own = cache_root() / source_hash()
    if _foreign:
        folder = own / hash_of(" ".join(sorted(_numbers)), sorted(_foreign))
    _foreign.clear()
    _numbers.clear()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for one in {own, folder}:
            os.utime(one)
            _forget_old(one)
    except OSError:
        pass  # a read-only home: Numba then compiles without keeping the result
    import numba

    numba.config.CACHE_DIR = str(folder)
    return folder


def _forget_old(keep: Path) -> None:
    others = [p for p in keep.parent.iterdir()
              if p.is_dir() and p != keep and len(p.name) == NAME_LENGTH]  # fmt: skip
    others.sort(key=lambda p: p.stat().st_mtime, reverse=True)
    for stale in others[CACHE_FOLDERS_MAX - 1 :]:
        shutil.rmtree(stale, ignore_errors=True)


def mark_compiled(name: str) -> None:
    """Remember in the cache folder that a loop is compiled, unless it came with the toolkit."""
    if ready.is_ready(name) or _not_kept:
        return
    import numba

    with contextlib.suppress(OSError):  # nothing is kept where nothing can be written
        (Path(numba.config.CACHE_DIR) / f"{name}.compiled").touch()


def is_compiled(name: str) -> bool:
    """True if that loop came with the toolkit, or is in the cache folder of the sources."""
    return ready.is_ready(name) or (cache_root() / source_hash() / f"{name}.compiled").exists()


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """`function` compiled by Numba, kept in the cache folder, without the interpreter lock.

    One process compiles it: others that want it at the same time wait, and take it from the cache.
    """
    return _compiled(function, lambda _name: contextlib.nullcontext())


def compiled_as_one(function: Callable[..., Any]) -> Callable[..., Any]:
    """As `compiled`, in half the time, for loops over hundreds of functions (see linking.py)."""
    from innervate.kernel.linking import as_one

    return _compiled(function, as_one)


def loop(name: str, jitted: Callable[[], Any]) -> Loop:
    """A loop over a world of arrays, ready if it came with the toolkit, or else compiled.

    Args:
        name: of what it runs (see `ready.Loop`); "" = never ready.
        jitted: registers what it calls and makes it, as `compiled_as_one` does.
    """

    def advance() -> Callable[[Any, int, int], None]:
        from innervate.kernel import tables

        return tables.Lending(jitted())

    return Loop(name, advance)


def is_own(module: ModuleType) -> bool:
    """True for a module of the toolkit itself, as it was imported: not a copy, not a folder's."""
    name = module.__name__
    return name.startswith("innervate.") and sys.modules.get(name) is module


def _compiled(function: Callable[..., Any], way: Callable[[str], Any]) -> Callable[..., Any]:
    import numba

    from innervate.kernel import lowering  # noqa: F401 - what it tells Numba of our tables

    folder = open_cache()
    numba.config.SLP_VECTORIZE = 1  # a tenth faster: frames are copied in whole words
    jitted = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    _know_by_words(jitted)
    compile_or_load = jitted.compile
    bound_to = [cell.cell_contents for cell in function.__closure__ or ()]
    name = [function.__module__, function.__qualname__]
    name += [getattr(thing, "__name__", "") for thing in bound_to]

    def compile_once(signature: Any) -> Any:
        known = hashlib.blake2b(f"{name} {signature}".encode(), digest_size=10).hexdigest()
        with ends_at_once(), alone(folder / f"{known}.lock"), way(function.__qualname__):
            try:
                return compile_or_load(signature)
            except OSError:  # compiled it is; on a full disk it cannot be kept
                _not_kept.append(function.__qualname__)
                return compile_or_load(signature)

    jitted.compile = compile_once
    return jitted


def _know_by_words(jitted: Any) -> None:
    """Have Numba find a function in its cache by what it is bound to, in words.

    Numba's own key is a pickle, which is another where a module was read from its source than where
    it was translated before: who edited a file had its loops compiled twice.
    """
    kept: Any = getattr(jitted, "_cache", None)
    if not hasattr(kept, "_index_key"):
        return  # a Numba that has changed keeps its own way
    words = hashlib.sha256(repr(told(jitted.py_func)).encode()).hexdigest()
    kept._index_key = lambda signature, codegen: (signature, codegen.magic_tuple(), words)


def told(thing: Any, above: tuple[Any, ...] = ()) -> Any:
    """What compiled code is made of or bound to, in words that are the same in every process.

    Args:
        thing: a function, a module, or a value.
        above: what it is part of.

    What lies in files is known by the cache folder's name; what is written out as a program runs,
    and what is bound, is told here.
    """
    from numba.core.serialize import dumps

    if any(thing is one for one in above):
        return "itself"
    inside = (*above, thing)
    if inspect.ismodule(thing):
        if getattr(thing, "__file__", thing.__spec__) is not None:
            return thing.__name__
        named = sorted((name, one) for name, one in vars(thing).items() if name[:2] != "__")
        return thing.__name__, [(name, told(one, inside)) for name, one in named]
    if inspect.isfunction(thing):
        cells = [told(cell.cell_contents, inside) for cell in thing.__closure__ or ()]
        return thing.__module__, thing.__qualname__, told(thing.__code__, inside), cells
    if inspect.iscode(thing):
        return thing.co_firstlineno, thing.co_code.hex(), thing.co_names, told(thing.co_consts)
    if isinstance(thing, tuple):
        return [told(one, inside) for one in thing]
    if thing is None or isinstance(thing, str | int | float):
        return thing
    return hashlib.sha256(dumps(thing)).hexdigest()
