"""Names at the right ends of curves, spread so that none lies on another."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes

LEADER = (0.012, 0.05)  # from the axes' edge to the text, as shares of the axes' width


def end_labels(
    ax: Axes, ends: Sequence[tuple[float, str, str]], gap: float = 0.062, size: float = 6.5
) -> None:
    """Name curves at their ends; call it when the limits are set.

    Args:
        ax: of the curves.
        ends: last value, text and colour of each curve.
        gap: least distance of two names, as a share of the axes' height.
        size: of the type, points.
    """
    to_axes = ax.transData + ax.transAxes.inverted()
    x = ax.get_xlim()[1]
    placed = sorted((float(to_axes.transform((x, y))[1]), text, colour) for y, text, colour in ends)
    wanted = [height for height, _, _ in placed]
    # Groups of names that touch move as one about the middle of where they belong.
    groups: list[list[int]] = []
    for i in range(len(wanted)):
        groups.append([i])
        while len(groups) > 1 and _low(groups[-1], wanted, gap) < _top(groups[-2], wanted, gap):
            groups[-2:] = [groups[-2] + groups[-1]]
    for group in groups:
        low = _low(group, wanted, gap) + gap / 2
        for place, i in enumerate(group):
            height, text, colour = placed[i]
            y = low + place * gap
            edge, start = LEADER
            ax.plot([1.0, 1 + edge, 1 + start], [height, y, y], color=colour, lw=0.5,
                    transform=ax.transAxes, clip_on=False)  # fmt: skip
            ax.text(1.01 + start, y, text, color=colour, va="center", fontsize=size,
                    transform=ax.transAxes)  # fmt: skip


def _low(group: list[int], wanted: list[float], gap: float) -> float:
    middle = sum(wanted[i] for i in group) / len(group)
    high = 1 + gap / 2 - gap * len(group)
    return max(-gap / 2, min(middle - gap * len(group) / 2, high))


def _top(group: list[int], wanted: list[float], gap: float) -> float:
    return _low(group, wanted, gap) + gap * len(group)
