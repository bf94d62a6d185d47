"""Frames that nodes of a declared network send and deliver, looked at before they leave a call.

On a wire a value has the bits of its layout, and in C the width of its declared range: one beyond
that would be another there, or none, and only a simulation would carry it.
"""

from collections.abc import Callable
from typing import Any

from innervate.dialect.folder import MEASURED
from innervate.dialect.outbox import DELIVER, SEND
from innervate.kernel.records import Declaration
from innervate.network import dropped_of

FRAME_BROKEN, KIND_BROKEN = 62, 63  # `run.broken`, below what a network's own rules have
WORDS = {
    FRAME_BROKEN: "a frame of {node} has a value out of its declared range",
    KIND_BROKEN: "a frame of {node} is of a kind that has no layout",
}


def look_of(declared: Declaration, layouts: Any = ()) -> Callable[..., None]:
    """`look(world, node)`: marks a run as broken by what a call has put into its outbox.

    What a layout has no bits for is not sent: as on a wire, it is 0 where it arrives.

    Args:
        declared: the fields of a frame.
        layouts: of the kinds that a frame which is sent may have; () = any.
    """
    lines = []
    for name, length, low, high, *_ in declared:
        if name not in MEASURED:
            lines += [f"    for k in range({length}):"] if length else []
            place, by = (f"{name}[k]", "    ") if length else (name, "")
            lines += [f"    {by}beyond |= (frame.{place} < {low}) | (frame.{place} > {high})"]
    known = " or ".join(f"frame.kind == {kind}" for kind, *_ in layouts)
    clears = _clears(declared, dropped_of(declared, layouts))
    text = "\n".join([
        "def is_declared(frame):", "    beyond = False", *lines, "    return not beyond",
        "def has_layout(frame):", f"    return {known or True}",
        "def clear(frame):", *clears,
        "def look(world, node):",
        "    run, out = world.run[0], world.out",
        "    if run.checks and run.broken == 0:",
        "        for i in range(out.count[0]):",
        "            what = out.action[i].kind",
        f"            if what == {SEND} or what == {DELIVER}:",
        "                if not is_declared(out.frame[i]):",
        f"                    run.broken, run.broken_node = {FRAME_BROKEN}, node",
        f"                elif what == {SEND} and not has_layout(out.frame[i]):",
        f"                    run.broken, run.broken_node = {KIND_BROKEN}, node",
        "    for i in range(out.count[0]):",
        f"        if out.action[i].kind == {SEND}:",
        "            clear(out.frame[i])",
    ])  # fmt: skip
    made: dict[str, Any] = {}
    exec(compile(text, "what a protocol sends", "exec"), made)
    look: Callable[..., None] = made["look"]
    return look


def _clears(declared: Declaration, dropped: dict[int, set[str]]) -> list[str]:
    """The lines that make 0 what a frame's layout has no bits for."""
    lines = []
    for kind, names in dropped.items():
        lines += [f"    if frame.kind == {kind}:"] if names else []
        for name, length, *_ in declared:
            if name in names and length:
                lines += [f"        for k in range({length}):", f"            frame.{name}[k] = 0"]
            elif name in names:
                lines += [f"        frame.{name} = 0"]
    return lines or ["    return"]


def parts_of(look: Callable[..., None]) -> dict[str, Callable[..., Any]]:
    """What a look calls, and itself, by name: to be compiled with it."""
    names = ("is_declared", "has_layout", "clear", "look")
    return {name: look.__globals__[name] for name in names}
