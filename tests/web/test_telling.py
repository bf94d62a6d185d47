"""What a page is told: only what is new, all of it however slow it is, and whatever it says."""

import json
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.analysis.ways import follow, reach
from innervate.web import history
from innervate.web.errors import Refused
from innervate.web.history import LOG, SERIES, TIMELINE, History, Logbook
from innervate.web.messages import Command, Cut, Go, Pause, Seek, Speed, name_of, parse
from innervate.web.playback import Playback
from innervate.web.snapshot import DeltaEncoder, Part, Snapshot
from innervate.web.stage import Stage
from tests.web.runs import SKIN, simulated

SCENE = Part({"type": "scene"})


def told(encoder, snapshot):
    return [json.loads(message) for message in encoder.messages(snapshot)]


def snapshot(record, before=None, scene=SCENE, **fields):
    return Snapshot(scene, fields, record.newest, before)


def test_only_what_changed_is_told():
    record = History()
    encoder = DeltaEncoder(record)
    first = snapshot(record, t_s=0.0, up=np.array([1, 1]), load=np.array([0.5]))
    scene, state = told(encoder, first)
    assert scene == {"type": "scene"}
    assert state == {"type": "state", "t_s": 0.0, "up": [1, 1], "load": [0.5]}
    second = snapshot(record, first, t_s=0.1, up=np.array([1, 1]), load=np.array([0.6]))
    assert second.parts["up"] is first.parts["up"]
    assert told(encoder, second) == [{"type": "state", "t_s": 0.1, "load": [0.6]}]
    third = snapshot(record, second, t_s=0.1, up=np.array([1, 1]), load=np.array([0.6]))
    assert third.same_as(second)
    assert told(encoder, third) == []


def test_who_missed_states_is_told_what_changed_in_all_of_them():
    record = History()
    slow = DeltaEncoder(record)
    before = snapshot(record, t_s=0.0, up=np.array([1]), load=np.array([0.0]))
    told(slow, before)
    for i in range(1, 6):
        up = np.array([1 if i % 2 else 0])
        before = snapshot(record, before, t_s=i / 10, up=up, load=np.array([0.0]))
    (state,) = told(slow, before)
    assert state["t_s"] == 0.5
    assert "load" not in state


def test_another_scene_begins_anew():
    record = History()
    encoder = DeltaEncoder(record)
    record.add(SERIES, 7, {"loss": 1.0})
    first = snapshot(record, t_s=0.0, up=np.array([1]))
    told(encoder, first)
    other = Part({"type": "scene", "name": "other"})
    scene, state = told(encoder, snapshot(record, first, other, t_s=0.0, up=np.array([1])))
    assert scene["name"] == "other"
    assert state["series"] == {"loss": [[7e-06, 1.0]]}
    assert state["up"] == [1]


def test_points_boxes_and_lines_are_never_lost_and_never_told_twice():
    record, slow_points, fast_points = History(), [], []
    fast, slow = DeltaEncoder(record), DeltaEncoder(record)
    before = None
    for i in range(9_000):
        record.add(SERIES, i, {"loss": float(i)})
        record.add(TIMELINE, i, {"station": i})
        if i % 1000 == 999:
            before = snapshot(record, before, t_s=i / 1e6)
            for state in told(fast, before)[-1:]:
                fast_points += state["series"]["loss"]
    behind, boxes = True, []
    while behind:
        for message in told(slow, before):
            slow_points += message.get("series", {}).get("loss", [])
            boxes += message.get("timeline", [])
        behind = slow.is_behind(before)
    assert [value for _, value in slow_points] == list(range(9_000))
    assert fast_points == slow_points
    assert [box["station"] for box in boxes] == list(range(9_000))


def test_what_is_kept_is_bounded(monkeypatch):
    monkeypatch.setitem(history.MOST, LOG, 10)
    record = History()
    for i in range(1000):
        record.add(LOG, i, i)
    kept = record.after(LOG, 0, record.newest, 5000)
    assert 10 <= len(kept) <= 20
    assert kept[-1].what == 999


def test_gone_back_what_came_later_is_forgotten_and_told_anew():
    record = History()
    encoder = DeltaEncoder(record)
    for at in (100, 200, 300):
        record.add(SERIES, at, {"loss": at})
        record.add(LOG, at, {"type": "log", "text": str(at)})
    first = snapshot(record, t_s=0.0003)
    told(encoder, first)
    record.go_back(200)
    record.add(SERIES, 250, {"loss": 250})
    second = snapshot(record, first, t_s=0.00025)
    (state,) = told(encoder, second)
    assert state["back_s"] == 0.0002
    assert state["series"] == {"loss": [[0.00025, 250]]}
    late = DeltaEncoder(record)
    _scene, state, *lines = told(late, second)
    assert "back_s" not in state
    assert [value for _, value in state["series"]["loss"]] == [100, 200, 250]
    assert [line["text"] for line in lines] == ["100"]


def test_a_flood_of_lines_is_cut_short_until_something_else_is_done():
    record = History()
    book = Logbook(record)
    for _ in range(2):
        for i in range(100):
            book.often("lost", i, f"cell {i} lost its parent")
        book.calm()
    lines = [item.what["text"] for item in record.after(LOG, 0, record.newest, 1000)]
    assert len(lines) == 2 * (Logbook.FLOOD + 1)


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


def test_a_pace_goes_holds_and_changes():
    clock = Clock()
    playback = Playback(0.5, clock)
    clock.now += 2
    assert playback.due_us(10_000_000) == 1_000_000
    playback.hold(1_000_000)
    clock.now += 50
    assert playback.due_us(10_000_000) == 1_000_000
    playback.go(1_000_000)
    clock.now += 1
    assert playback.due_us(10_000_000) == 1_500_000
    playback.set_speed(2.0, 1_500_000)
    clock.now += 1
    assert playback.due_us(10_000_000) == 3_500_000
    assert playback.due_us(2_000_000) == 2_000_000
    playback.set_speed(0, 3_500_000)
    assert playback.due_us(10_000_000) == 10_000_000


def test_a_network_that_cannot_keep_up_is_waited_for():
    clock = Clock()
    playback = Playback(1.0, clock)
    clock.now += 5
    playback.note(1_000_000, playback.due_us(10_000_000))
    assert playback.due_us(10_000_000) == 1_000_000
    clock.now += 1
    assert playback.due_us(10_000_000) == 2_000_000


@pytest.mark.parametrize(("late_s", "waits"), [(0.2501, True), (0.2499, False)])
@pytest.mark.parametrize("speed", [0.1, 4.0])
def test_a_quarter_of_a_second_of_ours_is_caught_up(speed, late_s, waits):
    clock = Clock()
    playback = Playback(speed, clock)
    clock.now += 1
    due_us, late_us = playback.due_us(10_000_000), round(1e6 * late_s * speed)
    assert due_us == round(1e6 * speed)
    playback.note(due_us - late_us, due_us)
    assert playback.due_us(10_000_000) == due_us - late_us * waits
    playback.set_speed(0, 0)  # without a speed there is nothing to keep up with
    playback.note(0, 10_000_000)
    assert playback.due_us(10_000_000) == 10_000_000


@pytest.mark.parametrize("speed", [-1.0, 0.0009, 1e6 + 1, 1e7, float("nan"), float("inf")])
def test_speeds_have_limits(speed):
    with pytest.raises(Refused, match=r"0\.001"):
        Playback().set_speed(speed, 0)
    for at_limit in (0.001, 1_000_000.0, 0):
        Playback().set_speed(at_limit, 0)


def test_commands_are_read():
    assert parse('{"do":"cut","link":7}') == Cut(7)
    assert parse(b'{"do":"speed","value":1}') == Speed(1.0)
    assert parse('{"do":"pause"}') == Pause()
    assert (name_of(Pause()), name_of(Go()), name_of(Seek(1.0))) == ("pause", "pause", "seek")


@pytest.mark.parametrize(
    "text",
    ["", "{", "null", "[]", "7", '"cut"', '{"do":"cut"}', '{"do":"cut","link":"7"}',
     '{"do":"cut","link":1.5}', '{"do":"cut","link":1,"x":2}', '{"do":"quit"}', '{"link":1}',
     '{"do":"seek","t_s":1e999}', '{"do":"speed","value":NaN}', b"\xff\xfe", "[" * 5000,
     '{"do":"cut","link":' + "9" * 4000 + "}"],
)  # fmt: skip
def test_what_is_no_command_is_refused_in_one_line(text):
    with pytest.raises(Refused) as error:
        parse(text)
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 400


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=6), inner, max_size=3)
    ),
    max_leaves=6,
)
NAMES = st.sampled_from(["cut", "heal", "kill", "seek", "speed", "step", "touch", "save", "x"])
FIELDS = st.dictionaries(st.sampled_from(["link", "node", "value", "t_s", "do"]), VALUES)


@settings(max_examples=300, deadline=None)
@given(
    st.binary(max_size=200)
    | VALUES.map(json.dumps)
    | st.builds(lambda do, more: json.dumps({**more, "do": do}), NAMES, FIELDS)
)
def test_nothing_that_a_page_sends_raises_anything_else(text):
    try:
        command = parse(text)
    except Refused:
        return
    assert isinstance(command, Command)


HOPS = st.lists(st.integers(-1, 11), min_size=12, max_size=12)


@given(HOPS, st.sets(st.integers(0, 11)))
def test_chains_are_followed_to_their_roots(hops, roots):
    is_root = np.isin(np.arange(12), list(roots))
    root, depth = follow(np.array(hops), is_root)
    for start in range(12):
        node, steps = start, 0
        while node != -1 and node not in roots and steps <= 12:
            node, steps = hops[node], steps + 1
        there = node in roots
        assert root[start] == (node if there else -1)
        assert depth[start] == (steps if there else -1)


@given(st.sets(st.tuples(st.integers(0, 7), st.integers(0, 7))), st.sets(st.integers(0, 7)))
def test_what_can_be_reached_is_found(pairs, start):
    links = np.zeros((8, 8), bool)
    for a, b in pairs:
        links[a, b] = True
    found = set(start)
    for _ in range(8):
        found |= {b for a, b in pairs if a in found}
    assert set(np.flatnonzero(reach(links, np.isin(np.arange(8), list(start))))) == found


def test_where_nothing_changes_nothing_is_worked_out():
    made = simulated(SKIN)
    made.run_to_end()
    looked = []
    fields = made.fields
    made.fields = lambda: looked.append(1) or fields()
    stage = Stage(made, lambda snapshot: None)
    stage.start()
    answered = threading.Event()
    for _ in range(3):
        answered.clear()
        stage.submit(Cut(0), lambda answer: answered.set())  # refused: this is the end
        assert answered.wait(10)
    stage.stop()
    assert len(looked) < 12
