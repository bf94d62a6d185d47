import numpy as np
import pytest

from innervate.networks.skin.papers import eq3, experiment, loop
from innervate.papers.experiment import HOLDS, Measured, reading
from innervate.plot import style
from tests.fixtures.papers import CHEAP
from tests.networks.skin.papers import results
from tests.plot.labels import covered, noted
from tests.plot.self_contained import check_paper


@pytest.mark.parametrize("name", ["at_most", "eq7", "fig8a", "fig10", "modes"])
def test_bars_and_lines_lie_within_their_panels(name):
    """Of figures whose runs are too long to be made here: of results that are written here."""
    with style.house():
        figure = experiment(name).draw(Measured(results.of(name), True))
    assert [found for ax in figure.axes for found in beyond(ax)] == []


def test_bars_end_below_the_top_of_their_panels():
    with style.house():
        figure = experiment("fig8a").draw(Measured(results.of("fig8a", off=90), True))
    for ax in figure.axes[1:]:
        top = max(float(y) for line in ax.lines for y in line.get_ydata())
        assert top == pytest.approx(90)
        assert (ax.transData + ax.transAxes.inverted()).transform((0, top))[1] < 0.95


@pytest.mark.parametrize(("cured", "words"), [(0, "none"), (1, "10")])
def test_every_name_of_a_loops_legend_has_its_sample(cured, words):
    values = results.of("loop", printed=3, lax=2, cured=cured)
    with style.house():
        _figure, ax = style.panels(2, 2)
        loop._bars(ax[0], Measured(values, True))
    handles, names = ax[0].get_legend_handles_labels()
    named = dict(zip(names, handles, strict=True))
    sample = named[f"strict, feasible: {words}"]
    assert sample.get_marker() == "o"
    assert sample.get_ydata().tolist() == [2 * cured] * 5


@pytest.mark.parametrize("moved", [(True, False), (True,), (False,), ()])
def test_a_legend_names_only_clocks_that_have_points(moved):
    """With few seeds a free running skin may never move, and the first setup of none."""
    got = results.of("eq3")
    for setup in eq3.SETUPS:
        for flag in eq3.CLOCKS:
            if flag not in moved or setup == eq3.SETUPS[0]:
                got[eq3.sizes(setup, flag, True).key] = [[]]
    with style.house():
        ax = experiment("eq3").draw(Measured(got, True)).axes[2]
    named = [text.get_text() for text in ax.get_legend().get_texts()]
    assert named == [*(eq3.CLOCKS[flag] for flag in eq3.CLOCKS if flag in moved), "2 max(H)"]


def beyond(ax):
    """Heights that lie outside of a panel."""
    low, high = sorted(ax.get_ylim())
    bars = [(bar.get_y(), bar.get_y() + bar.get_height()) for bar in ax.patches]
    lines = [line.get_ydata() for line in ax.lines if line.get_transform() == ax.transData]
    found = [float(y) for ys in (*bars, *lines) for y in ys]
    assert found
    return [y for y in found if not low - 1e-9 <= y <= high + 1e-9]


def test_the_overlap_check_can_fail(tmp_path):
    with style.house(), noted(tmp_path):
        figure, (ax,) = style.panels(2, 2)
        ax.text(0.5, 0.5, "one")
        ax.text(0.52, 0.5, "other")
        style.save(figure, tmp_path, "two")
    assert covered(tmp_path, "two") == [["other", "one"]]


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


def test_figures_have_the_same_bytes_twice(made, tmp_path):
    with style.house():
        paths = style.save(
            made.experiments["eq9"].draw(Measured(made.values, True)), tmp_path, "eq9"
        )
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
