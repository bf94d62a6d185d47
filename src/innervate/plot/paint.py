"""A drawing of a page as a matplotlib figure, so that a map or timeline is drawn in one place only.

It knows what `svg.Drawing` writes: paths of straight lines and half circles, lines, circles,
rectangles, texts and drawings inside; their classes look as in the light style sheet.
"""

import math
import re
from collections.abc import Iterable, Iterator
from functools import cache
from typing import Any
from xml.etree import ElementTree

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch, PathPatch
from matplotlib.path import Path

from innervate.plot import style, theme
from innervate.plot.svg import Drawing, Point

TEXT_PX = 12.0
KEY_PX, COLUMN_PX, GAP_PX = 22.0, 235.0, 20.0  # of a key: a row, the least column, what parts two
LETTER_PX = 6.6  # of small words
EDGE_IN, TITLE_IN = 0.03, 0.25  # round a figure, and above it for its title
_STEP = re.compile(r"([MLHlhvaz])([^MLHlhvaz]*)")
_NUMBER = re.compile(r"-?\d*\.?\d+")
_RULE = re.compile(r"([^{}]+)\{([^}]*)\}")


def figure(drawing: Drawing, title: str = "", width_in: float = style.WIDE_IN) -> Figure:
    """A figure that shows a drawing, `width_in` wide."""
    wide = width_in - 2 * EDGE_IN
    high, head = wide * drawing.height / drawing.width, TITLE_IN * bool(title)
    made = style.figure(width_in, high + head + 2 * EDGE_IN)
    whole_in = made.get_figheight()
    # A layout would have to guess how much room words above and below the axes take.
    made.set_layout_engine(None)
    place = (EDGE_IN / width_in, EDGE_IN / whole_in, wide / width_in, high / whole_in)
    ax = made.add_axes(place)
    ax.set_title(title)
    paint(ax, drawing, wide)
    return made


def paint(ax: Axes, drawing: Drawing, width_in: float) -> None:
    """Show a drawing on axes that are about `width_in` wide."""
    ax.set(xlim=(0, drawing.width), ylim=(drawing.height, 0))
    ax.set_aspect("equal")
    ax.axis("off")
    _paint(ax, ElementTree.fromstring(drawing.render()), (0.0, 0.0), 72 * width_in / drawing.width)


def keyed(drawing: Drawing, entries: Iterable[tuple[Drawing, str]]) -> Drawing:
    """A drawing with samples and their words below it."""
    shown = list(entries)
    needed = [icon.width + LETTER_PX * len(words) + GAP_PX for icon, words in shown]
    column_px = max([COLUMN_PX, *needed])
    columns = max(1, int(drawing.width // column_px))
    rows = -(-len(shown) // columns)
    size = max(drawing.width, column_px), drawing.height + KEY_PX * rows
    made = Drawing(*size, drawing.label)
    made.place(drawing, (0.0, 0.0))
    for i, (icon, words) in enumerate(shown):
        row, column = divmod(i, columns)
        x, y = column_px * column, drawing.height + KEY_PX * row
        made.place(icon, (x, y))
        made.text((x + icon.width + 8, y + 13), words)
    return made


def _paint(ax: Axes, parent: ElementTree.Element, shift: Point, scale: float) -> None:
    """The elements inside one; `scale` is points a pixel."""
    for node in parent:
        tag = node.tag.rpartition("}")[2]
        if tag == "g":
            x, y = _numbers(node.get("transform", "0 0"))[:2]
            _paint(ax, node, (shift[0] + x, shift[1] + y), scale)
        elif tag == "text":
            _write(ax, node, shift, scale)
        elif tag in ("path", "line", "circle", "rect"):
            patch = _shape(tag, node, shift)
            patch.set(**_look(node, scale, filled=tag != "line"), zorder=2)
            ax.add_patch(patch)


def _shape(tag: str, node: ElementTree.Element, shift: Point) -> Any:
    def at(x: str, y: str) -> Point:
        return shift[0] + float(node.get(x, 0)), shift[1] + float(node.get(y, 0))

    if tag == "circle":
        return Circle(at("cx", "cy"), float(node.get("r", 0)))
    if tag == "rect":
        wide, high, round_ = (float(node.get(name, 0)) for name in ("width", "height", "rx"))
        return FancyBboxPatch(at("x", "y"), wide, high, f"round,pad=0,rounding_size={round_}")
    if tag == "line":
        return PathPatch(Path([at("x1", "y1"), at("x2", "y2")]))
    corners, codes = zip(*_corners(node.get("d", ""), shift), strict=True)
    return PathPatch(Path(corners, codes))


def _corners(data: str, shift: Point) -> Iterator[tuple[Point, int]]:
    """(place, code for matplotlib) of path data."""
    here = start = shift
    for letter, text in _STEP.findall(data):
        values = _numbers(text)
        if letter == "z":
            here = start
            yield start, int(Path.CLOSEPOLY)
        elif letter == "a":  # half a circle, to the right or left
            middle, radius = here[0] + values[5] / 2, values[5] / 2
            for turn in range(1, 17):
                angle = math.pi * (1 - turn / 16)
                place = (middle + radius * math.cos(angle), here[1] + radius * math.sin(angle))
                yield place, int(Path.LINETO)
            here = (here[0] + values[5], here[1])
        else:
            here = _next(letter, values, here, shift)
            start = here if letter == "M" else start
            yield here, int(Path.MOVETO if letter == "M" else Path.LINETO)


def _next(letter: str, values: list[float], here: Point, shift: Point) -> Point:
    """Where a straight step leads."""
    if letter in "hH":
        return (values[0] + (here[0] if letter == "h" else shift[0]), here[1])
    if letter == "v":
        return (here[0], here[1] + values[0])
    x, y = values
    base = here if letter == "l" else shift
    return (base[0] + x, base[1] + y)


def _numbers(text: str) -> list[float]:
    return [float(number) for number in _NUMBER.findall(text)]


def _write(ax: Axes, node: ElementTree.Element, shift: Point, scale: float) -> None:
    css = _css(node)
    place = (shift[0] + float(node.get("x", 0)), shift[1] + float(node.get("y", 0)))
    anchor = {"middle": "center", "end": "right"}.get(node.get("text-anchor", ""), "left")
    ax.text(
        *place, (node.text or "").replace("$", r"\$"), ha=anchor, va="baseline", zorder=3,
        fontsize=scale * float(css.get("font-size", f"{TEXT_PX}px")[:-2]),
        fontweight="bold" if "font-weight" in css else "normal",
        color=css.get("fill", style.INK),
    )  # fmt: skip


def _look(node: ElementTree.Element, scale: float, filled: bool) -> dict[str, Any]:
    """How a shape is painted."""
    css = _css(node)
    wide = scale * float(css.get("stroke-width", 1))
    dashes = tuple(scale * length / wide for length in _numbers(css.get("stroke-dasharray", "")))
    fill = css.get("fill", "#000000") if filled else "none"
    return {
        "facecolor": fill if fill == "none" else (fill, float(css.get("fill-opacity", 1))),
        "edgecolor": (css["stroke"], float(css.get("stroke-opacity", 1))) if "stroke" in css
        else "none",
        "linewidth": wide if "stroke" in css else 0.0,
        "linestyle": (0, dashes) if dashes else "-",
        "capstyle": css.get("stroke-linecap", "butt"),
    }  # fmt: skip


def _css(node: ElementTree.Element) -> dict[str, str]:
    """What an element's classes and attributes say of its look."""
    found: dict[str, str] = {}
    classes = (node.get("class") or "").split()
    for kind, says in _rules():
        if kind in classes:
            found |= says
    return found | {name: value for name, value in node.items() if name.startswith("stroke")}


@cache
def _rules() -> list[tuple[str, dict[str, str]]]:
    """(class, what it says) of the style sheet, in its order; colours as they are in the light."""
    sheet = theme.drawing_style()
    light = dict(re.findall(r"--(\w+):(#\w+)", sheet.partition("@media")[0]))
    sheet = re.sub(r"var\(--(\w+)\)", lambda name: light[name[1]], sheet)
    return [
        (kind[1:], dict(pair.split(":", 1) for pair in says.split(";") if ":" in pair))
        for kinds, says in _RULE.findall(sheet)
        for kind in kinds.strip().split(",")
        if kind.startswith(".")
    ]
