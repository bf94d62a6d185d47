"""What cannot work of a declared network's scenario, whatever its medium, told before it runs."""

from collections.abc import Iterator
from typing import Any

from innervate.network import networks
from innervate.topology.placement import components, neighbours

SHOWN = 4
NODE = "node"  # the unit of fields that name one


def warnings(plan: Any, near: list[tuple[int, int]], start_us: int = 0) -> list[str]:
    """A sentence for each thing; `near` are pairs that hear each other, `start_us` as in plans."""
    network = networks()[plan.kind]
    own = network.foreseen(plan) if network.has("foreseen") else ()
    return [*_late(plan, start_us), *_apart(_count(plan), near), *_nobody(plan, network), *own]


def _count(plan: Any) -> int:
    return int(plan.graph.cells if hasattr(plan, "graph") else plan.nodes)


def _late(plan: Any, start_us: int) -> Iterator[str]:
    if start_us > plan.duration_us:
        yield (
            f"nodes are switched on within {start_us / 1e6:g} s, and duration_s is "
            f"{plan.duration_us / 1e6:g}: not all ever are; make start_us smaller"
        )


def _apart(count: int, near: list[tuple[int, int]]) -> Iterator[str]:
    """Nodes that no way leads to."""
    parts = components(neighbours(count, near))
    if len(parts) > 1:
        cut = [node for part in parts[1:] for node in part]
        more = f" and {len(cut) - SHOWN} more" if len(cut) > SHOWN else ""
        yield (
            f"the network falls into {len(parts)} parts: no way leads from the largest, of "
            f"{len(parts[0])}, to nodes {', '.join(map(str, cut[:SHOWN]))}{more}"
        )


def _nobody(plan: Any, network: Any) -> Iterator[str]:
    """Parameters and inputs that name a node which is not there."""
    last, model = _count(plan) - 1, plan.scenario.model
    for name, _length, _low, _high, unit, _meaning in network.fields.PARAMS:
        if unit == NODE and model.protocol.get(name, 0) > last:
            value = model.protocol[name]
            yield f"protocol.{name} = {value}, but nodes are 0 to {last}: nobody is it"
    # The greatest value of a field often stands for all.
    named = {name: high for name, _, _, high, unit, _ in network.fields.FRAME if unit == NODE}
    for place, given in enumerate(getattr(model, "input", ())):
        for name, value in given.item.items():
            if name in named and isinstance(value, int) and last < value < named[name]:
                where = f"input.{place}.item.{name}"
                yield f"{where} = {value}, but nodes are 0 to {last}: nobody is it"
