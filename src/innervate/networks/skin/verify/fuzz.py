"""Whole networks drawn from one number: settings, sizes and faults; the checkers are always on.

A network that breaks something is made smaller as long as it still does, and saved as a scenario.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from innervate import scenario as scenarios
from innervate.networks.mesh.verify import fuzz as wild_mesh
from innervate.running.run import run
from innervate.sim.driver import InvariantBroken

SKIN_ACTIONS = ("cut", "restore", "kill", "revive", "loose", "lose", "restart")
TARGETS = {"cut": "link", "restore": "link", "loose": "link", "lose": "link"}
TRIES = 400

Tables = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Broken:
    """A network that breaks something.

    Attributes:
        seed: what it was drawn from.
        why: what is broken, in one line.
        tables: the scenario, made as small as it goes.
        tries: how many smaller ones were tried.
    """

    seed: int
    why: str
    tables: Tables
    tries: int

    def save(self, folder: Path) -> Path:
        """Write the scenario; `innervate run` plays it."""
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"broken-{self.seed}.toml"
        loaded = scenarios.from_dict(self.tables)
        path.write_text(f"# {self.why}\n{scenarios.dump(loaded)}", encoding="utf-8")
        return path


def drawn(seed: int) -> Tables:
    """The scenario that a number stands for: a skin, or less often a radio team or a mesh."""
    draw = random.Random(f"wild/{seed}")
    kind = draw.random()
    if kind < 0.25:
        return _radio(draw, seed)
    return _skin(draw, seed) if kind < 0.75 else wild_mesh.drawn(draw, seed)


def _skin(draw: random.Random, seed: int) -> Tables:
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


def _radio(draw: random.Random, seed: int) -> Tables:
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


def trouble(tables: Tables) -> str:
    """What this scenario breaks, in one line; "" nothing."""
    try:
        done = run(scenarios.from_dict(tables))
    except InvariantBroken as error:
        return str(error)
    summary = done.summary
    if summary["kind"] == "radio" and summary["lost_silently"]:
        return f"{summary['lost_silently']} packets lost silently"
    return ""


def smaller(tables: Tables) -> Iterator[Tables]:
    """Simpler scenarios next to this one."""
    events = tables.get("event", [])
    for half in (events[: len(events) // 2], events[len(events) // 2 :]):
        if len(half) < len(events):
            yield tables | {"event": half}
    for i in range(len(events)):
        yield tables | {"event": events[:i] + events[i + 1 :]}
    if tables["kind"] == "mesh":
        yield from wild_mesh.smaller(tables)
    for name in ("protocol", "timing", "data", "channel"):
        for key in tables.get(name, {}):
            if key not in ("rule", "updates"):
                rest = {k: v for k, v in tables[name].items() if k != key}
                yield tables | {name: rest}
    for patch in tables.get("patch", []):
        for side in ("columns", "rows"):
            if patch[side] > 1:
                yield tables | {"patch": [patch | {side: patch[side] - 1}]}
    if len(tables.get("interface", [])) > 1:
        yield tables | {"interface": tables["interface"][:-1]}
    if tables.get("stations", 0) > 2:
        yield tables | {"stations": tables["stations"] - 1}


def shrink(tables: Tables, breaks: Callable[[Tables], str]) -> tuple[Tables, int]:
    """The smallest scenario found that still breaks something, and how many were tried."""
    tries = 0
    found = True
    while found and tries < TRIES:
        found = False
        for candidate in smaller(tables):
            tries += 1
            if tries >= TRIES:
                break
            try:
                still = bool(breaks(candidate))
            except scenarios.ScenarioError:
                continue  # what an event speaks of is gone
            if still:
                tables, found = candidate, True
                break
    return tables, tries


def attempt(seed: int, breaks: Callable[[Tables], str] = trouble) -> Broken | None:
    """Draw a network, run it; what it breaks, made small."""
    tables = drawn(seed)
    why = breaks(tables)
    if not why:
        return None
    small, tries = shrink(tables, breaks)
    return Broken(seed, breaks(small), small, tries)
