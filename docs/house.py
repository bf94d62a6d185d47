"""Draws the house from its imports: `python -m docs.house` writes docs/images/house.svg.

Rooms stand on what they import. A line is an import that does not follow from the others.
"""

from __future__ import annotations

from pathlib import Path

import grimp
import networkx as nx
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.patches import FancyBboxPatch

from innervate.network import networks

ROOT = Path(__file__).resolve().parents[1]
SOURCES, PICTURE = ROOT / "src", ROOT / "docs/images/house.svg"
SPINE, HOME = "innervate", "innervate.networks"
WIDTH, FLOOR = 1.9, 1.1  # of a room with its gap, of a floor
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
    ax: Axes, graph: nx.DiGraph, level: dict[str, int], home: str, left: float, tint: str
) -> float:
    """Draw the rooms of one package on their floors; how wide it is."""
    rows = [[room for room in sorted(graph) if level[room] == floor]
            for floor in range(1 + max(level[room] for room in graph))]  # fmt: skip
    wide = max(map(len, rows))
    at: dict[str, tuple[float, float]] = {}
    for floor, row in enumerate(rows):
        # Rooms over what they stand on, as far as there is space.
        row.sort(key=lambda room: sum(at[b][0] for b in sorted(graph.successors(room)) if b in at)
                 / max(1, graph.out_degree(room)))  # fmt: skip
        for number, room in enumerate(row):
            x = left + WIDTH * (number + 0.5 + (wide - len(row)) / 2)
            at[room] = (x, FLOOR * floor)
    for one, other in sorted(graph.edges):
        (x, y), (to_x, to_y) = at[one], at[other]
        ax.plot([x, to_x], [y - 0.3, to_y + 0.3], color=WALL, lw=0.6, alpha=0.55, zorder=1)
    for room, (x, y) in at.items():
        box = FancyBboxPatch((x - 0.84, y - 0.3), 1.68, 0.6, boxstyle="round,pad=0.02",
                             fc=tint, ec=WALL, lw=0.8, zorder=2)  # fmt: skip
        ax.add_patch(box)
        ax.text(x, y + 0.09, room, ha="center", va="center", size=6.2, color=DARK, zorder=3)
        count = f"{lines(home, room):,}"
        ax.text(x, y - 0.15, count, ha="center", va="center", size=5.5, color=WALL, zorder=3)
    return wide * WIDTH


def draw() -> Path:
    """The spine, and beside it every network with the same plan inside."""
    graph = built()
    figure, ax = plt.subplots(figsize=(22, 6))
    spine = nx.transitive_reduction(imports(graph, SPINE))
    right = house(ax, spine, floors(spine), SPINE, 0.0, LIGHT)
    ax.text(right / 2, -0.75, "the spine: names no network", ha="center", size=9, color=DARK)
    homes = [f"{HOME}.{name}" for name in networks()]
    plans = [nx.transitive_reduction(imports(graph, home)) for home in homes]
    level = floors(nx.compose_all(plans))  # the same plan in each
    for home, inside, tint in zip(homes, plans, TINTS, strict=True):
        width = house(ax, inside, level, home, right + 0.5, tint)
        called = home.removeprefix("innervate.").replace(".", "/")
        ax.text(right + 0.5 + width / 2, -0.75, called, ha="center", size=9, color=DARK)
        right += 0.5 + width
    ax.set_xlim(-0.2, right + 0.2)
    ax.set_ylim(-1.05, None)
    ax.set_axis_off()
    plt.rcParams["svg.hashsalt"] = "house"  # the same bytes for the same rooms
    figure.savefig(PICTURE, bbox_inches="tight", metadata={"Date": None})
    plt.close(figure)
    return PICTURE


if __name__ == "__main__":
    print(draw())
