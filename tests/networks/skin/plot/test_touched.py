"""What a report shows of a touch, by samples that are written here: a line of three cells."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.skin.plot import report
from innervate.networks.skin.plot.digest import Digest
from innervate.networks.skin.plot.sheet import Sheet
from tests.networks.skin.runs import line, plan_of

GRAPH = plan_of(line(3)).graph
KINDS = [("time", np.int64), ("cell", np.int64), ("force", np.int64, 3), ("proximity", np.int64)]
# Sample i holds from 1000 i us on.
PRESSED = Of(force_mn=4_000, step_us=1_000, x_um=[0, 9_000, 18_000], y_um=[0, 1_000, 2_000],
             radius_um=5_000)  # fmt: skip


def image(time_us, window_us=200, pressed=PRESSED, came=((900, 0), (950, 1), (2_500, 2))):
    rows = np.array([(at, cell, (500, 500, 500), 7) for at, cell in came], KINDS)
    digest = Of(result=Of(plan=Of(graph=GRAPH), deliveries=rows), graph=GRAPH,
                plan=Of(touch=pressed), bare_sheet=Sheet(GRAPH))  # fmt: skip
    return Digest.image(digest, time_us, window_us, "Before")


def tips(panel, parse):
    return [node.text.split(": ")[1] for node in parse(panel.drawing).iter()
            if node.tag.endswith("title")]  # fmt: skip


@pytest.mark.parametrize(("came", "text"), [
    (((900, 0), (950, 1), (960, 2)), "all samples came"),
    (((900, 0), (950, 1)), "nothing from 1 of 3 cells"), ((), "nothing from 3 of 3 cells"),
    (((800, 0), (801, 1), (1_000, 2), (1_001, 0)), "nothing from 1 of 3 cells"),
])  # fmt: skip
def test_cells_of_which_nothing_came_are_counted_and_crossed(parse, came, text):
    panel = image(1_000, came=came)
    assert (panel.head, panel.text) == ("Before", text)
    assert panel.drawing.label == f"Touch as the PC received it: Before, {text}"
    known = {cell for at, cell in came if 800 < at <= 1_000}
    shown = ["0.5 N" if cell in known else "nothing received" for cell in range(3)]
    assert tips(panel, parse) == shown


@pytest.mark.parametrize(("time_us", "window_us", "place"), [
    (0, 200, 0), (50, 200, 0), (1_099, 200, 0), (1_100, 200, 1), (1_000, 0, 1), (2_099, 200, 1),
    (2_100, 200, 2), (90_000, 200, 2),
])  # fmt: skip
def test_the_touch_is_where_it_was_half_a_window_ago(parse, time_us, window_us, place):
    panel, sheet = image(time_us, window_us), Sheet(GRAPH)
    (ring,) = [node for node in parse(panel.drawing).iter() if node.get("class") == "touch"]
    x, y = sheet.of_mm(PRESSED.x_um[place] / 1e3, PRESSED.y_um[place] / 1e3)
    found = [float(ring.get(name)) for name in ("cx", "cy", "r")]
    assert found == pytest.approx([x, y, 5 * sheet.scale], abs=0.01)


@pytest.mark.parametrize("pressed", [None, Of(**vars(PRESSED) | {"x_um": []})])
def test_without_a_touch_there_is_no_ring(parse, pressed):
    drawing = image(1_000, pressed=pressed).drawing
    assert not [node for node in parse(drawing).iter() if node.get("class") == "touch"]


@pytest.mark.parametrize(("wide", "columns"), [(True, "two"), (False, "three")])
def test_images_of_a_wide_skin_stand_by_twos(wide, columns):
    digest = Of(images=lambda: [image(1_000)], plan=Of(data_period_us=4_000, touch=PRESSED),
                sheet=Of(wide=wide), result=Of(has_deliveries=True))  # fmt: skip
    shown = report._touch(digest)
    assert f'<div class="pictures {columns}">' in shown
    assert "Every cell measures once in 4 ms; shown is what came in 1.25 times that." in shown
    assert "0 to 4 N" in shown
    assert "where the touch really is" in shown
    assert "Nothing touches" not in shown
    digest.plan.touch = None
    bare = report._touch(digest)
    assert "where the touch really is" not in bare
    assert "1.25 times that. Nothing touches this skin." in bare
    digest.images = list
    assert report._touch(digest) == ""


@pytest.mark.parametrize(("extent", "wide"), [((1.41, 1.0), True), ((1.39, 1.0), False)])
def test_a_sheet_is_wide_from_seven_by_five_on(monkeypatch, extent, wide):
    from innervate.networks.skin.plot import sheet

    places = [(0.0, 0.0), (20 * extent[0], 0.0), (0.0, 20 * extent[1])]
    monkeypatch.setattr(sheet, "cell_places", lambda _: places)
    made = Sheet(GRAPH)
    assert made.wide == wide
    most = sheet.WIDE if wide else sheet.TALL
    assert made.width <= most[0] + 1e-6
    assert made.height <= most[1] + 1e-6


@pytest.mark.parametrize(("interfaces", "fills"), [
    (1, ["bar", "bar"]), (2, ["p0", "p1"]), (8, ["p0", "p1"]), (9, ["bar", "bar"]),
])  # fmt: skip
def test_bars_of_ports_have_their_colours_where_cells_have_them(interfaces, fills):
    """In cells, with the even share and how far from it they are."""
    digest = object.__new__(Digest)
    digest.graph = Of(interfaces=interfaces)
    digest.summary = {"port_loads": [1_200, 300], "balance_factor": 0.64}
    shown = digest.loads()
    assert [bar.kind for bar in shown.bars] == fills
    assert [(bar.name, bar.value, bar.words) for bar in shown.bars] == [
        ("port 0", 1_200, "1,200 cells"), ("port 1", 300, "300 cells")]  # fmt: skip
    assert (shown.text, shown.even) == ("Balance factor 0.640; 1 is even.", 750.0)
    digest.summary = {"port_loads": [9], "balance_factor": None}
    assert (digest.loads().text, digest.loads().even) == ("", None)
    digest.summary = {"port_loads": []}
    assert digest.loads() is None
