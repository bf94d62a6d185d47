"""What a mesh's own events, messages and robots will do to it, as far as a plan alone tells."""

from collections.abc import Iterator
from heapq import heappop, heappush
from itertools import pairwise
from math import dist, log10

from innervate.networks.mesh.protocol.constants import ACK_BYTES, ALL, MONITOR
from innervate.networks.mesh.scenario.access import is_shared
from innervate.networks.mesh.scenario.nodes import listed
from innervate.networks.mesh.scenario.params import sent_at_most
from innervate.networks.mesh.scenario.plan import ONE, MeshPlan
from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE
from innervate.scenario.robots import Walk, position_cm
from innervate.topology.placement import distances, neighbours

METRE_CM = 100
HALF = 0.5
# Of transmissions over a link. A hop is tried the more often, the fewer are acknowledged, but 12
# times at most. Before links down to an eighth made no pauses, in three runs of 3 minutes, a
# message in 5 s from each node to the gateway: where on a node's only link 25, 16, 9 or 4 % are
# acknowledged, 99, 89, 82 or 17 % came; in a ring of 30 nodes with eight such links each 92, 60,
# 38 or 23 %.
ACKED_MIN = 0.25
# What a standby waits on links that lose much (decision 0067), and as the template has it.
PATIENT_US = 500_000
ON_A_LEG = 8  # places that are looked at between two points of a robot's way
MOMENTS_MAX = 300
BadLinks = dict[int, tuple[float, int, int]]  # by node, see _badly_reached()


def foreseen(made: MeshPlan) -> list[str]:
    """A sentence for each; none if all is well."""
    bad = _badly_reached(made)
    return [
        *_acks(made),
        *_untold(made),
        *_bad_ways(made, bad),
        *_hasty(made),
        *_at_the_end(made, bad),
        *_too_much(made),
        *_out_of_reach(made),
    ]


def _acks(made: MeshPlan) -> list[str]:
    """Hops that are given up before an ack can be there."""
    radio, wait_us = made.radio, made.params["ack_us"]
    if not radio.collisions or not made.params["hop_acks"]:
        return []
    needed_us = radio.turnaround_us + (radio.phy_bytes + int(ACK_BYTES)) * radio.byte_ns // 1000
    if wait_us >= needed_us:
        return []
    return [
        f"a hop's ack is there {needed_us:,} us after its frame at the earliest, and "
        f"protocol.ack_us is {wait_us:,}: every hop counts as lost; make it longer"
    ]


def _untold(made: MeshPlan) -> list[str]:
    """Hops of which nobody learns what was received: each packet goes once, whoever is dead."""
    if made.params["hop_acks"] or is_shared(made.mac):
        return []
    return [
        f'hops do not acknowledge, and with radio.mac = "{made.mac}" nothing else says what was '
        "received: no hop is tried again and nobody goes round a failure; leave "
        "protocol.hop_acks out"
    ]


def _bad_ways(made: MeshPlan, bad: BadLinks) -> list[str]:
    """Who has no way to the gateway but over links that are worse than retries make up for."""
    if not bad:
        return []
    gateway = made.gateway
    share, a, b = min(bad.values())
    there, back = (made.radio.prob_q15[i * made.nodes + j] / ONE for i, j in ((a, b), (b, a)))
    return [
        f"{listed([made.names[node] for node in sorted(bad)])}: every way to "
        f"{made.names[gateway]}, the gateway, has a link on which less than "
        f"{100 * ACKED_MIN:g} % of transmissions are acknowledged; retries do not make up for "
        "that, and many messages will not come; the worst is "
        f"{made.names[a]} - {made.names[b]}: there "
        f"{100 * there:.3g} % arrive, back {100 * back:.3g} %, so {100 * share:.2g} % are "
        "acknowledged"
    ]


def _badly_reached(made: MeshPlan) -> BadLinks:
    """Nodes whose best way to the gateway has a bad link: the worst on it, see _worst_links()."""
    worst = _worst_links(made, made.gateway)
    return {node: link for node, link in worst.items()
            if link[0] < ACKED_MIN and not made.robots[node]}  # fmt: skip


def _worst_links(made: MeshPlan, gateway: int) -> dict[int, tuple[float, int, int]]:
    """Per node the worst link of its best way to the gateway: share that is acknowledged, ends.

    The best way is the one whose worst link is best; nodes that no link leads to are left out.
    """
    near: list[list[tuple[float, int]]] = [[] for _ in range(made.nodes)]
    for a, b, share in _shares(made):
        near[a].append((share, b))
        near[b].append((share, a))
    found: dict[int, tuple[float, int, int]] = {}
    ahead = [(-1.0, gateway, gateway, (1.0, gateway, gateway))]
    while ahead:
        _, node, _, worst = heappop(ahead)
        if node in found:
            continue
        found[node] = worst
        for share, other in near[node]:
            if other not in found:
                link = min(worst, (share, other, node))
                heappush(ahead, (-link[0], other, node, link))
    return found


def _hasty(made: MeshPlan) -> list[str]:
    """Standbys that lossy links keep from hearing in time that the gateway lives."""
    guard_us = made.params["guard_us"]
    if not 0 < guard_us < PATIENT_US:
        return []
    worst = _worst_links(made, made.gateway)
    ways = {node: worst[node] for node, rank in enumerate(made.ranks) if rank > 0 and node in worst}
    lossy = [node for node, link in ways.items() if link[0] < HALF]
    if not lossy:
        return []
    return [
        f"{listed([made.names[node] for node in lossy])}: less than half of the transmissions are "
        "acknowledged on a link to the gateway, so that its answers are late: with "
        f"protocol.guard_s = {guard_us / 1e6:g} a standby may take over from a gateway that "
        f"lives; set it to {PATIENT_US / 1e6:g}"
    ]


def _at_the_end(made: MeshPlan, bad: BadLinks) -> list[str]:
    """Who is missing when all events have happened, and who is then cut off."""
    on = [not absent for absent in made.absent]
    cut: set[tuple[int, int]] = set()
    noise: dict[int, int | None] = {}
    for fault in made.faults:
        pair = min(fault.node, fault.other), max(fault.node, fault.other)
        if fault.action in (KILL, REVIVE, RESTART):
            on[fault.node] = fault.action != KILL
        elif fault.action in (CUT, RESTORE):
            (cut.add if fault.action == CUT else cut.discard)(pair)
        elif fault.action in (JAM, QUIET):
            noise[fault.node] = fault.value if fault.action == JAM else None
    monitor = made.params["monitor"]
    found = []
    if monitor != MONITOR and not on[monitor]:
        found.append(f"the monitor {made.names[monitor]} is off at the end")
    leaders = [made.ranks.index(rank) for rank in range(max(made.ranks) + 1)]
    leader = next((node for node in leaders if on[node]), None)
    if leader is None:
        whose = "and so is every standby" if len(leaders) > 1 else "and there is no standby"
        return [*found, f"nobody leads at the end: the gateway is off, {whose}"]
    working = _working(made)
    left = [(a, b) for a, b in working if on[a] and on[b] and (a, b) not in cut
            and not _drowned(made, noise, a, b) and not _drowned(made, noise, b, a)]  # fmt: skip
    hops = distances(neighbours(made.nodes, left), leader)
    at_first = distances(neighbours(made.nodes, working), leaders[0])
    known = {node for node in bad if at_first[node] < 0}  # said by _bad_ways()
    apart = [
        made.names[node]
        for node, far in enumerate(hops)
        if far < 0 and on[node] and not made.robots[node] and node not in known
    ]
    if apart:
        name = made.names[leader]
        found.append(f"at the end no links lead to {name}, the gateway, from {listed(apart)}")
    return found


def _drowned(made: MeshPlan, noise: dict[int, int | None], node: int, other: int) -> bool:
    """True if a jammer's noise is too loud for the other to receive the node."""
    there, radio = noise.get(other), made.radio
    if there is None or not radio.collisions:
        return False
    return radio.rssi_cdb[node * made.nodes + other] < there + radio.capture_cdb


def _working(made: MeshPlan) -> list[tuple[int, int]]:
    """Links over which, with all their tries, most messages come: faint ones too."""
    tries = sent_at_most(made.params)
    return [(a, b) for a, b, share in _shares(made) if (1 - share) ** tries <= HALF]


def _shares(made: MeshPlan) -> Iterator[tuple[int, int, float]]:
    """Pairs of nodes that hear each other, and what share of transmissions is acknowledged."""
    count, prob = made.nodes, made.radio.prob_q15
    for a in range(count):
        for b in range(a + 1, count):
            there, back = prob[a * count + b] / ONE, prob[b * count + a] / ONE
            share = there * back if made.params["hop_acks"] else min(there, back)
            if share > 0:
                yield a, b, share


def _too_much(made: MeshPlan) -> list[str]:
    """Messages to one node that alone take longer than there is time: it hears one at a time."""
    if not made.radio.collisions:
        return []
    bytes_to: dict[int, int] = {}
    gateway = made.gateway
    monitor = gateway if made.params["monitor"] == MONITOR else made.params["monitor"]
    for offer in made.offers:
        dest = monitor if offer.dest == MONITOR else offer.dest
        if dest not in (ALL, offer.node):
            size = made.radio.phy_bytes + offer.length
            bytes_to[dest] = bytes_to.get(dest, 0) + size
    if not bytes_to:
        return []
    dest, most = max(bytes_to.items(), key=lambda item: item[1])
    needed_us = most * made.radio.byte_ns / 1000
    room_us = made.duration_us - made.offers[0].at_us
    if needed_us <= room_us:
        return []
    return [
        f"messages to {made.names[dest]} alone take {needed_us / 1e6:,.0f} s on the air, without "
        f"any header or ack, and there are {room_us / 1e6:,.0f} s: most will not come"
    ]


def _out_of_reach(made: MeshPlan) -> list[str]:
    """Robots that somewhere on their way hear not half of the frames of anybody."""
    if not made.radio.base_cdb or not made.positions_cm:
        return []
    ways = {walk.node: walk for walk in made.walks}
    found = []
    for walk in made.walks:
        others = [node for node in range(made.nodes) if node != walk.node]
        for at_us in _moments(walk, made.duration_us):
            here = position_cm(walk, at_us)
            places = (
                position_cm(ways[node], at_us) if node in ways else made.positions_cm[node]
                for node in others
            )  # fmt: skip
            pairs = zip(others, places, strict=True)
            if not any(_hears(made, node, walk.node, dist(here, there)) for node, there in pairs):
                found.append((at_us, made.names[walk.node]))
                break
    if not found:
        return []
    who = listed([name for _, name in found])
    return [f"out of everybody's reach on the way, first after {min(found)[0] / 1e6:.3g} s: {who}"]


def _hears(made: MeshPlan, node: int, robot: int, far_cm: float) -> bool:
    """True if a robot so far away receives half of a node's frames."""
    loss_cdb = 10 * made.radio.exponent_c * log10(max(far_cm / METRE_CM, 1.0))
    return made.radio.base_cdb[node * made.nodes + robot] - loss_cdb >= made.radio.rssi50_cdb


def _moments(walk: Walk, until_us: int) -> list[int]:
    """Times at which a robot is looked at: at every point of its way and between them."""
    times = [min(at, until_us) for at, _, _ in walk.points]
    found = {times[0], times[-1]}
    for a, b in pairwise(times):
        found |= {a + (b - a) * k // ON_A_LEG for k in range(ON_A_LEG)}
    return sorted(found)[:: max(1, len(found) // MOMENTS_MAX)]
