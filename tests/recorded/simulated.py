"""Small scenarios run plain, which every loop's parity holds compiled: summaries and tables.

Between them they take every branch: each medium access with each kind of traffic, each rule of a
skin, each kind of event, hidden stations, motion, noise, queues that run over.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import innervate
from innervate import scenario as scenarios
from innervate.networks.radio.scenario.model import MACS
from innervate.networks.radio.slotted.model import slotted
from tests.networks.radio.slotted.test_parity import CASES, TRAFFIC
from tests.recorded.data import plain
from tests.recorded.plans import SMALL
from tests.recorded.record import OF_THE_MACHINE

Sets = tuple[str, ...]
EVENTS = (
    "event=[{at_s=0.12, action='kill', station=1}, {at_s=0.2, action='leave', station=2}, "
    "{at_s=0.3, action='join', station=1}, {at_s=0.15, action='garble', station=3, frames=2}, "
    "{at_s=0.22, action='fade', station=4, frames=2}]"
)
BAD: Sets = (EVENTS, "channel.hidden=[[0,5]]", "channel.loss=0.05", "duration_s=0.5")
SATURATED: Sets = ("traffic.kind=saturated", "traffic.packets=3")
POISSON: Sets = ("traffic.kind=poisson", "traffic.load=0.8", "duration_s=0.3")
OFFERED = ("csma-cd-r", "dcf", "tree")
EACH: dict[str, tuple[Sets, ...]] = {
    "radio-all": (("duration_s=2.5",),),
    "radio-paper": ((), ("channel.turnaround_us=0", "traffic.spread_us=0")),
    "skin-patches": tuple(
        (f"protocol.rule={rule}", f"protocol.updates={updates}", *more)
        for rule, updates, more in (
            ("feasible", "wave", ()),
            ("strict", "triggered", ("timing.latency=per_frame", "duration_s=1.05")),
            ("paper", "periodic", ("data.rate_hz=120", "duration_s=1.05",
                                   "protocol.balance_rule=paper", "protocol.balance_periods=3")),
            ("static", "wave", ()),
            ("feasible", "wave", ("timing.lock_step=true", "timing.loss=0.2")),
        )
    ),
    "skin-copies": (
        ("protocol.balance_periods=5", "data.rate_hz=900", "data.queue=1", "duration_s=0.2"),
    ),
    "mesh-links": ((), ("radio.profile=38k4", "protocol.discovery=tree")),
    "mesh-grid": (
        ("duration_s=36",),
        ("duration_s=36", "protocol.failover=alternate", "flow.0.every_s=30"),
    ),
    "mesh-near": (
        (), ("radio.mac=csma-cd-r",), ("radio.mac=dcf",),
    ),
    "mesh-fence": (("duration_s=40",),),
    "mesh-wide": ((),),
}  # fmt: skip


def found() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Name and run of everything."""
    for mac in MACS:
        yield f"{mac}, saturated", partial(of_mac, mac, (*SATURATED, *BAD))
    for mac in OFFERED:
        yield f"{mac}, poisson", partial(of_mac, mac, POISSON)
    yield "csma-cd-r, at once", partial(of_mac, "csma-cd-r", BAD)
    for name, variants in EACH.items():
        for sets in variants:
            yield ", ".join((name, *sets)), partial(ran, name, sets)
    for mac, options in CASES:
        for traffic, load in TRAFFIC:
            said = " ".join(f"{key}={value}" for key, value in options.items() if key != "dcf")
            name = f"slotted {mac} {said}{'basic' if 'dcf' in options else ''}".strip()
            yield f"{name}, {traffic}", partial(in_slots, mac, traffic, load, options)


def of_mac(mac: str, sets: Sets) -> Any:
    """A few stations under a medium access protocol."""
    return ran("radio-few", (f"protocol.mac={mac}", *sets))


def ran(name: str, sets: Sets) -> Any:
    """The summary and the tables of a run."""
    done = innervate.run(scenarios.load(SMALL / f"{name}.toml", sets), plain=True)
    summary = {key: value for key, value in done.summary.items() if key not in OF_THE_MACHINE}
    tables = {key: table.collect() for key, table in done.tables.items()}
    rows = {key: plain([list(row) for row in table.iter_rows()]) for key, table in tables.items()}
    return {**json.loads(json.dumps(summary)), "tables": rows}


def in_slots(mac: str, traffic: str, load: float | None, options: Any) -> Any:
    """What a run that counts slots measures."""
    more = {} if load is None else {"load": load}
    run = slotted(mac, 5, 7, traffic, packets=12, seed=3, warmup=0.1, plain=True, **more, **options)
    return {name: plain(getattr(run, name)) for name in run.__slots__}
