"""Runs of CSMA/CD-R as published, with the paper's constants; its Fig. 1; what was on the air."""

from itertools import pairwise

from innervate.networks.radio.protocol.constants import DATA
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.networks.radio.sim.simulate import simulate
from tests.networks.radio.runs import START_US, radio_plan

TAU, SLOT, BIT = 104, 208, 26
R1, R2, R3, R4, R5 = range(5)
FIGURE_1 = (1248, 1040, 624, 0)
SEEDS = range(1, 41)


def paper(n, *, ta=0, real=(TAU, TAU), **more):
    """Runs a plan of the paper's constants: one delay for all pairs."""
    return simulate(
        radio_plan(n, ta=ta, protocol="csma-cd-r/paper", real=real, delay_us=(TAU, TAU), **more)
    )


def natural(n, **more):
    """A collision as carrier sense allows it: all begin within tau."""
    return paper(n, spread=TAU - 1, **more)


def forced(*starts, **more):
    """A collision of these starts (us), which carrier sense would forbid."""
    arrivals = [[START_US + start] for start in starts]
    return paper(len(starts), forced=True, arrivals=arrivals, **more)


def figure_1(*faults, packet_slots=25, **more):
    """The paper's Fig. 1, with (us, action, station, value) that happen to it."""
    happen = [RadioFault(START_US + at, what, i, value, 0) for at, what, i, value in faults]
    return forced(*FIGURE_1, faults=happen, packet_slots=packet_slots, **more)


def aired(result, kind):
    """(station, start, end) of what was sent, us from the first start."""
    rows = result.sent[result.sent["kind"] == kind]
    return [(int(r["node"]), int(r["time"]) - START_US, int(r["end"]) - START_US) for r in rows]


def said(result, code):
    """Per station, (a, b) of its reports of a kind."""
    rows = result.rows[result.rows["code"] == code]
    found = {}
    for row in rows:
        found.setdefault(int(row["node"]), []).append((int(row["a"]), int(row["b"])))
    return found


def order(result):
    """Stations in the order in which their packets got through."""
    return [int(node) for node in result.packets[result.packets["end"].argsort()]["node"]]


def overlaps(frames):
    """How many begin before the one before has ended."""
    return sum(b[1] < a[2] for a, b in pairwise(frames))


def is_ordered(result):
    """One collision, one resolution, turns in the order of the ends, and no packet more."""
    n = result.plan.stations
    frames = aired(result, DATA)
    first = [node for node, _start, end in sorted(frames[:n], key=lambda f: f[2])]
    return [f[0] for f in frames[n:]] == first and overlaps(frames[n:]) == 0
