"""What is proved of any network, by protocols of a few lines: what handlers may be told."""

import ast
import re
import typing
from types import SimpleNamespace as Of

import pytest

from innervate.dialect.arith import MASK30
from innervate.prove import declared, execute
from innervate.prove.check import check
from innervate.prove.errors import ProveError
from innervate.prove.steps import SENT
from innervate.prove.tell import changes
from innervate.scenario.declared.shared import InputTable
from tests.prove.programs import ACTIONS

SOURCE = (
    ACTIONS
    + """
def on_start(state, params, now, cause, out):
    state.x = cause

def on_frame(state, params, now, port, frame, out):
    state.x = port

def on_timer(state, params, now, timer, out):
    state.x = timer

def on_input(state, params, now, kind, item, out):
    state.x = kind

def on_carrier(state, params, now, cd, voc, out):
    state.x = cd + voc

def on_sent(state, params, now, ok, out):
    state.x = ok

def of_one_that_sends(state, params, now, cd, voc, out):
    state.x = 2 * voc - cd + 1

def of_params(state, params, now, cause, out):
    params.z = params.z + 1

def of_what_came(state, params, now, port, frame, out):
    frame.y = frame.y - 1

def at_any_time(state, params, now, cause, out):
    state.x = now

def of_a_frame(state, params, now, port, frame, out):
    state.x = frame.y

def tell(state, params, now, kind, item, out):
    out.frame[send(out, 0, 0, 0)].y = item.y + 1

def hand_up(state, params, now, kind, item, out):
    out.frame[deliver(out, 1)].y = 2

def far(state, params, now, kind, item, out):
    out.frame[send(out, kind, 0, 0)].y = 7

def late(state, params, now, kind, item, out):
    set_timer(out, 1, now + 1)

def third(state, params, now, kind, item, out):
    set_timer(out, 2, now)

def often(state, params, now, timer, out):
    for i in range(params.z):
        report(out, 1, 2, 3)
"""
)
OUT = ("report", "send", "deliver", "set_timer")
NODES = {node.name: node for node in ast.parse(SOURCE).body}
KNOWN = {
    name: Of(name=name, node=node, path="m.py", constants={},
             module=execute.OUTBOX if name in OUT else "m", calls={one: one for one in NODES})
    for name, node in NODES.items()
}  # fmt: skip


def network(most=9, many=0, least=0, **protocol):
    """A network whose state has an x up to `most`, and which may send so many reports."""
    fields = Of(STATE=(("x", 0, least, most, "", ""),), FRAME=(("y", 0, 3, 7, "", ""),),
                PARAMS=(("z", 0, 0, many, "", ""),))  # fmt: skip
    return Of(name="some", protocol=Of(TIMERS=2, **protocol), fields=fields,
              has=lambda part: part in ("protocol", "fields"))  # fmt: skip


def refuted(made, handler, *told):
    step = declared._step(made, KNOWN, ("it happens", handler, list(told)))
    return [bad.goal.partition(" (")[0] for bad in check(step, reach=False).refuted]


RANGE = "every field stays in its declared range: state.x"


@pytest.mark.parametrize(
    ("handler", "told", "most"),
    [
        ("on_start", ["cause"], 1), ("on_frame", ["port", "frame"], 3), ("on_timer", [1], 1),
        ("on_input", ["kind", "frame"], 1 << 20), ("on_carrier", ["cd", "voc"], 2),
        ("on_sent", ["ok"], 1), ("at_any_time", ["cause"], MASK30),
        ("of_a_frame", ["port", "frame"], 7),
    ],
)  # fmt: skip
def test_what_a_handler_is_told_may_be_anything_up_to_its_most(handler, told, most):
    assert refuted(network(most), handler, *told) == []
    assert refuted(network(most - 1), handler, *told) == [RANGE]


@pytest.mark.parametrize(("handler", "told"), [
    ("on_start", ["cause"]), ("on_frame", ["port", "frame"]), ("on_timer", [0]),
    ("on_input", ["kind", "frame"]), ("at_any_time", ["cause"]), ("on_carrier", ["cd", "voc"]),
    ("on_sent", ["ok"]),
])  # fmt: skip
def test_what_a_handler_is_told_may_be_nothing(handler, told):
    assert refuted(network(MASK30, least=1), handler, *told) == [RANGE]


@pytest.mark.parametrize(("handler", "words"), [
    ("tell", "y of a frame that tell sends is 8, declared 3 to 7"),
    ("hand_up", "y of a frame that hand_up delivers is 2, declared 3 to 7"),
    ("far", r"far sends a frame on port ([4-9]|\d\d+)"),
    ("late", "late sets timer 1 to 1073741824, which is no reading of a clock"),
    ("third", "third sets timer 2, and there are 2"),
])  # fmt: skip
def test_what_is_sent_and_set_beyond_its_range_is_named(handler, words):
    step = declared._step(network(), KNOWN, ("it happens", handler, ["kind", "frame"]))
    (bad,) = check(step, changes, reach=False).refuted
    assert bad.goal == SENT
    assert re.fullmatch(f"This breaks: {SENT}: {words}.", bad.sentences[-1])


def test_an_outbox_holds_what_its_protocol_says_or_sixteen():
    for more, room in (({}, 16), ({"OUTBOX": 5}, 5)):
        assert refuted(network(many=room, **more), "often", 0) == []
        assert refuted(network(many=room + 1, **more), "often", 0) == ["the outbox has room"]


def test_everything_happens_that_the_protocol_knows():
    usual = [("on_start", ["cause"]), ("on_frame", ["port", "frame"]), ("on_timer", [0]),
             ("on_timer", [1])]  # fmt: skip
    assert [what[1:] for what in declared._events(network())] == usual
    for handler, told in (("on_input", ["kind", "frame"]), ("on_carrier", ["cd", "voc"]),
                          ("on_sent", ["ok"])):  # fmt: skip
        found = [what[1:] for what in declared._events(network(**{handler: None}))]
        assert found == [*usual, (handler, told)]


def test_where_one_sends_and_no_more_somebody_does():
    assert refuted(network(2), "of_one_that_sends", "cd", "voc") == []
    assert refuted(network(1), "of_one_that_sends", "cd", "voc") == [RANGE]


@pytest.mark.parametrize(("handler", "told", "field"), [
    ("of_params", ["cause"], "params.z"), ("of_what_came", ["port", "frame"], "frame.y"),
])  # fmt: skip
def test_what_a_handler_is_told_stays_in_its_range_too(handler, told, field):
    assert refuted(network(many=3), handler, *told) == [
        f"every field stays in its declared range: {field}"
    ]


def test_a_scenario_hands_in_kinds_up_to_the_most_that_is_proved():
    (limit,) = typing.get_type_hints(InputTable, include_extras=True)["kind"].__metadata__
    assert limit.le == declared.KIND_MAX


@pytest.mark.parametrize("lacks", ["protocol", "fields"])
def test_without_a_declared_protocol_nothing_is_proved(lacks):
    made = network()
    made.has = lambda part: part != lacks
    with pytest.raises(ProveError, match="some declares no protocol"):
        declared.theories(made)
