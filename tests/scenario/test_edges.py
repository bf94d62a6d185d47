"""Scenarios at the edges of what is read, refused, written and told."""

import os
import re
from types import SimpleNamespace as Of

import pytest

from innervate.scenario import ScenarioError, bundled, dump, from_dict, load, loads, plan
from innervate.scenario.cables import Happening, describe
from innervate.scenario.declared.shared import Input, check_values, inputs_of
from innervate.scenario.events import in_time, told
from innervate.scenario.overrides import parse_value
from innervate.scenario.source import Source, shown
from tests.fixtures.scenarios import one_port

RING = {"kind": "babel", "nodes": 4, "duration_s": 2.0}
SKIN = one_port(4, 3, "")


def findings(at_s, duration_s=2.0):
    return [message for _, message in in_time(0, at_s, duration_s)]


def test_an_event_happens_from_the_first_moment_to_just_before_the_last():
    assert findings(0.0) == findings(1.999) == findings((0.0, 1.999)) == []
    assert findings((1.0, 2.0)) == [
        "event.0.at_s = 2 is the end of the run, so it would never happen; make it earlier, or "
        "duration_s longer"
    ]
    assert findings((1.0, 2.5)) == ["event.0.at_s = 2.5 is outside the run; duration_s is 2"]
    assert findings((1.5, 1.0)) == ["event.0.at_s must be [from, to], not [1.5, 1]"]
    assert findings((1.0, 1.0)) == []


@pytest.mark.parametrize(("events", "last"), [
    (12, "at 1.2 s cut n0 E - n1 W"),
    (13, "and 1 more"),
    (14, "and 2 more"),
])  # fmt: skip
def test_twelve_events_are_told(events, last):
    event = [{"at_s": (k + 1) / 10, "action": "cut", "link": "n0-n1"} for k in range(events)]
    made = plan(from_dict(RING | {"event": event}))
    lines = list(told(made, lambda _, fault: f"at {fault.at_us / 1e6:g} s cut n0 E - n1 W", ()))
    assert len(lines) == min(events, 13)
    assert lines[0] == "  event      at 0.1 s cut n0 E - n1 W"
    assert lines[-1] == f"             {last}"


@pytest.mark.parametrize(("event", "words"), [
    ({"action": "loose", "link": "n0-n1"}, "at 1 s loose n0 E - n1 W, loss 0.5"),
    ({"action": "loose", "link": "n0-n1", "loss": 0.0}, "at 1 s loose n0 E - n1 W, loss 0"),
    ({"action": "restore", "link": "n0-n1"}, "at 1 s restore n0 E - n1 W"),
    ({"action": "lose", "link": "n0-n1", "frames": 2}, "at 1 s lose n0 E - n1 W, 2 frames"),
    ({"action": "kill", "node": 3}, "at 1 s kill n3"),
])  # fmt: skip
def test_the_loss_of_a_loose_cable_is_told_even_if_it_is_none(event, words):
    text = describe(plan(from_dict(RING | {"event": [{"at_s": 1.0, **event}]})))
    assert text.splitlines()[-1] == f"  event      {words}"


@pytest.mark.parametrize(("at_s", "every_s", "times"), [
    (0.2, 0.1, 6), (0.1, 0.7, 1), (0.2, 0.3, 2), (0.0, 0.3, 3), (0.7, 0.0, 1), (0.79, 0.1, 1),
])  # fmt: skip
def test_an_input_is_repeated_up_to_the_end_and_not_at_it(at_s, every_s, times):
    """0.8 - 0.2 s are 0.6 s, though not in binary numbers."""
    given = {"at_s": at_s, "every_s": every_s, "node": 2}
    inputs = plan(from_dict(RING | {"duration_s": 0.8, "input": [given]})).inputs
    assert [one.at_us for one in inputs] == [
        round(1e6 * (at_s + k * every_s)) for k in range(times)
    ]


def test_what_happens_to_a_node_is_told_it_as_its_network_says():
    """Among inputs, in order of time; what the medium does itself is none."""
    model = Of(duration_s=4.0, input=[Of(at_s=1.0, every_s=0.0, node=None, kind=1, item={"v": 2})],
               event=[Of(action="warm", at_s=2.5, node=0, value=9),
                      Of(action="kill", at_s=0.2, node=0, value=0),
                      Of(action="cool", at_s=0.5, node=1, value=4)])  # fmt: skip
    network = Of(happenings={
        "warm": lambda node, value: (3, {"node": node, "value": value}),
        "cool": lambda node, value: (5, {"of": (node, value)}),
    })  # fmt: skip
    found = inputs_of(model, network, 2, ("kill",))
    assert [type(one) for one in found] == [Happening, Input, Input, Happening]
    assert found == [
        Happening(500_000, 1, 5, {"of": (1, 4)}), Input(1_000_000, 0, 1, {"v": 2}),
        Input(1_000_000, 1, 1, {"v": 2}), Happening(2_500_000, 0, 3, {"node": 0, "value": 9}),
    ]  # fmt: skip


@pytest.mark.parametrize(("node", "there"), [(0, True), (3, True), (4, False), (-1, False)])
def test_the_node_of_an_event_is_one_of_them(node, there):
    tables = RING | {"event": [{"at_s": 1.0, "action": "kill", "node": node}]}
    if there:
        assert from_dict(tables).model.event[0].node == node
        return
    with pytest.raises(ScenarioError):
        from_dict(tables)


@pytest.mark.parametrize(("value", "words"), [
    ([1, 2], None),
    ([1], "a must be 2 numbers, not [1]"),
    ([1, 2, 3], "a must be 2 numbers, not [1, 2, 3]"),
    (1, "a must be 2 numbers, not 1"),
    ([0, 1], "a must be 1 to 9 V, not [0, 1]"),
    ([9, 10], "a must be 1 to 9 V, not [9, 10]"),
    ([9, 9], None),
])  # fmt: skip
def test_a_list_is_as_long_as_it_is_declared(value, words):
    declared = [("a", 2, 1, 9, "V", "")]
    if words is None:
        check_values(Source("", ""), ("input", 0), {"a": value}, declared)
        return
    with pytest.raises(ScenarioError, match=re.escape(words)):
        check_values(Source("", ""), ("input", 0), {"a": value}, declared)


def test_what_was_not_given_is_not_written():
    source = loads(SKIN + "\n[protocol]\nk = 3\n")
    text = dump(source, whole=False)
    assert "seed = 1" in text
    assert text.partition("[protocol]")[2].split() == ["k", "=", "3"]
    assert text.partition("[[patch]]")[2].partition("[[")[0].split() == [
        "columns", "=", "4", "rows", "=", "3",
    ]  # fmt: skip
    assert "rule =" in dump(source)


def test_a_comment_may_have_as_many_dots_as_it_likes():
    dots = "." * 1000
    assert loads(f"# a{dots}\n   # b{dots}\n{SKIN}").kind == "skin"
    with pytest.raises(ScenarioError, match="a key has more than"):
        loads(f"a{'.a' * 1000} = 1\n{SKIN}")


def test_a_folder_of_the_name_of_a_bundled_scenario_hides_it_not(tmp_path, monkeypatch):
    name = sorted(bundled())[0]
    (tmp_path / name).mkdir()
    monkeypatch.chdir(tmp_path)
    assert load(name).name == load(str(bundled()[name])).name
    os.rmdir(name)
    os.mkdir("other")
    with pytest.raises(ScenarioError, match="this is a folder"):
        load("other")


def test_four_of_a_list_are_shown():
    assert shown([1, 2, 3, 4]) == "[1, 2, 3, 4]"
    assert shown([1, 2, 3, 4, 5]) == "[1, 2, 3, 4, ...]"
    assert shown(("a" * 16,) * 2) == f'["{"a" * 16}", "{"a" * 16}"]'
    assert shown(["a" * 30] * 2) == "a list"
    assert shown("a" * 48) == f'"{"a" * 48}"'
    assert shown("a" * 49) == f'"{"a" * 45}..."'
    assert shown(10**20) == "1" + "0" * 20
    assert shown(-(10**21)) == "a number that long"


@pytest.mark.parametrize("name", ["a\0b", "a" * 5000])
def test_a_name_that_no_file_can_have_is_none(name):
    with pytest.raises(ScenarioError, match="no such file, and no bundled scenario"):
        load(name)


@pytest.mark.parametrize(("text", "value"), [
    ("2.5", 2.5), ("[1, 2]", [1, 2]), ("true", True), ("9x", "9x"), ('"9"', "9"),
    ("1\nw = 2", "1\nw = 2"), ("1\r\nw = 2", "1\r\nw = 2"), ("1\r", "1\r"),
    ("[1,\n2]", "[1,\n2]"),
])  # fmt: skip
def test_what_is_set_is_one_line_of_toml_or_a_text(text, value):
    assert parse_value(text) == value
