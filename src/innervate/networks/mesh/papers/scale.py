"""Section 1: "not scalable, but sufficient for small networks": up to how many nodes?"""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.papers.document import SMALL, beyond, said
from innervate.networks.mesh.papers.lossy import NONE, row_of
from innervate.networks.mesh.papers.testbed import GATEWAY, GRAPH, MeshTestbed, Options
from innervate.networks.mesh.protocol.constants import TABLES
from innervate.networks.mesh.scenario.plan import ONE
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, Sheet, verdict
from innervate.papers.words import joined, percent
from innervate.plot import style

TITLE = "1: how small is small"
CAPTION = (
    "Mean degree 8. Airtime of one discovery round and of all that it distributes, as heard where "
    "it is busiest, as a share of the period. Hollow, off the line: in some network not everyone "
    "got a table, so that this is less than a whole round. Dotted: half."
)
HALF = 0.5
SMALL_MOST = 70  # nodes: more than that, we would not call small


class Radio(NamedTuple):
    """A profile and what is tried with it."""

    profile: str
    period_s: float  # between discovery rounds
    nodes: tuple[int, ...]  # how many, up to what is reasonable
    graph_max: int  # nodes that a flooded graph has room for
    per_node_s: float  # a round and its tables take less than this for every node


RADIOS = (
    Radio("250k", 10, (10, 20, 30, 45, 70, 100, 145, 200, 254), 145, 0.5),
    Radio("38k4", 60, (10, 20, 30, 45, 70, 85, 120), 85, 8.0),
)
SOME = (10, 30, SMALL_MOST)
SCHEMES: dict[str, Options] = {"tables": (), "graph": GRAPH, "table-free": (("tables", False),)}


def point(radio: Radio, scheme: str, nodes: int, quick: bool) -> Point:
    """A single round, and time for all its tables."""
    alone: Options = (("period_s", 3600.0), ("period_max_s", 3600.0))
    duration = 20 + radio.per_node_s * nodes
    testbed = MeshTestbed(nodes, 8, radio.profile, (*alone, *SCHEMES[scheme]), duration)
    return testbed.point("a full round", 1 if quick else 3, measure)


def points(quick: bool) -> list[Point]:
    """Every radio, scheme and size."""
    return [
        point(radio, scheme, n, quick)
        for radio in RADIOS
        for scheme in SCHEMES
        for n in _ns(radio, scheme, quick)
    ]


def measure(of: MeshTestbed, seed: int) -> dict[str, Any]:
    """Seconds that the channel is busy for one full round, where it is busiest."""
    result = of.run(seed)
    plan, sent = result.plan, result.sent
    spent_us = np.zeros(plan.nodes, np.int64)
    np.add.at(spent_us, sent["node"], sent["end"] - sent["time"])
    hears = np.array(plan.radio.prob_q15).reshape(plan.nodes, plan.nodes) >= ONE // 2
    found = summarize(result)["discovery"]
    busy_s = float((spent_us @ hears + spent_us).max()) / 1e6
    ways = row_of(result, GATEWAY, "next")
    lost = sum(way == NONE for node, way in enumerate(ways) if node != GATEWAY)
    has_tables = plan.params["mode"] == TABLES
    return {
        "busy_s": busy_s,
        "unknown": lost if has_tables else None,
        **{name: found[name] for name in ("with_tables", "tables_s")},
    }


def _ns(radio: Radio, scheme: str, quick: bool) -> list[int]:
    most = radio.graph_max if scheme == "graph" else 254
    return [n for n in (SOME if quick else radio.nodes) if n <= most]


class Size(NamedTuple):
    """What came of a scheme at one size."""

    nodes: int  # how many
    share: float  # of the period that the busiest channel is busy, all tables new each round
    without: list[int]  # how many nodes got no table, in each network
    unknown: int  # to how many nodes the gateway knows no way, in all networks
    took_s: float  # until the last node had its table, mean of the networks where all got theirs

    @property
    def is_whole(self) -> bool:
        """True if everyone got a table in all networks; less than a whole round costs less."""
        return not any(self.without)

    @property
    def short(self) -> str:
        """Who got none, in words."""
        bad = sum(map(bool, self.without))
        return (
            f"nodes in {bad} of {len(self.without)} networks got no table, {sum(self.without)} of "
            f"{self.nodes * len(self.without)}"
        )

    @property
    def took(self) -> str:
        """When all had theirs, in words."""
        return f"all after {self.took_s:.0f} s" if self.is_whole else "not all"


def sizes(got: Measured, radio: Radio, scheme: str) -> list[Size]:
    """Every size that was tried, also those at which it failed."""
    found = []
    for n in _ns(radio, scheme, got.quick):
        runs = got[point(radio, scheme, n, got.quick)]
        without = [0 if some is None else n - some for some in runs["with_tables"]]
        times = [time for time in runs["tables_s"] if time is not None]
        took_s = float(np.mean(times)) if times else np.nan
        unknown = sum(some or 0 for some in runs["unknown"])
        share = float(np.mean(runs["busy_s"])) / radio.period_s
        found.append(Size(n, share, without, unknown, took_s))
    return found


def draw(got: Measured) -> Figure:
    """Busy share over N, for both radios."""
    figure, axes = style.panels(style.WIDE_IN, 2.7, 1, 2, sharey=True)
    for ax, radio, letter in zip(axes, RADIOS, "ab", strict=True):
        for i, scheme in enumerate(SCHEMES):
            _curve(ax, sizes(got, radio, scheme), scheme, style.look(i))
        ax.axhline(100 * HALF, color=style.INK, lw=0.8, ls=":", label="half")
        ax.set_yscale("log")
        drawing.logarithmic(ax, SOME if got.quick else (10, 30, 100, 250))
        title = f"{letter}  {radio.profile}, a round every {radio.period_s:g} s"
        ax.set(xlabel="nodes N", title=title)
    axes[0].set_ylabel("busiest channel busy (%)")
    drawing.legend(figure, axes, ncols=4)
    return figure


def _curve(ax: Axes, tried: list[Size], scheme: str, look: dict[str, Any]) -> None:
    """Whole rounds on a line; what was not a whole round hollow, beside it."""
    for is_whole, label in ((True, scheme), (False, f"{scheme}, not all got theirs")):
        some = [size for size in tried if size.is_whole == is_whole]
        how = look if is_whole else look | drawing.HOLLOW
        if some:
            ax.plot([size.nodes for size in some], [100 * size.share for size in some],
                    label=label, **how)  # fmt: skip


def sheets(got: Measured) -> list[Sheet]:
    """Every size, and where not everyone got a table."""
    head = ("radio", "what goes out", "nodes", "networks", "busiest channel, of the period",
            "who has a table")  # fmt: skip
    rows = [
        (radio.profile, scheme, str(size.nodes), str(len(size.without)), percent(size.share, 1),
         _whole(scheme, size))
        for radio in RADIOS for scheme in SCHEMES for size in sizes(got, radio, scheme)
    ]  # fmt: skip
    return [Sheet("Every size that was tried", head, rows)]


def _whole(scheme: str, size: Size) -> str:
    if scheme == "table-free":
        return "there are no tables"
    return size.took if size.is_whole else f"failed: {size.short}"


def judge(got: Measured) -> Claims:
    """How small is small; the other two schemes."""
    for radio in RADIOS:
        yield _small(got, radio)
        yield _others(got, radio)
    yield _complete(got)


def _small(got: Measured, radio: Radio) -> Claim:
    tried = sizes(got, radio, "tables")
    (small,) = (size for size in tried if size.nodes == SMALL_MOST)
    words = f"{percent(small.share, 1)} of the period at N = {SMALL_MOST}"
    if not small.is_whole:
        words += f", where {small.short}"
    return said(
        SMALL,
        f"tables leave half of the channel at {radio.profile} with {SMALL_MOST} nodes, if every "
        "round changes every table (our bar)",
        f"{words}, {small.took}, where a period is {radio.period_s:g} s; {_reached(tried)}",
        verdict(small.share <= HALF and small.is_whole),
        "an unchanged table is not sent, which takes less",
    )


def _reached(tried: list[Size]) -> str:
    """From which size on half of the channel is taken, as far as was tried."""
    full = [size.nodes for size in tried if size.share > HALF]
    if not full:
        last = tried[-1]
        return f"less than half up to N = {last.nodes}, the most that was run"
    before = [size.nodes for size in tried if size.nodes < full[0]]
    return f"half is passed between N = {before[-1] if before else 0} and {full[0]}"


def _others(got: Measured, radio: Radio) -> Claim:
    found = {scheme: sizes(got, radio, scheme) for scheme in SCHEMES}
    n = max(size.nodes for size in found["graph"])
    at = {
        scheme: next(size for size in tried if size.nodes == n) for scheme, tried in found.items()
    }
    tables, *others = at.values()
    fine = all(one.share < tables.share and one.is_whole for one in others)
    words = [f"{scheme} {percent(size.share, 1)}" + ("" if size.is_whole else f" ({size.short})")
             for scheme, size in at.items()]  # fmt: skip
    return beyond(
        f"at {radio.profile} the flooded graph and the table-free mode take less of the channel "
        "than tables, at the largest size that has a graph",
        f"N = {n}, all new each round: {joined(words)}",
        verdict(fine),
        f"a graph has room for {radio.graph_max} nodes at most",
    )


def _complete(got: Measured) -> Claim:
    failed, words, lost = [], [], 0
    for radio in RADIOS:
        for scheme in ("tables", "graph"):
            tried, name = sizes(got, radio, scheme), f"{radio.profile} {scheme}"
            failed += [f"{name}, N = {size.nodes}: {size.short}"
                       for size in tried if not size.is_whole]  # fmt: skip
            words += [f"{name}, N = {tried[-1].nodes}: {tried[-1].took}"] * tried[-1].is_whole
            lost += sum(size.unknown for size in tried)
    return beyond(
        "at every size that was tried everyone gets its table in the end",
        joined([*failed, *words], "; "),
        verdict(not failed),
        f"to {lost} of them the gateway knew no way; why else is not known" if failed else "",
    )
