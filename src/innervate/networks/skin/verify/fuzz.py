"""Skins drawn from one number: patches, settings, faults."""

import random
from collections.abc import Iterator

from innervate.scenario.shrink import Tables, with_fewer_keys

SHARE = (0.25, 0.75)
SKIN_ACTIONS = ("cut", "restore", "kill", "revive", "loose", "lose", "restart")
TARGETS = {"cut": "link", "restore": "link", "loose": "link", "lose": "link"}


def drawn(draw: random.Random, seed: int) -> Tables:
    """The skin that a generator's next numbers stand for."""
    columns, rows = draw.randint(1, 8), draw.randint(1, 8)
    duration_s = draw.choice((0.5, 1.0, 2.0))
    wiring = draw.choice("ZS") if columns > 1 else "Z"  # S does not join a single column
    sides = [(row, column) for row in range(rows) for column in (0, columns - 1)]
    interfaces = draw.sample(sorted(set(sides)), min(draw.randint(1, 3), len(set(sides))))
    tables: Tables = {
        "kind": "skin",
        "name": f"random-{seed}",
        "seed": seed,
        "duration_s": duration_s,
        "patch": [{"columns": columns, "rows": rows, "wiring": wiring}],
        "interface": [{"row": row, "column": column} for row, column in interfaces],
        "protocol": {
            "rule": draw.choice(("feasible", "feasible", "strict")),
            "updates": draw.choice(("periodic", "triggered", "wave")),
            "k": draw.randint(1, 8),
            "balancing": draw.random() < 0.5,
            "beacon_hz": draw.choice((50.0, 250.0, 500.0)),
        },
        "timing": {
            "drift_ppm": draw.choice((0, 100, 1000, 20_000)),
            "hop_latency_us": sorted((draw.randint(60, 400), draw.randint(60, 400))),
            "lock_step": draw.random() < 0.1,
            "loss": draw.choice((0.0, 0.0, 0.01, 0.2)),
        },
        "data": {"rate_hz": draw.choice((0, 100))},
    }
    cables = columns * rows > 1
    tables["event"] = [
        event
        for _ in range(draw.randint(0, 12))
        if (event := _skin_event(draw, duration_s, columns, rows, cables))
    ]
    if tables["protocol"]["rule"] == "strict":  # which stands no restart of the PC, as is known
        tables["event"] = [event for event in tables["event"] if "pc" not in event]
    return tables


def _skin_event(
    draw: random.Random, duration_s: float, columns: int, rows: int, cables: bool
) -> Tables:
    action = draw.choice(SKIN_ACTIONS)
    event: Tables = {"at_s": round(draw.uniform(0.05, 0.9) * duration_s, 4), "action": action}
    cell = {"row": draw.randrange(rows), "column": draw.randrange(columns)}
    if action == "restart" and draw.random() < 0.5:
        event["pc"] = True
    elif action not in TARGETS:
        event["cell"] = cell
    elif draw.random() < 0.3 or not cables:
        event["interface"] = 0
    else:
        other = _beside(draw, cell, columns, rows)
        event["link"] = [cell, other]
    if action == "loose":
        event["loss"] = draw.choice((0.1, 0.5, 0.9))
    if action == "lose":
        event["frames"] = draw.randint(1, 9)
    return event


def _beside(draw: random.Random, cell: Tables, columns: int, rows: int) -> Tables:
    """A neighbour in the same row, or in the same column of a single one."""
    if columns > 1:
        step = 1 if cell["column"] + 1 < columns else -1
        return {"row": cell["row"], "column": cell["column"] + step}
    step = 1 if cell["row"] + 1 < rows else -1
    return {"row": cell["row"] + step, "column": cell["column"]}


def smaller(tables: Tables) -> Iterator[Tables]:
    """Simpler skins next to this one."""
    yield from with_fewer_keys(tables)
    for patch in tables.get("patch", []):
        for side in ("columns", "rows"):
            if patch[side] > 1:
                yield tables | {"patch": [patch | {side: patch[side] - 1}]}
    if len(tables.get("interface", [])) > 1:
        yield tables | {"interface": tables["interface"][:-1]}
