"""Radio runs on the slotted level: the reference model instead of the event-level channel."""

import hashlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from innervate.analysis.percentiles import percentiles
from innervate.analysis.summary_common import measured
from innervate.kernel.clock import wall_s
from innervate.networks.radio.analysis.headline import RadioFacts, headline
from innervate.networks.radio.analysis.summary_keys import Delays, SlottedSummary
from innervate.networks.radio.scenario.slotted import TURNAROUND, USED_BY
from innervate.networks.radio.scenario.traffic import mean_interval_us
from innervate.networks.radio.slotted.model import SlottedResult, slotted


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
    has_deliveries: bool = False


def simulate(plan: Any, plain: bool) -> SlottedRun:
    """Run a plan on the slotted level.

    Raises:
        ScenarioError: the protocol cannot run that traffic.
    """
    model, source = plan.scenario.model, plan.scenario.source
    protocol, traffic = model.protocol, model.traffic
    slot_us = plan.params["slot_us"]
    options = {
        name: getattr(protocol, name)
        for (table, name), macs in USED_BY.items()
        if table == "protocol" and protocol.mac in macs
    }
    if protocol.mac in TURNAROUND:
        options["turnaround_slots"] = plan.params["ta_us"] / slot_us
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
            until_slots=plan.duration_us / slot_us,
            plain=plain,
            **options,
        )
    except ValueError as error:
        raise source.error(("protocol", "mac"), f"on the slotted level {error}") from None
    took = wall_s() - started
    digest = hashlib.blake2b(np.asarray(found.order, np.int64).tobytes(), digest_size=8)
    digest.update(np.round(found.delay_slots * 1000).astype(np.int64).tobytes())
    done = sum(found.successes)
    offers = plan.stations if traffic.kind == "disaster" else done
    return SlottedRun(
        plan=plan,
        found=found,
        counts={"offers": offers, "completed": done, "handled": done},
        ended_us=round(found.duration_slots * slot_us),
        wall_s=took,
        fingerprint=digest.hexdigest(),
    )


def summarize(result: SlottedRun) -> SlottedSummary:
    """The summary of a slotted run, by the names of other radio runs."""
    plan, found = result.plan, result.found
    p50, p95, p99, most = percentiles(found.delay_slots, (50, 95, 99, 100))
    quantiles: Delays = {"p50": p50, "p95": p95, "p99": p99, "max": most}
    first = list(dict.fromkeys(found.order))
    done = result.counts["completed"]
    offers = result.counts["offers"]
    facts = RadioFacts(
        plan.stations,
        offered=offers,
        delivered=done,
        pending=offers - done,
        overdue=offers - done,
        ended=True,
    )
    return {
        "kind": plan.kind,
        "name": plan.scenario.name,
        "headline": headline(facts).as_summary(),
        **measured(result, done),
        "level": "slotted",
        "protocol": plan.scenario.model.protocol.mac,
        "stations": plan.stations,
        "throughput": found.throughput,
        "duration_slots": found.duration_slots,
        "jain": found.jain,
        "jain_round": found.jain_round,
        "delay_slots": quantiles,
        "collisions": found.collisions,
        "delivered": done,
        "lost_silently": 0,
        "order": found.order[:1000] if plan.scenario.model.traffic.kind == "disaster" else first,
    }
