"""How matplotlib figures look: column widths, type, colours that colour-blind readers can tell.

Figures are made without pyplot, so that they may be drawn in any thread and leave no state behind.
Series differ by marker or dash as well as by colour.
"""

import io
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

COLUMN_IN = 3.5  # one column of a two-column page
WIDE_IN = 7.16  # both
SCREEN_DPI = 130

# Hues of Okabe and Ito.
BLACK = "#000000"
BLUE = "#0072B2"
VERMILION = "#D55E00"
GREEN = "#009E73"
ORANGE = "#E69F00"
PURPLE = "#CC79A7"
SKY = "#56B4E9"
BROWN = "#7A4A1E"  # two more, where there are more curves than hues of Okabe and Ito
WINE = "#882255"
SERIES = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, BLACK)
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
DASHES = ("-", (0, (5, 1.5)), (0, (1.5, 1.2)), (0, (5, 1.2, 1.2, 1.2)))

INK = "#1c2430"
SOFT = "#5b6675"
FAINT = "#d5dae1"
PALE = "#eef1f5"

# Any: which keys there are differs between releases of matplotlib.
_RC: Any = dict(matplotlib.rc_params_from_file(
    Path(__file__).with_name("house.mplstyle"), fail_on_error=True, use_default_template=False
))  # fmt: skip
_RC |= dict.fromkeys(("axes.edgecolor", "xtick.color", "ytick.color"), SOFT)
_RC |= dict.fromkeys(("axes.labelcolor", "text.color", "xtick.labelcolor", "ytick.labelcolor"), INK)
_RC["grid.color"] = FAINT


def look(number: int) -> dict[str, Any]:
    """Colour, marker and dash of a series by its number, 0 and following."""
    turn, i = divmod(number, len(SERIES))
    marker = MARKERS[(i + turn) % len(MARKERS)]
    return {"color": SERIES[i], "marker": marker, "ls": DASHES[number % len(DASHES)]}


@contextmanager
def house() -> Iterator[None]:
    """Draw and save inside this: the house style, whatever the user's own settings are."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_RC)
        yield


class Shown(Figure):
    """A figure that a notebook shows; without pyplot it would be a line of text there."""

    def _repr_png_(self) -> bytes:
        packed = io.BytesIO()
        with house():
            self.savefig(packed, format="png", dpi=SCREEN_DPI, metadata={"Software": None})
        return packed.getvalue()


def figure(width_in: float, height_in: float) -> Figure:
    """An empty figure whose parts are laid out so that no labels overlap."""
    engine = ConstrainedLayoutEngine(w_pad=0.03, h_pad=0.03)
    made = Shown(figsize=(width_in, height_in), layout=engine)
    FigureCanvasAgg(made)
    return made


def panels(
    width_in: float, height_in: float, rows: int = 1, columns: int = 1, **options: Any
) -> tuple[Figure, list[Axes]]:
    """A figure with a grid of axes, row by row; `options` go to `Figure.subplots`."""
    made = figure(width_in, height_in)
    grid = made.subplots(rows, columns, squeeze=False, **options)
    return made, list(grid.flat)


def save(made: Figure, folder: str | os.PathLike[str], name: str) -> list[Path]:
    """Write `name`.png and `name`.svg, the same bytes for the same figure; their paths."""
    paths = [Path(folder) / f"{name}.{kind}" for kind in ("png", "svg")]
    layout = made.get_layout_engine()
    if layout is not None:
        layout.execute(made)
    made.set_layout_engine(None)  # saving would lay it out anew each time, and draw it once more
    for path in paths:
        fresh = path.with_name(path.name + ".part")
        metadata = {"Date": None} if path.suffix == ".svg" else {"Software": None}
        made.savefig(fresh, format=path.suffix[1:], metadata=metadata)
        fresh.replace(path)
    made.set_layout_engine(layout)
    return paths
