"""Ready loops: machine code that comes with a wheel, so that a first run has nothing to compile.

A loop is one function of the C language's calling convention over addresses and lengths of tables;
it knows neither Python nor Numba, and asks nothing of a machine but memory to be set and copied.
It is taken only if it was made of the very sources that are installed here, for this system and
processor, and for tables of exactly this form. `readying.py` makes them, `make dist` puts them
into the wheel; without them loops are compiled (compilation.py). To go without: INNERVATE_READY=0.
"""

import ctypes
import hashlib
import json
import os
import platform
import sys
import zlib
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np

from innervate.kernel.sources import ROOT, content_hash

FORM = 1  # of a loop's arguments, and of what stands in `about.json`
ENTRY = "innervate_loop"
ABOUT = "about.json"
FOLDER = ROOT / "kernel" / "loops"
# What compiled code may ask of the machine that it runs on.
ASKED = ("memset", "memcpy", "memmove")
# x86-64-v3, ten years of processors: code for any x86-64 is slower by a sixth, this is not.
BASELINES: dict[str, tuple[str, tuple[str, ...]]] = {
    "x86_64": ("x86-64-v3", (
        "sse3", "ssse3", "sse4.1", "sse4.2", "popcnt", "cx16", "avx", "avx2", "bmi", "bmi2",
        "f16c", "fma", "lzcnt", "movbe",
    )),
}  # fmt: skip
ANY: tuple[str, tuple[str, ...]] = ("generic", ())

Advance = Callable[[Any, int, int], None]


class Loop:
    """A loop that is taken as it came with the toolkit, or else compiled when it is first run.

    Args:
        name: what it runs, the same for the same functions; "" = it never comes ready.
        compile: makes the compiled loop: (world, until_us, budget of events).
    """

    def __init__(self, name: str, compile: Callable[[], Advance]) -> None:
        self.name = name
        self._compile = compile
        self._taken: dict[Any, Advance] = {}
        self._compiled: Advance | None = None

    def __call__(self, world: Any, until: int, budget: int) -> None:
        """Advance a world of tables."""
        if not self.name or self._compiled is not None:
            self.compiled(world, until, budget)
            return
        arrays = list(_arrays(world))
        form = type(world), tuple((array.dtype, array.shape[1:]) for array in arrays)
        advance = self._taken.get(form)
        if advance is None:
            advance = self._taken[form] = load(self.name, world) or self.compiled
        advance(world if advance == self.compiled else arrays, until, budget)

    def compiled(self, world: Any, until: int, budget: int) -> None:
        """Advance it by the compiled loop, whether there is a ready one or not."""
        if self._compiled is None:
            self._compiled = self._compile()
        self._compiled(world, until, budget)


def target() -> str:
    """What code is made for here: system and processor, as `linux-x86_64`."""
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower())
    bits = "" if sys.maxsize > 1 << 32 else "-32"
    return f"{sys.platform}-{machine or platform.machine().lower()}{bits}"


def baseline() -> tuple[str, tuple[str, ...]]:
    """The least processor that ready loops are made for: LLVM's name, and what it must have."""
    return BASELINES.get(target().partition("-")[2], ANY)


@cache
def about() -> dict[str, Any]:
    """What is said of the ready loops; {} if there are none, or none that fits this machine."""
    if os.environ.get("INNERVATE_READY") == "0":
        return {}
    try:
        found: dict[str, Any] = json.loads((FOLDER / ABOUT).read_text("utf-8"))
        dict(found["loops"])
        fits = (found["form"], found["target"]) == (FORM, target())
        if fits and found["sources"] == content_hash() and _has(found["features"]):
            return found
    except (OSError, ValueError, LookupError, TypeError, ImportError):
        pass  # no loops, or none that can be trusted: compile
    return {}


def _has(features: list[str]) -> bool:
    """True if this processor has all of that."""
    if not features:
        return True
    import llvmlite.binding as llvm

    here = llvm.get_host_cpu_features()
    return all(here.get(name, False) for name in features)


def is_ready(name: str) -> bool:
    """True if the loop of this name (see `loop_name` of a network) came with the toolkit."""
    return name in about().get("names", ())


def key_of(name: str, world: Any) -> str:
    """A loop over tables of one form, in one word: what its file is called."""
    return hashlib.blake2b(f"{name}\0{form_of(world)}".encode(), digest_size=12).hexdigest()


def form_of(value: Any) -> str:
    """The form of a world of tables: names, and where in memory each number stands."""
    if isinstance(value, np.ndarray):
        return f"{_layout(value.dtype)}*{value.shape[1:]}"
    fields = getattr(value, "_fields", range(len(value)))
    parts = (f"{name}={form_of(part)}" for name, part in zip(fields, value, strict=True))
    return f"{type(value).__name__}({','.join(parts)})"


def _layout(kind: np.dtype[Any]) -> str:
    if kind.subdtype is not None:
        return f"{_layout(kind.subdtype[0])}{kind.subdtype[1]}"
    if kind.fields is None:
        return kind.str
    found = (f"{name}@{kind.fields[name][1]}:{_layout(kind.fields[name][0])}"
             for name in kind.names or ())  # fmt: skip
    return f"[{kind.itemsize}|{kind.isalignedstruct}|{' '.join(found)}]"


def _arrays(value: Any) -> Iterator[Any]:
    """The arrays of a world in order, which is that of the loop's arguments."""
    if isinstance(value, np.ndarray):
        yield value
    else:
        for part in value:
            yield from _arrays(part)


def load(name: str, world: Any) -> Advance | None:
    """The ready loop of a name for worlds like this, over their arrays; None if none fits."""
    key = key_of(name, world)
    digest = about().get("loops", {}).get(key)
    if digest is None:
        return None
    try:
        packed = (FOLDER / f"{key}.o.z").read_bytes()
        if hashlib.blake2b(packed, digest_size=16).hexdigest() != digest:
            return None
        return called(address_of(zlib.decompress(packed)), sum(1 for _ in _arrays(world)))
    except (OSError, zlib.error, ImportError, RuntimeError, AttributeError, TypeError):
        return None  # a library that has changed, or half a file: compile


_engines: list[Any] = []  # what holds the code's memory


def address_of(code: bytes) -> int:
    """Put an object file's machine code into memory, for as long as this process lasts."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_triple(llvm.get_process_triple())
    options = machine.create_target_machine(codemodel="jitdefault", jit=True)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), options)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)
    address: int = engine.get_function_address(ENTRY)
    if not address:
        raise RuntimeError(f"{ENTRY} is not in a ready loop")
    return address


def called(address: int, tables: int) -> Advance:
    """The loop at an address, over the arrays of a world, without the interpreter lock."""
    number = ctypes.c_int64
    function = ctypes.CFUNCTYPE(ctypes.c_int32, *[number] * (2 * tables + 4))(address)

    def advance(arrays: list[Any], until: int, budget: int) -> None:
        result, failure, given = number(), number(), []
        for array in arrays:
            if not array.flags.c_contiguous:
                raise ValueError("a table needs contiguous memory")
            given += [array.ctypes.data, len(array)]
        places = ctypes.addressof(result), ctypes.addressof(failure)
        status = function(*places, *given, int(until), int(budget))
        if status not in (0, -2):  # -2: it returns None
            raise RuntimeError(f"a ready loop ended with status {status}")

    return advance
