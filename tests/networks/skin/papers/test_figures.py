import re

import matplotlib.image
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.text import Text

from innervate.networks.skin.papers import FIGURES, experiment
from innervate.papers.experiment import FAILS, HOLDS, reading
from innervate.plot import style
from tests.fixtures.papers import CHEAP
from tests.plot.self_contained import check_paper

VERDICT = re.compile(r"holds|does not hold|holds with reading [EF]\d+(, [EF]\d+)*")


@pytest.mark.parametrize("name", CHEAP)
def test_a_figure_is_drawn(made, name):
    picture = matplotlib.image.imread(made.folder / f"{name}.png")
    height, width = picture.shape[:2]
    assert width >= 1000
    assert 0.3 < height / width < 1.5
    ink = (picture[..., :3].min(axis=2) < 0.9).mean()
    assert 0.01 < ink < 0.6
    assert (made.folder / f"{name}.svg").read_text().startswith("<?xml")


@pytest.mark.parametrize("name", CHEAP)
def test_no_labels_overlap(made, name):
    with style.house():
        figure = made.experiments[name].draw(made.values, True)
        assert overlapping(figure) == []


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


def test_the_overlap_check_can_fail():
    with style.house():
        figure, (ax,) = style.panels(2, 2)
        ax.text(0.5, 0.5, "one")
        ax.text(0.52, 0.5, "other")
        assert overlapping(figure) == [("other", "one")]


def test_a_saved_figure_is_laid_out_as_a_shown_one(tmp_path):
    def drawn():
        figure, (ax,) = style.panels(2, 2)
        ax.set(xlabel="time", ylabel="load")
        return figure, ax

    with style.house():
        (saved, ours), (shown, theirs) = drawn(), drawn()
        before = ours.get_position().bounds
        style.save(saved, tmp_path, "one")
        shown.draw_without_rendering()
    assert ours.get_position().bounds == theirs.get_position().bounds != before
    assert saved.get_layout_engine() is not None


@pytest.mark.parametrize("name", CHEAP)
def test_every_claim_is_whole(made, name):
    for claim in made.claims[name]:
        assert VERDICT.fullmatch(claim.verdict), claim.verdict
        assert claim.figure
        assert claim.claim
        assert re.search(r"\d", claim.measurement), claim
        assert "nan" not in claim.measurement
        assert claim.verdict != FAILS or claim.reason, claim


@pytest.mark.parametrize("name", FIGURES)
def test_points_are_told_apart(name):
    made = experiment(name)
    assert made.name == name
    for quick in (True, False):
        keys = [point.key for point in made.points(quick)]
        assert len(keys) == len(set(keys))
    ours = {point.key for point in made.points(True)}
    assert all(point.cost_s > 0 for point in made.points(False))
    assert ours


def test_figures_have_the_same_bytes_twice(made, tmp_path):
    with style.house():
        paths = style.save(made.experiments["eq9"].draw(made.values, True), tmp_path, "eq9")
    for path in paths:
        assert path.read_bytes() == (made.folder / path.name).read_bytes()


def test_the_users_settings_come_back():
    import matplotlib

    before = dict(matplotlib.rcParams)
    with style.house():
        assert matplotlib.rcParams["axes.grid"] is True
    assert dict(matplotlib.rcParams) == before
    assert np.isclose(matplotlib.rcParams["font.size"], before["font.size"])


def test_verdicts_are_words():
    assert HOLDS == "holds"
    assert reading("E20", "E21") == "holds with reading E20, E21"


def test_the_page_needs_nothing_else_and_can_be_had_again(made):
    check_paper(
        made,
        "skin",
        "innervate papers skin --quick " + " ".join(f"--only {name}" for name in CHEAP),
    )
