"""Scenes of a radio team that are written here: what of them is drawn, and where."""

import re
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.radio.analysis.air import Heard
from innervate.networks.radio.plot import scene, timeline
from innervate.networks.radio.plot.words import frame_words
from innervate.networks.radio.protocol.constants import CRR, DATA, REPORT, REPORT_TURN

PROTOCOL = "csma-cd-r/practical"
WINDOW = scene.Window(1_000, 2_000, 1_000)
RESOLUTION = scene.resolution  # of which the tests choose what comes out, but one
ROOM = timeline.WIDTH - timeline.LEFT - timeline.RIGHT


def spans(*found):
    return np.array(found, np.int64).reshape(-1, 2)


def heard(cd=(), voc=(), deaf=(), off=()):
    return Heard(spans(*cd), spans(*voc), spans(*deaf), spans(*off))


def box(start, end, station=0, kind=DATA, labels=("data", "D"), collided=False):
    words = frame_words(PROTOCOL, kind)
    return scene.Box(station, start, end, kind, words, labels, collided, f"{start} to {end}")


def scene_of(stations=1, boxes=(), notes=(), ears=None, window=WINDOW):
    found = {station: (ears or {}).get(station, heard()) for station in range(stations)}
    return scene.Scene(window, 100, tuple(found), tuple(boxes), tuple(notes), found, False)


def drawn(*args, **named):
    return timeline.draw(scene_of(*args, **named))


def paths(drawing, kind, parse):
    shapes = (node for node in parse(drawing).iter() if node.tag.endswith("path"))
    return [node.get("d") for node in shapes if node.get("class") == kind]


@pytest.mark.parametrize(("start", "end", "left", "wide"), [
    (500, 1_500, 0, 0.5), (1_500, 2_500, 0.5, 0.5), (0, 9_000, 0, 1), (1_250, 1_500, 0.25, 0.25),
])  # fmt: skip
def test_a_box_stands_where_its_time_is_and_ends_with_the_window(start, end, left, wide, parse):
    (shape,) = paths(drawn(boxes=[box(start, end)]), "frame p0", parse)[:-1]  # and the legend
    x, _, width = map(float, re.match(r"M([\d.]+),([\d.]+)h([\d.]+)", shape).groups())
    assert (x, width) == pytest.approx((timeline.LEFT + left * ROOM, wide * ROOM), abs=0.01)


@pytest.mark.parametrize(("start", "end", "shown"), [
    (900, 1_000, 0), (900, 1_001, 1), (1_999, 2_100, 1), (2_000, 2_100, 0),
])  # fmt: skip
def test_what_lies_outside_the_window_has_no_box(start, end, shown, parse):
    assert len(paths(drawn(boxes=[box(start, end)]), "frame p0", parse)) == shown + 1


@pytest.mark.parametrize(("stations", "detailed"), [(16, True), (17, False)])
def test_of_up_to_sixteen_stations_it_is_shown_what_they_hear(stations, detailed, texts):
    assert texts(drawn(stations)).count("VOC") == (stations if detailed else 0)


@pytest.mark.parametrize(("count", "tips"), [(600, 600), (601, 0)])
def test_few_boxes_say_what_they_are_under_the_pointer(count, tips):
    boxes = [box(1_000 + i, 1_001 + i) for i in range(count)]
    assert drawn(boxes=boxes).render().count("<title>") == tips


@pytest.mark.parametrize(("stations", "marks"), [
    (16, {"warn": 2, "done": 2, "lack": 2}), (17, {"warn": 0, "done": 2, "lack": 2}),
    (81, {"warn": 0, "done": 2, "lack": 2}), (82, {"warn": 0, "done": 0, "lack": 0}),
])  # fmt: skip
def test_marks_need_room(stations, marks, parse):
    """Each once in its lane, once in the legend."""
    notes = [scene.Note(0, 1_500, kind, "") for kind in (scene.NOTICED, scene.DONE, scene.FAILED)]
    drawing = drawn(stations, notes=notes)
    assert {kind: len(paths(drawing, kind, parse)) for kind in marks} == marks


def test_the_mark_of_a_failure_is_a_diamond_where_it_was_noted(parse):
    drawing = drawn(notes=[scene.Note(0, 1_500, scene.FAILED, "")])
    x, y = timeline.LEFT + ROOM / 2, timeline.TOP + timeline.NOTES_PX / 2
    assert paths(drawing, "lack", parse)[0] == f"M{x:g},{y - 4:g}l4,4l-4,4l-4,-4z"


@pytest.mark.parametrize(("deaf", "off", "quiet"), [
    ([], [], [(0, 1)]), ([(1_200, 1_400)], [], [(0, 0.2), (0.4, 1)]),
    ([(1_100, 1_500)], [(1_200, 1_300)], [(0, 0.1), (0.5, 1)]),  # one within the other
    ([(1_000, 1_500)], [(1_500, 2_000)], []),
])  # fmt: skip
def test_where_a_radio_cannot_listen_no_line_says_that_it_hears_nothing(deaf, off, quiet, parse):
    lines = paths(drawn(ears={0: heard(deaf=deaf, off=off)}), "axis", parse)
    at = [tuple(timeline.LEFT + share * ROOM for share in pair) for pair in quiet]
    line = [tuple(map(float, one)) for one in re.findall(r"M([\d.]+),[\d.]+H([\d.]+)", lines[0])]
    assert np.allclose(line, at, atol=0.01) if quiet else lines[0].endswith("h20")  # the legend's


@pytest.mark.parametrize(("wide_us", "collided", "label"), [
    (40, False, "data"), (20, False, "D"), (40, True, "D"), (8, False, None),
])  # fmt: skip
def test_a_box_has_the_longest_label_that_fits(wide_us, collided, label, texts):
    drawing = drawn(17, boxes=[box(1_100, 1_100 + wide_us, collided=collided)])
    shown = [text for text in texts(drawing) if text in ("data", "D")]
    assert shown[:-1] == ([label] if label else [])  # the last is the legend's


def run_of(*sent, rows=(), stations=3, turnaround=0):
    """A run of frames: (from, to, station, kind)."""
    kinds = [(name, np.int64) for name in ("time", "end", "node", "kind")]
    named = [(name, np.int64) for name in ("time", "node", "code", "a", "b")]
    plan = Of(stations=stations, faults=[], protocol=PROTOCOL, duration_us=9_000,
              delays_us=[[60] * stations] * stations, absent=[0] * stations,
              params={"slot_us": 100, "packet_slots": 5, "ta_us": turnaround})  # fmt: skip
    return Of(plan=plan, sent=np.array(list(sent), kinds), rows=np.array(list(rows), named),
              ended_us=9_000)  # fmt: skip


@pytest.fixture(autouse=True)
def whole(monkeypatch):
    monkeypatch.setattr(scene, "resolution", lambda _: scene.Window(0, 9_000, 0))


def test_a_resolution_without_an_end_is_so_many_packets_long_with_two_turnarounds_each():
    run = run_of((1_000, 1_600, 0, DATA), (1_100, 1_700, 1, DATA), turnaround=20)
    fields = ("time", "end", "node", "offered", "receivers")
    run.packets = np.zeros(0, [(name, np.int64) for name in fields])
    long = scene.PACKETS_MAX * (500 + 2 * 20)
    edge = round(scene.MARGIN * long)
    assert RESOLUTION(run) == scene.Window(1_000 - 20 - edge, 1_000 + long + edge, 1_000)


def test_a_frame_under_way_as_the_window_begins_or_ends_is_part_of_it():
    run = run_of((400, 1_000, 0, DATA), (500, 1_001, 1, DATA), (1_999, 2_500, 2, DATA),
                 (2_000, 2_500, 0, DATA))  # fmt: skip
    shown = scene.scene(run, 1_000, 2_000)
    assert [one.start_us for one in shown.boxes] == [500, 1_999]


@pytest.mark.parametrize(("most", "boxes", "to_us"), [(3, 3, 9_000), (2, 2, 3_000)])
def test_as_many_frames_as_there_is_room_for_are_not_cut(monkeypatch, most, boxes, to_us):
    monkeypatch.setattr(scene, "BOXES_MAX", most)
    shown = scene.scene(run_of(*((at, at + 10, 0, DATA) for at in (1_000, 2_000, 3_000))), 0, 9_000)
    assert (len(shown.boxes), shown.window.to_us, shown.cut) == (boxes, to_us, most == 2)


@pytest.mark.parametrize(("lanes", "cut"), [(3, False), (2, True)])
def test_stations_without_a_lane_are_said_to_be_missing(monkeypatch, lanes, cut):
    monkeypatch.setattr(scene, "LANES_MAX", lanes)
    run = run_of(*((1_000 + 100 * i, 1_050 + 100 * i, i, DATA) for i in range(3)))
    shown = scene.scene(run, 0, 9_000)
    assert (shown.stations, shown.cut) == (tuple(range(lanes)), cut)


def test_a_packet_in_its_turn_is_labelled_by_its_place_and_no_other_frame_is():
    """A turn begins as its frame is decided, a turnaround before it is on the air."""
    run = run_of((1_000, 1_500, 1, DATA), (2_000, 2_100, 2, CRR), (3_000, 3_500, 1, DATA),
                 rows=[(980, 1, REPORT_TURN, 4, 0), (1_980, 2, REPORT_TURN, 5, 0),
                       (2_980, 2, REPORT_TURN, 6, 0)], turnaround=20)  # fmt: skip
    first, pulse, other = scene.scene(run, 0, 9_000).boxes
    assert first.labels == ("data 4", "D4", "D")
    assert first.tip == "station 1: data, 1000 to 1500 us, 5 slots, place 4 of the round"
    assert pulse.labels == ("CR-R", "C")
    assert pulse.tip == "station 2: CR-R, 2000 to 2100 us, 1 slot"
    assert other.labels == ("data", "D")


def test_what_just_fits_into_a_row_of_the_legend_stands_there(monkeypatch):
    boxes = [box(1_000, 1_300, kind=kind) for kind in (DATA, CRR)]
    made = timeline._Timeline(scene_of(stations=17, boxes=boxes))
    (left, first, *_), (at, second, what, text), *_ = made._entries()
    assert (first, second) == (0, 0)
    ends = at + 28 + 6.4 * len(text) + 22
    monkeypatch.setattr(timeline, "WIDTH", ends)
    assert made._entries()[1][:2] == (at, 0)
    monkeypatch.setattr(timeline, "WIDTH", ends - 0.1)
    assert made._entries()[1][:2] == (left, 1)
    assert what


def test_kinds_of_frames_stand_in_the_legend_once_each(texts):
    boxes = [box(1_000, 1_300, kind=kind) for kind in (REPORT, DATA, CRR, DATA)]
    entries = [text for text in texts(drawn(boxes=boxes)) if ":" in text and "ms" not in text]
    assert [text.split(":")[0] for text in entries] == ["CR-R", "data", "report", "CD"]
