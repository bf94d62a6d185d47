"""What a figure of matplotlib shows, as lines of text: what is drawn, not how it is rendered.

Nothing here depends on fonts, on the size of a letter or on the release of matplotlib: ticks only
where the figure says where they are, places only in the units in which they were given.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import Collection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.figure import Figure, SubFigure
from matplotlib.image import AxesImage
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Patch
from matplotlib.text import Annotation, Text
from matplotlib.ticker import FixedLocator, NullLocator

Picture = dict[str, list[str]]  # lines of each panel
FEW = 8  # numbers that are written out


def digest(text: str) -> str:
    """What a long text is known by."""
    return hashlib.blake2b(text.encode(), digest_size=4).hexdigest()


def number(value: float) -> str:
    """Four digits."""
    text = f"{value:.4g}"
    return "0" if text == "-0" else text


def numbers(values: Any) -> str:
    """Few numbers as they are; of many how many, the ends, the range and a digest."""
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(float), np.nan)
    flat = np.asarray(values, float).ravel()
    if not flat.size:
        return "none"
    size = np.nanmax(np.abs(flat), initial=0.0)
    flat = np.where(np.abs(flat) < 1e-9 * size, 0.0, flat)  # left over by rounding
    words = [number(value) for value in flat]
    if len(words) <= FEW:
        return " ".join(words)
    low, high = (number(edge) for edge in (np.nanmin(flat), np.nanmax(flat)))
    return f"{words[0]} .. {words[-1]} in {low} to {high} ({len(words)} #{digest(' '.join(words))})"


def colour(value: Any) -> str:
    """As #rrggbbaa; several of them once each."""
    if value is None or (isinstance(value, str) and value in ("none", "auto")):
        return "none"
    found = np.atleast_2d(np.asarray([to_hex(one, True) for one in _each(value)]))
    return " ".join(dict.fromkeys(found.ravel().tolist())) or "none"


def _each(value: Any) -> Iterable[Any]:
    many = not isinstance(value, str) and np.ndim(value) == 2
    return value if many else [value]


def told(**words: Any) -> str:
    """`name=value` of what is there."""
    return " ".join(f"{name}={value}" for name, value in words.items() if value not in ("", None))


def picture(figure: Figure) -> Picture:
    """What is in a figure, by its panels."""
    whole = [f"figure {numbers(figure.get_size_inches())}"]
    whole += [text(one) for one in figure.texts if one.get_text()]
    for name in ("suptitle", "supxlabel", "supylabel"):
        label = getattr(figure, f"get_{name}")()
        whole += [f"{name} {label!r}"] if label else []
    for one in figure.legends:
        whole += legend(one)
    found = {"figure": whole}
    for place, ax in enumerate(axes_in(figure)):
        name = ax.get_title("left") or ax.get_title() or ax.get_ylabel() or ax.get_label()
        found[f"{place + 1} {name}".strip()] = panel(ax)
    return found


def axes_in(holder: Any) -> Iterator[Axes]:
    """All axes, as `findobj` finds them: that makes every tick, to look for axes in it."""
    for child in holder.get_children():
        if isinstance(child, Axes | SubFigure):
            yield from axes_in(child)
        if isinstance(child, Axes):
            yield child


def panel(ax: Axes) -> list[str]:
    """What is in one pair of axes: its frame, then what is drawn in it."""
    shown = [place for place, spine in ax.spines.items() if spine.get_visible()]
    lines = [
        told(
            axes=where(ax), aspect=ax.get_aspect(), box=ax.get_box_aspect(), z=ax.get_zorder(),
            ground=colour(ax.get_facecolor()), spines=",".join(shown),
            axis="" if ax.axison else "off", shown="" if ax.get_visible() else "no",
        ),
        *(f"title {side}: {text(one)}" for side, one in titles(ax)),
        *side_of(ax, "x"), *side_of(ax, "y"),
    ]  # fmt: skip
    frame = {id(one) for one in (*ax.spines.values(), ax.xaxis, ax.yaxis, ax.patch)}
    frame |= {id(one) for one in (ax.title, ax._left_title, ax._right_title)}
    for child in ax.get_children():
        if id(child) not in frame and not isinstance(child, Axes):
            lines += legend(child) if isinstance(child, Legend) else [artist(child, ax)]
    return lines


def titles(ax: Axes) -> Iterable[tuple[str, Text]]:
    """The titles that say something."""
    sides = {"left": ax._left_title, "center": ax.title, "right": ax._right_title}
    return [(side, one) for side, one in sides.items() if one.get_text()]


def where(ax: Axes) -> str:
    """Its place in the grid of panels, or inside other axes."""
    spec = ax.get_subplotspec()
    if spec is None:
        return "loose"
    grid = spec.get_gridspec()
    rows, columns, first, last = spec.get_geometry()
    shares = [numbers(one) for one in (grid.get_width_ratios(), grid.get_height_ratios())]
    return f"{first}-{last} of {rows} x {columns} ({'; '.join(shares)})"


def side_of(ax: Axes, name: str) -> list[str]:
    """An axis: label, scale, limits, grid; ticks that were chosen."""
    axis = getattr(ax, f"{name}axis")
    low_high = numbers(getattr(ax, f"get_{name}lim")())
    kept = axis.get_tick_params("major")
    ticks = {key: kept[key] for key in sorted(kept) if key in TICKS}
    lines = [
        told(**{name: repr(axis.get_label_text())}, scale=axis.get_scale(), limits=low_high,
             size=number(axis.label.get_size()), ticks=ticks or None,
             shown="" if axis.get_visible() else "no")
    ]  # fmt: skip
    for which, locator in (("", axis.get_major_locator()), ("minor ", axis.get_minor_locator())):
        if isinstance(locator, NullLocator):
            lines += [] if which else [f"{name} no ticks"]
        elif isinstance(locator, FixedLocator):
            labels = axis.get_ticklabels(minor=bool(which))
            words = "|".join(one.get_text() for one in labels)
            looks = {told(turn=number(one.get_rotation()), ha=one.get_ha(), va=one.get_va(),
                          size=number(one.get_size()), c=colour(one.get_color()))
                     for one in labels}  # fmt: skip
            places = numbers(locator.locs)
            lines.append(f"{name} {which}ticks {places}: {words} {' '.join(sorted(looks))}")
    return lines


TICKS = ("bottom", "gridOn", "grid_alpha", "grid_color", "grid_linewidth", "labelbottom",
         "labelleft", "labelright", "labelrotation", "labelsize", "labeltop", "left", "length",
         "pad", "right", "top", "width")  # fmt: skip


def legend(one: Legend) -> list[str]:
    """A legend: its place and its entries."""
    ax = one.axes
    anchor = one.get_bbox_to_anchor()
    frame = ax.transAxes if ax is not None else one.get_figure().transFigure
    at = anchor.transformed(frame.inverted()).bounds
    place = getattr(one, "_outside_loc", None) or getattr(one, "_loc", "")
    looks = [number(getattr(one, name)) for name in ("columnspacing", "handlelength",
             "handletextpad", "labelspacing", "borderaxespad", "borderpad")]  # fmt: skip
    head = told(
        legend=repr(one.get_title().get_text()), place=place, at=numbers(np.round(at, 6)),
        columns=one._ncols, frame=one.get_frame_on(), looks="/".join(looks), z=one.get_zorder(),
    )  # fmt: skip
    entries = zip(one.legend_handles, one.texts, strict=True)
    return [
        head,
        *(f"entry {words.get_text()!r} {number(words.get_size())} {artist(handle, ax)}"
          for handle, words in entries),
    ]  # fmt: skip


def artist(one: Artist, ax: Axes | None) -> str:
    """Anything that is drawn."""
    kinds = ((Line2D, line), (Text, text), (Patch, patch), (AxesImage, image), (QuadMesh, mesh),
             (Collection, collection))  # fmt: skip
    for kind, describe in kinds:
        if isinstance(one, kind):
            return f"{describe(one)} {common(one, ax)}".strip()
    return f"{type(one).__name__} {common(one, ax)}"


def common(one: Artist, ax: Axes | None) -> str:
    """What all artists have."""
    label = str(one.get_label())
    return told(
        label="" if label.startswith("_") else repr(label), z=number(one.get_zorder()),
        alpha="" if one.get_alpha() is None else numbers(one.get_alpha()),
        clip="" if one.get_clip_on() else "off", shown="" if one.get_visible() else "no",
        units=units(one, ax),
    )  # fmt: skip


def units(one: Artist, ax: Axes | None) -> str:
    """In which units places are; nothing for those of the data."""
    if ax is None:
        return ""
    given = Artist.get_transform(one)
    if isinstance(one, Collection) and given != ax.transData:
        given = one.get_offset_transform()
    known = {"axes": ax.transAxes, "x, axes": ax.get_xaxis_transform(),
             "axes, y": ax.get_yaxis_transform()}  # fmt: skip
    names = [name for name, transform in known.items() if given is transform]
    return "" if given is ax.transData else names[0] if names else "other"


def line(one: Line2D) -> str:
    """A line: its points and its looks."""
    dash = getattr(one, "_unscaled_dash_pattern", one.get_linestyle())
    marked = one.get_marker() not in ("None", "", None)
    every = one.get_markevery()
    marker = told(
        marker=one.get_marker(), ms=number(one.get_markersize()),
        fill=colour(one.get_markerfacecolor()), edge=colour(one.get_markeredgecolor()),
        mew=number(one.get_markeredgewidth()), every="" if every is None else repr(every),
    )  # fmt: skip
    return told(
        line=f"x {numbers(one.get_xdata())} y {numbers(one.get_ydata())}",
        c=colour(one.get_color()), lw=number(one.get_linewidth()), ls=one.get_linestyle(),
        dash="" if dash in ("-", (0, None), (0.0, None)) else dash,
        steps="" if one.get_drawstyle() == "default" else one.get_drawstyle(),
    ) + (f" {marker}" if marked else "")  # fmt: skip


def text(one: Text) -> str:
    """Words and where they stand."""
    more = ""
    if isinstance(one, Annotation):
        style = {key: str(value) for key, value in sorted((one.arrowprops or {}).items())}
        more = told(to=numbers(one.xy), coords=f"{one.xycoords}/{one.anncoords}", arrow=style or "")
    box = one.get_bbox_patch()
    return told(
        text=repr(one.get_text()), at=numbers(one.get_position()), ha=one.get_ha(),
        va=one.get_va(), size=number(one.get_size()), c=colour(one.get_color()),
        turn=number(one.get_rotation()), weight=one.get_weight(), style=one.get_style(),
        box="" if box is None else patch(box), more=more,
    )  # fmt: skip


def patch(one: Patch) -> str:
    """A shape with an edge and a ground."""
    if isinstance(one, FancyArrowPatch):
        style = re.sub(r" at 0x\w+", "", str(vars(one.get_arrowstyle())))
        shape = f"{numbers(np.ravel(one._posA_posB))} {style} {one.shrinkA} {one.shrinkB}"
    else:
        shape = numbers(one.get_patch_transform().transform_path(one.get_path()).vertices)
    return told(
        **{type(one).__name__: shape}, fill=colour(one.get_facecolor()),
        edge=colour(one.get_edgecolor()), lw=number(one.get_linewidth()), ls=one.get_linestyle(),
        hatch=one.get_hatch(),
    )  # fmt: skip


def shades(one: Any) -> str:
    """Which colours stand for which values."""
    values = one.get_array()
    if values is None:
        return ""
    ends = [colour(one.get_cmap()(share)) for share in (0.0, 0.5, 1.0)]
    return f"{numbers(values)} from {' '.join(ends)} over {numbers(one.get_clim())}"


def image(one: AxesImage) -> str:
    """A grid of values."""
    values = one.get_array()
    shown = shades(one) if values is not None and values.ndim == 2 else numbers(values)
    return told(
        image=f"{np.shape(values)} {shown}", extent=numbers(one.get_extent()),
        origin=one.origin, between=one.get_interpolation(),
    )  # fmt: skip


def mesh(one: QuadMesh) -> str:
    """A grid of cells of any size."""
    return told(mesh=numbers(one.get_coordinates()), shades=shades(one))


def collection(one: Collection) -> str:
    """Many shapes of one kind."""
    corners = [numbers(path.vertices) for path in one.get_paths()]
    shapes = "; ".join(corners) if len(corners) <= 3 else f"{len(corners)} #{digest(str(corners))}"
    sizes = getattr(one, "get_sizes", lambda: [])()
    at = numbers(one.get_offsets())
    return told(
        **{type(one).__name__: shapes}, at="" if at == "0 0" else at, sizes=numbers(sizes),
        fill=hues(one.get_facecolor()), edge=hues(one.get_edgecolor()),
        lw=numbers(one.get_linewidth()), dash=dashes(one.get_linestyle()), hatch=one.get_hatch(),
        shades=shades(one),
    )  # fmt: skip


def dashes(patterns: Any) -> str:
    """Line patterns that are not plain."""
    found = dict.fromkeys(str(one) for one in patterns if one not in ((0, None), (0.0, None)))
    return " ".join(found)


def hues(values: Any) -> str:
    """Colours of many shapes, each in its place."""
    if not len(values):
        return "none"
    names = [to_hex(one, True) for one in values]
    once = dict.fromkeys(names)
    known = " ".join(list(once)[:4])
    return known if len(names) == 1 else f"{known} ({len(names)} #{digest(str(names))})"
