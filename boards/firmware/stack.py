"""The worst stack of an image: the longest way through its calls, as the compiler counts it."""

from __future__ import annotations

import re
from pathlib import Path

from boards.errors import BoardFailed

NODE = re.compile(r'node: \{ title: "([^"]+)" label: "[^"]*?(\d+) bytes \(static\)')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')
COUNTED = "-fcallgraph-info=su"  # has a compiler write beside its output who calls whom
INDIRECT = "__indirect_call"
LIBGCC = 8  # of its functions, which call nothing
# What is called by a pointer: the port layer, and the example's algorithms.
POINTED = ("port_", "innervate_example_", "board_random")
INTERRUPT = 32  # bytes that a Cortex-M puts there by itself


def worst(image: Path) -> int:
    """Bytes of stack from `main` on, with an interrupt on top; it was compiled with COUNTED.

    What is called by a pointer is taken for the deepest of all functions that are (POINTED).

    Raises:
        BoardFailed: a function's stack is not known, or something calls itself.
    """
    text = "".join(path.read_text() for path in image.parent.glob(f"{image.name}-*.ci"))
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
    pointed = [name for name in sizes if name.startswith(POINTED)]

    def depth(name: str, above: tuple[str, ...]) -> int:
        if name in above:
            raise BoardFailed(f"{name} calls itself")
        if name == INDIRECT:
            return max(depth(called, above) for called in pointed)
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
