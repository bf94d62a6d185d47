"""`Run.plot`: figures of one run by matplotlib."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from innervate import run
from innervate.networks.skin.plot import figures
from innervate.plot import style
from tests.plot.ink import measured

TABLES = {
    "kind": "skin",
    "duration_s": 0.5,
    "patch": [{"columns": 5, "rows": 6}],
    "interface": [{"row": 0, "column": 1}, {"row": 5, "column": 3}],
    "protocol": {"k": 3},
    "data": {"rate_hz": 100},
    "touch": {"path": [(0.0, 30.0, 30.0)]},
    "event": [{"at_s": 0.3, "action": "cut", "interface": 1}],
}
FREE = {
    "kind": "skin",
    "duration_s": 0.1,
    "link": [{"a": "pc.0", "b": "n1"}, {"a": "n1", "b": "n2"}],
}


@pytest.fixture(scope="module")
def skin():
    return run(TABLES)


def words(figure):
    return [text.get_text() for ax in figure.axes for text in ax.texts]


@pytest.mark.parametrize("name", figures.FIGURES)
def test_each_figure_draws(skin, name, tmp_path):
    made = skin.plot(name)
    style.save(made, tmp_path, name)
    _, ink = measured(tmp_path / f"{name}.png")
    assert 0.003 < ink < 0.9


@pytest.mark.parametrize("name", figures.FIGURES)
def test_each_figure_draws_a_free_graph(name):
    made = run(FREE).plot(name)
    made.canvas.draw()
    ink = np.asarray(made.canvas.buffer_rgba())[..., :3].min(axis=2) < 230
    assert 0.003 < ink.mean() < 0.9
    assert any(ax.has_data() for ax in made.axes)


def test_the_picture_of_what_was_received_says_what_its_shades_and_signs_mean(skin):
    said = words(skin.plot("received"))
    force = skin.plan.touch.force_mn / 1e3
    wanted = {f"0 to {force:g} N", "nothing received in that time", "where the touch really is"}
    assert wanted <= set(said)
    bare = words(run(FREE).plot("received"))
    assert [word for word in bare if "N" in word or "touch" in word] == []
    assert "nothing received in that time" in bare


def test_recovery_shows_the_time_round_the_event(skin):
    ticks = [float(word) for word in words(skin.plot()) if re.fullmatch(r"0\.\d+", word)]
    assert 0.25 < min(ticks) <= 0.3 < max(ticks) < 0.4
    shown = words(skin.plot("recovery", from_s=0.1, to_s=0.45))
    assert {"0.1", "0.4"} <= set(shown)
    assert not {"0.0", "0.5"} & set(shown)
    assert any("interface 1" in word for word in shown)


def test_many_events_are_marked_without_names(skin):
    cut = skin.plan.faults[0]
    for count, named in ((figures.NAMED_MAX, True), (figures.NAMED_MAX + 1, False)):
        plan = replace(skin.plan, faults=[cut] * count)
        shown = words(figures.recovery(SimpleNamespace(
            result=skin.result, summary=skin.summary, plan=plan)))  # fmt: skip
        assert any("interface 1" in word for word in shown) == named, count


def test_routes_at_a_time(skin):
    before, after = skin.plot("routes", time_s=0.29), skin.plot("routes")
    assert before.axes[0].get_title(loc="left") == "routes at 0.290 s"
    assert after.axes[0].get_title(loc="left") == "routes at 0.500 s"


def test_loads_are_counted(skin):
    shown = words(skin.plot("loads"))
    assert [word for word in shown if "cell" in word] == ["30 cells", "0 cells"]


def test_an_unknown_figure_is_refused(skin):
    with pytest.raises(ValueError, match='no figure "map"; there are recovery, routes'):
        skin.plot("map")
