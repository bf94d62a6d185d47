"""From a plan of declared nodes in a field to a world, compiled (arrays) or plain (lists)."""

from collections.abc import Collection
from typing import Any, NamedTuple

import numpy as np

from innervate.dialect import rng
from innervate.kernel import records
from innervate.network import Network, access_of
from innervate.scenario.declared.field import in_reach
from innervate.scenario.declared.moving import placed_of
from innervate.sim import heard
from innervate.sim.channel.world import Heap
from innervate.sim.field import powers, queue, walkers
from innervate.sim.field import world as w
from innervate.sim.field.loop import BOOT, NEVER
from innervate.sim.field.medium import NONE
from innervate.sim.recorded import Recorded
from innervate.sim.tables import (
    ACTION,
    DELIVERY,
    ROW,
    TAP,
    TRAIL,
    Names,
    Tables,
    get,
    put,
    timed,
    uniform,
)
from innervate.topology.placement import RSSI50_CDB

OUTBOX = 16
PLACES_PER_NODE = 4
TAPS = 1 << 12


class Access(NamedTuple):
    """What the tables have of a medium access (a role of boards has it, too)."""

    state: Any
    params: Any
    item: Any
    room: int  # actions of its outbox
    timers: int


NOTHING = (("number", 0, 0, 0, "node", "not used"),)
NO_ACCESS = Access(
    NOTHING, NOTHING,
    tuple((name, 0, 0, 0, "", "not used") for name in ("us", "urgent", "attempt")), 1, 0,
)  # fmt: skip


def build(plan: Any, network: Network, plain: bool, kept: Recorded) -> w.World:
    """The world of a plan, before its first event."""
    tables, fields, n = Tables(plain, np.int64), network.fields, plan.nodes
    stations = tables.states(fields.STATE, n + 1)
    low, high = records.bounds(fields.STATE)
    room = getattr(network.protocol, "OUTBOX", OUTBOX)
    below = access_of(network) if network.over else NO_ACCESS
    places = min(PLACES_PER_NODE * n + 64, queue.PLACES_MAX)
    waiting = n * plan.air.queue_frames
    # In one event all may be given a frame, and all be told that a carrier has gone.
    chances = [in_reach(chance) for chance in powers.chance_table()]
    margin, rows = 2 * n * (room + 1), {"rows": ROW, "deliveries": DELIVERY}
    world = w.World(
        run=tables.records(w.RUN, 1, wide=w.WIDE),
        heap=heap_of(tables, n),
        stations=stations,
        words=tables.words(stations, fields.STATE),
        low=tables.given(low, np.int32),
        high=tables.given(high, np.int32),
        spans=tables.spans(fields.STATE),
        params=tables.states(fields.PARAMS, 1),
        radios=tables.records(w.RADIO, n, wide=w.RADIO),
        below=(),
        due=tables.numbers(n * (network.protocol.TIMERS + below.timers), NEVER, np.int64),
        **access_tables(tables, below, n),
        **air_tables(tables, plan.heard, tables.states(fields.FRAME, places), n),
        **walkers.motion_tables(tables, plan, plan.heard, plan.walks, chances),
        ring=tables.states(fields.FRAME, waiting),
        acts=tables.records(ACTION, waiting, wide=ACTION),
        commands=timed(tables, w.COMMAND, events_of(plan)),
        offers=timed(tables, w.OFFER, [(one.at_us, one.node, one.kind) for one in plan.inputs]),
        items=tables.states(fields.FRAME, len(plan.inputs) + 1),
        item=tables.states(fields.FRAME, 1),
        out=tables.outbox(room, fields.FRAME, ACTION),
        **heard.tables_of(tables, plan),
        **kept_tables(tables, kept, margin, fields.FRAME, w.WIDE, **rows),
    )
    set_limits(world, tables.rows, kept, "row_limit", "delivery_limit")
    _set_up(world, plan, network, below)
    return world


def _set_up(world: w.World, plan: Any, network: Network, below: Any) -> None:
    """Its numbers, parameters and nodes; what happens first."""
    radio, fields, has_access = plan.air, network.fields, bool(network.over)
    placed = placed_of(fields)
    set_air(
        world,
        plan,
        network.protocol.TIMERS,
        RSSI50_CDB - round(100 * radio.sense_db),
        round(100 * radio.capture_db),
        turnaround=radio.turnaround_us,
        byte_ns=round(8e9 / radio.bits_per_s),
        phy_bytes=radio.preamble_bytes,
        mac=int(has_access),
        collisions=1,
        told=1,
        sample=plan.sample_us,
        unit=placed.unit_cm if placed is not None else 1,
        moving=int(bool(plan.walks)),
        rssi50=RSSI50_CDB,
        offers=len(plan.inputs),
        room=radio.queue_frames,
    )
    for name, *_ in fields.PARAMS:
        put(world.params, 0, **{name: plan.params[name]})
    for name, _length, least, *_ in below.params if has_access else ():
        put(world.mac_params, 0, **{name: getattr(radio, name, least)})
    for place, one in enumerate(plan.inputs):
        put(world.items, place, **one.item)
    seeds = set_radios(world, plan.seed, has_access)
    names = {name for name, *_ in fields.STATE}
    for i in range(plan.nodes):
        own = {"number": i, "rng": int(seeds[i]), "choice": rng.GENERATE}
        put(world.stations, i, **{name: own[name] for name in own if name in names})
    walkers.place(world, plan)
    push_first(world)
    walkers.push_samples(world, len(plan.walks))


# What any network in a field has.


def heap_of(tables: Tables, nodes: int) -> Heap:
    """An empty event queue, with room for what so many nodes have."""
    return Heap(tables.numbers(128 * nodes + 1024, 0, np.int64), tables.numbers(1, 0, np.int64))


def access_tables(tables: Tables, below: Any, nodes: int) -> dict[str, Any]:
    """What a medium access has, a record for each node, and its outbox."""
    return {
        "macs": tables.states(below.state, nodes),
        "mac_params": tables.states(below.params, 1),
        "mac_item": tables.states(below.item, 1),
        "mac_out": tables.outbox(below.room, below.item, ACTION),
    }


def air_tables(tables: Tables, heard: Any, frames: Any, nodes: int) -> dict[str, Any]:
    """Tables of the medium: frames in the air, powers between nodes.

    Args:
        tables: makes them.
        heard: `rssi_cdb` and `prob_q15` by sender and receiver.
        frames: a place for each frame under way.
        nodes: how many there are.
    """
    strengths, places = powers.strength_table(), len(frames)
    power = [powers.strength(strengths, cdb) for cdb in heard.rssi_cdb]
    prob = list(heard.prob_q15)
    for own in range(0, nodes * nodes, nodes + 1):  # nobody hears himself
        power[own] = prob[own] = 0
    return {
        "rssi": tables.given(heard.rssi_cdb, np.int32),
        "prob": tables.given(prob, np.int32),
        "cut": tables.numbers(nodes * nodes),
        "power": tables.given(power),
        "sums": tables.numbers(nodes, 0, np.int64),
        "strengths": tables.given(strengths),
        "air": tables.records(w.AIR, places, wide=w.AIR),
        "frames": frames,
        "worst": tables.numbers(places * nodes, 0, np.int64),
        "on_air": tables.numbers(places),
        "free": tables.given(range(places - 1, -1, -1)),
        "got": tables.numbers(nodes),
    }


def events_of(plan: Any) -> list[tuple[int, ...]]:
    """What is done to nodes, in order of time; first of all they are switched on."""
    events = [(at, BOOT, i, 0, 0) for i, at in enumerate(plan.starts_us) if not plan.absent[i]]
    events += [(f.at_us, f.action, f.node, max(f.other, 0), f.value) for f in plan.faults]
    return sorted(events, key=lambda event: event[0])


def kept_tables(
    tables: Tables, kept: Recorded, margin: int, frame: Any, wide: Collection[str], **rows: Names
) -> dict[str, Any]:
    """Tables of what is kept, with room for what one event can add (`margin`)."""
    room = tables.rows + margin if kept.observe else 1
    tapped = TAPS + margin if kept.tap else 1
    trail = tables.rows + margin if kept.trail else 1
    return {
        **{name: tables.records(names, room, True, wide) for name, names in rows.items()},
        "trail": tables.records(TRAIL, trail, True, wide),
        "taps": tables.records(TAP, tapped, True, wide),
        "tapped": tables.states(frame, tapped),
    }


def set_limits(world: Any, rows: int, kept: Recorded, *limits: str) -> None:
    """How many rows of each kind are kept before the loop stops; `limits` are those observed."""
    put(world.run, 0, **dict.fromkeys(limits, rows if kept.observe else 0))
    put(world.run, 0, checks=int(kept.checks), watchful=int(kept.is_watchful))
    put(world.run, 0, trail_limit=rows if kept.trail else 0, tap_limit=TAPS if kept.tap else 0)


def set_air(
    world: Any, plan: Any, own_timers: int, sense_cdb: int, capture_cdb: int, **more: int
) -> None:
    """The numbers of a run; `sense_cdb`, `capture_cdb` in 0.01 dB, `more` as they are."""
    put(
        world.run,
        0,
        nodes=plan.nodes,
        timers=len(world.due) // plan.nodes,
        own_timers=own_timers,
        sense=max(1, powers.strength(powers.strength_table(), sense_cdb)),
        capture=powers.capture_ratio(capture_cdb),
        rng=rng.seeded(int(uniform(plan.seed, "medium", 1, 1 << 30)[0])),
        free=len(world.air),
        commands=len(events_of(plan)),
        **more,
    )


def set_radios(world: Any, seed: int, has_access: bool) -> Any:
    """Clocks and radios of nodes, the medium access's random numbers; seeds of the nodes' own."""
    n = len(world.radios)
    offsets = uniform(seed, "offset", n, 1 << 30)
    seeds = uniform(seed, "macs", n, rng.FIXED_POINT - 1) + 1
    for i in range(n):
        put(world.radios, i, offset=int(offsets[i]), held=NONE, tell_at=NONE)
        if has_access:
            put(world.macs, i, rng=int(seeds[i]), choice=rng.GENERATE)
    return uniform(seed, "nodes", n, rng.FIXED_POINT - 1) + 1


def push_first(world: Any) -> None:
    """Queue what nodes are given first, and what is done to them first; each queues the next."""
    for name, rank in (("offers", queue.OFFER), ("commands", queue.COMMAND)):
        if int(get(world.run, 0, name)):
            at = int(get(getattr(world, name), 0, "time"))
            queue.push(world.heap, queue.key_of(at, rank, 0, 0))
