"""Radio runs on the slotted level: the reference model instead of the event-level channel."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from innervate.analysis.radio_headline import RadioFacts, headline
from innervate.analysis.radio_summary import Delays, SlottedSummary
from innervate.kernel.wall import wall_s
from innervate.scenario.radio_traffic import mean_interval_us
from innervate.sim.slotted import SlottedResult, slotted

NONE = (None, None, None, None)


@dataclass(slots=True)
class SlottedRun:
    """What a run on the slotted level leaves; it has no rows, and `found` for all else."""

    plan: Any
    found: SlottedResult
    counts: dict[str, int]
    ended_us: int
    wall_s: float
    fingerprint: str
    interrupted: bool = False
    received_kept: bool = False


def simulate(plan: Any, plain: bool) -> SlottedRun:
    """Run a plan on the slotted level.

    Raises:
        ScenarioError: the protocol cannot run that traffic.
    """
    model, source = plan.scenario.model, plan.scenario.source
    protocol, traffic = model.protocol, model.traffic
    options: dict[str, Any] = {}
    slot_us = plan.params["slot_us"]
    if protocol.mac == "csma-cd-r":
        options["reading"] = protocol.reading
    if protocol.mac in ("csma-cd-r", "csma-cd-d2", "csma-cd-d2p") and plan.params["ta_us"]:
        options["turnaround_slots"] = plan.params["ta_us"] / slot_us
    if protocol.mac in ("slotted-aloha", "nonpersistent", "p-persistent"):
        options["p"] = protocol.p
    if protocol.mac in ("csma-cd-d1", "csma-cd-d2", "csma-cd-d2p"):
        options["backoff_slots"] = protocol.backoff_slots
    packets = traffic.packets
    if traffic.kind == "poisson":
        packets = max(1, plan.duration_us // mean_interval_us(model, slot_us))
    started = wall_s()
    try:
        found = slotted(
            protocol.mac,
            plan.stations,
            plan.params["packet_slots"],
            traffic.kind,
            packets=packets,
            seed=plan.seed,
            load=traffic.load if traffic.kind == "poisson" else None,
            plain=plain,
            **options,
        )
    except ValueError as error:
        raise source.error(("protocol", "mac"), f"on the slotted level {error}") from None
    took = wall_s() - started
    digest = hashlib.blake2b(np.asarray(found.order, np.int64).tobytes(), digest_size=8)
    digest.update(np.round(found.delay_slots * 1000).astype(np.int64).tobytes())
    done = sum(found.successes)
    return SlottedRun(
        plan=plan,
        found=found,
        counts={"offers": done, "completed": done, "handled": done},
        ended_us=round(found.duration_slots * slot_us),
        wall_s=took,
        fingerprint=digest.hexdigest(),
    )


def summarize(result: SlottedRun) -> SlottedSummary:
    """The summary of a slotted run, by the names of other radio runs."""
    plan, found = result.plan, result.found
    delays = found.delay_slots
    p50, p95, p99, most = (
        np.quantile(delays, (0.5, 0.95, 0.99, 1)).tolist() if len(delays) else NONE
    )
    quantiles: Delays = {"p50": p50, "p95": p95, "p99": p99, "max": most}
    first = list(dict.fromkeys(found.order))
    done = result.counts["completed"]
    facts = RadioFacts(plan.stations, offered=done, delivered=done, ended=True)
    return {
        "kind": plan.kind,
        "name": plan.scenario.name,
        "headline": headline(facts).as_summary(),
        "seed": plan.seed,
        "duration_s": plan.duration_us / 1e6,
        "events": done,
        "events_per_s": round(done / result.wall_s) if result.wall_s > 0 else None,
        "wall_s": round(result.wall_s, 6),
        "fingerprint": result.fingerprint,
        "level": "slotted",
        "protocol": plan.scenario.model.protocol.mac,
        "stations": plan.stations,
        "throughput": found.throughput,
        "duration_slots": found.duration_slots,
        "jain": found.jain,
        "jain_round": found.jain_round,
        "delay_slots": quantiles,
        "collisions": found.collisions,
        "lost_silently": 0,
        "order": found.order[:1000] if plan.scenario.model.traffic.kind == "disaster" else first,
    }
