"""Draws the house from its imports: `python -m docs.house` writes docs/images/house.svg.

Rooms stand on what they import. A line is an import that does not follow from the others.
"""

from __future__ import annotations

from pathlib import Path

import grimp
import networkx as nx
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.patches import FancyBboxPatch

from innervate.network import networks

ROOT = Path(__file__).resolve().parents[1]
SOURCES, PICTURE = ROOT / "src", ROOT / "docs/images/house.svg"
SPINE, HOME = "innervate", "innervate.networks"
WIDTH, FLOOR = 1.9, 1.1  # of a room with its gap, of a floor
APART, BELOW = 0.5, 0.85  # between networks; from the lowest rooms to a network's name
BELOW_SPINE = 3  # networks with many rooms, which have a row of their own
UNIT_IN = 0.37  # so that all is some 10 inches wide, as a page is: read without zooming in
NAME_PT, COUNT_PT, TITLE_PT = 7.5, 7, 9.5
Corner = tuple[float, float]  # left and lower end
WALL, LIGHT, DARK = "#52606d", "#e8eef4", "#1f2933"
TINTS = ("#dcefe3", "#fdeedb", "#e6e3f6", "#f9e2e2", "#e3f0f7", "#f3f0da")


def rooms(home: str) -> list[str]:
    """Modules and packages directly in a package."""
    folder = SOURCES / home.replace(".", "/")
    found = [path for path in folder.iterdir() if not path.name.startswith("__")]
    return sorted(path.stem for path in found if path.is_dir() or path.suffix == ".py")


def lines(home: str, room: str) -> int:
    """Lines of Python in a room."""
    place = SOURCES / home.replace(".", "/") / room
    files = place.rglob("*.py") if place.is_dir() else [place.with_suffix(".py")]
    return sum(len(path.read_text(encoding="utf-8").splitlines()) for path in files)


def built() -> grimp.ImportGraph:
    """All imports of the toolkit's modules."""
    return grimp.build_graph(SPINE, exclude_type_checking_imports=True, cache_dir=None)


def imports(graph: grimp.ImportGraph, home: str) -> nx.DiGraph:
    """Who imports whom among rooms, of which the networks are none, nor a network's record."""
    apart = "networks" if home == SPINE else "network"
    names = [room for room in rooms(home) if room != apart]
    found = nx.DiGraph()
    found.add_nodes_from(names)
    for one in names:
        for other in names:
            if one != other and graph.direct_import_exists(
                importer=f"{home}.{one}", imported=f"{home}.{other}", as_packages=True
            ):
                found.add_edge(one, other)
    return found


def floors(graph: nx.DiGraph) -> dict[str, int]:
    """On which floor each room is: one above the highest that it stands on."""
    level: dict[str, int] = {}
    for room in reversed(list(nx.topological_sort(graph))):
        level[room] = 1 + max((level[below] for below in graph.successors(room)), default=-1)
    return level


def house(
    ax: Axes, graph: nx.DiGraph, level: dict[str, int], home: str, corner: Corner, tint: str
) -> None:
    """Draw the rooms of one package on their floors, and its name below."""
    rows = by_floor(graph, level)
    wide = breadth(graph, level)
    at: dict[str, Corner] = {}
    for floor, row in enumerate(rows):
        # Rooms over what they stand on, as far as there is space.
        row.sort(key=lambda room: sum(at[b][0] for b in sorted(graph.successors(room)) if b in at)
                 / max(1, graph.out_degree(room)))  # fmt: skip
        for number, room in enumerate(row):
            x = corner[0] + WIDTH * (number + 0.5) + (wide - WIDTH * len(row)) / 2
            at[room] = (x, corner[1] + FLOOR * floor)
    for one, other in sorted(graph.edges):
        (x, y), (to_x, to_y) = at[one], at[other]
        ax.plot([x, to_x], [y - 0.3, to_y + 0.3], color=WALL, lw=0.6, alpha=0.55, zorder=1)
    for room, (x, y) in at.items():
        box = FancyBboxPatch((x - 0.88, y - 0.36), 1.76, 0.72, boxstyle="round,pad=0.02",
                             fc=tint, ec=WALL, lw=0.8, zorder=2)  # fmt: skip
        ax.add_patch(box)
        ax.text(x, y + 0.14, room, ha="center", va="center", size=NAME_PT, color=DARK, zorder=3)
        count = f"{lines(home, room):,}"
        ax.text(x, y - 0.18, count, ha="center", va="center", size=COUNT_PT, color=DARK, zorder=3)
    called = home.removeprefix("innervate.").replace(".", "/")
    name = "the spine: names no network" if home == SPINE else called
    ax.text(corner[0] + wide / 2, corner[1] - BELOW, name, ha="center", size=TITLE_PT, color=DARK)


def by_floor(graph: nx.DiGraph, level: dict[str, int]) -> list[list[str]]:
    """The rooms of a package on each floor, from the lowest."""
    return [[room for room in sorted(graph) if level[room] == floor]
            for floor in range(1 + max(level[room] for room in graph))]  # fmt: skip


def breadth(graph: nx.DiGraph, level: dict[str, int]) -> float:
    """How wide a package is drawn."""
    return WIDTH * max(map(len, by_floor(graph, level)))


def draw() -> Path:
    """The spine beside the networks with few rooms, below them those with many."""
    graph = built()
    homes = [f"{HOME}.{name}" for name in networks()]
    spine = nx.transitive_reduction(imports(graph, SPINE))
    plans = {home: nx.transitive_reduction(imports(graph, home)) for home in homes}
    level = floors(nx.compose_all(plans.values()))  # the same plan in each
    tints = dict(zip([SPINE, *homes], (LIGHT, *TINTS), strict=True))
    many = sorted(homes, key=lambda home: -len(plans[home]))[:BELOW_SPINE]
    few = [home for home in homes if home not in many]
    tall = FLOOR * (1 + max(level.values())) + BELOW
    figure, ax = plt.subplots()
    ends = []
    for row, bottom in (([SPINE, *few], tall), ([home for home in homes if home in many], 0.0)):
        left = 0.0
        for home in row:
            inside, on = (spine, floors(spine)) if home == SPINE else (plans[home], level)
            house(ax, inside, on, home, (left, bottom), tints[home])
            left += breadth(inside, on) + APART
        ends.append(left - APART)
    ax.set_xlim(-0.2, max(ends) + 0.2)
    ax.set_ylim(-BELOW - 0.1, tall + FLOOR * (max(floors(spine).values()) + 0.5))
    ax.set_axis_off()
    ax.set_position((0, 0, 1, 1))
    figure.set_size_inches(UNIT_IN * np.ptp(ax.get_xlim()), UNIT_IN * np.ptp(ax.get_ylim()))
    plt.rcParams["svg.hashsalt"] = "house"  # the same bytes for the same rooms
    figure.savefig(PICTURE, metadata={"Date": None})
    plt.close(figure)
    return PICTURE


if __name__ == "__main__":
    print(draw())
