"""The worst stack of an image: the longest way through its calls, as the compiler counts it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from boards.errors import BoardFailed
from innervate.firmware.tools import SMALL, run, sources

NODE = re.compile(r'node: \{ title: "([^"]+)" label: "[^"]*?(\d+) bytes \(static\)')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')
INDIRECT = "__indirect_call"
LIBGCC = 8  # of its functions, which call nothing
INTERRUPT = 32  # bytes that a Cortex-M puts there by itself


def worst(folder: Path, prefix: str, main: str, options: Iterable[str], out: Path) -> int:
    """Bytes of stack from `main` on, with an interrupt on top.

    What is called by a pointer is taken for the deepest of the functions of the port layer.

    Raises:
        BoardFailed: a function's stack is not known, or something calls itself.
    """
    text = ""
    for source in sources(folder, prefix, main):
        made = out / f"{source.stem}.o"
        asked = ("-fcallgraph-info=su", "-c", source, "-o", made)
        run("arm-none-eabi-gcc", *options, *SMALL, "-I", folder, *asked)
        text += made.with_suffix(".ci").read_text()
    return chain(text, "main") + INTERRUPT + chain(text, "board_interrupt")


def chain(text: str, begin: str) -> int:
    """Bytes of stack of the deepest function whose name begins so, with all that it calls.

    Args:
        text: what compilers say of calls (-fcallgraph-info=su).
        begin: how the names of functions begin.

    Raises:
        BoardFailed: a function's stack is not known, or something calls itself.
    """
    sizes = {_bare(name): int(size) for name, size in NODE.findall(text)}
    calls: dict[str, list[str]] = {}
    for caller, called in EDGE.findall(text):
        calls.setdefault(_bare(caller), []).append(_bare(called))
    ports = [name for name in sizes if name.startswith("port_")]

    def depth(name: str, above: tuple[str, ...]) -> int:
        if name in above:
            raise BoardFailed(f"{name} calls itself")
        if name == INDIRECT:
            return max(depth(port, above) for port in ports)
        if name not in sizes:
            if name.startswith("__"):
                return LIBGCC
            raise BoardFailed(f"the stack of {name} is not known")
        inner = [depth(called, (*above, name)) for called in set(calls.get(name, []))]
        return sizes[name] + max(inner, default=0)

    return max(depth(name, ()) for name in sizes if name.startswith(begin))


def _bare(name: str) -> str:
    """A function's name without its file."""
    return name.rpartition(":")[2]
