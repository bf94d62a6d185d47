"""How long samples took from the sensor to the PC."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from innervate.networks.skin.analysis.summary_keys import Latency, PortLatency
from innervate.sim import delays
from innervate.sim.tables import get


def latency_ms(result: Any) -> Latency:
    """Of all samples that the PC received: `mean`, `p50`, `p95`, `p99`, `max`, in ms.

    A percentile is the least value that so many of a hundred do not exceed, to 0.4 % and never
    too small. None without a sample. Samples that were lost have no latency.
    """
    return _figures(result.world, _ports(result))


def command_latency_ms(result: Any) -> Latency:
    """The same of the PC's commands, from the PC to every cell that one was for."""
    world = result.world
    return _figures(world, range(len(_ports(result)), len(world.delays)))


def latency_by_port(result: Any) -> list[PortLatency]:
    """The same for every interface port: `port`, `samples` received there, `latency_ms`."""
    world = result.world
    return [
        {
            "port": port,
            "samples": int(get(world.delays, port, "count")),
            "latency_ms": _figures(world, [port]),
        }
        for port in _ports(result)
    ]


def _ports(result: Any) -> range:
    """Interface ports that samples come to; what is kept of commands stands behind theirs."""
    return range(result.plan.graph.interfaces if result.plan.data_period_us else 0)


def _figures(world: Any, ports: Sequence[int]) -> Latency:
    kept = {
        name: [int(get(world.delays, port, name)) for port in ports]
        for name in ("count", "sum", "high")
    }
    total = sum(kept["count"])
    if total == 0:
        return {"mean": None, "p50": None, "p95": None, "p99": None, "max": None}
    counts = np.array(world.delay_counts, np.int64).reshape(-1, delays.CLASSES)
    upto = np.cumsum(counts[list(ports)].sum(axis=0))
    most = max(kept["high"])

    def percentile(share: int) -> float:
        longest = delays.longest_of(int(np.searchsorted(upto, -(-total * share // 100))))
        return float(min(longest, most) / 1e3)

    return {
        "mean": sum(kept["sum"]) / total / 1e3,
        "p50": percentile(50),
        "p95": percentile(95),
        "p99": percentile(99),
        "max": most / 1e3,
    }
