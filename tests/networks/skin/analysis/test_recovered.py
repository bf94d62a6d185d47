"""Recoveries of runs in all kinds of trouble, row after row by the sentences that describe them."""

import random
from itertools import pairwise

import numpy as np
import pytest

from innervate.networks.skin.analysis.recovery import next_hops, recoveries, start_up, users
from innervate.networks.skin.protocol.constants import (
    NONE,
    PORTS,
    REPORT_BALANCE,
    REPORT_BROKEN,
    REPORT_PARENT,
)
from innervate.networks.skin.sim.observer import APART, CUT_OFF, JOINED, UNROUTED
from innervate.scenario.actions.cables import (
    ACTIONS,
    CUT,
    KILL,
    LOOSE,
    LOSE,
    RESTART,
    RESTORE,
    REVIVE,
)  # fmt: skip
from innervate.scenario.cables import Fault
from tests.networks.skin.runs import EVERYTHING, faulty, line, patch, plan_of, run


def chain_of(graph, ports, cell):
    """[(node, end it leaves by)] of a cell's way by parents, as far as it leads."""
    way, cells = [], graph.cells
    while cell < cells and ports[cell] != NONE and len(way) <= cells:
        end = PORTS * cell + ports[cell]
        if graph.peer[end] < 0:
            break
        way.append((cell, end))
        cell = min(graph.peer[end] // PORTS, cells)
    return way, cell


def uses(graph, ports, cell, fault):
    """True if a cell's chain of parents goes over an event's cable, or through its node."""
    way, last = chain_of(graph, ports, cell)
    if fault.node >= 0:
        # Who has no parent itself goes through nothing, not even through itself.
        return bool(way) and fault.node in [node for node, _ in way] + [last]
    return any(end in (fault.end, graph.peer[fault.end]) for _, end in way)


def fault_of(end=-1, node=-1):
    return Fault(0, CUT if end >= 0 else KILL, end, node, 0, 0)


@pytest.mark.parametrize("shape", [(4, 4, (0, 1), (3, 2)), (6, 3, *((0, k) for k in range(6)))])
def test_who_uses_a_cable_or_a_node_on_any_chains_of_parents(shape):
    columns, rows, *roots = shape
    graph = plan_of(patch(columns, rows, *roots)).graph
    draw = random.Random(3)
    cabled = [end for end in range(PORTS * graph.cells) if graph.peer[end] >= 0]
    for _ in range(60):
        ports = [draw.choice([NONE, 0, 1, 2, 3]) for _ in range(graph.cells)]
        hops = [chain_of(graph, [p if n == c else NONE for n, p in enumerate(ports)], c)
                for c in range(graph.cells)]  # fmt: skip
        expected = [last if way else NONE for way, last in hops]
        assert next_hops(graph, np.array(ports)).tolist() == expected
        for fault in fault_of(end=draw.choice(cabled)), fault_of(node=draw.randrange(graph.cells)):
            found = users(graph, np.array(ports), fault).tolist()
            assert found == [uses(graph, ports, c, fault) for c in range(graph.cells)], ports


def test_a_long_line_uses_its_last_cable():
    graph = plan_of(line(40)).graph
    west = users(graph, np.zeros(40, np.int64), fault_of(end=0))
    assert west.tolist() == [True] * 40
    assert users(graph, np.zeros(40, np.int64), fault_of(end=PORTS * 39)).tolist() == (
        [False] * 39 + [True]
    )


def by_sentences(result):
    """What `recoveries` should say, from the rows one after the other."""
    rows = [tuple(int(part) for part in row) for row in result.rows.tolist()]
    names = result.rows.dtype.names
    rows = [dict(zip(names, row, strict=True)) for row in rows]
    marks = [i for i, row in enumerate(rows) if row["code"] == CUT_OFF and row["a"] >= 0]
    moments = sorted({rows[i]["time"] for i in marks})
    spans = dict(pairwise([*moments, None]))
    found = []
    for i in marks:
        at = rows[i]["time"]
        # From the moment's first mark up to that of the next later moment.
        first = min(j for j in marks if rows[j]["time"] == at)
        behind = next((j for j in marks if rows[j]["time"] == spans[at]), len(rows))
        found.append(one(result.plan, rows, (i, first, behind)))
    return found


def step(rows, code, behind, otherwise=0):
    """What a step function is before a row."""
    values = [row["a"] for row in rows[:behind] if row["code"] == code]
    return values[-1] if values else otherwise


def parents(graph, faults, rows):
    """Parent ports after these rows; who was switched off has none until it says so."""
    ports = [NONE] * graph.cells
    for row in rows:
        if row["code"] in (REPORT_PARENT, REPORT_BALANCE):
            ports[row["node"]] = row["b"]
        elif row["code"] == CUT_OFF and row["a"] in faults:
            harm = faults[row["a"]]
            if harm.action in (KILL, RESTART) and harm.node < graph.cells:
                ports[harm.node] = NONE
    return ports


def one(plan, rows, places):
    """What should be said of the event whose mark is row i, from `first` on up to `behind`."""
    i, first, behind = places
    graph, faults = plan.graph, {one.index: one for one in plan.faults}
    fault = faults[rows[i]["a"]]
    at, inside = rows[i]["time"], rows[first + 1 : behind]

    def ms(times, pick):
        return (pick(times) - at) / 1e3 if times else None

    ends = [fault.end] if fault.end >= 0 else list(graph.ends_of(fault.node))
    ends = {e for end in ends if graph.peer[end] >= 0 for e in (end, graph.peer[end])}
    detected = [row["time"] for row in inside if row["code"] == REPORT_BROKEN and row["b"] == 1
                and PORTS * row["node"] + row["a"] in ends]  # fmt: skip
    turned = [row["time"] for row in inside if row["code"] == REPORT_PARENT]
    gone = sum(row["b"] for row in inside if row["code"] == APART)
    gone_total = step(rows, APART, behind)
    without = step(rows, UNROUTED, behind)
    outage = [row["time"] for row in inside if row["code"] == UNROUTED]
    others = None if without else ms(outage, max) if outage else 0.0
    there = step(rows, JOINED, behind, graph.cells)
    others = others if there else None
    ports = parents(graph, faults, rows[:i])
    used = sum(uses(graph, ports, cell, fault) for cell in range(graph.cells))
    if fault.action in (RESTORE, REVIVE):
        used = 0
    elif fault.action == CUT or fault.node == graph.sink:
        used = rows[i]["b"]
    return {
        "at_s": at / 1e6, "action": ACTIONS[fault.action],
        "detected_ms": ms(detected, min), "converged_ms": ms(turned, max),
        "routed_ms": None if gone_total else others, "others_ms": others, "without_way": without,
        "cut_cells": used, "cut_off": gone, "cut_off_total": gone_total,
        "joined_again": max(0, there - step(rows, JOINED, first + 1, graph.cells)),
    }  # fmt: skip


@pytest.mark.parametrize("seed", range(4))
def test_recoveries_are_what_their_sentences_say(seed):
    keys = faulty(seed, EVERYTHING, (4, 4, ((0, 1), (3, 2))), count=30, gap_s=0.03)
    events = keys["event"]
    for event in events[6:9]:  # of one moment
        event["at_s"] = events[6]["at_s"]
    loose = {"at_s": 0.0, "action": "loose", "interface": 0, "loss": 0.1}
    keys["event"] = [loose, *events]  # at the very beginning
    result = run(keys)
    found = recoveries(result)
    expected = by_sentences(result)
    assert len(found) == len(expected) > 20
    for number, (this, that) in enumerate(zip(found, expected, strict=True)):
        assert this == that, number
    assert {LOOSE, LOSE, RESTART, KILL} & {fault.action for fault in result.plan.faults}


def test_the_beginning_looks_as_far_as_the_first_event():
    events = [{"at_s": 0.2, "action": "cut", "interface": 0}]
    result = run(line(3, duration_s=0.6, event=events), plain=True)
    early = result.rows[result.rows["time"] < 200_000]
    turned = early["time"][early["code"] == REPORT_PARENT]
    routed = early["time"][early["code"] == UNROUTED]
    assert start_up(result) == {
        "converged_ms": turned.max() / 1e3, "routed_ms": routed.max() / 1e3,
    }  # fmt: skip
