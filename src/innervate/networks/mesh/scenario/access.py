"""Which medium access a mesh runs over, and whether that one can work there."""

from math import ceil, hypot
from typing import Any

from innervate.networks.mesh.scenario.model import MeshScenario
from innervate.networks.mesh.scenario.network import Network
from innervate.networks.mesh.scenario.plan import HEADER_SLOTS
from innervate.networks.mesh.scenario.profiles import GOOD_CDB, Profile, crowded
from innervate.networks.radio.scenario.baselines import baseline
from innervate.networks.radio.scenario.plan import parameters
from innervate.scenario.robots import Walk
from innervate.topology.placement import path_loss_cdb

DELAY_US = (1, 2)  # from one node to another; detection included
CABLE = "csma-cd-d1"
PRACTICAL_NODES_MAX = 120  # places in a round of practical CSMA/CD-R
GUARD_S_MAX = 2
E2E_S_MAX = 16.0
# Rounds of turns until all have passed a request on; over which responses are spread; until all
# of these are at the gateway.
ROUNDS_TO_LISTEN, ROUNDS_TO_SPREAD, ROUNDS_TO_COLLECT = 4, 2, 10
ALL_HEAR = "its turns rest on what everybody hears"


def mac_of(model: MeshScenario, profile: Profile) -> str:
    """The medium access as scenarios call it."""
    return model.radio.mac or ("csma" if profile.collisions else "none")


def is_shared(mac: str) -> bool:
    """True for protocols of a channel that all share; the others need not hear everybody."""
    return mac not in ("csma", "none")


def waits_for_requests(model: MeshScenario, profile: Profile) -> bool:
    """True if there is a standby that does not ask whether the gateway lives (decision 0042)."""
    guard_s = model.protocol.guard_s
    if guard_s is None:
        guard_s = 0 if model.protocol.dead_s else profile.guard
    return len(model.standby) > 0 and guard_s == 0


def suited(model: MeshScenario, profile: Profile, count: int) -> Profile:
    """The profile with the timers that suit the medium access and the number of nodes [mesh 8.3].

    Where stations take turns a frame waits for a round at most, whatever the others send: rounds
    are the measure. Nobody has to keep out of others' way by waiting at random, so a request is
    sent once, with little jitter. Senders learn that their frame was received, so hops do not
    acknowledge: an ack would be a turn more for every frame.
    """
    if not profile.collisions:
        return profile
    if not is_shared(mac_of(model, profile)):
        again = model.protocol.failover in ("search", "alternate")
        return crowded(profile, count, waits_for_requests(model, profile), again)
    mtu = model.protocol.mtu or profile.mtu
    turnaround_us = model.radio.turnaround_us or profile.turnaround_us
    turn_us = (profile.phy_bytes + HEADER_SLOTS + mtu) * profile.byte_ns / 1000 + turnaround_us
    round_s = max(1, count) * turn_us / 1e6
    return profile._replace(
        hop_acks=False,
        ack_us=round(2e6 * round_s),
        jitter=min(profile.jitter, round_s),
        flood=min(profile.flood, round_s / 8),
        copies=1,
        listen=ROUNDS_TO_LISTEN * round_s,
        spread=ROUNDS_TO_SPREAD * round_s,
        collect=ROUNDS_TO_COLLECT * round_s,
        settled=min(profile.settled, ceil(2 * ROUNDS_TO_COLLECT * round_s)),
        e2e=min(E2E_S_MAX, max(profile.e2e, 4 * round_s)),
        guard=min(GUARD_S_MAX, max(profile.guard, 2 * round_s)),
    )


def access(
    model: MeshScenario, network: Network, profile: Profile, mtu: int, walks: list[Walk]
) -> tuple[str, dict[str, int]]:
    """(the protocol's name, its parameters).

    Raises:
        ScenarioError: the protocol cannot work in this network; the message says why.
    """
    mac = mac_of(model, profile)
    if mac == "none":
        return mac, {}
    if not profile.collisions:
        message = f'radio.mac = "{mac}" has nothing to do: profile "{model.radio.profile}" has no '
        raise network.nodes.source.error(("radio", "mac"), message + 'collisions; use "none"')
    if mac == "csma":
        return mac, {"backoff_us": profile.backoff_us}
    if mac == CABLE:
        message = f'radio.mac = "{mac}" hears others while it sends, as on a cable; radios cannot: '
        raise network.nodes.source.error(("radio", "mac"), f'{message}use "csma-cd-d2" or another')
    _check_one_cell(model, network, mac)
    _check_walks(network, mac, walks)
    _check_events(model, network, mac)
    return _shared(mac, len(network.nodes.names), profile, network, mtu)


def _check_one_cell(model: MeshScenario, network: Network, mac: str) -> None:
    """That all hear each other: what those protocols conclude from silence is else wrong."""
    names, radio = network.nodes.names, network.radio
    count = len(names)
    least = radio.rssi50_cdb + GOOD_CDB
    source = network.nodes.source
    for a in range(count):
        for b in range(count):
            if a != b and radio.rssi_cdb[a * count + b] < least:
                raise source.error(
                    ("radio", "mac"),
                    f'radio.mac = "{mac}" needs all nodes to hear each other, but {names[b]} does '
                    f'not hear {names[a]} well enough: {ALL_HEAR}; use "csma"',
                )
    if mac == "csma-cd-r" and count > PRACTICAL_NODES_MAX:
        message = f'radio.mac = "{mac}" has {PRACTICAL_NODES_MAX} places in a round, too few for '
        raise source.error(("radio", "mac"), f"{message}{count} nodes")


def _check_walks(network: Network, mac: str, walks: list[Walk]) -> None:
    """That all still hear each other wherever robots go; as far apart as their ways allow."""
    names, radio = network.nodes.names, network.radio
    count = len(names)
    if not radio.base_cdb:
        return
    boxes = [(x, y, x, y) for x, y in network.points]
    for walk in walks:
        xs, ys = [x for _, x, _ in walk.points], [y for _, _, y in walk.points]
        boxes[walk.node] = (min(xs), min(ys), max(xs), max(ys))
    least = radio.rssi50_cdb + GOOD_CDB
    for a in (walk.node for walk in walks):
        for b in range(count):
            far = _farthest_cm(boxes[a], boxes[b])
            lost = path_loss_cdb(far, radio.exponent_c)
            weakest = min(radio.base_cdb[a * count + b], radio.base_cdb[b * count + a]) - lost
            if a != b and weakest < least:
                raise network.nodes.source.error(
                    ("radio", "mac"),
                    f'radio.mac = "{mac}" needs all nodes to hear each other, but {names[a]} can '
                    f"come {far / 100:g} m away from {names[b]}, out of its reach: {ALL_HEAR}; "
                    'raise radio.reach_m or tx_dbm, or use "csma"',
                )


def _farthest_cm(a: tuple[int, int, int, int], b: tuple[int, int, int, int]) -> int:
    """Greatest distance of two points, one in each rectangle."""
    dx = max(a[2] - b[0], b[2] - a[0])
    dy = max(a[3] - b[1], b[3] - a[1])
    return round(hypot(dx, dy))


def _check_events(model: MeshScenario, network: Network, mac: str) -> None:
    """That no event makes nodes deaf for each other."""
    for index, event in enumerate(model.event):
        if event.action not in ("kill", "revive", "restart"):
            raise network.nodes.source.error(
                ("event", index, "action"),
                f'event.{index}.action = "{event.action}" changes who hears whom, and radio.mac = '
                f'"{mac}" needs all nodes to hear each other; use "csma", or leave the event out',
            )


def _shared(
    mac: str, count: int, profile: Profile, network: Network, mtu: int
) -> tuple[str, dict[str, int]]:
    """A medium access protocol of radio teams, with frames of at most this MTU."""
    params: dict[str, Any] = parameters(
        profile.phy_bytes + HEADER_SLOTS + mtu,
        network.radio.turnaround_us,
        DELAY_US,
        bit_us=round(profile.byte_ns / 8000),
    )
    if mac == "csma-cd-r":
        return f"{mac}/practical", params
    return mac, baseline(mac, count, params)
