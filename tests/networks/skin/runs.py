"""Whole runs for the tests: small scenarios, random faults, and what a run's rows say."""

import random
from contextlib import contextmanager
from unittest import mock

import numpy as np

from innervate import scenario
from innervate.networks.skin.protocol.constants import NONE, REPORT_BROKEN, REPORT_PARENT
from innervate.networks.skin.sim import simulate as simulator
from innervate.networks.skin.sim.observer import CUT_OFF, LOOP_OPEN, UNROUTED
from innervate.networks.skin.sim.simulate import simulate
from innervate.sim.cables import loop

PERIOD_US = 4000  # at 250 beacons per second
EVERYTHING = ["cut", "restore", "kill", "revive", "loose", "lose", "restart", "restart pc",
              "cut pc", "restore pc"]  # fmt: skip
# [skin Fig. 5] n1 is cut off; n2 knows a longer way, n4 another, both without a tie.
FIGURE_5 = [("pc.0", "n1"), ("n1", "n2"), ("n1", "n3"), ("n3", "n4"), ("n2", "n5"), ("n5", "n6"),
            ("n6", "pc.1"), ("n4", "n7"), ("n7", "n5")]  # fmt: skip


def keys_of(**keys):
    """A scenario's tables; [timing] and [protocol] keys can be left to their defaults."""
    return {"kind": "skin", "duration_s": 1.5, **keys}


def patch(columns, rows, *roots, **keys):
    """A patch of cells with interface ports at the cells `roots` (row, column)."""
    interfaces = [{"row": row, "column": column} for row, column in roots]
    return keys_of(patch=[{"columns": columns, "rows": rows}], interface=interfaces, **keys)


def setup_1(**keys):
    """Setup 1 of the paper: 99 cells, two interface ports."""
    return patch(9, 11, (0, 3), (10, 5), **keys)


def line(cells, **keys):
    """A line of cells between two interface ports."""
    ends = [{"row": 0, "column": 0, "port": "W"}, {"row": 0, "column": cells - 1, "port": "E"}]
    return keys_of(patch=[{"columns": cells, "rows": 1}], interface=ends, **keys)


def free(links, **keys):
    """A free graph."""
    return keys_of(link=[{"a": a, "b": b} for a, b in links], **keys)


def plan_of(keys):
    """The plan of a scenario's tables."""
    return scenario.plan(scenario.from_dict(keys))


def run(keys, **how):
    """Simulate a scenario's tables."""
    return simulate(plan_of(keys), **how)


def run_bundled(name, overrides=()):
    """Simulate a bundled scenario with some keys changed."""
    return simulate(scenario.plan(scenario.load(name, list(overrides))))


@contextmanager
def plain_stack(stack):
    """Plain runs use this stack instead of the simulator's own."""
    advance = loop.bind(stack)
    with mock.patch.object(simulator, "plain_loop", return_value=advance):
        yield


REPAIRS = {"restore": "cut", "restore pc": "cut pc", "revive": "kill"}
TARGETS = {"cut": "link", "restore": "link", "loose": "link", "lose": "link",
           "cut pc": "interface", "restore pc": "interface"}  # fmt: skip


def random_events(seed, count, actions, *, start_s=0.3, gap_s=0.02, most=6, ports=1):
    """Random faults: (events, moment of the last).

    Repairs come only where there is damage. At most `most` cables and as many cells are down at
    once, and at most `ports` of the PC's cables ("cut pc", "restore pc").
    """
    draw = random.Random(seed)
    events, at = [], start_s
    down = {"cut": 0, "kill": 0, "cut pc": 0}
    for _ in range(count):
        at += gap_s * draw.expovariate(1.0)
        action = draw.choice(actions)
        if action in REPAIRS and not down[REPAIRS[action]]:
            action = REPAIRS[action]
        if down.get(action, 0) >= (ports if action == "cut pc" else most):
            action = next(repair for repair, harm in REPAIRS.items() if harm == action)
        if action in REPAIRS:
            down[REPAIRS[action]] -= 1
        elif action in down:
            down[action] += 1
        event = {"at_s": round(at, 6), "action": action.removesuffix(" pc")}
        if action == "restart pc":
            event["pc"] = True
        else:
            event["random"] = TARGETS.get(action, "cell")
        if action == "loose":
            event["loss"] = 0.5
        events.append(event)
    return events, at


def faulty(seed, actions, shape=None, *, count=20, gap_s=0.02, loss=0.1, timing=None, **protocol):
    """A small patch under random faults and lost beacons."""
    columns, rows, roots = shape or (5, 5, ((0, 2), (4, 2)))
    events, last = random_events(seed, count, actions, gap_s=gap_s, ports=len(roots))
    return patch(
        columns, rows, *roots,
        seed=seed, duration_s=last + 0.2, event=events, protocol=protocol,
        timing={"loss": loss, **(timing or {})},
    )  # fmt: skip


def busy(seed, rule="feasible", **timing):
    """A small patch with sensor data, in all kinds of trouble."""
    events, last = random_events(seed, 15, EVERYTHING, start_s=0.05)
    return patch(
        5, 5, (0, 2), (4, 2), seed=seed, event=events, duration_s=last + 0.1,
        protocol={"rule": rule, "restart_s": 0.05, "k": 2 + seed % 4},
        timing={"loss": 0.05, **timing}, data={"rate_hz": 400, "queue": 1 + seed % 8},
    )  # fmt: skip


# What rows say.


def rows_since(result, start_us, *codes):
    """Rows with these codes from a moment on."""
    rows = result.rows
    return rows[(rows["time"] >= start_us) & np.isin(rows["code"], codes)]


def switches(result, start_us=0):
    """[(time_us, node)] of all changes of parent that do not serve balance."""
    rows = rows_since(result, start_us, REPORT_PARENT)
    return list(zip(rows["time"].tolist(), rows["node"].tolist(), strict=True))


def detected_us(result, start_us):
    """When the first port was found broken."""
    rows = rows_since(result, start_us, REPORT_BROKEN)
    return int(rows["time"][rows["b"] == 1].min())


def converged_us(result, start_us):
    """The last change of a parent, those for balance left out."""
    return switches(result, start_us)[-1][0]


def routed_us(result, start_us):
    """From when on every connected cell has a route for good; `start_us` if they never lost it."""
    rows = rows_since(result, start_us, UNROUTED)
    if len(rows) == 0:
        return start_us
    assert rows["a"][-1] == 0, f"{rows['a'][-1]} cells without a route at the end"
    return int(rows["time"][-1])


def loops_closed(result, start_us=0):
    """How many forwarding loops there were."""
    return len(rows_since(result, start_us, LOOP_OPEN))


def cut_cells(result):
    """Cells whose chain used the link, for the last event."""
    rows = rows_since(result, 0, CUT_OFF)
    return int(rows["b"][-1])


# The state at the end of a run, compiled or plain.


def cells_at_end(result, name):
    """A field of all cells: one number each, or a row of four."""
    cells = result.world.cells
    if isinstance(cells, list):
        return np.array([getattr(cell, name) for cell in cells])
    return np.array(cells[name])


def distances(result):
    """D of every cell at the end; 255 without a route."""
    parent = cells_at_end(result, "parent")
    heard = cells_at_end(result, "dist")
    rows = np.arange(len(parent))
    return np.where(parent == NONE, 255, np.minimum(heard[rows, np.maximum(parent, 0)] + 1, 255))


def parents(result):
    """The node on every cell's parent port; -1 without one."""
    graph = result.plan.graph
    ports = cells_at_end(result, "parent").tolist()
    ends = [graph.peer[4 * cell + port] if port >= 0 else -1 for cell, port in enumerate(ports)]
    return [graph.node_of(end) if end >= 0 else -1 for end in ends]


def true_loads(result):
    """L of every cell by counting: itself and all cells whose chain goes through it."""
    above = parents(result)
    loads = [0] * len(above)
    for cell in range(len(above)):
        node, steps = cell, 0
        while 0 <= node < len(above) and steps <= len(above):
            loads[node] += 1
            node, steps = above[node], steps + 1
    return loads


def port_sizes(result):
    """What the PC holds for the load of every interface port."""
    return [int(size) for size in result.world.pc.size]
