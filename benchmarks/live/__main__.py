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
from functools import partial
from pathlib import Path

from benchmarks.live.lab import Lab
from benchmarks.live.shapes import SHAPES
from benchmarks.live.sides import Babeld, Innervate, cpu_s, memory_mib
from innervate.live.errors import LiveError

PERIOD_MS = 5.0
BEFORE_S = 0.5
AFTER_S = 2.0
IDLE_S = 8.0
PATH_WAIT_S = 30.0
START_S = 5.0  # about: namespaces made and removed, nodes started
OUTAGE_MS = 40.0  # what innervate must reach: the median, with nothing lost and nothing twice


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
    raise TimeoutError(f"{side.name}, {side.shape.name}: no path after {PATH_WAIT_S} s: {path}")


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
            found = {"idle": measure_idle(side), **{fault: [] for fault in faults}}
            for i, fault in enumerate(fault for fault in faults for _ in range(runs)):
                if i:
                    time.sleep(side.settle_s)
                row = one_run(side, fault)
                found[fault].append(row)
                print(f"  {side.name:10} {shape.name:12} {fault:5} {json.dumps(row)}",
                      file=sys.stderr, flush=True)  # fmt: skip
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


def missed(results):
    """A line for everything that innervate had to reach and did not."""
    for (shape, side), found in results.items():
        for fault in found.keys() - {"idle"} if side == "innervate" else ():
            rows = found[fault]
            outage_ms = statistics.median(row["outage_ms"] for row in rows)
            if outage_ms > OUTAGE_MS:
                yield f"{shape}, {fault}: outage {outage_ms:.0f} ms, more than {OUTAGE_MS:g}"
            for what in ("lost", "duplicates"):
                if count := sum(row[what] for row in rows):
                    yield f"{shape}, {fault}: {count} {what}"


def duration_s(kind, faults, runs):
    """About how long a side takes on one network."""
    trial_s = BEFORE_S + AFTER_S + 0.5 + kind.settle_s
    return START_S + IDLE_S + kind.settle_s + faults * runs * trial_s


def listed(given, known):
    """Names with commas between them, all of them known."""
    names = given.split(",")
    if strange := [name for name in names if name not in known]:
        raise argparse.ArgumentTypeError(f'no "{strange[0]}"; there are {", ".join(known)}')
    return names


def main():
    kinds = {"innervate": Innervate, "babeld": Babeld}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for option, known in (("shapes", SHAPES), ("sides", kinds), ("faults", ("cut", "kill"))):
        usual = ",".join(known)
        parser.add_argument(f"--{option}", type=partial(listed, known=known), default=usual)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--realtime", action="store_true", help="all nodes before other work")
    parser.add_argument("--set", action="append", default=[], help="a parameter: ack_us=5000")
    parser.add_argument("--out", type=Path, help="write all figures as JSON")
    args = parser.parse_args()
    if os.geteuid() != 0:
        sys.exit("benchmarks.live: network namespaces need root; run it as root")
    urgency = ["chrt", "--fifo", "20"] if args.realtime else []
    settings = dict(text.split("=") for text in args.set)
    results, sides, shapes, faults = {}, args.sides, args.shapes, args.faults
    if "babeld" in sides and shutil.which("babeld") is None:
        print("babeld is not installed (apt install babeld): left out", file=sys.stderr)
        sides.remove("babeld")
    wrong, left = [], [(side, name) for name in shapes for side in sides]
    while left:
        rest_s = sum(duration_s(kinds[side], len(faults), args.runs) for side, _ in left)
        side, name = left.pop(0)
        shape = SHAPES[name]()
        print(f"{side}, {shape.name}; about {rest_s / 60:.1f} min left", file=sys.stderr)
        try:
            found = compare(kinds[side], shape, faults, args.runs, urgency, settings)
        except (OSError, ValueError, LiveError) as error:  # the others are measured all the same
            wrong.append(f"{shape.name}: {side} failed: {error}")
            continue
        results[shape.name, side] = found
        if args.out:
            text = json.dumps({"/".join(key): value for key, value in results.items()})
            args.out.write_text(text)
    if results:
        show(results)
    wrong += missed(results)
    print(*(f"not reached: {line}" for line in wrong), sep="\n", end="\n" * bool(wrong))
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
