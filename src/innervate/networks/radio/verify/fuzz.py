"""Radio teams drawn from one number: stations, traffic, delays, who comes and goes."""

import random
from collections.abc import Iterator
from typing import Any

from innervate.kernel.words import number_of
from innervate.scenario.shrink import Tables, with_fewer_keys

SHARE = (0.0, 0.25)


def drawn(draw: random.Random, seed: int) -> Tables:
    """The team that a generator's next numbers stand for."""
    stations = draw.randint(2, 20)
    least = draw.choice((26, 52, 80))
    tables: Tables = {
        "kind": "radio",
        "name": f"random-{seed}",
        "seed": seed,
        "duration_s": 3.0,
        "stations": stations,
        "packet_slots": draw.choice((3, 5, 25)),
        "traffic": {"kind": draw.choice(("disaster", "saturated", "poisson"))},
        "channel": {
            "tau_us": [least, draw.randint(least, 2 * least)],
            "turnaround_us": draw.choice((0, 0, 500, 2000)),
            "loss": draw.choice((0.0, 0.0, 0.05)),
        },
    }
    tables["event"] = [
        {
            "at_s": round(draw.uniform(0.01, 1.0), 4),
            "action": draw.choice(("kill", "leave", "join")),
            "station": draw.randrange(stations),
        }
        for _ in range(draw.randint(0, 5))
    ]
    return tables


def smaller(tables: Tables) -> Iterator[Tables]:
    """Simpler teams next to this one."""
    yield from with_fewer_keys(tables)
    if tables.get("stations", 0) > 2:
        yield tables | {"stations": tables["stations"] - 1}


def trouble(summary: Any) -> str:
    """What a run broke that no checker is for."""
    lost = summary["lost_silently"]
    return f"{number_of(lost, 'packet')} lost silently" if lost else ""
