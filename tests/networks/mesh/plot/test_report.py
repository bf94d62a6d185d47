import re
from types import SimpleNamespace

import pytest

from innervate import run
from innervate.networks.mesh.analysis.alarms import all_crossings
from innervate.networks.mesh.plot import film as mesh_film
from innervate.networks.mesh.plot import map as mesh_map
from innervate.networks.mesh.plot import report as mesh_report
from innervate.networks.mesh.plot.figures import FIGURES
from innervate.networks.mesh.plot.sheet import Labels, Sheet
from innervate.plot import figures
from tests.networks.mesh.tables_runs import mesh_tables, without_fence
from tests.plot.ink import ink_of


@pytest.fixture(scope="module")
def field():
    return run(mesh_tables())


@pytest.fixture(scope="module")
def plain():
    return run(without_fence())


def boxes(drawing, parse):
    """(x from, x to, y, words) of texts that are always there, letters taken as 6 px wide."""
    found = []
    for node in parse(drawing).iter():
        if node.tag.endswith("}text") and node.text and not len(node):
            wide = 6.0 * len(node.text)
            shift = {"end": wide, "middle": wide / 2}.get(node.get("text-anchor"), 0)
            x = float(node.get("x")) - shift
            found.append((x, x + wide, float(node.get("y")), node.text))
    return found


def overlaps(drawing, parse):
    texts = boxes(drawing, parse)
    return [
        (one[3], other[3])
        for i, one in enumerate(texts)
        for other in texts[:i]
        if one[0] < other[1] and other[0] < one[1] and abs(one[2] - other[2]) < 9
    ]


def test_the_map_names_roles_and_keeps_names_apart(field, parse, texts):
    sheet, crossings = Sheet(field.result.plan), all_crossings(field.result)
    drawing = mesh_map.field_map(field.result, sheet, "map", crossings)
    words = texts(drawing)
    for name in ("n0 gateway", "n7 standby", "n5 monitor", "n29 robot", "1", "2"):
        assert name in words
    assert overlaps(drawing, parse) == []
    kinds = [node.get("class") for node in parse(drawing).iter()]
    assert kinds.count("fence") == 2  # the polygon and its hole
    assert kinds.count("walk") == 2
    assert kinds.count("warn") == len(crossings) == 2
    assert kinds.count("off") == 6


def test_everything_lies_on_the_drawing(field):
    sheet = Sheet(field.result.plan)
    assert (sheet.points >= 0).all()
    assert (sheet.points <= [sheet.width, sheet.height]).all()


def test_a_film_repeats_as_a_whole_and_ends_with_the_monitor_told(field, parse):
    shown = mesh_report.shown_crossing(all_crossings(field.result))
    drawing = mesh_film.film(field.result, shown, Sheet(field.result.plan))
    moving = [node for node in parse(drawing).iter() if "animate" in node.tag]
    assert len(moving) > 12
    for node in moving:
        assert node.get("dur") == f"{mesh_film.CYCLE_S:g}s"
        times = [float(time) for time in node.get("keyTimes").split(";")]
        assert times[0] == 0.0
        assert times == sorted(times)
        assert times[-1] <= 1.0
        assert len(times) == len(node.get("values").split(";"))
        assert node.get("calcMode") == "discrete" or times[-1] == 1.0
    # Without movement the last moment is seen: one line of words, and the ring of the monitor.
    tree = parse(drawing)
    lasting = [n.text for n in tree.iter() if n.tag.endswith("}text") and n.get("opacity") == "1"]
    assert len(lasting) == 1
    assert lasting[0].startswith("the monitor knows")
    assert [n.get("opacity") for n in tree.iter() if n.get("class") == "done"] == ["1", "1"]
    assert overlaps(drawing, parse) == []


def test_the_report_shows_all_parts(field):
    page = field.report()
    for head in ("The field", "A crossing, in slow motion", "How well it went", "Crossings",
                 "Node by node", "Flows", "Events", "What the nodes reported"):  # fmt: skip
        assert f"<h2>{head}</h2>" in page
    assert "&lt;field&gt; &amp; more" in page
    assert "<field>" not in page
    assert "2 crossings of the fence" in page
    assert not re.search(r'(src|href)="(?!#)', page)  # it needs nothing else
    assert page.count("<script>") == 1


def test_when_a_fence_was_crossed_is_on_one_line_on_a_phone_too(field):
    rows = field.report().partition("<h2>Crossings</h2>")[2].partition("</table>")[0]
    assert len(re.findall(r"<td>\d+\.\d{3}\u00a0s</td>", rows)) == 2
    assert len(re.findall(r"<td>[\d.]+\u00a0m</td>", rows)) == 2


def test_what_a_node_sent_is_on_one_line_on_a_phone_too(plain):
    rows = plain.report().partition("<h2>Node by node</h2>")[2].partition("</table>")[0]
    assert len(re.findall(r"<td>[\d.]+\u00a0%</td>", rows)) == plain.result.plan.nodes


def test_a_mesh_without_a_fence_has_no_crossings(plain):
    page = plain.report()
    assert "A crossing, in slow motion" not in page
    assert "Crossings" not in page
    assert "<script>" not in page
    assert f"<h1>{plain.summary['headline']['text']}</h1>" in page
    assert "No message came twice" in page


def test_networks_without_places_are_drawn_by_who_hears_whom(plain, parse):
    plan = plain.result.plan
    bare = SimpleNamespace(
        **{name: getattr(plan, name) for name in plan.__dataclass_fields__} | {"positions_cm": []}
    )
    sheet = Sheet(bare)
    assert not sheet.metres
    assert len({(round(x, 1), round(y, 1)) for x, y in sheet.points.tolist()}) == plan.nodes


def test_labels_without_room_are_left_out():
    names = Labels(100.0, 30.0)
    names.block((50.0, 15.0), 5.0)
    assert names.put((50.0, 15.0), "ten", 9.0) is not None
    assert names.put((50.0, 15.0), "much too long a name", 9.0) is None


@pytest.mark.parametrize("figure", FIGURES)
@pytest.mark.parametrize("which", ["field", "plain"])
def test_each_figure_draws(which, figure, request, tmp_path):
    made = figures.draw(request.getfixturevalue(which), figure)
    assert 0.003 < ink_of(made, tmp_path) < 0.97


def test_an_unknown_figure_is_refused(plain):
    with pytest.raises(ValueError, match='no figure "routes"; there are field, latency'):
        plain.plot("routes")
