"""The explorer of any network over cables: on a token ring that is right, and on wrong ones."""

from types import SimpleNamespace

import pytest

from innervate.cli.options import VerifyOptions
from innervate.verify import declared
from innervate.verify.errors import VerifyError
from tests.networks.tokenring import fields, protocol


def never(part):
    return False


def explored(budget="", graph="ring", states=3_000, protocol=protocol, fields=fields):
    """The case of one graph."""
    parts = {"protocol": protocol, "fields": fields, "has": never}
    network = SimpleNamespace(name="tokenring", medium="cables", **parts)
    options = VerifyOptions(budget=budget, graph=graph, states=states)
    (explore,) = declared.explorations(network, options)
    return explore(lambda what, part, of: False)


def changed(module, **names):
    return SimpleNamespace(**{**vars(module), **names})


def test_nothing_is_broken_in_what_is_right():
    case = explored()
    assert not case.is_broken
    assert case.record["ended"] == "limit"
    assert case.record["states"] >= 3_000
    assert "as asked" in case.lines[0]


def test_a_value_out_of_its_range_is_found_on_the_shortest_way():
    state = [field if field[0] != "passed" else ("passed", 0, 0, 2, "tokens", "")
             for field in fields.STATE]  # fmt: skip
    case = explored("loss=0,restart=0", fields=changed(fields, STATE=state))
    assert case.story.title == "passed is out of its declared range"
    assert case.story.sentences == [
        f"Timer 1 of n0 fires: lap {n} to {n + 1}, passed {n} to {n + 1}." for n in range(3)
    ]
    assert case.lines[-1] == "    So: passed is out of its declared range"


def test_a_ring_that_ends_for_ever_is_found():
    def on_timer(node, params, now, timer, out):
        lost = params.lost_us
        protocol.on_timer(node, params, now, timer, out)
        for act in out.action[: out.count[0]]:
            if act.kind == 2 and act.b == now + lost:  # nobody mends the loss
                act.kind, act.a, act.b = 4, 0, 0

    case = explored("restart=0", protocol=changed(protocol, on_timer=on_timer))
    assert case.story.title == declared.STUCK
    assert case.story.sentences[-1].endswith("is lost.")
    wrong = changed(protocol, on_timer=on_timer)
    assert not explored("loss=0,restart=0", states=300, protocol=wrong).is_broken


def quiet(node, params, now, cause, out):
    """A start that sets no timer."""


def test_who_waits_for_its_user_from_the_start_may_be_still():
    waits = changed(protocol, on_start=quiet)
    asked = changed(fields, GIVEN=((1, {}),))
    assert not explored("input=1", states=300, protocol=waits, fields=asked).is_broken
    case = explored("input=1", states=300, protocol=waits)  # and nobody ever asks
    assert case.story.title == declared.STUCK


@pytest.mark.parametrize(
    ("action", "title"),
    [
        ((1, 4, 0, 0), "a frame is sent on a port that no node has"),
        ((2, 2, 0, 0), "there is no such timer"),
        ((9, 0, 0, 0), "the outbox holds what is no action"),
    ],
)
def test_an_action_that_nobody_can_carry_out_is_found(action, title):
    def on_start(node, params, now, cause, out):
        act = out.action[0]
        act.kind, act.a, act.b, act.c = action
        out.frame[0].kind = out.frame[0].lap = 1
        out.count[0] = 1

    assert explored(protocol=changed(protocol, on_start=on_start)).story.title == title


def test_what_must_hold_of_all_is_looked_at_as_they_are_switched_on(monkeypatch):
    rules = {"nobody holds a token": lambda nodes, count, params: 0}
    monkeypatch.setattr(declared, "invariants_of",
                        lambda network, prefix: rules if prefix == "network_" else {})  # fmt: skip
    story = explored().story
    assert story.title == "nobody holds a token"
    assert story.sentences == ["All nodes are switched on."]


def test_an_outbox_that_overflows_is_found():
    case = explored(protocol=changed(protocol, OUTBOX=1))
    assert case.story.title == "an outbox overflowed"


def test_mistakes_are_told():
    with pytest.raises(VerifyError, match="the names are loss, restart"):
        explored("cut=1")
    with pytest.raises(VerifyError, match="--graph"):
        explored(graph="n0-")


def test_an_error_in_a_handler_names_file_line_and_field():
    def on_frame(node, params, now, port, frame, out):
        node.lap = frame.lab

    line = on_frame.__code__.co_firstlineno + 1
    case = explored("", protocol=changed(protocol, on_frame=on_frame))
    assert case.story.title == (
        "a handler cannot go on: tests/networks/tokenring/test_verify.py:"
        f"{line}: lab is no field that fields.py declares"
    )


def test_an_error_in_an_invariant_names_file_line_and_field():
    def node_is_well(node, params, now):
        """a node is ill"""
        return node.temperature < 37

    rules = SimpleNamespace(node_is_well=node_is_well)
    network = SimpleNamespace(name="tokenring", medium="cables", protocol=protocol, fields=fields,
                              invariants=rules, has=lambda part: part == "invariants")  # fmt: skip
    (explore,) = declared.explorations(network, VerifyOptions(graph="pair", states=10))
    case = explore(lambda what, part, of: False)
    line = node_is_well.__code__.co_firstlineno + 2
    assert f"test_verify.py:{line}: temperature is no field" in case.lines[0] + case.lines[-1]
