"""Where a mesh's airtime goes, in the runs of `innervate papers compare`: by kind, and when.

`python -m benchmarks.airtime --nodes 254 --seeds 3 --set spread_s=0.4`
"""

import argparse
import tomllib

import numpy as np

from innervate.networks.mesh.analysis.messages import NEVER as LOST
from innervate.networks.mesh.analysis.messages import messages
from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.papers.comparison import HERE, planned
from innervate.networks.mesh.protocol import constants as w
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers.in_field import NEVER, figures

KINDS = {
    "requests": w.REQUEST, "responses": w.RESPONSE, "tables": w.TABLE, "table acks": w.TABLE_ACK,
    "graph": w.GRAPH, "messages": w.DATA, "end acks": w.E2E_ACK, "hop acks": w.ACK,
}  # fmt: skip
SAME_HOP = ("node", "link_dst", "kind", "origin", "seq", "path_len", "flags")


def is_again(sent):
    """Which rows send a frame to the same neighbour once more."""
    keys = np.stack([sent[name].astype(np.int64) for name in SAME_HOP], axis=1)
    _, first = np.unique(keys, axis=0, return_index=True)
    again = np.ones(len(sent), bool)
    again[first] = False
    return again & (sent["link_dst"] != w.ALL) & (sent["kind"] != w.ACK)


def parts(sent):
    """Names of what is told apart, each with its rows."""
    again = is_again(sent)
    searching = (sent["flags"] & w.DETOURED != 0) & np.isin(sent["kind"], (w.DATA, w.E2E_ACK))
    for name, kind in KINDS.items():
        of_kind = sent["kind"] == kind
        yield name, of_kind
        for more, which in ((" searching", searching), (" once more", again)):
            if (of_kind & which).any():
                yield f"  {more.strip()}", of_kind & which


def shares(sent, since_us, until_us):
    """Percent of the time that each part takes, all nodes together."""
    spent_us = (sent["end"] - sent["time"]) * (
        (sent["time"] >= since_us) & (sent["time"] < until_us)
    )
    found = [
        (name, 100 * spent_us[rows].sum() / (until_us - since_us)) for name, rows in parts(sent)
    ]
    return [*found, ("all", 100 * spent_us.sum() / (until_us - since_us))]


def show(nodes, dead, seed, protocol):
    """One run, as two columns: until messages begin, and from then on."""
    given = {"world": HERE, "rounds": 2, "nodes": nodes, "dead": dead}
    made, plan = planned(protocol, (), given, seed)
    result = simulate(plan, checks=False)
    came = [NEVER if at == LOST else at for at in messages(result).delivered_us.tolist()]
    found, rounds = figures(made, came, 0), summarize(result)["discovery"]
    print(
        f"{nodes} nodes, {dead} dead, seed {seed}: {found['first']:.1f} % of the first messages, "
        f"{found['later']:.1f} % of the second, 99 % within {found['p99_ms']:.0f} ms; "
        f"recall {rounds['recall']:.3f}, {rounds['with_tables']} with tables, "
        f"all after {rounds['tables_s'] or float('nan'):.1f} s"
    )
    begin = shares(result.sent, 0, made.since_us)
    later = shares(result.sent, made.since_us, made.duration_us)
    for (name, before), (_, after) in zip(begin, later, strict=True):
        print(f"  {name:14} {before:7.1f} {after:7.1f}")


def main():
    """Runs of a number of seeds, one after the other."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.airtime", description=__doc__)
    parser.add_argument("--nodes", type=int, default=254)
    parser.add_argument("--dead", type=int, default=0, help="so many die before the first message")
    parser.add_argument("--first", type=int, default=1, help="seed of the first run")
    parser.add_argument("--seeds", type=int, default=1, help="how many runs")
    parser.add_argument("--set", action="append", default=[], help="KEY=VALUE of [protocol]")
    asked = parser.parse_args()
    protocol = tuple(tomllib.loads("\n".join(asked.set)).items())
    for seed in range(asked.first, asked.first + asked.seeds):
        show(asked.nodes, asked.dead, seed, protocol)


if __name__ == "__main__":
    main()
