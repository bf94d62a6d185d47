"""A small writer of SVG: shapes with classes, styled by the page that holds them.

Drawings carry their natural size; in a page they shrink to the width there is. Alone
(`save`), they carry their style sheet themselves.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

Point = tuple[float, float]
Value = str | float | int | None
ARROW_PX = 7.0
HIDDEN = 'aria-hidden="true"'  # of drawings that words beside them say

# Letters from right to left; words of them, with the numbers between and behind them.
_RIGHT = "\u0590-\u08ff\ufb1d-\ufdff\ufe70-\ufefc\U00010800-\U00010fff\U0001e800-\U0001efff"
_TURNED = re.compile(rf"[{_RIGHT}](?:[{_RIGHT}\d ]*[{_RIGHT}\d])?")
# What XML 1.0 cannot hold, even escaped.
_FORBIDDEN = {c: "\ufffd" for c in (*range(9), 11, 12, *range(14, 32), 0xFFFE, 0xFFFF)}


def number(value: float) -> str:
    """A coordinate, to a hundredth; a ValueError if it is not finite."""
    if not math.isfinite(value):
        raise ValueError(f"a coordinate must be finite, not {value}")
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def clean(text: str) -> str:
    """Text with what XML cannot hold replaced, and the rest escaped; words written from right to
    left, with their numbers, turn nothing round that stands beside them.
    """
    return _TURNED.sub("\u2068\\g<0>\u2069", verbatim(text))


def verbatim(text: str) -> str:
    """Text to be copied: escaped, and nothing put into it."""
    return escape(_valid(text))


def attribute(text: str) -> str:
    """Text as a quoted attribute value."""
    return quoteattr(_valid(text))


def _valid(text: str) -> str:
    text = text.translate(_FORBIDDEN)
    return "".join("\ufffd" if "\ud800" <= c <= "\udfff" else c for c in text)


def polyline(points: Iterable[Point]) -> str:
    """Path data of a line through points."""
    return "M" + "L".join(f"{number(x)},{number(y)}" for x, y in points)


def polygon(x: float, y: float, corners: Sequence[Point]) -> str:
    """Path data of a closed shape round (x, y); corners relative to it."""
    first, *rest = corners
    steps = [f"M{number(x + first[0])},{number(y + first[1])}"]
    here = first
    for corner in rest:
        steps.append(f"l{number(corner[0] - here[0])},{number(corner[1] - here[1])}")
        here = corner
    return "".join(steps) + "z"


def arrow(start: Point, end: Point, gap: float) -> str:
    """Path data of an arrow that keeps a distance from either end."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    long = max((dx * dx + dy * dy) ** 0.5, 1e-9)
    gap = min(gap, 0.3 * long)
    ux, uy = dx / long, dy / long
    tip = (end[0] - gap * ux, end[1] - gap * uy)
    head = min(ARROW_PX, 0.4 * long)
    left = (tip[0] - head * (ux + 0.6 * uy), tip[1] - head * (uy - 0.6 * ux))
    right = (tip[0] - head * (ux - 0.6 * uy), tip[1] - head * (uy + 0.6 * ux))
    shaft = polyline([(start[0] + gap * ux, start[1] + gap * uy), tip])
    return shaft + polyline([left, tip, right])


def cross(x: float, y: float, size: float) -> str:
    """Path data of a diagonal cross."""
    near, far, whole = number(x - size), number(y - size), number(2 * size)
    return f"M{near},{far}l{whole},{whole}M{near},{number(y + size)}l{whole},-{whole}"


def opening(tag: str, attributes: Mapping[str, Value]) -> str:
    """What begins an element; those attributes that are None are left out."""
    words = [tag]
    for name, value in attributes.items():
        if value is not None:
            text = value if isinstance(value, str) else number(value)
            words.append(f"{name.rstrip('_').replace('_', '-')}={attribute(text)}")
    return " ".join(words)


class Drawing:
    """An SVG drawing that is filled piece by piece, of a natural size in px, > 0."""

    def __init__(self, width: float, height: float, label: str) -> None:
        self.width = width
        self.height = height
        self.label = label  # what a screen reader says of it
        self._parts: list[str] = []

    def add(self, tag: str, content: str | None = None, **attributes: Value) -> None:
        """An element; `class_` stands for class, underscores for hyphens. `content` is text."""
        head = opening(tag, attributes)
        inside = None if content is None else clean(content)
        self._parts.append(f"<{head}/>" if inside is None else f"<{head}>{inside}</{tag}>")

    def path(self, data: str, kind: str, tip: str = "") -> None:
        """A path; `tip` appears under the pointer."""
        if tip:
            shape = f"<path class={attribute(kind)} d={attribute(data)}>"
            self._parts.append(f"{shape}<title>{clean(tip)}</title></path>")
        elif data:
            self.add("path", class_=kind, d=data)

    def line(self, start: Point, end: Point, kind: str) -> None:
        """A straight line of a style class."""
        self.add("line", class_=kind, x1=start[0], y1=start[1], x2=end[0], y2=end[1])

    def rect(self, corner: Point, size: Point, kind: str) -> None:
        """A rectangle; negative sizes count as nothing."""
        wide, high = max(size[0], 0.0), max(size[1], 0.0)
        data = f"M{number(corner[0])},{number(corner[1])}h{number(wide)}v{number(high)}"
        self.path(f"{data}h{number(-wide)}z", kind)

    def circle(self, centre: Point, radius: float, kind: str) -> None:
        """A circle of a style class, its radius in the drawing's units."""
        self.add("circle", class_=kind, cx=centre[0], cy=centre[1], r=radius)

    def text(self, at: Point, words: str, kind: str = "", anchor: str = "start") -> None:
        """Words; `anchor` is start, middle or end."""
        self.add(
            "text", words, class_=kind or None, x=at[0], y=at[1],
            text_anchor=None if anchor == "start" else anchor,
        )  # fmt: skip

    def place(self, inner: Drawing, at: Point) -> None:
        """Another drawing inside this one, its corner at `at`."""
        shift = f"translate({number(at[0])} {number(at[1])})"
        self._parts += [f'<g transform="{shift}">', *inner._parts, "</g>"]

    def render(self, style: str = "") -> str:
        """The drawing as one <svg> element; with `style` it can stand alone."""
        wide, high = number(self.width), number(self.height)
        told = f'role="img" aria-label={attribute(self.label)}' if self.label else HIDDEN
        parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {high}" '
            f'width="{wide}" height="{high}" {told}>'
        ]
        if style:
            parts.append(f"<title>{clean(self.label)}</title><style>{clean(style)}</style>")
            parts.append(f'<rect class="ground" width="{wide}" height="{high}"/>')
        return "\n".join([*parts, *self._parts, "</svg>"])

    def save(self, path: Path, style: str) -> None:
        """Write it to a file of its own."""
        path.write_text(self.render(style) + "\n", encoding="utf-8")
