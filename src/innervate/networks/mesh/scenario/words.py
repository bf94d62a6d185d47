"""A mesh scenario in a few lines, without running it; and what somebody should know before."""

from itertools import pairwise
from math import ceil, dist
from typing import Any

from innervate.networks.mesh.protocol import constants as c
from innervate.networks.mesh.scenario.distribution import first_round, graph_nodes_max
from innervate.networks.mesh.scenario.fence import is_outside
from innervate.networks.mesh.scenario.foreseen import foreseen
from innervate.networks.mesh.scenario.model import MeshScenario
from innervate.networks.mesh.scenario.nodes import RESERVED, count_of, listed
from innervate.networks.mesh.scenario.plan import MeshFault, MeshPlan
from innervate.networks.mesh.scenario.profiles import PROFILES
from innervate.scenario.actions.field import JAM, TARGETS
from innervate.scenario.events import opening, told
from innervate.scenario.robots import Walk
from innervate.topology.placement import distances, neighbours

NEIGHBOURS_MIN, GATEWAY_MIN = 3, 5  # rules for planning WirelessHART networks [mesh 9]
STAR = 2 / 3  # share of nodes with a single link
# Up to so many nodes all had what they need within a minute (250k) or four (38k4) in our runs,
# at 8 neighbours each; of 230 nodes at 250k 138 had tables in one run of three, of 150 with rounds
# as short as a standby wants them 138, of 70 at 38k4 62 [mesh 8.2].
TABLES_MAX = {"38k4": 50, "250k": 200}
TABLES_MAX_BEHIND_STANDBY = {"38k4": 50, "250k": 120}
GRAPH_MAX = {"38k4": 70, "250k": 100}
# Of a message in 10 s from each of 100 nodes to others 98.5 % came before there was a graph, and
# with ways on demand 98.7; of 150 nodes 81.4 and 99.6; to the gateway no more [decision 0071].
EARLY_MAX = {"250k": 100}
# A robot that errs by 0.5 m anew at every sample raised 452 false alarms an hour with a `clear_m`
# of 0.2 m, 197 with 1 m and one with 3 m (docs/mesh.md, robots that err).
CLEAR_SIGMAS = 6
SOURCE_ROUTE_MAX = 19  # hops; at an MTU of 64 tables do not fit beside longer routes [mesh 2]


def describe(made: MeshPlan) -> str:
    """A plan in words, several lines, without a newline at the end."""
    model: MeshScenario = made.scenario.model
    params, gateway = made.params, made.gateway
    names = [made.names[made.ranks.index(rank)] for rank in range(1, max(made.ranks) + 1)]
    standby = f", standby {listed(names)}" if names else ""
    monitor = "the gateway" if params["monitor"] == c.MONITOR else made.names[params["monitor"]]
    hops = [far for far in hops_from(made, gateway) if far >= 0]
    degree = 2 * len(made.good) / made.nodes
    far = f"at most {count_of(max(hops), 'hop')} from the gateway" if max(hops) else "all alone"
    lines = [
        opening(made),
        *_cluster(made),
        f"  nodes      {made.nodes}, gateway {made.names[gateway]}{standby}, monitor {monitor}",
        f"  radio      {model.radio.profile}, {made.mac}, {count_of(len(made.good), 'good link')}, "
        f"{degree:.1f} a node, {far}",
        f"  protocol   discovery {model.protocol.discovery}, "
        f"failover {forwarding(made)}, MTU {params['mtu']}, "
        f"a round every {params['period'] * params['tick_us'] / 1e6:g} s",
    ]
    if made.offers:
        flows = count_of(len({offer.flow for offer in made.offers}), "flow")
        lines.append(f"  messages   {len(made.offers):,} in {flows}")
    if model.fence is not None:
        corners = count_of(params["points"], "corner")
        holes = count_of(len(model.fence.holes), "hole")
        lines.append(
            f"  fence      {corners}, {holes}, {params['unit_cm']} cm, "
            f"robots sampled at {1e6 / made.sample_us:g} Hz"
        )
    if made.walks:
        lines.append(f"  robots     {listed([made.names[walk.node] for walk in made.walks], 8)}")
    return "\n".join([*lines, *told(made, fault_words, warnings(made))])


def forwarding(made: MeshPlan) -> str:
    """How packets find their way; of "auto" what that is here, and why."""
    failover, mode = made.scenario.model.protocol.failover, made.params["mode"]
    if failover != "auto":
        return str({c.WHOLE_GRAPH: "graph", c.TABLE_FREE: "table-free"}.get(mode, failover))
    near = neighbours(made.nodes, made.good)
    tables_us, graph_us = first_round(made.radio, made.params, near, made.gateway)
    takes = f"{graph_us / 1e6:.2f} s on the air"
    if made.nodes > graph_nodes_max(made.params["mtu"]):
        takes = f"holds {graph_nodes_max(made.params['mtu'])} nodes"
    chosen = "graph" if mode == c.WHOLE_GRAPH else "search"
    return f"{chosen} (auto: tables {tables_us / 1e6:.2f} s, the graph {takes})"


def _cluster(made: MeshPlan) -> list[str]:
    """Of several clusters which one this is, and how large all are."""
    found = made.cluster
    if found is None:
        return []
    sizes = ", ".join(
        f"{name} {size}" for name, size in zip(found.gateways, found.sizes, strict=True)
    )
    lines = [f"  clusters   {found.words}; nodes of each gateway: {sizes}"]
    if len(found.sizes) > 1:
        lines.append(
            f"             the others: clusters.run = 1 to {len(found.sizes)}, or all in a row: "
            f"innervate sweep FILE --vary clusters.run=1..{len(found.sizes)} --paired clusters.run"
        )
    return lines


def warnings(made: MeshPlan) -> list[str]:
    """What makes a mesh weaker than it looks; one line each, none if all is well."""
    model: MeshScenario = made.scenario.model
    found = []
    near = neighbours(made.nodes, made.good)
    gateway = made.gateway
    leaves = sum(len(around) == 1 for around in near)
    if made.nodes > NEIGHBOURS_MIN and leaves >= STAR * made.nodes:
        found.append(
            f"nearly a star: {leaves} of {made.nodes} nodes have a single link, so nothing can be "
            "routed around anybody"
        )
    else:
        found += _thin(made, near, gateway)
    hops = hops_from(made, gateway)
    if max(hops) > c.PATH_MAX:
        far = [made.names[node] for node, count in enumerate(hops) if count > c.PATH_MAX]
        found.append(f"{listed(far)}: more than {c.PATH_MAX} hops over good links, the longest "
                     "path, to the gateway")  # fmt: skip
    elif max(hops) > SOURCE_ROUTE_MAX and made.params["mtu"] == 64:
        far = [made.names[node] for node, count in enumerate(hops) if count > SOURCE_ROUTE_MAX]
        found.append(f"{listed(far)}: over good links too far for tables at an MTU of 64; set "
                     "protocol.mtu = 127")  # fmt: skip
    found += [*_distribution(made), *_early(made)]
    if model.fence is not None and not made.walks:
        found.append("a fence but no [[robot]]: nobody can cross it")
    found += [*_outside(made), *_astray(made), *foreseen(made)]
    offered = {offer.flow for offer in made.offers}
    found += [
        f"flow.{index} sends nothing: it begins after the end; set start_s or a later duration_s"
        for index, flow in enumerate(model.flow)
        if index not in offered and not (made.cluster and _names_nodes(flow))
    ]
    return found


def _names_nodes(flow: Any) -> bool:
    """True for a flow that may have no part in a cluster."""
    return not {flow.from_, flow.to} <= set(RESERVED)


def _outside(made: MeshPlan) -> list[str]:
    """Robots that are outside the fence before they have moved."""
    fence = made.scenario.model.fence
    if fence is None:
        return []
    who = [made.names[walk.node] for walk in made.walks if is_outside(fence, walk.points[0][1:])]
    if not who:
        return []
    return [f"outside the fence from the beginning: {listed(who)}; that counts as a crossing"]


def _astray(made: MeshPlan) -> list[str]:
    """Robots that err by more than what lies between a warning, an alarm and the all-clear."""
    fence = made.scenario.model.fence
    if fence is None:
        return []
    soon = {walk.node: _fastest_mps(walk) * fence.predict_s for walk in made.walks}
    found = []
    for noise_m in sorted({walk.noise_um / 1e6 for walk in made.walks if walk.noise_um}):
        those = [walk.node for walk in made.walks if walk.noise_um == round(1e6 * noise_m)]
        who, least = listed([made.names[node] for node in those]), min(soon[node] for node in those)
        if noise_m > fence.clear_m:
            found.append(
                f"positions of {who} err by {noise_m:g} m, and fence.clear_m is {fence.clear_m:g}: "
                "near the fence the error alone raises alarms and takes them back; make it "
                f"{CLEAR_SIGMAS * noise_m:g}"
            )
        if noise_m > least:
            found.append(
                f"positions of {who} err by {noise_m:g} m, and the fence warns {least:.3g} m "
                "before it is reached (speed times fence.predict_s): warnings come no sooner than "
                "alarms"
            )
    return found


def _fastest_mps(walk: Walk) -> float:
    """The highest speed on a way; 0 if it leads nowhere."""
    legs = [(dist(a[1:], b[1:]), b[0] - a[0]) for a, b in pairwise(walk.points) if b[0] > a[0]]
    return max((1e4 * far_cm / took_us for far_cm, took_us in legs), default=0.0)


def _distribution(made: MeshPlan) -> list[str]:
    """Why nodes will be late with their tables, or never have any."""
    params, profile, found = made.params, made.scenario.model.radio.profile, []
    if params["mode"] == c.TABLE_FREE:
        return []
    what, limits = "graph", GRAPH_MAX
    if params["mode"] == c.TABLES:
        waiting = max(made.ranks) and not params["guard_us"]
        what, limits = "tables", TABLES_MAX_BEHIND_STANDBY if waiting else TABLES_MAX
    period_us = params["period"] * params["tick_us"]
    collect_us = params["collect_us"] << params["asks"]
    if period_us < collect_us:
        found.append(
            f"a round every {period_us / 1e6:g} s, but answers are collected for "
            f"{collect_us / 1e6:g} s: no round is ever complete, and nobody gets any {what}; raise "
            f"protocol.period_s to {ceil(collect_us / 1e6)}"
        )
    if made.nodes > limits.get(profile, made.nodes):
        found.append(
            f"{what} for {made.nodes} nodes will not be everywhere in time: more than "
            f"{limits[profile]} fill a {profile} channel; protocol.tables = false does without"
        )
    return found


def _early(made: MeshPlan) -> list[str]:
    """Why much of what is sent before there are tables is lost, where that need not be."""
    params, model = made.params, made.scenario.model
    most = EARLY_MAX.get(model.radio.profile, made.nodes)
    if params["mode"] != c.TABLES or params["on_demand"] or not params["reliable"]:
        return []
    monitor = made.gateway if params["monitor"] == c.MONITOR else params["monitor"]
    settled_us = 1e6 * PROFILES[model.radio.profile].settled
    who = {
        offer.node
        for offer in made.offers
        if offer.at_us < settled_us and offer.flags & c.END_TO_END
        if offer.dest != made.gateway and (offer.dest, monitor) != (c.MONITOR, made.gateway)
    }
    if len(who) <= most:
        return []
    return [
        f"{len(who)} nodes send to others in the first {settled_us / 1e6:g} s, when there are no "
        "tables yet: of 150 with a message in 10 s each a fifth is lost; protocol.on_demand = true "
        "finds ways by flooding"
    ]


def _thin(made: MeshPlan, near: list[list[int]], gateway: int) -> list[str]:
    found = []
    few = [
        made.names[node]
        for node, around in enumerate(near)
        if len(around) < NEIGHBOURS_MIN and node != gateway and not made.robots[node]
    ]
    if few:
        found.append(f"fewer than {NEIGHBOURS_MIN} neighbours: {listed(few)}")
    if len(near[gateway]) < GATEWAY_MIN:
        name = made.names[gateway]
        found.append(
            f"the gateway {name} has {count_of(len(near[gateway]), 'neighbour')}; "
            f"{GATEWAY_MIN} keep it reachable when some fail"
        )
    return found


def hops_from(made: MeshPlan, node: int) -> list[int]:
    """Hops over good links from a node to every other; -1 = none lead there."""
    return distances(neighbours(made.nodes, made.good), node)


def fault_words(made: MeshPlan, fault: MeshFault) -> str:
    """A fault in words: "at 2 s kill n3", "at 3 s cut n1 - n2"."""
    event = made.scenario.model.event[fault.index]
    what = made.names[fault.node]
    if TARGETS[event.action] == "link":
        what += f" - {made.names[fault.other]}"
    more = f" with {fault.value / 100:g} dBm" if fault.action == JAM else ""
    return f"at {fault.at_us / 1e6:g} s {event.action} {what}{more}"
