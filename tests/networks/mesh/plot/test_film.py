"""A film of a crossing, from rows that are written here: when what is seen, and what is said."""

import re
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.mesh.analysis.alarms import Crossing
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.plot import film, report
from innervate.networks.mesh.plot.sheet import Sheet
from innervate.networks.mesh.protocol import constants
from innervate.networks.mesh.protocol.constants import ACK, ALARM, ALL, DATA, FLOOD
from innervate.web.engine import engine_of

ROBOT, WITNESS, MONITOR = 2, 1, 0
TABLES = {
    "kind": "mesh", "duration_s": 30.0, "radio": {"reach_m": 40},
    "node": [{"name": f"n{i}", "x_m": 25.0 * i, "y_m": 0.0} for i in range(3)],
    "robot": [{"node": 2, "waypoints": [[50, 0], [60, 0]], "speed_mps": 1.0}],
    "fence": {"polygon": [[-5, -20], [55, -20], [55, 20], [-5, 20]]},
}  # fmt: skip
CROSSED = 5_000_000


def crossing(**more):
    given = {"robot": ROBOT, "crossed_us": CROSSED, "back_us": 30_000_000, "row": 0, "hops": 2,
             "raised_us": CROSSED + 10_000, "raised_by": ROBOT, "accepted_us": CROSSED + 100_000,
             "flooded": False, "warned_us": NEVER, "overrun_m": 0.123, "open": False}  # fmt: skip
    return Crossing(**given | more)


@pytest.mark.parametrize(("accepted", "ended", "shown"), [
    (100_000, 9_000_000, (-12_500, 120_000)), (1, 9_000_000, (-2500, 24_000)),
    (1_500_000, 9_000_000, (-187_500, 1_800_000)), (2_000_000, 9_000_000, (-187_500, 1_800_000)),
    (NEVER, 9_000_000, (-187_500, 1_800_000)), (NEVER, 5_080_000, (-10_000, 96_000)),
])  # fmt: skip
def test_it_begins_an_eighth_before_and_ends_a_fifth_after_what_happened(accepted, ended, shown):
    at = accepted if accepted == NEVER else CROSSED + accepted
    low, high = film.window(crossing(accepted_us=at), ended)
    assert (low - CROSSED, high - CROSSED) == shown


ROWS = [
    # (from and to after the crossing in us, who, to whom, kind, flags, path, receivers)
    (-40_000, -20_000, 0, 1, DATA, 0, 1, 1),  # before the film
    (1_000, 2_000, 0, 1, DATA, 0, 1, 1),
    (3_000, 4_000, 1, ALL, DATA, 0, 1, 2),
    (20_000, 21_000, 2, 1, ALARM, 0, 1, 1),
    (22_000, 23_000, 1, 2, ACK, 0, 1, 1),
    (30_000, 31_000, 1, ALL, ALARM, FLOOD, 2, 2),
    (40_000, 41_000, 1, 0, ALARM, 0, 2, 0),
    (200_000, 201_000, 0, 1, DATA, 0, 1, 1),  # after it
]


def result_of(rows=ROWS):
    plan = scenario.plan(scenario.from_dict(TABLES))
    world = engine_of(plan).world
    sent = np.zeros(len(rows), world.sent.dtype)
    for row, (start, end, node, to, kind, flags, path, receivers) in zip(sent, rows, strict=True):
        row["time"], row["end"] = CROSSED + start, CROSSED + end
        row["node"], row["link_dst"] = node, to
        row["kind"], row["flags"], row["path_len"], row["receivers"] = kind, flags, path, receivers
        row["origin"], row["seq"] = ROBOT, 9
    delivered = np.zeros(1, world.delivered.dtype)
    delivered["node"], delivered["origin"], delivered["seq"] = MONITOR, ROBOT, 9
    return SimpleNamespace(plan=plan, ended_us=30_000_000, sent=sent, delivered=delivered)


def seen(parse, rows=ROWS, **more):
    """Elements of a film by class: from when to when after the crossing, ms, and the element."""
    one, result = crossing(**more), result_of(rows)
    drawing = film.film(result, one, Sheet(result.plan))
    low, high = film.window(one, result.ended_us)
    found = {}
    for node in parse(drawing).iter():
        (change,) = [child for child in node if child.get("attributeName") == "opacity"] or [None]
        if change is not None:
            shares = [float(share) for share in change.get("keyTimes").split(";")]
            values = [float(value) for value in change.get("values").split(";")]
            on = [low + share * (high - low) - CROSSED
                  for share, value in zip(shares, values, strict=True) if share]  # fmt: skip
            found.setdefault(node.get("class"), []).append(([round(t / 1e3, 1) for t in on], node))
    return found


def times(found, kind):
    return [when for when, _ in found.get(kind, [])]


def test_others_on_the_air_are_seen_as_lines_and_rings_for_a_hundredth_of_it(parse):
    found = seen(parse)
    # Each for its time on the air, and 1.2 % of the 132.5 ms at least.
    assert times(found, "other") == [[1.0, 2.6], [3.0, 4.6]]
    assert [node.tag.rpartition("}")[2] for _, node in found["other"]] == ["path", "circle"]


def test_time_runs_below_from_20_of_the_left_edge_to_20_of_the_right_one(parse):
    result = result_of()
    sheet = Sheet(result.plan)
    drawing = parse(film.film(result, crossing(), sheet))
    lines = [one for one in drawing.iter() if one.get("class") == "axis" and one.get("x1")]
    across = [(float(one.get("x1")), float(one.get("x2"))) for one in lines]
    assert (20.0, sheet.width - 20.0) in across
    ticks = sorted(left for left, right in across if left == right)
    shares = [(ms * 1e3 + 12_500) / 132_500 for ms in range(0, 121, 20)]
    width = sheet.width - 40.0
    assert ticks == pytest.approx([20.0 + width * share for share in shares], abs=0.06)


def test_without_any_copy_of_the_alarm_neither_alarms_nor_acks_are_others(parse):
    found = seen(parse, ROWS[:5], row=NEVER, raised_us=NEVER, accepted_us=NEVER)
    assert [first for first, _ in times(found, "other")] == [-40.0, 1.0, 3.0]
    assert "way" not in found


def test_copies_of_the_alarm_are_arrows_that_stay_and_waves(parse):
    found = seen(parse)
    assert times(found, "way") == [[20.0, 21.6]]
    assert times(found, "way failed") == [[40.0, 41.6]]  # nobody decoded it
    assert times(found, "flooder") == [[30.0]]
    assert len(found["wave"]) == 1
    assert {float(node.get("opacity")) for kind in ("way", "way failed") for _, node in found[kind]
            } == {film.STAYS}  # fmt: skip


def test_alarms_of_before_are_others_and_a_copy_to_the_monitor_is_a_wave(parse):
    before = (-8_000, -7_000, 1, 0, ALARM, 0, 1, 1)
    assert times(seen(parse, [*ROWS, before]), "other")[-1] == [-8.0, -6.4]
    found = seen(parse, [*ROWS, (50_000, 51_000, 1, constants.MONITOR, ALARM, 0, 1, 1)])
    assert times(found, "flooder") == [[30.0], [50.0]]


@pytest.mark.parametrize(
    ("accepted", "marks"),
    [(100_000, ["crossed", "raised", "monitor knows"]), (NEVER, ["crossed", "raised"])],
)
def test_words_of_moments_do_not_meet(parse, accepted, marks):
    at = accepted if accepted == NEVER else CROSSED + accepted
    result = result_of()
    made = parse(film.film(result, crossing(accepted_us=at), Sheet(result.plan)))
    found = [(float(node.get("x")), node.text) for node in made.iter()
             if node.text in {"crossed", "raised", "monitor knows"}]  # fmt: skip
    assert [text for _, text in found] == marks
    assert all(a + 6 * len(text) < b for (a, text), (b, _) in pairwise(found))


@pytest.mark.parametrize(("some", "shown"), [
    ([], None), ([{"raised_us": NEVER, "accepted_us": NEVER}], None),
    ([{}, {"accepted_us": NEVER}, {"accepted_us": NEVER, "raised_us": CROSSED}], 1),
    ([{"accepted_us": NEVER, "open": True}, {}], 1),
    ([{}, {"accepted_us": CROSSED + 99_000, "raised_us": CROSSED}, {}], 1),
])  # fmt: skip
def test_shown_is_the_first_that_nobody_heard_of_or_the_slowest(some, shown):
    made = [crossing(**more) for more in some]
    assert report.shown_crossing(made) is (None if shown is None else made[shown])


def test_the_robot_and_the_monitor_are_marked_from_their_moments_on(parse):
    found = seen(parse)
    assert times(found, "warn") == [[0.0]]
    assert times(found, "done") == [[100.0]] * 2
    assert "done" not in seen(parse, row=NEVER, accepted_us=NEVER)


def words(found):
    return [(when, node.text) for kind, some in found.items() if re.search("heavy", kind)
            for when, node in some]  # fmt: skip


@pytest.mark.parametrize(("by", "who"), [(ROBOT, "the robot"), (WITNESS, "node n1, a witness,")])
def test_the_line_above_says_what_has_happened_so_far(parse, by, who):
    told = sorted(words(seen(parse, raised_by=by)), key=lambda one: one[0][0])
    assert [when for when, _ in told] == [[0.0], [0.0, 10.0], [10.0, 100.0], [100.0]]
    assert [text for _, text in told] == [
        "robot n2 is inside the fence", "robot n2 has left the fence", f"{who} raises the alarm",
        "the monitor knows, 90.0 ms later: robot 0.12 m out"]  # fmt: skip


def test_no_name_lies_on_the_pin_of_the_crossing(parse, monkeypatch):
    """The robot's own would stand above it: beside it is the fence."""
    walk = [{"node": 2, "waypoints": [[50, 15], [50, 25]], "speed_mps": 1.0}]
    monkeypatch.setitem(TABLES, "robot", walk)
    result = result_of()
    drawing = parse(film.film(result, crossing(), Sheet(result.plan)))
    x, y = map(float, pins(drawing)[0].split("l")[0].split(","))
    for text in drawing.findall(".//{*}text"):
        if text.text in ("n0 gateway", "n1", "n2 robot"):
            long, at, level = 6.6 * len(text.text), float(text.get("x")), float(text.get("y"))
            left = at - {"middle": 0.5, "end": 1}.get(text.get("text-anchor"), 0) * long
            top, low = level + film.HEAD - 9, level + film.HEAD + 2
            assert left + long < x - 5 or left > x + 5 or low < y - 13 or top > y, text.text


def pins(drawing):
    return [one.get("d")[1:] for one in drawing.findall(".//{*}path") if one.get("class") == "warn"]
