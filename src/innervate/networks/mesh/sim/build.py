"""From a mesh plan to a world: all tables of a simulation, compiled (arrays) or plain (lists)."""

from typing import Any

import numpy as np

from innervate.dialect import rng
from innervate.kernel import records
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol import csma_fields
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.protocol.constants import MTU
from innervate.networks.mesh.sim import channel, recorder
from innervate.networks.mesh.sim import world as m
from innervate.networks.mesh.sim.over_channel import KEPT
from innervate.sim.channel.world import Heap
from innervate.sim.field import powers, queue
from innervate.sim.field.loop import BOOT, NEVER
from innervate.sim.field.medium import NONE
from innervate.sim.recorded import Recorded
from innervate.sim.tables import ACTION, TAP, Tables, get, put, uniform

TAPS = 1 << 12
OUTBOX = 32
MAC_OUTBOX = 4
DUPLICATES = 1 << 15
FRAME_BYTES = 1 << 10
PLACES_PER_NODE = 8
CSMA = {"backoff_us": 320, "exponent_min": 3, "exponent_max": 6, "busy_max": 8}
MACS = {"none": 0, "csma": 1}


def build(plan: Any, plain: bool, **kept: bool) -> m.World:
    """The world of a plan, before its first event; `kept` as in `sim.recorded`."""
    tables, asked = Tables(plain, np.int64), Recorded(**kept)
    n = plan.nodes
    mtu = plan.params["mtu"]
    fields = mesh_fields.node(plan.capacity, mtu=mtu)
    frame = mesh_fields.frame(mtu)
    nodes = tables.states(fields, n + 1)
    low, high = records.bounds(fields)
    heap = Heap(tables.numbers(128 * n + 1024, 0, np.int64), tables.numbers(1, 0, np.int64))
    below: Any = ()
    if plan.mac not in MACS:
        below = channel.world_of(plan, plain, asked.checks, heap)
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
        **_access(tables, n),
        **_medium(tables, plan, frame),
        **_script(tables, plan),
        item=tables.states(mesh_fields.item(mtu), 1),
        out=tables.outbox(OUTBOX, frame, ACTION),
        duplicate_key=tables.numbers(DUPLICATES, 0, np.int64),
        duplicate_at=tables.numbers(DUPLICATES, 0, np.int64),
        **_rows(tables, n, frame, asked),
    )
    _set_limits(world, tables.rows, asked)
    _set_run(world, plan)
    _set_nodes(world, plan, len(world.gates) - 1)
    _set_events(world, plan)
    return world


def _gates(tables: Tables, plan: Any) -> dict[str, Any]:
    """Records of gateways, and one that stands for what other nodes have."""
    fields = mesh_fields.gate(plan.capacity)
    gates = tables.states(fields, sum(rank >= 0 for rank in plan.ranks) + 1)
    return {"gates": gates, "gate_words": tables.words(gates, fields)}


def _access(tables: Tables, nodes: int) -> dict[str, Any]:
    """What CSMA has, one for each node, and its outbox."""
    return {
        "macs": tables.states(csma_fields.STATION, nodes),
        "mac_params": tables.states(csma_fields.PARAMS, 1),
        "mac_item": tables.states(csma_fields.ITEM, 1),
        "mac_out": tables.outbox(MAC_OUTBOX, csma_fields.ITEM, ACTION),
    }


def _rows(tables: Tables, nodes: int, frame: Any, asked: Recorded) -> dict[str, Any]:
    """Tables of what is kept, with room for what one event can add."""
    room, margin = tables.rows, _margin(nodes)
    kept = room + margin if asked.observe else 1
    tapped = TAPS + margin if asked.tap else 1
    trail = room + margin if asked.trail else 1
    names = {"rows": m.ROW, "sent": m.SENT, "delivered": m.DELIVERED, "rounds": m.ROUND}
    return {
        **{name: tables.records(names[name], kept, True, m.WIDE) for name in names},
        "trail": tables.records(m.TRAIL, trail, True, m.WIDE),
        "taps": tables.records(TAP, tapped, True, m.WIDE),
        "tapped": tables.states(frame, tapped),
    }


def _set_limits(world: m.World, rows: int, asked: Recorded) -> None:
    limit = rows if asked.observe else 0
    put(world.run, 0, row_limit=limit, sent_limit=limit, delivered_limit=limit, round_limit=limit)
    put(world.run, 0, checks=int(asked.checks), watchful=int(asked.is_watchful))
    put(world.run, 0, trail_limit=rows if asked.trail else 0, tap_limit=TAPS if asked.tap else 0)


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
    strengths = powers.strength_table()
    power = [powers.strength(strengths, cdb) for cdb in radio.rssi_cdb]
    power[:: n + 1] = [0] * n  # nobody hears himself
    good = np.zeros((n, n), np.int64)
    for a, b in plan.good:
        good[a, b] = good[b, a] = 1
    return {
        "rssi": tables.given(radio.rssi_cdb, np.int32),
        "base": tables.given(radio.base_cdb or [0], np.int32),
        "prob": tables.given(radio.prob_q15, np.int32),
        "cut": tables.numbers(n * n),
        "power": tables.given(power),
        "sums": tables.numbers(n, 0, np.int64),
        "strengths": tables.given(strengths),
        "losses": tables.given(powers.loss_table(radio.exponent_c)),
        "chances": tables.given(powers.chance_table()),
        "air": tables.records(m.AIR, places, wide=m.AIR),
        "frames": tables.states(frame, places, FRAME_BYTES if plan.params["mtu"] <= MTU else 0),
        "worst": tables.numbers(places * n, 0, np.int64),
        "on_air": tables.numbers(places),
        "free": tables.given(range(places - 1, -1, -1)),
        "got": tables.numbers(n),
        "good": tables.given(good),
    }


def _script(tables: Tables, plan: Any) -> dict[str, Any]:
    """What happens to the nodes, as tables in order of time."""
    events = [(at, BOOT, i, 0, 0) for i, at in enumerate(plan.starts_us) if not plan.absent[i]]
    events += [(f.at_us, f.action, f.node, max(f.other, 0), f.value) for f in plan.faults]
    events.sort(key=lambda event: event[0])
    offers = [(o.at_us, o.node, o.dest, o.flags, o.length) for o in plan.offers]
    offers.sort(key=lambda offer: offer[0])
    walks, points = _walks(plan)
    made: dict[str, list[Any]] = {
        "commands": events,
        "offers": offers,
        "walks": walks,
        "points": points,
    }
    names = {"commands": m.COMMAND, "offers": m.OFFER, "walks": m.WALK, "points": m.POINT}
    found = {}
    for name, rows in made.items():
        table = tables.records(names[name], max(len(rows), 1), wide=names[name])
        for i, row in enumerate(rows):
            put(table, i, **dict(zip(names[name], row, strict=True)))
        found[name] = table
    return found


def _walks(plan: Any) -> tuple[list[Any], list[Any]]:
    """Walkers with their place in the list of all points; robots that stand still, too."""
    paths = [(walk.node, walk.points) for walk in plan.walks]
    moving = {node for node, _ in paths}
    for node, robot in enumerate(plan.robots):
        if robot and plan.positions_cm and node not in moving:
            paths.append((node, ((0, *plan.positions_cm[node]),)))
    phases = uniform(plan.seed, "sample", plan.nodes, plan.sample_us)
    walks: list[Any] = []
    points: list[Any] = []
    for node, path in paths:
        first = len(points)
        points += list(path)
        walks.append((node, first, len(points) - 1, int(phases[node]), 0))
    return walks, points


def _set_run(world: m.World, plan: Any) -> None:
    gate_words = sum(max(int(field[1]), 1) for field in mesh_fields.gate(plan.capacity))
    radio, n = plan.radio, plan.nodes
    strengths = powers.strength_table()
    put(
        world.run,
        0,
        nodes=n,
        timers=m.TIMERS,
        own_timers=mesh_const.TIMERS,
        mac=MACS.get(plan.mac, 0),
        collisions=int(radio.collisions and plan.mac in MACS),
        turnaround=radio.turnaround_us,
        byte_ns=radio.byte_ns,
        phy_bytes=radio.phy_bytes,
        sense=max(1, powers.strength(strengths, radio.sense_cdb)),
        capture=powers.capture_ratio(radio.capture_cdb),
        rng=rng.seeded(int(uniform(plan.seed, "medium", 1, 1 << 30)[0])),
        sample=plan.sample_us,
        origin_x=plan.origin_cm[0],
        origin_y=plan.origin_cm[1],
        unit=plan.params["unit_cm"],
        moving=int(bool(radio.base_cdb)),
        rssi50=radio.rssi50_cdb,
        told=plan.params["told"],
        row=plan.params["row"],
        good=len(plan.good),
        free=len(world.air),
        gate_words=gate_words,
        commands=sum(not away for away in plan.absent) + len(plan.faults),
        offers=len(plan.offers),
        duplicate_limit=DUPLICATES // 2 - _margin(n) // 4,
        forget=(plan.params["forget"] - 1) * plan.params["tick_us"],  # they count whole ticks
    )
    for name, length, *_ in mesh_fields.PARAMS:
        if length:
            field = get(world.params, 0, name)
            for i, value in enumerate(plan.params[name]):
                field[i] = value
        else:
            put(world.params, 0, **{name: plan.params[name]})
    if plan.mac in MACS:
        put(world.mac_params, 0, **{name: plan.mac_params.get(name, CSMA[name]) for name in CSMA})


def _set_nodes(world: m.World, plan: Any, spare: int) -> None:
    n = plan.nodes
    seeds = uniform(plan.seed, "nodes", n, rng.FIXED_POINT - 1) + 1
    mac_seeds = uniform(plan.seed, "macs", n, rng.FIXED_POINT - 1) + 1
    offsets = uniform(plan.seed, "offset", n, 1 << 30)
    gate = 0
    put(world.nodes, n, choice=rng.GENERATE)
    for i in range(n):
        own = {"number": i, "rank": plan.ranks[i], "robot": plan.robots[i]}
        put(world.nodes, i, rng=int(seeds[i]), choice=rng.GENERATE, **own)
        put(world.macs, i, rng=int(mac_seeds[i]), choice=rng.GENERATE)
        put(world.radios, i, offset=int(offsets[i]), held=NONE, tell_at=NONE, gate=spare)
        if plan.ranks[i] >= 0:
            put(world.radios, i, gate=gate)
            gate += 1
        if plan.positions_cm:
            x, y = plan.positions_cm[i]
            put(world.radios, i, x=x, y=y)


def _set_events(world: m.World, plan: Any) -> None:
    """Queue the first event of every kind; each queues the next."""
    if plan.offers:
        queue.push(world.heap, queue.key_of(int(get(world.offers, 0, "time")), queue.OFFER, 0, 0))
    if int(get(world.run, 0, "commands")):
        at = int(get(world.commands, 0, "time"))
        queue.push(world.heap, queue.key_of(at, queue.COMMAND, 0, 0))
    for i in range(len(_walks(plan)[0])):
        at, node = int(get(world.walks, i, "phase")), int(get(world.walks, i, "node"))
        queue.push(world.heap, queue.key_of(at, queue.SAMPLE, node, i))
