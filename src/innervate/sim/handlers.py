"""A protocol's functions as loops call them: the world and a node first; written out, as text."""

from collections.abc import Callable
from typing import Any, NamedTuple

# Of each: what it is called with behind the world, the node and its clock; what it hands on.
ARGUMENTS = {
    "on_start": ("cause", "cause"),
    "on_frame": ("frame", "0, frame"),
    "on_timer": ("timer", "timer"),
    "on_input": ("kind", "kind, {item}"),
    "on_carrier": ("cd, voc", "cd, voc"),
    "on_sent": ("ok", "ok"),
}
BY_PORT = ("port, frame", "port, frame")  # `on_frame` where nodes have several


class Given(NamedTuple):
    """What protocols are given of `world` and `node`: what stands first; an input; the outbox."""

    records: str = "world.stations[node], world.params[0]"
    item: str = "world.item[0]"
    out: str = "world.out"


STATION = Given()
MAC = Given("world.macs[node], world.mac_params[0]", "world.mac_item[0]", "world.mac_out")


def handlers(
    entry: Any,
    of: Given = STATION,
    before: str = "",
    look: Callable[..., None] | None = None,
    has_ports: bool = False,
) -> dict[str, Callable[..., Any]]:
    """Those of a protocol's functions that it has, by name; all of none, which do nothing.

    Args:
        entry: the module with its functions; None = there is none.
        of: what they are given.
        before: what stands before their names.
        look: is called after each, with the world and the node.
        has_ports: a frame comes with its port.
    """
    arguments = {**ARGUMENTS, "on_frame": BY_PORT} if has_ports else ARGUMENTS
    names = [name for name in arguments if entry is None or hasattr(entry, name)]
    its = {f"its_{name}": getattr(entry, name, None) for name in names}
    lines = [f"def bind({', '.join(its)}, look):"]
    for name in names:
        given, handed = arguments[name]
        call = f"its_{name}({of.records}, now, {handed.format(item=of.item)}, {of.out})"
        lines.append(f"    def {before}{name}(world, node, now, {given}):")
        lines.append(f"        {'pass' if entry is None else call}")
        lines += ["        look(world, node)"] if look else []
    lines.append(f"    return {', '.join(f'{before}{name}' for name in names)}")
    made: dict[str, Any] = {}
    exec(compile("\n".join(lines), "handlers of a protocol", "exec"), made)
    return {one.__name__: one for one in made["bind"](**its, look=look)}


def access_handlers(entry: Any) -> dict[str, Callable[..., Any]]:
    """The same of a medium access below a protocol in a field, `mac_` before their names."""
    return handlers(entry, MAC, "mac_")
