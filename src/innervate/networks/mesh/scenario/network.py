"""Who is in a mesh, where everybody lies, and who hears whom how well [mesh 6]."""

from dataclasses import dataclass
from math import ceil, isqrt
from typing import Any

from innervate.networks.mesh.scenario.model import MeshScenario
from innervate.networks.mesh.scenario.nodes import NODES_MAX, Nodes, listed
from innervate.networks.mesh.scenario.plan import ONE, MeshRadio
from innervate.networks.mesh.scenario.profiles import GOOD_CDB, REPORT_CDB, Profile
from innervate.scenario.errors import ScenarioError
from innervate.topology import placement
from innervate.topology.placement import UNHEARD, Point, quality_cdb, reception_q15
from innervate.trace.streams import stream

MEAN_DEGREE = 8.0
MEAN_DEGREE_OF_MANY = 12.0  # of more than a mesh has: with 8 hardly one of them in ten is connected
REACH = 1.5  # spacings of a grid or line: its eight, or two, neighbours are in reach
SHADOWING_DB, DIRECTION_DB = 3.0, 1.0
WORK_MAX = 3_000_000  # pairs looked at before a connected placement is given up
TRIES_MAX = 300


@dataclass(slots=True)
class Network:
    """A mesh before anything happens."""

    nodes: Nodes  # their names
    points: list[Point]  # per node (x, y) in cm; empty where none are known
    radio: MeshRadio  # who hears whom
    good: list[tuple[int, int]]  # links (a < b) that are good both ways
    # If qualities were given, rssi of the weakest good link, at most what is reported anyway; else
    # None.
    weakest_cdb: int | None = None


def linked(model: MeshScenario, nodes: Nodes, profile: Profile) -> Network:
    """The network of given links: one hears exactly those it is linked with.

    Raises:
        ScenarioError: it falls into parts.
    """
    count = len(nodes.names)
    radio = _radio(model, profile, count)
    good, weakest = [], REPORT_CDB
    for (a, b), (there, back) in nodes.links.items():
        for i, j, quality in ((a, b, there), (b, a, back)):
            radio.prob_q15[i * count + j] = round(quality * ONE)
            radio.rssi_cdb[i * count + j] = radio.rssi50_cdb + quality_cdb(quality)
        if min(there, back) > 0:
            good.append((a, b))
            weakest = min(weakest, quality_cdb(min(there, back)))
    good.sort()
    imported = model.import_ is not None
    remedy = (
        "set import.largest_component = true" if imported else "add the [[link]] that is missing"
    )
    _check_connected(nodes, good, set(), remedy)
    return Network(nodes, nodes.points, radio, good, radio.rssi50_cdb + weakest)


def placed(
    model: MeshScenario, nodes: Nodes, profile: Profile, starts: dict[int, Point]
) -> Network:
    """The network of nodes in the plane, drawn anew until good links connect it.

    Nodes without points are placed. Robots, which begin at `starts`, cm, need not be connected.

    Raises:
        ScenarioError: no network that is asked for in this way is connected.
    """
    count = len(nodes.names)
    draw = stream(model.seed, "placement")
    pairs = max(1, count * (count - 1) // 2)
    shadowing, direction = _spread(model, profile)
    drawn = shadowing or direction or not (nodes.points or model.placement.layout != "random")
    robots = {nodes.number(("robot", i, "node"), robot.node)
              for i, robot in enumerate(model.robot)}  # fmt: skip
    for left in range(min(TRIES_MAX, max(10, WORK_MAX // pairs)) if drawn else 1, 0, -1):
        points = list(nodes.points) or _points(model, count, draw)
        for node, start in starts.items():
            points[node] = start
        faded = placement.fading(count, shadowing, direction, draw)
        network = _heard(model, nodes, profile, points, faded)
        if left > 1 and len(_parts(count, network.good, robots)) > 1:
            continue
        _check_connected(nodes, network.good, robots, _remedy(model))
        return network
    raise AssertionError("there is at least one try")


def _points(model: MeshScenario, count: int, draw: Any) -> list[Point]:
    table = model.placement
    if table.layout == "random":
        return placement.square(count, round(100 * table.side_m), draw)
    columns = count if table.layout == "line" else table.columns or isqrt(count - 1) + 1
    return placement.grid(count, columns, round(100 * table.spacing_m))


def _spread(model: MeshScenario, profile: Profile) -> tuple[int, int]:
    """Sigma of shadowing and of a direction's own part, 0.01 dB.

    A grid and an ideal medium are as regular as they can be, unless something else is asked for.
    """
    regular = not profile.collisions or (model.placement.layout != "random" and not model.node)
    shadowing, direction = (0.0, 0.0) if regular else (SHADOWING_DB, DIRECTION_DB)
    if model.radio.shadowing_db is not None:
        shadowing = model.radio.shadowing_db
    if model.radio.direction_db is not None:
        direction = model.radio.direction_db
    return round(100 * shadowing), round(100 * direction)


def _heard(
    model: MeshScenario, nodes: Nodes, profile: Profile, points: list[Point], faded: list[int]
) -> Network:
    """The radio between nodes at these places."""
    count = len(points)
    exponent_c = round(100 * model.radio.exponent)
    gain = placement.gains(points, faded, exponent_c)
    least = profile.rssi50_cdb + GOOD_CDB
    power, weakened = _power_cdb(model, profile, gain, count, exponent_c)
    faded = list(faded)
    for a, b in weakened:
        for table in (gain, faded):
            table[a * count + b] -= 1
            table[b * count + a] -= 1
    radio = _radio(model, profile, count)
    for i in range(count * count):
        if i % (count + 1) == 0:
            continue
        rssi = power + gain[i]
        if profile.collisions:
            radio.rssi_cdb[i] = max(rssi, UNHEARD + 1)
            radio.prob_q15[i] = reception_q15(rssi - radio.rssi50_cdb)
        elif rssi >= least:
            radio.rssi_cdb[i], radio.prob_q15[i] = rssi, ONE
    if model.robot:
        radio.base_cdb = [power + some if i % (count + 1) else UNHEARD
                          for i, some in enumerate(faded)]  # fmt: skip
    return Network(nodes, points, radio, placement.good_links(radio.rssi_cdb, count, least))


def _power_cdb(
    model: MeshScenario, profile: Profile, gain: list[int], count: int, exponent_c: int
) -> tuple[int, list[tuple[int, int]]]:
    """(rssi at 1 m without fading, pairs to be weakened by 0.01 dB)."""
    radio, table = model.radio, model.placement
    least = profile.rssi50_cdb + GOOD_CDB
    if radio.tx_dbm is not None:
        return round(100 * radio.tx_dbm) - profile.loss_1m_cdb, []
    reach_m = radio.reach_m
    if reach_m is None and table.layout != "random" and not model.node:
        reach_m = REACH * table.spacing_m
    if reach_m is not None:
        return least + placement.path_loss_cdb(ceil(100 * reach_m), exponent_c), []
    usual = MEAN_DEGREE if count <= NODES_MAX else MEAN_DEGREE_OF_MANY
    degree = usual if radio.mean_degree is None else radio.mean_degree
    pairs = count * (count - 1) // 2
    if not pairs:
        return least, []
    links = min(max(1, round(count * degree / 2)), pairs)
    level, weakened = placement.threshold(gain, count, links)
    return least - level, weakened


def _radio(model: MeshScenario, profile: Profile, count: int) -> MeshRadio:
    """A medium in which nobody hears anybody yet."""
    return MeshRadio(
        byte_ns=profile.byte_ns,
        phy_bytes=profile.phy_bytes,
        turnaround_us=model.radio.turnaround_us or profile.turnaround_us,
        collisions=profile.collisions,
        sense_cdb=profile.rssi50_cdb - round(100 * model.radio.sense_db),
        capture_cdb=round(100 * model.radio.capture_db),
        rssi50_cdb=profile.rssi50_cdb,
        rssi_cdb=[UNHEARD] * (count * count),
        prob_q15=[0] * (count * count),
        exponent_c=round(100 * model.radio.exponent),
    )


def _remedy(model: MeshScenario) -> str:
    if model.radio.tx_dbm is not None:
        return "raise radio.tx_dbm"
    if model.radio.reach_m is not None or (model.placement.layout != "random" and not model.node):
        return "raise radio.reach_m"
    return "raise radio.mean_degree"


def _parts(count: int, good: list[tuple[int, int]], robots: set[int]) -> list[list[int]]:
    """The parts of a network; robots hold nothing together and need not be reached."""
    fixed = [link for link in good if not robots.intersection(link)]
    found = placement.components(placement.neighbours(count, fixed))
    return [part for part in found if len(part) > 1 or part[0] not in robots]


def _check_connected(
    nodes: Nodes, good: list[tuple[int, int]], robots: set[int], remedy: str
) -> None:
    parts = _parts(len(nodes.names), good, robots)
    if len(parts) > 1:
        cut = [nodes.names[node] for part in parts[1:] for node in part]
        raise ScenarioError(
            f"the network falls into {len(parts)} parts: no good links lead to {listed(cut)}; "
            f"{remedy}",
            nodes.source.path,
        )
