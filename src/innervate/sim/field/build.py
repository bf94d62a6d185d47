"""From a plan of declared nodes in a field to a world, compiled (arrays) or plain (lists)."""

from typing import Any

import numpy as np

from innervate.dialect import rng
from innervate.kernel import records
from innervate.network import Network, access_of
from innervate.sim.channel.world import Heap
from innervate.sim.field import listening, powers, queue
from innervate.sim.field import world as w
from innervate.sim.field.loop import BOOT, NEVER
from innervate.sim.field.medium import NONE
from innervate.sim.own import came_of
from innervate.sim.recorded import Recorded
from innervate.sim.tables import ACTION, TAP, Tables, put, uniform

OUTBOX = 16
PLACES_PER_NODE = 4
TAPS = 1 << 12
RSSI50_CDB = -9_500
NOTHING = (("number", 0, 0, 0, "node", "not used"),)
# What is handed to a medium access, where there is none.
NOT_USED = tuple((name, 0, 0, 0, "", "not used") for name in ("us", "urgent", "attempt"))


def build(plan: Any, network: Network, plain: bool, kept: Recorded) -> w.World:
    """The world of a plan, before its first event."""
    tables, fields, n = Tables(plain, np.int64), network.fields, plan.nodes
    stations = tables.states(fields.STATE, n + 1)
    low, high = records.bounds(fields.STATE)
    room = getattr(network.protocol, "OUTBOX", OUTBOX)
    below = access_of(network) if network.over else None
    own_timers = network.protocol.TIMERS
    timers = own_timers + (below.timers if below else 0)
    world = w.World(
        run=tables.records(w.RUN, 1, wide=w.WIDE),
        heap=Heap(tables.numbers(128 * n + 1024, 0, np.int64), tables.numbers(1, 0, np.int64)),
        stations=stations,
        words=tables.words(stations, fields.STATE),
        low=tables.given(low, np.int32),
        high=tables.given(high, np.int32),
        spans=tables.spans(fields.STATE),
        params=tables.states(fields.PARAMS, 1),
        radios=tables.records(w.RADIO, n, wide=w.RADIO),
        below=(),
        due=tables.numbers(n * timers, NEVER, np.int64),
        **_access(tables, below, n),
        **_medium(tables, plan, fields.FRAME),
        **_given(tables, plan, fields.FRAME),
        item=tables.states(fields.FRAME, 1),
        came=came_of(plan, tables),
        out=tables.outbox(room, fields.FRAME, ACTION),
        counters=tables.numbers(listening.COUNTERS, 0, np.int64),
        # In one event all may be given a frame, and all be told that a carrier has gone.
        **_rows(tables, 2 * n * (room + 1), fields.FRAME, kept),
    )
    _set_run(world, plan, timers, own_timers)
    _set_limits(world, tables.rows, kept)
    _set_params(world, plan, fields.PARAMS, below)
    _set_nodes(world, plan, {name for name, *_ in fields.STATE}, below)
    _set_events(world, plan)
    return world


def _access(tables: Tables, below: Any, nodes: int) -> dict[str, Any]:
    """What the medium access has, a record for each node, and its outbox."""
    item = below.item if below else NOT_USED
    return {
        "macs": tables.states(below.state if below else NOTHING, nodes),
        "mac_params": tables.states(below.params if below else NOTHING, 1),
        "mac_item": tables.states(item, 1),
        "mac_out": tables.outbox(below.room if below else 1, item, ACTION),
    }


def _set_params(world: w.World, plan: Any, params: Any, below: Any) -> None:
    for name, *_ in params:
        put(world.params, 0, **{name: plan.params[name]})
    if below:
        put(world.run, 0, mac=1)
        for name, _length, least, *_ in below.params:
            put(world.mac_params, 0, **{name: getattr(plan.air, name, least)})


def _set_events(world: w.World, plan: Any) -> None:
    """Queue the first event of every kind; each queues the next."""
    if plan.inputs:
        queue.push(world.heap, queue.key_of(plan.inputs[0].at_us, queue.OFFER, 0, 0))
    events = _events(plan)
    if events:
        queue.push(world.heap, queue.key_of(events[0][0], queue.COMMAND, 0, 0))


def _medium(tables: Tables, plan: Any, frame: Any) -> dict[str, Any]:
    """Tables of the medium: frames in the air, powers between nodes."""
    n, heard = plan.nodes, plan.heard
    places = min(PLACES_PER_NODE * n + 64, queue.PLACES_MAX)
    strengths = powers.strength_table()
    power = [powers.strength(strengths, cdb) for cdb in heard.rssi_cdb]
    power[:: n + 1] = [0] * n  # nobody hears himself
    prob = list(heard.prob_q15)
    prob[:: n + 1] = [0] * n
    waiting = n * plan.air.queue_frames
    return {
        "rssi": tables.given(heard.rssi_cdb, np.int32),
        "prob": tables.given(prob, np.int32),
        "cut": tables.numbers(n * n),
        "power": tables.given(power),
        "sums": tables.numbers(n, 0, np.int64),
        "strengths": tables.given(strengths),
        "air": tables.records(w.AIR, places, wide=w.AIR),
        "frames": tables.states(frame, places),
        "worst": tables.numbers(places * n, 0, np.int64),
        "on_air": tables.numbers(places),
        "free": tables.given(range(places - 1, -1, -1)),
        "got": tables.numbers(n),
        "ring": tables.states(frame, waiting),
        "acts": tables.records(ACTION, waiting, wide=ACTION),
    }


def _events(plan: Any) -> list[tuple[int, ...]]:
    """What is done to nodes, in order of time; first of all they are switched on."""
    events = [(at, BOOT, i, 0, 0) for i, at in enumerate(plan.starts_us) if not plan.absent[i]]
    events += [(f.at_us, f.action, f.node, max(f.other, 0), f.value) for f in plan.faults]
    return sorted(events, key=lambda event: event[0])


def _given(tables: Tables, plan: Any, frame: Any) -> dict[str, Any]:
    """What happens to nodes, and what they are handed, as tables in order of time."""
    offers = [(one.at_us, one.node, one.kind) for one in plan.inputs]
    items = tables.states(frame, len(offers) + 1)
    for place, one in enumerate(plan.inputs):
        put(items, place, **one.item)
    found = {"items": items}
    for name, names, made in (
        ("commands", w.COMMAND, _events(plan)), ("offers", w.OFFER, offers),
    ):  # fmt: skip
        table = tables.records(names, max(len(made), 1), wide=names)
        for i, row in enumerate(made):
            put(table, i, **dict(zip(names, row, strict=True)))
        found[name] = table
    return found


def _rows(tables: Tables, margin: int, frame: Any, kept: Recorded) -> dict[str, Any]:
    """Tables of what is kept, with room for what one event can add."""
    rows = tables.rows + margin if kept.observe else 1
    tapped = TAPS + margin if kept.tap else 1
    trail = tables.rows + margin if kept.trail else 1
    return {
        "rows": tables.records(w.ROW, rows, True, w.WIDE),
        "deliveries": tables.records(w.DELIVERY, rows, True, w.WIDE),
        "trail": tables.records(w.TRAIL, trail, True, w.WIDE),
        "taps": tables.records(TAP, tapped, True, w.WIDE),
        "tapped": tables.states(frame, tapped),
    }


def _set_limits(world: w.World, rows: int, kept: Recorded) -> None:
    limit = rows if kept.observe else 0
    put(world.run, 0, row_limit=limit, delivery_limit=limit, checks=int(kept.checks))
    put(world.run, 0, trail_limit=rows if kept.trail else 0, watchful=int(kept.is_watchful))
    put(world.run, 0, tap_limit=TAPS if kept.tap else 0)


def _set_run(world: w.World, plan: Any, timers: int, own_timers: int) -> None:
    radio = plan.air
    sense_cdb = RSSI50_CDB - round(100 * radio.sense_db)
    put(
        world.run,
        0,
        nodes=plan.nodes,
        timers=timers,
        own_timers=own_timers,
        collisions=1,
        turnaround=radio.turnaround_us,
        byte_ns=round(8e9 / radio.bits_per_s),
        phy_bytes=radio.preamble_bytes,
        sense=max(1, powers.strength(powers.strength_table(), sense_cdb)),
        capture=powers.capture_ratio(round(100 * radio.capture_db)),
        rng=rng.seeded(int(uniform(plan.seed, "medium", 1, 1 << 30)[0])),
        told=1,
        free=len(world.air),
        commands=len(_events(plan)),
        offers=len(plan.inputs),
        room=radio.queue_frames,
    )


def _set_nodes(world: w.World, plan: Any, names: set[str], below: Any) -> None:
    n = plan.nodes
    seeds = uniform(plan.seed, "nodes", n, rng.FIXED_POINT - 1) + 1
    mac_seeds = uniform(plan.seed, "macs", n, rng.FIXED_POINT - 1) + 1
    offsets = uniform(plan.seed, "offset", n, 1 << 30)
    for i in range(n):
        own = {"number": i, "rng": int(seeds[i]), "choice": rng.GENERATE}
        put(world.stations, i, **{name: own[name] for name in own if name in names})
        put(world.radios, i, offset=int(offsets[i]), held=NONE, tell_at=NONE)
        if below:
            put(world.macs, i, rng=int(mac_seeds[i]), choice=rng.GENERATE)
