"""From a mesh plan to a world: all tables of a simulation, compiled (arrays) or plain (lists)."""

from typing import Any

import numpy as np

from innervate.dialect import rng
from innervate.kernel import records
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol import csma, csma_fields
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.protocol.constants import MTU
from innervate.networks.mesh.sim import channel, recorder
from innervate.networks.mesh.sim import world as m
from innervate.networks.mesh.sim.over_channel import KEPT
from innervate.scenario.robots import Walk
from innervate.sim.field import build as field
from innervate.sim.field import powers, queue, walkers
from innervate.sim.field.loop import NEVER
from innervate.sim.field.world import COMMAND
from innervate.sim.recorded import Recorded
from innervate.sim.tables import ACTION, ROW, Tables, get, put, timed

OUTBOX = 32
DUPLICATES = 1 << 15
FRAME_BYTES = 1 << 10
PLACES_PER_NODE = 8
ACCESS = field.Access(csma_fields.STATION, csma_fields.PARAMS, csma_fields.ITEM, 4, csma.TIMERS)
CSMA = {"backoff_us": 320, "exponent_min": 3, "exponent_max": 6, "busy_max": 8}
MACS = {"none": 0, "csma": 1}
LIMITS = ("row_limit", "sent_limit", "delivered_limit", "round_limit")


def build(plan: Any, plain: bool, **kept: bool) -> m.World:
    """The world of a plan, before its first event; `kept` as in `sim.recorded`."""
    tables, asked = Tables(plain, np.int64), Recorded(**kept)
    n, mtu = plan.nodes, plan.params["mtu"]
    fields = mesh_fields.node(plan.capacity, mtu=mtu)
    frame = mesh_fields.frame(mtu)
    nodes = tables.states(fields, n + 1)
    low, high = records.bounds(fields)
    heap = field.heap_of(tables, n)
    below = () if plan.mac in MACS else channel.world_of(plan, plain, asked.checks, heap)
    world = m.World(
        run=tables.records(m.RUN, 1, wide=m.WIDE),
        heap=heap,
        below=below,
        nodes=nodes,
        words=tables.words(nodes, fields),
        low=tables.given(low, np.int32),
        high=tables.given(high, np.int32),
        spans=tables.spans(fields),
        params=tables.states(mesh_fields.PARAMS, 1),
        radios=tables.records(m.RADIO, n, wide=m.RADIO),
        due=tables.numbers(n * m.TIMERS, NEVER, np.int64),
        **_gates(tables, plan),
        **field.access_tables(tables, ACCESS, n),
        **_medium(tables, plan, frame),
        **_script(tables, plan),
        item=tables.states(mesh_fields.item(mtu), 1),
        out=tables.outbox(OUTBOX, frame, ACTION),
        duplicate_key=tables.numbers(DUPLICATES, 0, np.int64),
        duplicate_at=tables.numbers(DUPLICATES, 0, np.int64),
        **field.kept_tables(
            tables, asked, _margin(n), frame, m.WIDE,
            rows=ROW, sent=m.SENT, delivered=m.DELIVERED, rounds=m.ROUND,
        ),
    )  # fmt: skip
    field.set_limits(world, tables.rows, asked, *LIMITS)
    _set_run(world, plan)
    _set_nodes(world, plan, len(world.gates) - 1)
    _set_events(world, plan)
    return world


def _gates(tables: Tables, plan: Any) -> dict[str, Any]:
    """Records of gateways, and one that stands for what other nodes have."""
    fields = mesh_fields.gate(plan.capacity)
    gates = tables.states(fields, sum(rank >= 0 for rank in plan.ranks) + 1)
    return {"gates": gates, "gate_words": tables.words(gates, fields)}


def grow_duplicates(world: m.World) -> m.World:
    """The same world with twice the room for deliveries."""
    tables = Tables(isinstance(world.duplicate_key, list))
    count = 2 * len(world.duplicate_key)
    keys, times = tables.numbers(count, 0, np.int64), tables.numbers(count, 0, np.int64)
    for key, at in zip(world.duplicate_key, world.duplicate_at, strict=True):
        if key:
            place = recorder.place_of(keys, int(key))
            keys[place], times[place] = key, at
    put(world.run, 0, duplicate_limit=count // 2 - _margin(len(world.radios)) // 4)
    return world._replace(duplicate_key=keys, duplicate_at=times)


def _margin(nodes: int) -> int:
    """Most rows that one event can add: all nodes hear a frame and fill their outboxes."""
    return (nodes + 1) * (OUTBOX + 1)


def _medium(tables: Tables, plan: Any, frame: Any) -> dict[str, Any]:
    """Tables of the ideal or fading medium: frames in the air, powers between nodes."""
    n, radio = plan.nodes, plan.radio
    places = min(PLACES_PER_NODE * n + 64, queue.PLACES_MAX)
    if plan.mac not in MACS:
        places = n * KEPT
    frames = tables.states(frame, places, FRAME_BYTES if plan.params["mtu"] <= MTU else 0)
    good = np.zeros((n, n), np.int64)
    for a, b in plan.good:
        good[a, b] = good[b, a] = 1
    return {
        **field.air_tables(tables, radio, frames, n),
        **walkers.motion_tables(tables, plan, radio, _paths(plan), powers.chance_table()),
        "good": tables.given(good),
    }


def _script(tables: Tables, plan: Any) -> dict[str, Any]:
    """What happens to the nodes, as tables in order of time."""
    offers = [(o.at_us, o.node, o.dest, o.flags, o.length) for o in plan.offers]
    return {
        "commands": timed(tables, COMMAND, field.events_of(plan)),
        "offers": timed(tables, m.OFFER, sorted(offers, key=lambda offer: offer[0])),
    }


def _paths(plan: Any) -> list[Walk]:
    """Who is told where it is: robots that stand still, too."""
    moving = {walk.node for walk in plan.walks}
    return plan.walks + [
        Walk(node, ((0, *plan.positions_cm[node]),)) for node, robot in enumerate(plan.robots)
        if robot and plan.positions_cm and node not in moving
    ]  # fmt: skip


def _set_run(world: m.World, plan: Any) -> None:
    gate_words = sum(max(int(length), 1) for _, length, *_ in mesh_fields.gate(plan.capacity))
    radio, n = plan.radio, plan.nodes
    field.set_air(
        world,
        plan,
        mesh_const.TIMERS,
        radio.sense_cdb,
        radio.capture_cdb,
        mac=MACS.get(plan.mac, 0),
        collisions=int(radio.collisions and plan.mac in MACS),
        turnaround=radio.turnaround_us,
        byte_ns=radio.byte_ns,
        phy_bytes=radio.phy_bytes,
        sample=plan.sample_us,
        origin_x=plan.origin_cm[0],
        origin_y=plan.origin_cm[1],
        unit=plan.params["unit_cm"],
        moving=int(bool(radio.base_cdb)),
        rssi50=radio.rssi50_cdb,
        told=plan.params["told"],
        row=plan.params["row"],
        good=len(plan.good),
        gate_words=gate_words,
        offers=len(plan.offers),
        duplicate_limit=DUPLICATES // 2 - _margin(n) // 4,
        forget=(plan.params["forget"] - 1) * plan.params["tick_us"],  # they count whole ticks
    )
    for name, length, *_ in mesh_fields.PARAMS:
        if length:
            numbers = get(world.params, 0, name)
            for i, value in enumerate(plan.params[name]):
                numbers[i] = value
        else:
            put(world.params, 0, **{name: plan.params[name]})
    if plan.mac in MACS:
        put(world.mac_params, 0, **{name: plan.mac_params.get(name, CSMA[name]) for name in CSMA})


def _set_nodes(world: m.World, plan: Any, spare: int) -> None:
    n = plan.nodes
    seeds = field.set_radios(world, plan.seed, True)
    gate = 0
    put(world.nodes, n, choice=rng.GENERATE)
    for i in range(n):
        own = {"number": i, "rank": plan.ranks[i], "robot": plan.robots[i]}
        put(world.nodes, i, rng=int(seeds[i]), choice=rng.GENERATE, **own)
        put(world.radios, i, gate=spare)
        if plan.ranks[i] >= 0:
            put(world.radios, i, gate=gate)
            gate += 1
    walkers.place(world, plan)


def _set_events(world: m.World, plan: Any) -> None:
    """Queue the first event of every kind; each queues the next."""
    field.push_first(world)
    walkers.push_samples(world, len(_paths(plan)))
