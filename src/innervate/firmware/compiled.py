"""A role compiled for this machine: a shared library, made once for its sources and kept.

It knows neither Python nor a C library. Its name is a hash of all that it is made from, and stands
in the library, too: what was made from other sources is never taken. A wheel brings those of usual
nodes (`readying.py`), others are made and kept in the cache.
"""

import ctypes
import os
import platform
import sys
import tempfile
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

from innervate.dialect.source import numbers_of, reached
from innervate.firmware.errors import FirmwareError
from innervate.firmware.program import GIVEN
from innervate.firmware.records import records_of
from innervate.firmware.texts import filled, shipped
from innervate.firmware.tools import find, run
from innervate.kernel.cache import alone, cache_root
from innervate.kernel.sources import ROOT, hash_of
from innervate.live.board import Coded, Role

COMPILER = "cc"
SHIPPED, QUICK = ("innervate_wire.h", "innervate_wire.c"), frozenset({"quick"})
FOLDER = "nodes"  # below the cache
READY = ROOT / "firmware" / FOLDER  # those of a wheel; a checkout has none
KEPT_MOST = 32  # libraries; those not used for longest go first
MAKERS = ("firmware", "dialect", "wire")  # rooms that have a part in what is made


def key_of(role: Role, coded: Coded | None) -> str:
    """A hash of all that a role's library is made from, and for which machine."""
    modules = reached(role.entry)
    files = {Path(module.__file__ or "") for module in modules}
    numbers = [sorted(numbers_of(module).items()) for module in modules]
    for room in MAKERS:
        files |= {path for path in (ROOT / room).rglob("*") if path.suffix in (".py", ".c", ".h")}
    of = role._replace(noted=frozenset(), usual=())  # which C does not have; no order
    begun = f"{sys.platform} {platform.machine()}\0{of}\0{coded}\0{numbers}"
    return hash_of(begun, sorted(files), ROOT)


def handlers_of(role: Role) -> list[str]:
    """Names of the handlers that a role has."""
    module = import_module(role.entry)
    return [name for name in GIVEN if hasattr(module, name)]


def library_of(role: Role, coded: Coded | None) -> Any:
    """A role's library, from the wheel, from the cache, or made now.

    Raises:
        FirmwareError: the role cannot be said in C, there is no compiler, or it does not take it.
    """
    key = key_of(role, coded)
    path = cache_root() / FOLDER / f"{key}.so"
    found = _ready(key) or _kept(path, key)
    if found is None:
        find(COMPILER)
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with alone(path.with_suffix(".lock")):
            found = _kept(path, key) or _made(role, coded, path, key)
    return found


def _ready(key: str) -> Any:
    """The library that came with the toolkit, trusted as its sources are; None without one."""
    path = READY / f"{key}.so"
    return None if os.environ.get("INNERVATE_READY") == "0" else _open(path, key)


def _kept(path: Path, key: str) -> Any:
    """The library in the cache, if nobody else could have written it."""
    with suppress(OSError):
        about = path.stat()
        if about.st_uid in (0, os.getuid()) and not about.st_mode & 0o022:
            found = _open(path, key)
            if found is not None:
                os.utime(path)
            return found
    return None


def _open(path: Path, key: str) -> Any:
    """The library in a file, if it is whole, and made from this very role."""
    with suppress(OSError):
        if key.encode() in path.read_bytes():
            return ctypes.CDLL(str(path))
    return None


def _made(role: Role, coded: Coded | None, path: Path, key: str) -> Any:
    with tempfile.TemporaryDirectory(dir=path.parent, prefix="making-") as name:
        folder = Path(name)
        for file, text in texts_of(role, coded, key).items():
            (folder / file).write_text(text, encoding="utf-8")
        run(COMPILER, "-std=c99", "-O2", "-fPIC", "-shared", "-I", folder,
            *sorted(folder.glob("*.c")), "-o", folder / path.name)  # fmt: skip
        (folder / path.name).chmod(0o700)
        os.replace(folder / path.name, path)
    _forget(path.parent)
    found = _kept(path, key)
    if found is None:
        raise FirmwareError(f"{path}: was made, and cannot be taken; set INNERVATE_CACHE")
    return found


def texts_of(role: Role, coded: Coded | None, key: str) -> dict[str, str]:
    """What a library is made from, by file.

    Raises:
        FirmwareError: see Library.
    """
    from innervate.firmware.emit import Library  # half a second that a library at hand spares
    from innervate.firmware.wire import Wire

    library = Library(role, {})
    texts = library.texts()
    if coded is not None:
        texts |= Wire(library, coded).texts()
        texts |= {file: shipped(file, "", QUICK) for file in SHIPPED}
    texts["node.c"] = _entries(role, library.prefix, key)
    return texts


def _entries(role: Role, name: str, key: str) -> str:
    """What Python calls: the handlers, each with an empty outbox; sizes of the records."""
    sizes = [f"sizeof({name}_{record}_t)" for record in (*records_of(role), "out")]
    parts = [f'#include "{name}.h"', "", f'const char innervate_source[] = "{key}";',
             f"const int32_t innervate_sizes[] = {{{', '.join(sizes)}}};"]  # fmt: skip
    entry = shipped("made/entry.c", name)
    for handler in handlers_of(role):
        kinds = ["int32_t " if kind == "int" else f"const {name}_{kind}_t *"
                 for kind in GIVEN[handler]]  # fmt: skip
        words = {
            "@name": handler, "@gate_given": f"{name}_gate_t *gate, " if role.has_gate else "",
            "@given": ", ".join(f"{kind}a{i}" for i, kind in enumerate(kinds)),
            "@gate_passed": "gate, " if role.has_gate else "",
            "@passed": ", ".join(f"a{i}" for i in range(len(kinds))),
        }  # fmt: skip
        parts.append(filled(entry, words))
    return "\n".join(parts)


def _forget(folder: Path) -> None:
    """Those that were not used for longest are deleted."""
    found = sorted(folder.glob("*.so"), key=lambda path: path.stat().st_mtime, reverse=True)
    for path in found[KEPT_MOST:]:
        path.unlink(missing_ok=True)
