"""The report of a run of any network, and drawings as figures, by hand."""

import re
from types import SimpleNamespace as Of

import numpy as np
import pytest
from matplotlib import colors
from matplotlib.figure import Figure

import innervate
from innervate.plot import body, charts, figures, paint
from innervate.plot.charts import Bar
from innervate.plot.svg import Drawing
from innervate.scenario import from_dict, plan

ROW = [("time", np.int64), ("node", np.int64), ("code", np.int64)]


def ring(nodes):
    return plan(from_dict({"kind": "babel", "nodes": nodes, "duration_s": 1.0}))


def result(rows, deliveries=(), ended_us=2_000_000):
    made = {"rows": np.array(rows, ROW)}
    if len(deliveries):
        times = [("time", np.int64), ("sent_us", np.int64)]
        made["deliveries"] = np.array([(at, 0) for at in deliveries], times)
    return Of(rows=made, plan=Of(kind="babel", faults=[]), ended_us=ended_us)


def test_a_graph_is_drawn_and_named_as_far_as_it_can_be_read(monkeypatch):
    monkeypatch.setattr(body, "DRAWN_MAX", 5)
    monkeypatch.setattr(body, "NAMED_MAX", 4)
    four, five = body.graph(ring(4)), body.graph(ring(5))
    assert (four.count("<circle"), five.count("<circle")) == (4, 5)
    assert (four.count("<text"), five.count("<text")) == (4, 0)
    assert four.count("<line") == 4
    assert "4 nodes, 4 links." in four
    assert body.graph(ring(6)) == ""


def test_who_is_off_at_the_end_is_crossed_and_named_so_in_the_table():
    kill = {"at_s": 0.02, "action": "kill", "node": 2}
    made = {"kind": "babel", "nodes": 4, "duration_s": 0.05, "event": [kill]}
    run = innervate.run(made, plain=True)
    shown = body.body(run.result, run.summary)
    assert (shown.count('class="off"'), shown.count('class="struck"')) == (1, 1)
    assert "4 nodes, 4 links; crossed: off at the end." in shown
    assert re.findall(r"<td>(n\d[^<]*)</td>", shown) == ["n0", "n1", "n2, off", "n3"]
    assert "struck" not in body.graph(ring(4))


def test_one_of_a_figure_is_told_as_one():
    run = innervate.run({"kind": "babel", "nodes": 4, "duration_s": 0.05}, plain=True)

    def told(frames, lost, messages, events):
        changed = {
            "frames": run.summary["frames"] | {"sent": frames, "lost": lost}, "events": events,
            "messages": run.summary["messages"] | {"delivered": messages},
        }  # fmt: skip
        shown = body.top(run.result, run.summary | changed)
        return re.findall(r"frames? sent|frames? lost|messages? delivered|events?\b", shown)

    assert told(1, 1, 1, 1) == ["frame sent", "frame lost", "message delivered", "event"]
    assert told(2, 0, 0, 2) == ["frames sent", "frames lost", "messages delivered", "events"]


def test_on_the_air_receptions_are_not_called_frames_as_there_are_more_of_them():
    run = innervate.run({"kind": "rpl", "nodes": 4, "duration_s": 0.5}, plain=True)
    shown = body.top(run.result, run.summary)
    assert run.result.counts.is_shared
    assert re.findall(r">(\w+ due|\w+ sent|\w+ lost)<", shown) == [
        "receptions due", "receptions lost"]  # fmt: skip


def test_nodes_lie_where_their_coordinates_say():
    """From 40 on, 340 wide or high at most; without any the whole graph is spread."""
    nodes = [("a", {"x_m": 3.0, "y_m": 1.0, "z_m": 9.0}), ("b", {"x_m": 7.0, "y_m": 3.0})]
    assert body._places(nodes, []) == {"a": (40.0, 40.0), "b": (380.0, 210.0)}
    assert body._places(nodes[:1], []) == {"a": (40.0, 40.0)}
    spread = body._places([nodes[0], ("b", {"x_m": 7.0})], [("a", "b", {})])
    assert spread["a"] != (40.0, 40.0) or spread["b"] != (380.0, 210.0)
    for axis in (0, 1):
        assert min(place[axis] for place in spread.values()) == 40.0


def test_deliveries_come_first_then_what_was_reported_most():
    rows = [(5, 0, 1), (6, 0, 2), (7, 1, 2), (8, 0, 977), (9, 0, 977), (9, 1, 977)]
    found = body._series(result(rows, [4, 3]))
    assert [(name.split()[-1], times.tolist()) for name, times in found][:2] == [
        ("delivered", [4, 3]), ("977", [8, 9, 9]),
    ]  # fmt: skip
    assert [times.tolist() for _, times in found][2:] == [[6, 7], [5]]
    assert len(body._series(result(rows))) == 3


@pytest.mark.parametrize(("kind", "names"), [
    ("babel", {1: "route", 2: "drop", 3: "link"}), ("flooding", {2: "gave up"}),
    ("rpl", {1: "no route", 5: "parent"}), ("mesh", {}),
])  # fmt: skip
def test_reports_have_the_names_that_any_part_of_the_protocol_gives_them(kind, names):
    found = body._report_names(kind)
    assert {code: found[code] for code in names} == names


@pytest.mark.parametrize("faults", [(), (Of(at_us=700_000),)])
def test_lines_in_charts_are_said_to_be_events(faults):
    drawn = body._over_time(Of(
        ended_us=2_000_000, rows={"deliveries": np.array([(5,)], [("time", "i8")])},
        plan=Of(kind="babel", faults=faults),
    ))  # fmt: skip
    assert ('class="mark"' in drawn) == ("dashed: the events below" in drawn) == bool(faults)


def test_what_an_interrupted_run_did_not_come_to_is_not_among_its_events():
    kills = [{"at_s": at_s, "action": "kill", "node": 2} for at_s in (0.02, 0.04)]
    made = {"kind": "babel", "nodes": 4, "duration_s": 0.05, "event": kills}
    run = innervate.run(made, plain=True)
    run.result.ended_us = 30_000
    shown = body.body(run.result, run.summary)
    assert re.findall(r"<td>(0\.0\d+\u00a0s)</td>", shown) == ["0.020\u00a0s"]
    assert shown.count('class="mark"') == shown.count('class="series"') > 0


def test_so_many_charts_are_shown():
    made = result([(at, 0, code) for code in range(20) for at in range(code + 1)])
    text = body._over_time(made)
    assert text.count("<svg") == body.CHARTS_MAX
    assert body._over_time(result([])) == ""


@pytest.mark.parametrize(("bars", "named"), [(1, True), (24, True), (25, False)])
def test_so_many_bars_are_drawn_one_by_one(bars, named):
    shown = charts.Bars([Bar(f"b{k}", k + 1.0, "") for k in range(bars)], "bars").drawing
    assert (">b0<" in shown.render()) == named


def test_the_fair_share_is_drawn_at_its_place():
    """Longer than all bars, it sets the scale."""
    rendered = charts.Bars(
        [Bar("a", 1.0, ""), Bar("b", 2.0, "")], "bars", even=4.0
    ).drawing.render()
    wide = [float(one) for one in re.findall(r'class="bar" d="M[\d.]+,[\d.]+h([\d.]+)', rendered)]
    left = 14 + charts.LETTER
    full = charts.WIDTH - left - 14
    assert wide == pytest.approx([full / 4, full / 2], abs=0.01)
    assert f'x1="{charts.WIDTH - 14:g}"' in rendered


def painted(drawing, width_in=1.0) -> tuple[Figure, list]:
    made = paint.figure(drawing, width_in=width_in)
    return made, made.axes[0].patches


def test_shapes_are_painted_where_they_are_drawn():
    """100 units are an inch, 72 points; what is inside another drawing is shifted."""
    inner = Drawing(10, 10, "")
    inner.line((1, 2), (3, 4), "cable")
    inner.circle((5, 6), 2, "relay")
    whole = Drawing(100, 50, "")
    whole.place(inner, (20, 30))
    whole.path("M1,2h3v4l-1,1L7,8H9z", "cable")
    whole.path("M0,0h5zM10,10a4,4 0 0 1 8,0", "cable")
    _, (line, circle, path, half) = painted(whole)
    assert line.get_path().vertices.tolist() == [[21, 32], [23, 34]]
    assert circle.center == (25, 36)
    assert circle.radius == 2
    assert path.get_path().vertices.tolist() == [
        [1, 2], [4, 2], [4, 6], [3, 7], [7, 8], [9, 8], [1, 2],
    ]  # fmt: skip
    corners = half.get_path().vertices
    assert corners[:4].tolist() == [[0, 0], [5, 0], [0, 0], [10, 10]]
    assert corners[-1] == pytest.approx((18, 10))
    assert corners[11] == pytest.approx((14, 14))  # the middle of the half circle, below
    assert len(corners) == 20


def test_lines_and_letters_are_as_wide_as_the_figure_makes_them():
    whole = Drawing(100, 50, "")
    whole.line((0, 0), (9, 9), "cable")
    whole.rect((1, 1), (5, 5), "relay")
    whole.text((3, 4), "a $b", "small", "middle")
    for width_in in (1.0, 2.0):
        made, (line, rect) = painted(whole, width_in)
        scale = 0.72 * (width_in - 2 * paint.EDGE_IN)
        assert line.get_facecolor()[3] == 0.0
        assert colors.to_rgba(rect.get_facecolor())[3] > 0.0
        style = dict(paint._rules())["cable"]
        assert line.get_linewidth() == pytest.approx(scale * float(style.get("stroke-width", 1)))
        (text,) = made.axes[0].texts
        size = float(dict(paint._rules()).get("small", {}).get("font-size", "12px")[:-2])
        assert text.get_fontsize() == pytest.approx(scale * size)
        assert text.get_position() == (3, 4)
        assert (text.get_text(), text.get_ha()) == (r"a \$b", "center")


def test_samples_stand_below_in_columns():
    whole = Drawing(500, 100, "all")
    made = paint.keyed(whole, [(Drawing(10, 10, ""), f"k{i}") for i in range(3)])
    assert (made.width, made.height) == (500, 100 + 2 * paint.KEY_PX)
    shifts = re.findall(r"translate\(([\d.]+) ([\d.]+)\)", made.render())
    assert [(float(x), float(y)) for x, y in shifts] == [
        (0, 0), (0, 100), (235, 100), (0, 122),
    ]  # fmt: skip
    wide = paint.keyed(whole, [(Drawing(10, 10, ""), "w" * 100)] * 2)
    assert (wide.width, wide.height) == (690, 144)


def test_what_was_delivered_so_far_and_how_fast():
    made = figures.delivered(Of(result=result([(5_000, 0, 1), (1_000, 0, 1)], [2_000_000])))
    there, reports = made.axes[0].lines
    assert there.get_xdata().tolist() == [2.0, 2.0]
    assert there.get_ydata().tolist() == [1, 1]
    assert reports.get_xdata().tolist() == [0.001, 0.005, 2.0]
    assert reports.get_ydata().tolist() == [1, 2, 2]
    assert made.axes[0].get_xlim() == (0, 2.0)
    with pytest.raises(ValueError, match='no figure "x"; there are delivered, latency'):
        figures.draw(Of(result=result([])), "x")


def test_a_table_says_what_each_node_was_at_the_end(monkeypatch):
    """In single numbers that it declares, but for those of its generator; of few nodes."""
    state = (("number", 0, 0, 9, "", "who"), ("dist", 0, 0, 9, "hops", "how <far>"),
             ("row", 3, 0, 9, "", "a list"), ("up", 0, 0, 1, "flag", "on"))  # fmt: skip
    cells = np.array([(1, 4, 0), (2, 7, 1)], [(n, np.int64) for n in ("number", "dist", "up")])
    names = [("a<b", ""), ("c", "")]
    network = Of(graph=lambda plan: Of(nodes=names), has=lambda part: True, fields=Of(STATE=state))
    monkeypatch.setattr(body, "networks", lambda: {"babel": network})
    for kept in ("cells", "stations"):
        told = body._nodes(Of(plan=Of(kind="babel"), world=Of(**{kept: cells}), counts=Of(off=())))
        rows = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in told.split("<tr")[1:]]
        assert rows == [["node", '<span title="how &lt;far&gt;">dist</span>, hops',
                         '<span title="on">up</span>, flag'],
                        ["a&lt;b", "4", "0"], ["c", "7", "1"]]  # fmt: skip
    assert body._nodes(Of(plan=Of(kind="babel"), world=Of())) == ""
    names *= body.NAMED_MAX
    assert body._nodes(Of(plan=Of(kind="babel"), world=Of(cells=cells))) == ""
