"""What is drawn for the record: small runs of each network with everything that can go wrong, and
what is drawn of none (sweeps, counterexamples, answers in words), by picture."""

from __future__ import annotations

import dataclasses
import os
from array import array
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import innervate
from innervate import scenario
from innervate.network import networks
from innervate.networks.skin.plot.words import fault_words
from innervate.plot import figures as drawing
from innervate.plot import notebook, panels, report, style
from tests.fixtures.plots import MANY_EVENTS, make_tables
from tests.networks.mesh.tables_runs import mesh_tables, without_fence
from tests.networks.radio.plot.test_timeline import CASES
from tests.networks.radio.runs import run as radio_run
from tests.recorded import looks, pages
from tests.recorded.looks import Picture

RING = Path(__file__).resolve().parents[1] / "networks" / "tokenring"
Drawn = Callable[[], Any]  # a page, a drawing, a figure or lines of words
ORIGIN = {"version": "1", "python": "3", "seeds": [1, 2], "of": {"none": None, "few": []}}


def text_of(drawn: Any) -> Picture:
    """Whatever was drawn, as lines."""
    if isinstance(drawn, str):
        return pages.picture(drawn)
    if isinstance(drawn, list):
        return {"words": [str(line) for line in drawn]}
    if hasattr(drawn, "render"):
        return pages.picture(drawn.render())
    with style.house():
        return looks.picture(drawn)


def skin(**changes: Any) -> Any:
    """A run of the fixtures' skin; keys that are None are left out."""
    tables = make_tables(**changes)
    return timeless(innervate.run({key: of for key, of in tables.items() if of is not None}))


def timeless(run: Any, **more: Any) -> Any:
    """A run without what depends on the machine."""
    summary = run.summary | {"wall_s": 0.25, "events_per_s": 1000.0} | more
    made = dataclasses.replace(run, summary=summary)
    vars(made)["provenance"] = ORIGIN
    return made


def body(run: Any) -> str:
    """A run's report without the parts that all networks share."""
    page: str = networks()[run.summary["kind"]].report(run.result, run.summary)
    return page


def figures(run: Any, prefix: str, **options: dict[str, Any]) -> dict[str, Drawn]:
    """Every figure of a run, and some with other options."""
    found: dict[str, Drawn] = {
        f"{prefix}, {name}": lambda name=name: drawing.draw(run, name)
        for name in networks()[run.summary["kind"]].figures
    }
    for name, more in options.items():
        found[f"{prefix}, {name} {more}"] = lambda name=name, more=more: drawing.draw(
            run, name, **more
        )
    return found


FREE = [{"a": "left", "b": "pc.0"}, {"a": "left", "b": "right"}, {"a": "right", "b": "pc.1"}]
QUIET = [{"row": 0, "column": 1}]
ONE_CELL = {"patch": [{"columns": 1, "rows": 1}], "interface": [{"row": 0, "column": 0}]}
LARGE = {"patch": [{"columns": 6, "rows": 10, "count": 20, "interfaces_every": 1}],
         "interface": [], "data": {"rate_hz": 20}, "duration_s": 0.35}  # fmt: skip
PORTS = {"patch": [{"columns": 3, "rows": 4, "count": 9, "interfaces_every": 1}], "interface": []}
COMMANDS = {"command": [{"kind": "ask", "period_s": 0.05}]}
SKIN_CASES: dict[str, dict[str, Any]] = {
    "cut": {},
    "many events": {"duration_s": 0.8, "event": MANY_EVENTS},
    "quiet, one port": {"event": [], "interface": QUIET},
    "no data": {"data": {"rate_hz": 0}},
    "no touch, static": {"touch": None, "protocol": {"rule": "static", "restart_s": 0.1}},
    "one cell": ONE_CELL | {"event": []},
    "too short": {"duration_s": 0.001, "event": []},
    "ends in the recovery": {"duration_s": 0.301},
    "all cut off": {"event": [{"at_s": 0.3, "action": "cut", "interface": i} for i in (0, 1)]},
    "a free graph": {"patch": None, "interface": None, "link": FREE,
                     "event": [{"at_s": 0.3, "action": "cut", "link": ["left", "right"]}]},
    "large": LARGE,
    "nine ports": PORTS,
}  # fmt: skip


@cache
def skin_runs() -> dict[str, Any]:
    """Runs of skins."""
    return {name: skin(**changes) for name, changes in SKIN_CASES.items()}


def of_skin() -> Iterator[tuple[str, Drawn]]:
    """Reports, notebook and figures of skins."""
    for name, run in skin_runs().items():
        yield name, lambda run=run: body(run)
    runs = skin_runs()
    cut, many = runs["cut"], runs["many events"]
    yield "interrupted", lambda: body(timeless(cut, interrupted_at_s=0.25))
    yield "whole page", lambda: report.render(cut)
    yield "notebook", lambda: notebook.render(cut.result, cut.summary)
    times = {"recovery": {"from_s": 0.1, "to_s": 0.4}, "routes": {"time_s": 0.31},
             "received": {"time_s": 0.4, "window_s": 0.02}}  # fmt: skip
    yield from figures(cut, "cut", **times).items()
    yield from figures(many, "many events").items()
    yield from figures(runs["a free graph"], "a free graph").items()
    yield from figures(runs["large"], "large").items()
    yield "words", lambda: [fault_words(many.plan.graph, fault) for fault in many.plan.faults]
    show = import_module("innervate.networks.skin.show")
    yield "said", lambda: [line for run in (cut, many) for line in show.summary_lines(run)]


@cache
def mesh_runs() -> dict[str, Any]:
    """Runs of meshes."""
    big = without_fence() | {"name": "big", "nodes": 70, "duration_s": 1.0}
    silent = without_fence() | {
        "name": "silent",
        "nodes": 2,
        "flow": [],
        "duration_s": 0.5,
        "standby": [],
        "monitor": 1,
    }
    events = [
        {"at_s": 2, "action": "kill", "node": 3}, {"at_s": 3, "action": "kill", "random": 2},
        {"at_s": 4, "action": "revive", "node": 3},
    ]  # fmt: skip
    tables = {"field": mesh_tables(), "plain": without_fence(), "big": big, "silent": silent,
              "events": without_fence() | {"name": "events", "event": events}}  # fmt: skip
    # Plain where it would be the only one of its size: that costs a fifth of compiling it.
    return {name: timeless(innervate.run(of, plain=name == "big")) for name, of in tables.items()}


def of_mesh() -> Iterator[tuple[str, Drawn]]:
    """Reports, notebook and figures of meshes."""
    runs = mesh_runs()
    for name, run in runs.items():
        yield name, lambda run=run: body(run)
        yield f"{name}, notebook", lambda run=run: notebook.render(run.result, run.summary)
    early = timeless(runs["field"], interrupted_at_s=0.25)
    yield "interrupted", lambda: body(early)
    yield "whole page", lambda: report.render(runs["plain"])
    for name in ("field", "plain", "silent"):
        yield from figures(runs[name], name).items()
    yield "delivery in 7", figures(runs["field"], "f", delivery={"bins": 7}).popitem()[1]
    show = import_module("innervate.networks.mesh.show")
    yield "said", lambda: [line for run in runs.values() for line in show.summary_lines(run)]
    yield (
        "story",
        lambda: import_module("innervate.networks.mesh.plot.counterexample").draw(mesh_story()),
    )


def mesh_story() -> Any:
    """A story of four nodes: one dies, a packet goes round."""
    scenes = [
        SimpleNamespace(hops=(1, 2, 3, -1), dead=(), actor=0, sent=(0, 1), lost=()),
        SimpleNamespace(hops=(1, 0, 3, -1), dead=(3,), actor=1, sent=(1, 0), lost=(2, 3)),
        SimpleNamespace(hops=(1, 0, 1, -1), dead=(3,), actor=2, sent=(), lost=()),
    ]
    links = [(0, 1), (1, 2), (2, 3), (0, 2)]
    return SimpleNamespace(
        scenes=scenes, found=SimpleNamespace(model=SimpleNamespace(nodes=4, links=links)),
        dest=3, ring=(0, 1), title="a packet goes round", sentences=SENTENCES,
    )  # fmt: skip


SENTENCES = ["Node 0 sends.", "Node 1 " + "hears nothing and sends it back, " * 9 + "at last.", "x"]


@cache
def radio_runs() -> dict[str, tuple[Any, Any]]:
    """(result, summary) of radio teams."""
    summarize = import_module("innervate.networks.radio.analysis.summary").summarize
    found = {}
    told = scenario.from_dict({"kind": "radio", "stations": 5})  # for what it says of delays
    for name, (n, more) in CASES.items():
        result = radio_run(n, plain=n < 50, scenario=told, **more)
        summary = summarize(result) | {"wall_s": 0.25, "name": f"<{name}>"}
        found[name] = (result, summary)
    return found


def of_radio() -> Iterator[tuple[str, Drawn]]:
    """Reports and figures of radio teams, of the slotted level too."""
    for name, run in radio_runs().items():
        yield name, lambda run=run: import_module("innervate.networks.radio.plot.report").body(*run)
    for name in ("two", "ten slow", "saturated", "faults", "nothing"):
        result, summary = radio_runs()[name]
        run = SimpleNamespace(result=result, summary=summary | {"kind": "radio"})
        yield from figures(run, name).items()
    for traffic in ({"kind": "disaster"}, {"kind": "saturated", "packets": 200}):
        tables = {"kind": "radio", "stations": 5, "seed": 3, "duration_s": 60, "traffic": traffic,
                  "channel": {"level": "slotted"}, "protocol": {"mac": "csma-cd-r"}}  # fmt: skip
        run = timeless(innervate.run(tables))
        yield f"slotted {traffic['kind']}", lambda run=run: report.render(run)
        yield (
            f"slotted {traffic['kind']}, notebook",
            lambda run=run: notebook.render(run.result, run.summary),
        )


@contextmanager
def ring_known() -> Iterator[None]:
    """The tests' own network is one of the networks."""
    before = os.environ.get("INNERVATE_NETWORKS")
    os.environ["INNERVATE_NETWORKS"] = str(RING)
    networks.cache_clear()
    try:
        yield
    finally:
        if before is None:
            del os.environ["INNERVATE_NETWORKS"]
        else:
            os.environ["INNERVATE_NETWORKS"] = before
        networks.cache_clear()


def ring(kind: str) -> Any:
    """A ring whose node 2 is cut off for a while."""
    events = [
        {"at_s": 0.1, "action": "cut", "node": 2},
        {"at_s": 0.15, "action": "restore", "node": 2},
    ]
    tables = {"kind": "tokenring", "nodes": 5, "duration_s": 0.3, "event": events}
    with ring_known():
        run = timeless(innervate.run(tables, plain=True))
        if kind == "page":
            return report.render(run)
        if kind == "notebook":
            return notebook.render(run.result, run.summary)
        if kind == "said":
            return import_module("innervate.plot.lines").summary_lines(run)
        return drawing.draw(run, kind)


def of_spine() -> Iterator[tuple[str, Drawn]]:
    """What no network draws: a network without drawings of its own, sweeps, stories, answers."""
    for kind in ("page", "notebook", "said", "delivered", "latency"):
        yield f"ring, {kind}", lambda kind=kind: ring(kind)
    yield from sweeps()
    yield from stories()


def sweeps() -> Iterator[tuple[str, Drawn]]:
    """Figures of made-up sweeps."""
    room = import_module("innervate.plot.sweeps")

    def draw(columns: Any, *case: Any) -> Any:
        *shown, over = case
        return room.draw(columns, room.Shown(*shown), over)

    ks, seeds = (1, 2, 5, 10, 20), 3
    rows = [(k, rule, s) for k in ks for rule in ("a", "b") for s in range(seeds)]
    columns = {
        "protocol.k": [k for k, _, _ in rows],
        "protocol.rule": [rule for _, rule, _ in rows],
        "one": [1.5 for _ in rows],
        "found.routed_ms": [None if (k, rule) == (20, "b") else k * (1 + s) + 3 * (rule == "b")
                            for k, rule, s in rows],
        "data.loss": [0.1 / k + 0.01 * s for k, _, s in rows],
    }  # fmt: skip
    x, y, by = "protocol.k", "found.routed_ms", "protocol.rule"
    over = {"seed": 3, "stations": 2}
    cases = {
        "bands": (x, y, by, "band", "Bands", over), "one line": (x, y, "", "band", "", {}),
        "texts": (by, y, x, "band", "", {}), "one place": ("one", y, "", "band", "", {}),
        "dots": ("data.loss", y, by, "band", "Dots", None),
        "all dots": (y, "data.loss", "", "band", "", None),
        "heat": (x, y, by, "heat", "Heat", over),
    }  # fmt: skip
    for name, case in cases.items():
        yield f"sweep, {name}", lambda case=case: draw(columns, *case)
    many = [(a, b) for a in range(9) for b in range(9)]
    wide = {"a": [a for a, _ in many], "b_hz": [0.5 * b for _, b in many],
            "y_s": [a * b for a, b in many]}  # fmt: skip
    yield "sweep, many squares", lambda: draw(wide, "a", "y_s", "b_hz", "heat", "", {})
    yield "sweep, many lines", lambda: draw(wide, "a", "y_s", "b_hz", "band", "", {})
    none = {"a": [1, 2], "b": [1, 1], "y": [None, None]}
    yield "sweep, nothing", lambda: draw(none, "a", "y", "b", "heat", "", {})


def stories() -> Iterator[tuple[str, Drawn]]:
    """A counterexample of a skin."""
    scene = import_module("innervate.networks.skin.verify.narrator").Scene
    none = import_module("innervate.networks.skin.protocol.constants").NONE
    tables = make_tables(**SKIN_CASES["a free graph"])
    nine = {"kind": "skin", "duration_s": 0.1, "patch": [{"columns": 3, "rows": 3}],
            "interface": [{"row": 0, "column": 1}]}  # fmt: skip
    graph, small = (
        scenario.plan(scenario.from_dict({key: of for key, of in one.items() if of is not None}))
        .graph for one in (tables, nine)
    )  # fmt: skip
    told = {}
    for name, one in (("a free graph", graph), ("nine cells", small)):
        cells, pc = one.cells, one.sink
        rest, cut = (0,) * (cells - 1), frozenset({(pc, 0), (0, 1)})
        scenes = [
            scene((none,) * cells, frozenset(), 0), scene((pc, *rest), frozenset(), 1),
            scene((pc, *rest), frozenset(), 0), scene((1, *rest), cut, none),
            scene((1, *rest), cut, 0),
        ]  # fmt: skip
        told[name] = SimpleNamespace(
            graph=one, scenes=scenes, ring=[0, 1], title="closed loop", sentences=SENTENCES
        )
    draw = import_module("innervate.networks.skin.plot.counterexample").draw
    for name, story in told.items():
        yield f"story, {name}", lambda story=story: draw(story)
    yield from answers(small)


def answers(graph: Any) -> Iterator[tuple[str, Drawn]]:
    """The answer of `innervate size`, in words and as a picture."""
    sizing = import_module("innervate.networks.skin.plot.sizing")
    lines = import_module("innervate.networks.skin.plot.answer").answer_lines
    weak = import_module("innervate.topology.weak").Weak
    rows = []
    for rate in (100.0, 1000.0):
        for ports in (1, 2, 3):
            mean = rate / 2e4 / ports
            rows.append({
                "rate_hz": rate, "ports": ports, "isolated_max": {1: None, 2: 4, 3: 0}[ports],
                "enough": ports == 3, "unhealed": int(ports == 1 and rate > 100),
                **dict.fromkeys(("loss_cell_runs", "recovery_ms_cell_runs"), ports),
                "recovery_ms_pc_runs": 20,
                **{f"{name}_{part}": None if ports == 1 and "pc" in name else scale * mean * share
                   for name, scale in (("loss_cell", 1.0), ("recovery_ms_cell", 500.0),
                                       ("recovery_ms_pc", 300.0))
                   for part, share in (("mean", 1.0), ("low", 0.8), ("high", 1.3))},
            })  # fmt: skip
    points = [weak(4, 5, -1), *(weak(1 + n % 2, -1, n) for n in range(5))]
    places = [value for n in range(9) for value in (30.0 * (n % 3), 3.0 * n, 40.0 * (n // 3))]
    bent = dataclasses.replace(graph, positions=array("d", places))
    flat = dataclasses.replace(
        graph, positions=array("d", [v for n in range(9) for v in (n % 3, 9.0 * (n // 3), 0.0)])
    )
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    asked = SimpleNamespace(pitch_mm=25.0, reach_mm=40.0, loss_max=0.01, recovery_ms_max=50.0,
                            ports=(1, 2, 3))  # fmt: skip
    answer = SimpleNamespace(
        question=asked, frames=False, cells=9, is_single=False,
        graphs=dict.fromkeys((1, 2, 3), graph),
        table=SimpleNamespace(iter_rows=lambda named: iter(rows)),
        where={3: ["n1", "n5", "n9"], 1: ["n1"]},
        needed={100.0: 3, 1000.0: None, 500.0: None, 50.0: 1},
        carries={100.0: 3, 1000.0: 2, 500.0: None, 50.0: 1},
        weak={3: [], 2: points, 1: points[:1]},
    )  # fmt: skip
    yield "size, words", lambda: lines(answer)
    yield "size, of a robot", lambda: lines(SimpleNamespace(**(vars(answer) | {"frames": True})))
    yield "size, picture", lambda: sizing.draw(columns, bent, (0.01, 50.0), "9 cells, 3 ports")
    one = {name: of[:3] for name, of in columns.items()}
    yield "size, one rate", lambda: sizing.draw(one, flat, (0.02, 5.0), "")


def save(drawing: Any, path: Path) -> None:
    """Write a drawing so that it can be looked at by itself."""
    of_mesh = import_module("innervate.networks.mesh.plot.counterexample")
    panels.save(drawing, path, of_mesh._MORE)  # the others have none of their own
