"""The compiled mesh: networks of three capacity classes with messages, for a minute of their time.

An event is a handler call or a frame that arrives somewhere. Radio 250k, mean degree 8, ten pairs
of nodes with a message every 2 s, and a robot that crosses its fence. The best of a few runs
counts, because other work on the machine only ever slows one down.
"""

import time

from innervate import scenario
from innervate.networks.mesh.sim.simulate import simulate
from innervate.running import run

NODES = (30, 100, 254)
DURATION_S = 60.0
BAR_S = 2.0  # 30 nodes for a minute, warm
RUNS = 3


def tables(nodes):
    """A field with messages, and a robot that crosses its fence."""
    return {
        "kind": "mesh",
        "name": f"bench-{nodes}",
        "nodes": nodes,
        "duration_s": DURATION_S,
        "fence": {"polygon": [[15, 15], [85, 15], [85, 85], [15, 85]]},
        "robot": [{"node": nodes - 1, "waypoints": [[70, 60], [70, 95]], "start_s": 20}],
        "flow": [{"from": "random", "to": "random", "pairs": 10, "every_s": 2, "jitter_s": 1}],
    }


def measure(nodes, checks=False):
    """Seconds and events per second of the loop; without checks also without rows."""
    plan = scenario.plan(scenario.from_dict(tables(nodes)))
    results = [simulate(plan, checks=checks, observe=checks) for _ in range(RUNS)]
    best = min(results, key=lambda result: result.wall_s)
    events = best.counts["handled"] + best.counts["arrived"]
    return {
        "nodes": nodes,
        "wall_s": best.wall_s,
        "events": events,
        "events_per_s": events / best.wall_s,
        "s_per_s": DURATION_S / best.wall_s,
    }


def whole_s(nodes):
    """Seconds of `innervate.run`, plan and summary included: what the bar is about."""
    walls = []
    for _ in range(RUNS):
        started = time.perf_counter()
        run(tables(nodes))
        walls.append(time.perf_counter() - started)
    return min(walls)
