"""Commented scenarios of networks that were measured (`innervate new mesh --network`)."""

from __future__ import annotations

from typing import Any

from innervate.networks.mesh.scenario.nodes import NODES_MAX, found_at, nodes_of
from innervate.scenario.emit import inline
from innervate.scenario.load import loads
from innervate.topology.errors import TopologyError
from innervate.topology.measured import Measured

TOPOHUB = "topohub:"
MIN_TQ = 0.3
MIN_TQ_MAX = 0.5  # better links are not left out for the number of nodes
COMMENTS = {  # of the keys of [import], in their order
    "types": "links of JSON files that count; [] = all",
    "min_tq": "worse in either direction: as if there were no link",
    "around": "those about this node, as the file calls it",
    "nodes": "so many, the nearest first, by their better links",
    "largest_component": "the others have no way to it",
}

TEMPLATE = """\
# A network as it was measured: everybody has something to tell the gateway.
# Check it with `innervate check FILE`, run it with `innervate run FILE`.
kind = "mesh"
schema = 1
name = {name}
duration_s = 60.0             # simulated time
seed = 1                      # same seed, same run
# gateway = "..."             # a node by its name; the best connected one if left out

[import]
{imported}

[[flow]]                      # messages
from = "all"                  # a node, "all" or "random"
to = "gateway"
every_s = 10.0
jitter_s = 10.0

# [[event]]
# at_s = 30.0
# action = "kill"             # kill | revive | restart | cut | restore | jam | quiet
# random = 5                  # so many bystanders; or node = "..."
"""


def measured(name: str, network: str, wanted: dict[str, Any], folder: str) -> tuple[str, str]:
    """A commented scenario of a network that was measured, and what of it that takes.

    Where nothing is said of its size, what fits is chosen: links of 0.3 and better, better ones
    if those leave too many nodes, or the nodes about the best connected one.

    Args:
        name: of the scenario.
        network: a file as the scenario's folder sees it, a bundled one like "freifunk/leipzig", or
            "topohub:" and a name.
        wanted: what was chosen of it: types, min_tq, around, nodes.
        folder: the scenario's.

    Raises:
        ScenarioError: it cannot be read, or there is nothing as it was chosen.
    """
    wanted = {"types": ["wifi"], **wanted}
    first = loads(_text(name, network, wanted), folder=folder)
    whole, why = found_at(first.model.import_, first.source), ""
    if not {"min_tq", "around", "nodes"} & wanted.keys():
        fitting, why = _fitting(whole)
        wanted |= fitting
    wanted = {"min_tq": MIN_TQ} | wanted
    text = _text(name, network, wanted)
    made = loads(text, folder=folder)
    taken = nodes_of(made.model, made.source).names
    held = f"links of {wanted['min_tq']:g} and better hold them together"
    return text, f"Taken: {len(taken)} of {len(whole.names)} nodes; {held}{why}."


def _fitting(whole: Measured) -> tuple[dict[str, Any], str]:
    """What to choose of a network so that a mesh can have as many nodes, and why."""
    try:
        largest = whole.kept(MIN_TQ).largest()
    except TopologyError:
        return {}, ""  # said when the scenario is planned
    count = len(largest.names)
    if count <= NODES_MAX:
        return {}, ""
    least = whole.least_for(NODES_MAX, in_one=True)
    if least is not None and least <= MIN_TQ_MAX:
        return {"min_tq": least}, f"; those of {MIN_TQ:g} hold {count}, too many for a mesh"
    middle = largest.names[largest.best_connected()]
    why = f"; about the best connected one of {count}, too many for a mesh"
    return {"around": middle, "nodes": NODES_MAX}, why


def _text(name: str, network: str, chosen: dict[str, Any]) -> str:
    key, value = "file", network
    if network.startswith(TOPOHUB):
        key, value = "topohub", network.removeprefix(TOPOHUB)
    if not {"around", "nodes"} & chosen.keys():
        chosen = chosen | {"largest_component": True}
    lines = [f"{key} = {inline(value)}"]
    for key, words in COMMENTS.items():
        if key in chosen:
            lines.append(f"{f'{key} = {inline(chosen[key])}':<29} # {words}")
    return TEMPLATE.format(name=inline(name), imported="\n".join(lines))
