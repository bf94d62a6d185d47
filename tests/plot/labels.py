"""Texts of a figure that cover each other, and legends that cover panels."""

import json
from contextlib import contextmanager
from unittest.mock import patch

from matplotlib.axes import Axes
from matplotlib.legend import Legend
from matplotlib.text import Text

from innervate.plot import style

NOTED = "covering.json"


def overlapping(figure):
    """Pairs of texts that cover each other."""
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    frame = figure.bbox
    unseen = {id(label) for ax in figure.findobj(Axes) for label in outside(ax)}
    texts = [
        text
        for text in figure.findobj(Text)
        if text.get_visible() and text.get_text().strip() and id(text) not in unseen
    ]
    boxes = [(t.get_text(), t.get_window_extent(renderer)) for t in texts]
    boxes = [(words, box) for words, box in boxes if box.width > 0 and frame.overlaps(box)]
    return [
        (first, second)
        for i, (first, a) in enumerate(boxes)
        for second, b in boxes[:i]
        if shared(a, b) > 0.02 * min(a.width * a.height, b.width * b.height)
    ]


def over_panels(figure):
    """Legends that lie over the panel of some axes, by their first name."""
    renderer = figure.canvas.get_renderer()
    panels = [ax.get_window_extent(renderer) for ax in figure.findobj(Axes)]
    legends = [(one, one.get_window_extent(renderer)) for one in figure.findobj(Legend)]
    return [
        legend.get_texts()[0].get_text()
        for legend, box in legends
        if any(shared(box, panel) > 0 for panel in panels)
    ]


def outside(ax):
    """Labels of ticks beyond the axes' limits, which are not drawn."""
    for axis in (ax.xaxis, ax.yaxis):
        low, high = sorted(axis.get_view_interval())
        for tick in axis.get_major_ticks():
            if not low <= tick.get_loc() <= high:
                yield tick.label1


def shared(a, b):
    """Area that two boxes share."""
    wide = min(a.x1, b.x1) - max(a.x0, b.x0)
    high = min(a.y1, b.y1) - max(a.y0, b.y0)
    return max(wide, 0) * max(high, 0)


@contextmanager
def noted(folder):
    """Keep of each figure that is saved meanwhile what lies over what in it, as it was saved."""
    found, save = {}, style.save

    def saved(figure, where, name):
        paths = save(figure, where, name)
        layout = figure.get_layout_engine()
        figure.set_layout_engine(None)  # it was laid out to be saved
        found[name] = overlapping(figure), over_panels(figure)
        figure.set_layout_engine(layout)
        return paths

    with patch.object(style, "save", saved):
        yield
    (folder / NOTED).write_text(json.dumps(found))


def covered(folder, name):
    """Pairs of texts that covered each other in a figure when it was saved."""
    return json.loads((folder / NOTED).read_text())[name][0]


def legends_over_panels(folder, name):
    """Legends that lay over a panel in a figure when it was saved."""
    return json.loads((folder / NOTED).read_text())[name][1]
