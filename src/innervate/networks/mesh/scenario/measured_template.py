"""Commented scenarios of networks that were measured (`innervate new mesh --network`)."""

from typing import Any

from innervate.networks.mesh.protocol.fields import NEIGHBOURS
from innervate.networks.mesh.scenario.nodes import NODES_MAX, Nodes, found_at, nodes_of
from innervate.scenario.bundled import text_of
from innervate.scenario.emit import inline
from innervate.scenario.load import loads
from innervate.topology.errors import TopologyError
from innervate.topology.measured import Measured
from innervate.topology.placement import neighbours

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
# What suits links that lose much: a hop or a request that is lost is sent again, and there is time
# for it; whoever gave a packet back is soon asked again. Found on community meshes of 36 to 254
# nodes (decision 0038); two tables at a time, and rounds 20 s apart, leave room for messages
# (0069).
TUNED = {
    "copies": 4, "transmissions": 10, "jitter_s": 0.1, "listen_s": 1.0, "spread_s": 0.4,
    "collect_s": 4.0, "period_s": 20.0, "period_max_s": 40.0, "table_window": 2, "table_tries": 3,
    "e2e_s": 3.0, "e2e_tries": 8, "forget_s": 120.0, "guard_s": 0.5,
}  # fmt: skip
# In large networks, and where a hub has many neighbours that do not hear each other, what they
# pass on meets at it: they have to take their time, and tables do not get through.
CROWD = 120  # nodes
CROWD_TUNED = {
    **TUNED, "transmissions": 4, "jitter_s": 1.0, "listen_s": 3.0, "spread_s": 3.0,
    "collect_s": 9.0, "period_s": 20.0, "period_max_s": 60.0, "e2e_s": 4.0, "tables": False,
}  # fmt: skip


GATEWAY = """\
# gateway = "..."             # a node by its name; the best connected one if left out
"""
CLUSTERS = """\

[clusters]                    # several meshes, each on a channel of its own
gateways = {gateways:<18} # so many, amidst the others; or their names
run = 1                       # which of them is run
"""


def measured(name: str, network: str, wanted: dict[str, Any], folder: str) -> tuple[str, str]:
    """A commented scenario of a network that was measured, and what of it that takes.

    Where nothing is said of its size, what fits is chosen: links of 0.3 and better, better ones
    if those leave too many nodes, or the nodes about the best connected one.

    `network` is a file as the scenario's folder sees it, a bundled one like "freifunk/leipzig", or
    "topohub:" and a name; `wanted` has what was chosen of it: types, min_tq, around, nodes;
    gateways, for clusters. Raises ScenarioError: it cannot be read, or nothing is as it was chosen.
    """
    wanted = {"types": ["wifi"], **wanted}
    first = loads(_text(name, network, wanted), folder=folder)
    whole, why = found_at(first.model.import_, first.source), ""
    if not {"min_tq", "around", "nodes", "gateways"} & wanted.keys():
        fitting, why = _fitting(whole)
        wanted |= fitting
    wanted = {"min_tq": MIN_TQ} | wanted
    bare = loads(_text(name, network, wanted), folder=folder)
    taken = nodes_of(bare.model, bare.source)
    clusters = wanted.get("gateways", 1)
    text = _text(name, network, wanted, tuned(taken, clusters))
    held = f"links of {wanted['min_tq']:g} and better hold them together{why}"
    parts = f", in {clusters} clusters" if clusters > 1 else ""
    return text, f"Taken: {len(taken.names)} of {len(whole.names)} nodes{parts}; {held}."


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
    why = (
        f"; about the best connected one of {count}, too many for a mesh: --gateways makes several"
    )
    return {"around": middle, "nodes": NODES_MAX}, why


def tuned(taken: Nodes, clusters: int = 1) -> dict[str, Any]:
    """The keys of [protocol] that suit a measured network, or so many parts of it."""
    links = [pair for pair, both in taken.links.items() if min(both) > 0]
    most = max(len(near) for near in neighbours(len(taken.names), links))
    crowd = len(taken.names) > clusters * CROWD or most > NEIGHBOURS
    return CROWD_TUNED if crowd else TUNED


def _text(
    name: str, network: str, chosen: dict[str, Any], protocol: dict[str, Any] | None = None
) -> str:
    key, value = "file", network
    if network.startswith(TOPOHUB):
        key, value = "topohub", network.removeprefix(TOPOHUB)
    if not {"around", "nodes"} & chosen.keys():
        chosen = chosen | {"largest_component": True}
    lines = [f"{key} = {inline(value)}"]
    for key, words in COMMENTS.items():
        if key in chosen:
            lines.append(f"{f'{key} = {inline(chosen[key])}':<29} # {words}")
    gateway = GATEWAY
    if "gateways" in chosen:
        gateway = CLUSTERS.format(gateways=chosen["gateways"])
    settings = [f"{key} = {inline(value)}" for key, value in (protocol or {}).items()]
    return text_of(__package__, "measured.txt").format(
        name=inline(name),
        gateway=gateway,
        imported="\n".join(lines),
        protocol="\n".join(settings),
    )
