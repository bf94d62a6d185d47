"""Meshes drawn from one number: radios, settings, messages, robots, deaths and noise."""

import random
from collections.abc import Iterator

from innervate.scenario.shrink import Tables, with_fewer_keys

SHARE = (0.75, 1.0)

ACTIONS = ("kill", "kill", "revive", "revive", "cut", "restore", "jam", "quiet", "restart")
PROFILES = ("250k", "250k", "250k", "ideal", "ip", "38k4")
FAILOVERS = ("search", "search", "graph", "alternate", "rssi", "heard", "random")


def drawn(draw: random.Random, seed: int) -> Tables:
    """The mesh that a generator's next numbers stand for."""
    nodes = draw.randint(3, 24)
    profile = draw.choice(PROFILES)
    scale = 5 if profile == "38k4" else 1
    duration_s = draw.choice((15.0, 40.0)) * scale
    tables: Tables = {
        "kind": "mesh",
        "name": f"random-{seed}",
        "seed": seed,
        "duration_s": duration_s,
        "nodes": nodes,
        "gateway": 0,
        "standby": draw.sample(range(1, nodes), draw.choice((0, 0, 1, 2))),
        "radio": {"profile": profile, "mean_degree": min(draw.uniform(3.5, 9.0), nodes - 1.0)},
        "protocol": _protocol(draw),
        "flow": [_flow(draw, nodes, duration_s) for _ in range(draw.randint(1, 4))],
        "event": [_event(draw, nodes, duration_s) for _ in range(draw.randint(0, 10))],
    }
    if draw.random() < 0.3:
        tables["fence"] = {"polygon": [[20, 20], [80, 20], [80, 80], [20, 80]]}
        tables["robot"] = [{"node": nodes - 1, "random": True, "speed_mps": draw.uniform(1, 9)}]
    return tables


def _protocol(draw: random.Random) -> Tables:
    failover = draw.choice(FAILOVERS)
    tables = failover == "graph" or draw.random() < 0.9
    reliable = draw.random() < 0.9
    return {
        "failover": failover,
        "discovery": draw.choice(("list", "list", "tree", "each")),
        "retry": draw.random() < 0.8,
        "reliable": reliable,
        "on_demand": reliable and draw.random() < 0.2,
        "tables": tables,
        "activation": tables and draw.random() < 0.2,
        "mtu": draw.choice((64, 127)),
        "transmissions": draw.choice((1, 3, 3)),
    }


def _flow(draw: random.Random, nodes: int, duration_s: float) -> Tables:
    ends = draw.sample(range(nodes), 2)
    return {
        "from": ends[0],
        "to": draw.choice((ends[1], ends[1], "monitor" if ends[0] else ends[1], "all")),
        "every_s": draw.choice((0.05, 0.5, 2.0)),
        "count": draw.randint(1, 60),
        "bytes": draw.choice((1, 16, 27)),
        "start_s": round(draw.uniform(0, 0.8) * duration_s, 3),
        "priority": draw.random() < 0.2,
    }


def _event(draw: random.Random, nodes: int, duration_s: float) -> Tables:
    action = draw.choice(ACTIONS)
    event: Tables = {"at_s": round(draw.uniform(0.05, 0.95) * duration_s, 3), "action": action}
    if action in ("cut", "restore"):
        return event | {"link": sorted(draw.sample(range(nodes), 2))}
    return event | {"node": draw.randrange(nodes)}


def smaller(tables: Tables) -> Iterator[Tables]:
    """Simpler meshes next to this one."""
    flows = tables["flow"]
    for i in range(len(flows)):
        if len(flows) > 1:
            yield tables | {"flow": flows[:i] + flows[i + 1 :]}
        if flows[i]["count"] > 1:
            less = flows[i] | {"count": flows[i]["count"] // 2}
            yield tables | {"flow": [*flows[:i], less, *flows[i + 1 :]]}
    if "robot" in tables:
        yield {key: value for key, value in tables.items() if key not in ("robot", "fence")}
    for node in tables["standby"]:
        yield tables | {"standby": [other for other in tables["standby"] if other != node]}
    if tables["nodes"] > 2:
        yield tables | {"nodes": tables["nodes"] - 1}
    if tables["duration_s"] > 2:
        yield tables | {"duration_s": round(tables["duration_s"] * 0.7, 3)}
    yield from with_fewer_keys(tables)
