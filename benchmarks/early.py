"""What comes of messages that are sent before a mesh has its tables (decision 0044).

`python -m benchmarks.early --nodes 150 --every 10 --to gateway --first 5001 --seeds 6`
"""

import argparse
from dataclasses import replace

import numpy as np

from innervate.networks.mesh.analysis.messages import NEVER, messages
from innervate.networks.mesh.papers.testbed import GATEWAY, MeshTestbed, send_anywhere
from innervate.networks.mesh.protocol.constants import REPORT_GRAPH, REPORT_TABLES
from innervate.networks.mesh.sim.simulate import simulate

LAST_S = 30  # without new messages: the last ones have their time
SPANS = ("before the graph", "while tables go out", "in the 30 s after", "later")


def run(nodes, every_s, to, start_s, duration_s, seed):
    """(per span which came and how long they took, when tables were out) of one network."""
    plan = MeshTestbed(nodes, duration_s=duration_s).plan(seed)
    send_anywhere(plan, start_s, duration_s - LAST_S, every_s)
    if to == "gateway":
        plan.offers = [replace(one, dest=GATEWAY) for one in plan.offers if one.node != GATEWAY]
    result = simulate(plan, checks=False)
    rows, sent = result.rows, messages(result)
    graph = rows["time"][rows["code"] == REPORT_GRAPH][0]
    out = next(iter(rows["time"][rows["code"] == REPORT_TABLES]), duration_s * 10**6)
    ends = [graph, out, out + 30_000_000]
    span = np.searchsorted(ends, sent.offered_us, "right")
    took_ms = (
        np.where(sent.delivered_us == NEVER, np.nan, sent.delivered_us - sent.offered_us) / 1e3
    )
    return [took_ms[span == k] for k in range(len(SPANS))], out / 1e6


def main():
    """Runs of a number of seeds, all together."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.early", description=__doc__)
    parser.add_argument("--nodes", type=int, default=100)
    parser.add_argument("--every", type=int, default=10, help="s between a node's messages")
    parser.add_argument("--to", choices=("others", "gateway"), default="others")
    parser.add_argument("--start", type=int, default=0, help="s, when the first are sent")
    parser.add_argument("--duration", type=int, default=150, help="s, of a run")
    parser.add_argument("--first", type=int, default=5001, help="seed of the first run")
    parser.add_argument("--seeds", type=int, default=6, help="how many runs")
    asked = parser.parse_args()
    found, outs = [[] for _ in SPANS], []
    for seed in range(asked.first, asked.first + asked.seeds):
        spans, out_s = run(asked.nodes, asked.every, asked.to, asked.start, asked.duration, seed)
        outs.append(out_s)
        for all_, here in zip(found, spans, strict=True):
            all_.append(here)
    print("tables are out after", ", ".join(f"{out_s:.0f}" for out_s in outs), "s")
    for name, all_ in zip(SPANS, found, strict=True):
        took_ms = np.concatenate(all_)
        came = took_ms[~np.isnan(took_ms)]
        if len(came):
            share, (half_ms, most_ms) = len(came) / len(took_ms), np.percentile(came, (50, 99))
            print(f"  {name:20} {len(came)} of {len(took_ms)}, {100 * share:.2f} %;", end=" ")
            print(f"median {half_ms:.0f} ms, 99 % within {most_ms:.0f}")


if __name__ == "__main__":
    main()
