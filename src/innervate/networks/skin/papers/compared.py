"""The skin's job, and the skin at it: cells that want to reach the PC while cables fail."""

from collections.abc import Iterator
from functools import partial
from itertools import groupby, product
from typing import Any

import numpy as np

from innervate.networks.skin.analysis.rows import broken_changes, parent_changes
from innervate.networks.skin.papers import warm_up
from innervate.networks.skin.papers.common import plan_of, simulated
from innervate.papers import cabled, jobs
from innervate.papers.experiment import Claim, verdict
from innervate.sim.cables.wires import BLOCKS, SENT

JOB = "skin"
SETUPS = {"setup-1": "99 cells, 2 ports", "setup-7": "204 cells, 3 ports"}
LOSSES = (0.0, 0.05)
HARMS = {"none": "nothing fails", "cut": "a cable of the PC is cut",
         "four cuts": "four cables are cut", "death": "a cell two hops away dies"}  # fmt: skip
BEACON_US, K = 4_000, 5
SETTLE, WATCH = 100, 200
CALM_SETTLE = 1_000  # periods until the load is balanced
STATIC_WATCH = 700  # its dead time of 2 s, and what comes before and after
RECOVERY = (
    jobs.Column("found (ms)", "detected_ms", jobs.MEDIAN),
    jobs.Column("all have a way (ms)", "routed_ms", jobs.MEDIAN),
    jobs.Column("90 % (ms)", "routed_ms", jobs.TAIL),
    jobs.Column("cells without, most", "without", jobs.MEDIAN, 0),
    jobs.Column("cell seconds without", "without_s", jobs.MEDIAN, 2),
    jobs.Column("loops, all runs", "loops", jobs.TOTAL, 0),
)
CALM = (
    jobs.Column("start-up (ms)", "start_ms", jobs.MEDIAN),
    jobs.Column("90 % (ms)", "start_ms", jobs.TAIL),
    jobs.Column("control bit/s a cable", "bits_per_s", jobs.MEDIAN, 0),
    jobs.Column("busiest port's share", "largest_share", jobs.MEDIAN, 2),
    jobs.Column("cell seconds without, later", "without_s", jobs.MEDIAN, 2),
    jobs.Column("loops, all runs", "loops", jobs.TOTAL, 0),
    jobs.Column("cells without later, most of all", "without", jobs.MOST, 0),
)


def cables(setup: str) -> list[list[str]]:
    """The cables of a bundled skin, its cells called c0, c1, ..."""
    graph = plan_of(setup).graph

    def end(one: int) -> str:
        node = graph.node_of(one)
        return f"{'pc' if node == graph.sink else f'c{node}'}.{graph.port_of(one)}"

    return [[end(a), end(b)] for a, b in graph.links()]


def cases(quick: bool) -> list[jobs.Case]:
    """Every setup, with and without loss, everything that can happen."""
    setups = list(SETUPS)[: 1 if quick else None]
    return [case(*one, quick) for one in product(setups, LOSSES, HARMS)]


def case(setup: str, loss: float, harm: str, quick: bool) -> jobs.Case:
    """One setting, as a case."""
    settle = CALM_SETTLE if harm == "none" else SETTLE
    given = {"cables": cables(setup), "beacon_us": BEACON_US, "k": K, "loss": loss, "harm": harm,
             "settle": settle, "watch": WATCH}  # fmt: skip
    said = f"{SETUPS[setup]}, {100 * loss:g} % of all frames are lost: {HARMS[harm]}"
    name = f"{setup}, loss {loss:g}, {harm}, {BEACON_US} us, k={K}, {settle} + {WATCH} periods"
    # With loss, links are found down all the time, whatever was cut.
    columns = CALM if harm == "none" else RECOVERY[1:] if loss else RECOVERY
    return jobs.Case(name, said, given, range(1, 4 if quick else 61), columns)


def measure(given: jobs.Given, seed: int, **protocol: Any) -> dict[str, Any]:
    """One run of a case under a rule."""
    if protocol.get("rule") == "static":
        given = {**given, "watch": STATIC_WATCH}
    harm, made = cabled.drawn(given, seed), cabled.wiring(given)
    at_s, names = harm.at_us / 1e6, made.names
    cuts = [made.cables[place] for place in harm.cables]
    events = [{"at_s": at_s, "action": "cut", "link": [names[a], names[b]]} if a and b else
              {"at_s": at_s, "action": "cut", "interface": p if a == 0 else q}
              for a, p, b, q in cuts]  # fmt: skip
    events += [{"at_s": at_s, "action": "kill", "node": names[node]} for node in harm.nodes]
    tables = {
        "kind": "skin",
        "duration_s": cabled.end_us(given, harm) / 1e6,
        "link": [{"a": a, "b": b} for a, b in given["cables"]],
        "protocol": {"beacon_hz": 1e6 / given["beacon_us"], "k": given["k"], **protocol},
        "timing": {"loss": given["loss"]},
        "event": events,
    }
    result = simulated(tables, seed, checks=False)
    number = made.number
    whose = [*(number[name] for name in result.plan.graph.names), 0]
    changes = parent_changes(result)
    told = zip(changes.time_us.tolist(), changes.cell.tolist(), changes.new.tolist(), strict=True)
    broken = broken_changes(result)
    downs = broken.time_us[np.flatnonzero(broken.broken == 1)].tolist()
    sent = sum(int(result.counters[SENT + block]) for block in BLOCKS)
    moved = [(at, whose[cell], port) for at, cell, port in told]
    return cabled.measured(given, harm, moved, downs, sent)


def entry(name: str, what: str, **protocol: Any) -> jobs.Entry:
    """An entry that is the skin, in some setting."""
    return jobs.Entry(JOB, name, what, partial(measure, **protocol), warm_up, 0.2)


ENTRIES = (
    entry("skin, feasible", f"rule feasible, wave updates, k = {K} (the default)", rule="feasible"),
    entry("skin, feasible, k = 2", "the same with k = 2", rule="feasible", k=2),
    entry("skin, feasible, periodic", "rule feasible, beacons at their period only",
          rule="feasible", updates="periodic"),
    entry("skin, strict", f"rule strict, wave updates, k = {K}", rule="strict"),
    entry("static trees", "the paper's static tree, set up anew after a failure, dead for 2 s",
          rule="static"),
)  # fmt: skip


# Who is held against whom, and why the skin is not ahead where it is not.
OURS, FAST = "skin, feasible", "skin, feasible, k = 2"
STATIC, RFC, SAME = "static trees", "Babel, 2 of 3", "Babel, 1 of k"
SLOW_TO_FIND = (
    "measured, in the column found: a port is broken after k = 5 missing beacons, and Babel's link "
    "is down when two of three are missing; the next two lines compare what is left when both find "
    "a failure as soon"
)
NOTHING_TO_DO = (
    "a reading: where another port is at hand both take it at once, and finding out is all there is"
)
LISTENS = (
    "measured, with k = 2 it starts sooner: the PC of a skin listens for k periods before it says "
    "anything, as it may have restarted"
)
WAVES = (
    "measured, with periodic updates it sends no more than Babel: every new sequence number goes "
    "out as a wave at once, and comes a little before the period"
)
NO_TIES = (
    "a reading: the wiring of this skin leaves few cells that have ports of two subnetworks as near"
)


def judge(compared: jobs.Compared) -> Iterator[Claim]:
    """Setup by setup, with and without loss."""
    for place, group in groupby(compared.cases(), lambda case: case.title.partition(":")[0]):
        cases = {case.given["harm"]: case for case in group}
        calm = {"": cases.pop("none")}
        yield from _recovery(compared, place, cases)
        yield from _calm(compared, place, calm)
    yield _loops(compared)


def _recovery(compared: jobs.Compared, place: str, cases: dict[str, jobs.Case]) -> Iterator[Claim]:
    for ours, other, words, why in (
        (OURS, RFC, "at the same beacon rate, with k = 5,", SLOW_TO_FIND),
        (FAST, RFC, "at the same beacon rate, with k = 2,", NOTHING_TO_DO),
        (OURS, SAME, "with the same time to find a failure", NOTHING_TO_DO),
        (OURS, STATIC, "with the same time to find a failure", ""),
    ):
        claim = f'{place}: {words} all cells of "{ours}" have a way again sooner than of "{other}"'
        yield compared.less(cases, "routed_ms", (ours, other), jobs.Words(claim, why))


def _calm(compared: jobs.Compared, place: str, calm: dict[str, jobs.Case]) -> Iterator[Claim]:
    for name, words, why, digits in (
        ("start_ms", "starts up sooner", LISTENS, 1),
        ("bits_per_s", "sends less control", WAVES, 0),
        ("largest_share", "loads the busiest port less", NO_TIES, 2),
    ):
        claim = f'{place}: "{OURS}" {words} than "{RFC}"'
        yield compared.less(calm, name, (OURS, RFC), jobs.Words(claim, why, digits))


def _loops(compared: jobs.Compared) -> Claim:
    found = {
        entry.name: sum(sum(compared.values(case, entry, "loops")) for case in compared.cases())
        for entry in jobs.entries(compared.job.name)
    }
    runs = sum(len(case.seeds) for case in compared.cases())
    said = ", ".join(f"{name} {count:.0f}" for name, count in found.items())
    return Claim(
        compared.job.name, "no forwarding loop in any run of any of them",
        f"{said}; in {runs} runs each", verdict(not any(found.values())),
    )  # fmt: skip


JOBS = (
    jobs.Job(
        JOB,
        "Cells that want to reach the PC while cables fail",
        "Until all cells have a way again, from the failure on; a dot a run, the median and its "
        f"95 % interval. A beacon every {BEACON_US / 1e3:g} ms for all, the same failures.",
        cases,
        judge,
        ("routed_ms", "all have a way (ms)"),
    ),
)
