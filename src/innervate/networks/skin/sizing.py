"""How many interface ports a robot's skin needs: a sweep over ports, sample rates and cuts."""

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Unpack

import polars

from innervate import scenario as scenarios
from innervate.running.options import refuse_others, takes
from innervate.scenario import ScenarioError
from innervate.sweeping.errors import SweepError
from innervate.sweeping.plan import SweepPlan
from innervate.sweeping.result import Sweep
from innervate.sweeping.sweep import ALL_CORES, Crew, Progress, make_plan, sweep
from innervate.sweeping.vary import Named
from innervate.topology import Graph, TopologyError, cells_from_urdf
from innervate.topology.body import body_graph, joining_reach
from innervate.topology.cover import has_surface
from innervate.topology.urdf import Vector, find_urdf, read_links
from innervate.topology.weak import Weak, weak_points

PORTS_MAX = 8
PITCH_MM = 25.0
REACH_PITCHES = 1.6  # cables to the nearest neighbours, some 1 to 1.5 pitches away
LOSS_MAX = 0.01
RECOVERY_MS_MAX = 50.0
REACH_MM_MAX = 100_000.0
SETTLED_S = 1.0
DURATION_S = 2.0
LOST = "lost_on_the_way"
RECOVERY = "recoveries.others_ms"
UNHEALED = "recoveries.without_way"
INNER, OUTER = "between cells", "to the PC"
_CUT_AT_S = [SETTLED_S, SETTLED_S + 0.1]
CUTS = (
    Named(INNER, [{"at_s": _CUT_AT_S, "action": "cut", "random": "link"}]),
    Named(OUTER, [{"at_s": _CUT_AT_S, "action": "cut", "random": "interface"}]),
)


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked.

    Attributes:
        urdf: a file, or "package:DISTRIBUTION/ROBOT".
        links: pattern for the links that carry skin.
        rates_hz: samples per second and cell.
        ports: numbers of interface ports to try, in order.
        pitch_mm: distance of cells on links that have a shape; None = 25 mm.
        reach_mm: longest cable between cells; None = as long as it takes to join all.
        loss_max: share of samples that may be lost, by the upper end of its interval.
        recovery_ms_max: time until all cells that cables still reach have a way again, by the upper
            end of its interval.
    """

    urdf: str
    links: str
    rates_hz: tuple[float, ...] = (250.0,)
    ports: tuple[int, ...] = tuple(range(1, PORTS_MAX + 1))
    pitch_mm: float | None = None
    reach_mm: float | None = None
    loss_max: float = LOSS_MAX
    recovery_ms_max: float = RECOVERY_MS_MAX


@dataclass(eq=False, repr=False)
class Answer:
    """What came out.

    Attributes:
        question: as asked, pitch and reach filled in.
        cells: how many there are.
        frames: they are the robot's own skin frames, rather than points on its surface.
        sweep: the runs.
        table: a row for every rate and number of ports: means with 95 % intervals; `isolated_max`,
            how many cells a single failure can cut off for good; `failed`, runs that failed;
            `unhealed`, runs in which cells that cables still reached got no way again; `within`,
            loss and recovery are small enough, without any of these; `enough`, they are and no
            single failure cuts off cells.
        needed: for every rate the fewest ports that are enough; None if none of those tried is.
        carries: for every rate the fewest ports that are `within`; None if none is.
        graphs: the skin for every number of ports that there is room for.
        weak: for every number of ports the cables and cells whose loss cuts off others.
    """

    question: Question
    cells: int
    frames: bool
    sweep: Sweep
    table: polars.DataFrame
    needed: dict[float, int | None]
    carries: dict[float, int | None]
    graphs: dict[int, Graph]
    weak: dict[int, list[Weak]]

    @property
    def is_single(self) -> bool:
        """One run of every combination: nothing is known of how much runs differ."""
        return self.sweep.plan.repeat == 1

    @property
    def where(self) -> dict[int, list[str]]:
        """For every number of ports the names of the cells that they are on, by port."""
        return {
            ports: [graph.label(cell) for cell in graph.neighbours(graph.sink)]
            for ports, graph in self.graphs.items()
        }

    def lines(self) -> list[str]:
        """It in words: a table, then how many ports, where, and what does not heal."""
        from innervate.networks.skin.plot.answer import answer_lines

        return answer_lines(self)

    def record(self) -> dict[str, Any]:
        """It for programs, as `innervate size --json` prints it."""
        from innervate.networks.skin.plot.answer import answer_record

        return answer_record(self)

    def draw(self, folder: Path) -> Path:
        """Its picture, written into a folder, with the ports that the hardest rate needs."""
        from innervate.networks.skin.plot import sizing as figure

        return figure.write(self, folder)


@takes(Crew, ALL_CORES)
def size(
    question: Question,
    *,
    out: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
    repeat: int = 20,
    seed: int = 1,
    **crew: Unpack[Crew],
) -> Answer:
    """Answer a question by simulation; the other arguments are those of sweep().

    Raises:
        TypeError: no argument of that name.
        SweepError: nothing to place cells on, or no ports or rates to try.
        ScenarioError: the skin cannot be built.
    """
    refuse_others("size", crew, Crew.__annotations__)
    asked, frames, names = _placed(question)
    plan = plan_of(asked, frames, repeat, seed)
    done = sweep(plan, out=out, follow=(RECOVERY,), progress=progress, **crew)
    made = {ports: _graph(plan, ports) for ports in asked.ports}
    graphs = {ports: graph for ports, graph in made.items() if graph is not None}
    weak = {ports: weak_points(graph) for ports, graph in graphs.items()}
    table = judged(asked, done, weak)
    needed, carries = (
        {
            rate: min(table.filter((table["rate_hz"] == rate) & table[word])["ports"], default=None)
            for rate in asked.rates_hz
        }
        for word in ("enough", "within")
    )
    return Answer(asked, len(names), frames, done, table, needed, carries, graphs, weak)


def _placed(question: Question) -> tuple[Question, bool, list[str]]:
    """The question with pitch and reach filled in; are the cells frames; their names."""
    if not question.ports or not question.rates_hz:
        raise SweepError("name at least one number of ports and one rate")
    try:
        path = find_urdf(question.urdf, Path())
        links = read_links(path, question.links)
        frames = question.pitch_mm is None and not any(map(has_surface, links))
        pitch = None if frames else question.pitch_mm or PITCH_MM
        names, places = cells_from_urdf(question.urdf, question.links, Path(), pitch)
    except TopologyError as error:
        raise SweepError(str(error)) from None
    reach = question.reach_mm
    if reach is None:
        least = joining_reach(places) * 1.001
        reach = round(max(least, REACH_PITCHES * pitch if pitch else 0.0) + 0.05, 1)
    _say_if_unjoined(path, names, places, reach, min(question.ports))
    return replace(question, pitch_mm=pitch, reach_mm=reach), frames, names


def _say_if_unjoined(
    path: Path, names: Sequence[str], places: Sequence[Vector], reach: float, ports: int
) -> None:
    """Raise if no cables join the cells, or not even the fewest ports find room; by the options."""
    if reach > REACH_MM_MAX:
        raise SweepError(
            f"{path.name}: cables of {reach:,.0f} mm would be needed to join the cells, more than "
            f"{REACH_MM_MAX:,.0f}; choose other --links, or look at its joints"
        )
    try:
        body_graph(names, places, reach, ports)
    except TopologyError as error:
        told = str(error).replace("reach_mm = ", "--reach ")
        option = {"reach_mm": "--reach: ", "interfaces": "--ports: "}.get(error.subject, "")
        raise SweepError(f"{option}{told}") from None


def plan_of(question: Question, frames: bool, repeat: int, seed: int) -> SweepPlan:
    """The sweep that answers a question: ports x rates x what is cut."""
    body: dict[str, Any] = {"urdf": question.urdf, "links": question.links,
                            "reach_mm": question.reach_mm}  # fmt: skip
    if not frames:
        body["pitch_mm"] = question.pitch_mm
    tables = {
        "kind": "skin",
        "name": "size",
        "duration_s": DURATION_S,
        "body": body | {"interfaces": question.ports[0]},
        "data": {"rate_hz": question.rates_hz[0]},
    }
    vary = {
        "data.rate_hz": list(question.rates_hz),
        "body.interfaces": list(question.ports),
        "event": list(CUTS),
    }
    return make_plan(tables, vary=vary, repeat=repeat, seed=seed, paired=("body.interfaces",))


def judged(question: Question, done: Sweep, weak: Mapping[int, Sequence[Weak]]) -> polars.DataFrame:
    """A row for every rate and number of ports.

    `within` if loss and recovery are small enough, no run failed, and every cell that cables still
    reached got a way again; `enough` if besides no single failure cuts off cells for good.

    `loss` counts samples lost on the way: full queues, the cut cable, loops. Those that a cell
    took while it had no route count as recovery time, and before its first route not at all.
    """
    reasons = [c for c in done.results.columns if c.startswith("data.lost_by.")]
    kept = [c for c in reasons if not c.endswith(".no_route")]
    if not kept:
        raise SweepError(f"no run succeeded: {done.failed['reason'][0]}")
    lost = sum((done.results[c] for c in kept[1:]), done.results[kept[0]])
    frame = done.results.with_columns((lost / done.results["data.sent"]).alias(LOST))
    points = Sweep(done.plan, frame, done.timings).points((LOST, RECOVERY))
    found = {
        (r["data.rate_hz"], r["body.interfaces"], r["event"], r["measure"]): r
        for r in points.iter_rows(named=True)
    }
    failed, unhealed = (
        Counter(part.select("data.rate_hz", "body.interfaces").iter_rows())
        for part in (done.failed, frame.filter(frame[UNHEALED] > 0))
    )
    rows = []
    for rate in question.rates_hz:
        for ports in question.ports:
            row = _row(question, rate, ports, found)
            wrong = {"failed": failed[rate, ports], "unhealed": unhealed[rate, ports]}
            within = row["within"] and not any(wrong.values())
            alone = weak.get(ports)  # None if there is no room for so many
            worst = None if alone is None else max((one.isolated for one in alone), default=0)
            rows.append(row | wrong | {"isolated_max": worst, "within": within,
                               "enough": within and worst == 0})  # fmt: skip
    return polars.DataFrame(rows, infer_schema_length=None)


def _row(question: Question, rate: float, ports: int, found: dict[Any, Any]) -> dict[str, Any]:
    row: dict[str, Any] = {"rate_hz": rate, "ports": ports}
    within = True
    for cut, short in ((INNER, "cell"), (OUTER, "pc")):
        alone = cut == OUTER and ports == 1  # nobody has a way any more; there is nothing to judge
        for name, measure, most in (
            ("loss", LOST, question.loss_max),
            ("recovery_ms", RECOVERY, question.recovery_ms_max),
        ):
            one = found[rate, ports, cut, measure]
            row[f"{name}_{short}_runs"] = 0 if alone else one["runs"]
            for part in ("mean", "low", "high", "max"):
                value = None if alone else one[part]
                row[f"{name}_{short}_{part}"] = None if value is None else float(value)
            # With one port less the rest may be too few to carry all; that is no failure.
            if not alone and not (name == "loss" and cut == OUTER):
                within &= one["high"] is not None and one["high"] <= most
    return row | {"within": within}


def _graph(plan: SweepPlan, ports: int) -> Graph | None:
    """The skin with so many interface ports; None if there is no room for them."""
    try:
        made: Graph = scenarios.plan(plan.base.scenario([("body.interfaces", ports)])).graph
    except ScenarioError:
        return None
    return made


def parse_ports(text: str) -> tuple[int, ...]:
    """Numbers of ports: "1..8" or "1,2,4".

    Raises:
        SweepError: it is neither.
    """
    from innervate.sweeping.planfile import listed

    found: Sequence[Any] = listed(text, "--ports")
    if not all(isinstance(n, int) and not isinstance(n, bool) and n >= 1 for n in found):
        raise SweepError(f'--ports must be whole numbers from 1, like 1..8, not "{text[:40]}"')
    return tuple(sorted(set(found)))
