"""The summary of a skin's run: what a person wants to know of it, as plain numbers and words."""

from typing import Any

import numpy as np

from innervate.analysis.summary_common import measured
from innervate.networks.skin.analysis.commands import commands_summary
from innervate.networks.skin.analysis.frames import beacon_share, data_summary
from innervate.networks.skin.analysis.headline import skin_headline
from innervate.networks.skin.analysis.load import balance_factor, port_loads
from innervate.networks.skin.analysis.proved import outside
from innervate.networks.skin.analysis.reach import reach, skin_facts
from innervate.networks.skin.analysis.recovery import recoveries, start_up
from innervate.networks.skin.analysis.rows import NEVER, broken_changes, loop_episodes
from innervate.networks.skin.analysis.summary_keys import BrokenPort, Loops, SkinSummary
from innervate.networks.skin.protocol.constants import ONE, PORTS
from innervate.networks.skin.scenario.warnings import warnings
from innervate.sim.cables.world import ALIVE
from innervate.sim.tables import column
from innervate.topology import PORT_NAMES


def summarize(result: Any) -> SkinSummary:
    """The summary of a run; what never happened is None."""
    plan = result.plan
    loads = port_loads(result)
    data = data_summary(result)
    facts = skin_facts(result, data)
    return {
        "kind": plan.kind,
        "name": plan.scenario.name,
        **measured(result, result.handled + result.arrived),
        "headline": skin_headline(facts, plan.graph.label).as_summary(),
        "warnings": [*warnings(plan), *outside(result.rows, plan.graph.label)],
        "cells": plan.graph.cells,
        "depth_max": plan.depth_max,
        "start_up": start_up(result),
        "recoveries": recoveries(result),
        **reach(result, facts),
        "loops": loops(result),
        "balance_factor": balance_factor(loads),
        "port_loads": loads,
        "data": data,
        "commands": commands_summary(result),
        "beacon_share": beacon_share(result),
        "broken": broken_ports(result),
    }


def loops(result: Any) -> Loops:
    """How many forwarding loops there were, and how long the longest stood (ms)."""
    found = loop_episodes(result)
    ends = np.where(found.closed_us == NEVER, result.ended_us, found.closed_us)
    longest = int((ends - found.opened_us).max()) / 1e3 if len(ends) else None
    return {"episodes": len(ends), "longest_ms": longest}


def broken_ports(result: Any) -> list[BrokenPort]:
    """Ports that carry a cable and are broken at the end, at cells that are on."""
    graph = result.plan.graph
    penalty = column(result.world.cells, "pf").reshape(-1)
    peer = np.frombuffer(graph.peer, np.int32)[: PORTS * graph.cells]
    alive = np.array(result.world.alive[: graph.cells]) == ALIVE
    ends = np.flatnonzero((penalty >= ONE) & (peer >= 0) & np.repeat(alive, PORTS))
    changes = broken_changes(result)
    # Of several changes of a port the last, which is that it was found broken.
    since = dict(zip(changes.end.tolist(), changes.time_us.tolist(), strict=True))
    return [
        {
            "cell": graph.label(end // PORTS),
            "port": PORT_NAMES[end % PORTS],
            "since_s": since[end] / 1e6 if end in since else None,
            "to": graph.label_end(int(peer[end])),
        }
        for end in ends.tolist()
    ]
