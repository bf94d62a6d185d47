"""python -m benchmarks.live: outage, losses and cost, innervate beside babeld; needs root.

Ring of 8, 3x3 grid, 19 hexagons, each node in its namespace. A probe every 5 ms from end to end;
a cable of its path is cut in silence, then a node of its path is killed; so often as --runs says.
Outage = longest gap between first arrivals, less 5 ms. Control = all IP bytes without probes.
"""

import argparse
import itertools
import json
import os
import shutil
import statistics
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.live.shapes import SHAPES
from benchmarks.live.sides import Babeld, Innervate, cpu_s, memory_mib
from innervate.live.netns import Lab

PERIOD_MS = 5.0
BEFORE_S = 1.0
AFTER_S = 2.5
IDLE_S = 8.0
PATH_WAIT_S = 30.0


def measure_idle(side):
    """Control bytes per link and second, CPU and memory of a node, without probes."""
    pids, links = side.daemons(), range(len(side.shape.links))
    start = time.monotonic()
    cpu = {pid: cpu_s(pid) for pid in pids}
    before = sum(side.lab.ip_bytes(k) for k in links)
    time.sleep(IDLE_S)
    after = sum(side.lab.ip_bytes(k) for k in links)
    took = time.monotonic() - start
    return {
        "control_bytes_per_link_s": (after - before) / took / len(links),
        "cpu_percent": 100 * statistics.mean(cpu_s(p) - cpu[p] for p in pids) / took,
        "memory_mib": statistics.mean(memory_mib(p) for p in pids),
    }


def wait_for_path(side):
    """The nodes that packets pass, once there is such a way."""
    for _ in range(int(PATH_WAIT_S)):
        path = side.path()
        hops = [tuple(sorted(pair)) for pair in itertools.pairwise(path)]
        # A packet that had to turn back on its way has nodes in its path that are no neighbours.
        if path and path[-1] == side.shape.sink and set(hops) <= set(side.shape.links):
            return path
        time.sleep(1)
    raise SystemExit(f"{side.name}, {side.shape.name}: no path after {PATH_WAIT_S} s: {path}")


def one_run(side, fault):
    """Probes with a fault in the middle; what came of them."""
    shape = side.shape
    path = wait_for_path(side)
    middle = len(path) // 2
    side.ask(shape.sink, "take")
    before = sum(side.lab.ip_bytes(k) for k in range(len(shape.links)))
    count = round((BEFORE_S + AFTER_S) * 1000 / PERIOD_MS)
    side.tell(shape.source, f"go {count} {side.target()}")
    time.sleep(BEFORE_S)
    ends = tuple(sorted((path[middle - 1], path[middle])))
    if fault == "cut":
        side.lab.cut(shape.links.index(ends))
    elif fault == "kill":
        side.kill(path[middle])
    told = side.hear(shape.source)
    got = side.ask(shape.sink, "take")["got"]
    after = sum(side.lab.ip_bytes(k) for k in range(len(shape.links)))
    if fault == "cut":
        side.lab.restore(shape.links.index(ends))
    elif fault == "kill":
        side.revive(path[middle])
    row = judge(told, got)
    row["bytes_per_link_s"] = (after - before) / (BEFORE_S + AFTER_S) / len(shape.links)
    return row


def judge(told, got):
    """Outage, losses, duplicates, reordering of one run."""
    first = {}
    duplicates = 0
    for number, at in got:
        if number in first:
            duplicates += 1
        else:
            first[number] = at
    times = sorted(first.values())
    gaps = [(b - a) / 1e6 for a, b in itertools.pairwise(times)]
    in_order = sorted(first, key=first.__getitem__)
    newest = -1
    reordered = 0
    for number in in_order:
        reordered += number < newest
        newest = max(newest, number)
    late = max(((at - told["sent"][str(n)]) / 1e6 for n, at in first.items()), default=0)
    return {
        "outage_ms": max(0.0, max(gaps, default=1e9) - PERIOD_MS),
        "lost": len(told["sent"]) - len(first),
        "duplicates": duplicates,
        "reordered": reordered,
        "latest_ms": late,
        "states": told["states"],
    }


def compare(kind, shape, faults, runs, urgency, settings):
    """All figures of one side on one network."""
    with tempfile.TemporaryDirectory(prefix="innervate-") as folder:
        lab = Lab(f"iv{kind.name[:2]}", shape.count, shape.links)
        lab.up()
        args = (shape, lab, Path(folder), urgency)
        side = kind(*args, settings=settings) if kind is Innervate else kind(*args)
        try:
            side.start()
            time.sleep(side.settle_s)
            found = {"idle": measure_idle(side)}
            for fault in faults:
                rows = []
                for _ in range(runs):
                    rows.append(one_run(side, fault))
                    print(f"  {side.name:10} {shape.name:12} {fault:5} "
                          f"{json.dumps(rows[-1])}", file=sys.stderr, flush=True)  # fmt: skip
                    time.sleep(side.settle_s)
                found[fault] = rows
        finally:
            side.stop()
            lab.down()
    return found


def show(results):
    """The table, side by side."""
    print(
        f"{'':13}{'':8}{'side':11}{'outage ms median (all)':>38}{'lost':>6}{'dup':>5}{'reord':>7}"
    )
    for (shape, side), found in results.items():
        for fault, rows in found.items():
            if fault == "idle":
                continue
            outages = sorted(row["outage_ms"] for row in rows)
            texts = " ".join(f"{x:.0f}" for x in outages)
            total = {key: sum(row[key] for row in rows)
                     for key in ("lost", "duplicates", "reordered")}  # fmt: skip
            print(f"{shape:13}{fault:8}{side:11}{statistics.median(outages):>12.1f}"
                  f"{'(' + texts + ')':>26}{total['lost']:>6}{total['duplicates']:>5}"
                  f"{total['reordered']:>7}")  # fmt: skip
    print()
    print(f"{'idle':13}{'side':11}{'control B/s per link':>22}{'with probes':>13}"
          f"{'CPU %':>8}{'memory MiB':>12}")  # fmt: skip
    for (shape, side), found in results.items():
        idle = found["idle"]
        rows = [row for fault, rows in found.items() if fault != "idle" for row in rows]
        probed = statistics.median(row["bytes_per_link_s"] for row in rows)
        print(f"{shape:13}{side:11}{idle['control_bytes_per_link_s']:>22.0f}{probed:>13.0f}"
              f"{idle['cpu_percent']:>8.2f}{idle['memory_mib']:>12.1f}")  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--shapes", default="ring,grid,hexagon")
    parser.add_argument("--sides", default="innervate,babeld")
    parser.add_argument("--faults", default="cut,kill")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--realtime", action="store_true", help="all nodes before other work")
    parser.add_argument("--set", action="append", default=[], help="a parameter: ack_us=5000")
    parser.add_argument("--out", type=Path, help="write all figures as JSON")
    args = parser.parse_args()
    if os.geteuid() != 0:
        sys.exit("benchmarks.live: network namespaces need root; run it as root")
    urgency = ["chrt", "--fifo", "20"] if args.realtime else []
    settings = dict(text.split("=") for text in args.set)
    kinds = {"innervate": Innervate, "babeld": Babeld}
    results = {}
    for side in args.sides.split(","):
        if side == "babeld" and shutil.which("babeld") is None:
            print("babeld is not installed (apt install babeld): left out", file=sys.stderr)
            continue
        for name in args.shapes.split(","):
            shape = SHAPES[name]()
            found = compare(
                kinds[side], shape, args.faults.split(","), args.runs, urgency, settings
            )
            results[shape.name, side] = found
    show(dict(sorted(results.items())))
    if args.out:
        args.out.write_text(json.dumps({"/".join(key): value for key, value in results.items()}))


if __name__ == "__main__":
    main()
