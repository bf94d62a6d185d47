"""Beacons delivered per second by the compiled skin, from 99 to 1,000,000 cells.

`measure(cells, checks)` runs the full protocol with its default settings (rule feasible, updates
wave) and the fingerprint on, settled first, then timed in slices; the best of a few slices counts,
because other work on the machine only ever slows one down.
"""

import resource
import subprocess
import sys
import time

from innervate import scenario
from innervate.networks.skin.sim.build import build
from innervate.networks.skin.sim.simulate import compiled_loop
from innervate.sim.cables.build import grow_pool
from innervate.sim.cables.wires import ARRIVED, URGENT_BLOCK
from innervate.sim.status import DONE, POOL_FULL
from innervate.sim.tables import get, put

SIZES = (99, 204, 1_000, 10_000, 100_000, 1_000_000)
SLICES = 5
BEACONS_PER_SLICE = 2_000_000
SETTLED_PERIODS = 40


def skin(cells, beacon_hz=250.0, updates="wave"):
    """Setup 1 or 8 up to 204 cells; above, joined patches of 6 x 10 cells, an interface each."""
    protocol = {"beacon_hz": beacon_hz, "updates": updates}
    if cells <= 204:
        name = "setup-1" if cells == 99 else "setup-8"
        text = scenario.load(name)
        patches = [{"columns": p.columns, "rows": p.rows} for p in text.model.patch]
        ports = [{"row": p.row, "column": p.column} for p in text.model.interface]
        form = {"kind": "skin", "patch": patches, "interface": ports, "protocol": protocol}
    else:
        count = -(-cells // 60)
        patch = {"columns": 6, "rows": 10, "count": count, "interfaces_every": 1}
        form = {"kind": "skin", "patch": [patch], "protocol": protocol}
    return scenario.plan(scenario.from_dict(form))


def measure(cells, checks=False, updates="wave"):
    """Beacons delivered and handler calls per second of one core."""
    plan = skin(cells, updates=updates)
    advance = compiled_loop(False)
    world = build(plan, checks=checks, observe=checks)
    period_us = plan.params["beacon_us"]
    now = SETTLED_PERIODS * period_us
    world = _advance(advance, world, now)
    slice_us = max(1, round(BEACONS_PER_SLICE / (4 * plan.graph.cells) * period_us))
    best = {"beacons_per_s": 0.0}
    for _ in range(SLICES):
        beacons, handled = _counts(world)
        now += slice_us
        started = time.perf_counter()
        world = _advance(advance, world, now)
        wall_s = time.perf_counter() - started
        after, after_handled = _counts(world)
        rate = (after - beacons) / wall_s
        if rate > best["beacons_per_s"]:
            best = {"beacons_per_s": rate, "handlers_per_s": (after_handled - handled) / wall_s}
    return {"cells": plan.graph.cells, "checks": checks, "updates": updates, **best}


def _advance(advance, world, until_us):
    while True:
        advance(world, until_us, 1 << 40)
        status = int(get(world.run, 0, "status"))
        put(world.run, 0, rows=0)
        if status == DONE:
            return world
        if status == POOL_FULL:
            world = grow_pool(world)


def _counts(world):
    return int(world.counters[ARRIVED + URGENT_BLOCK]), int(get(world.run, 0, "handled"))


def million():
    """One second of 1,000,000 cells at 10 Hz: topology, tables and loop, warm; time and memory."""
    compiled_loop(False)(build(skin(99)), 1, 1)
    started = time.perf_counter()
    plan = skin(1_000_000, beacon_hz=10.0)
    planned = time.perf_counter()
    world = build(plan, checks=False, observe=False)
    built = time.perf_counter()
    world = _advance(compiled_loop(False), world, 1_000_000)
    ended = time.perf_counter()
    return {
        "cells": plan.graph.cells,
        "topology_s": planned - started,
        "tables_s": built - planned,
        "loop_s": ended - built,
        "total_s": ended - started,
        "beacons": _counts(world)[0],
        "peak_gib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
    }


def million_apart():
    """`million()` in a process of its own, so that its peak memory is its own."""
    code = "import json; from benchmarks import beacons; print(json.dumps(beacons.million()))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip().splitlines()[-1]
