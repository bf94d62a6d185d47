"""The time of a node that is explored: it passes until what is due next, and not between."""

from types import SimpleNamespace

import pytest

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import send, set_timer
from innervate.dialect.rng import draw
from innervate.verify import declared
from innervate.verify.graphs import graph_of
from innervate.verify.states import happen

STATE = (("at", 0, 0, MASK30, "us", "a moment"), ("left", 0, 0, 99, "us", "until it"))
FIELDS = SimpleNamespace(STATE=STATE, FRAME=(), PARAMS=())
MOMENT = 50


def started(*timers, delays=()):
    """A node that keeps a moment, sets timers to so long from now, and sends frames so late."""

    def on_start(node, params, now, cause, out):
        node.at = (now + MOMENT) & MASK30
        for timer, wait in enumerate(timers):
            set_timer(out, timer, (now + wait) & MASK30)
        for delay in delays:
            send(out, 0, delay, 0)

    def on_timer(node, params, now, timer, out):
        node.left = (node.at - now) & MASK30

    protocol = SimpleNamespace(
        on_start=on_start, on_timer=on_timer, on_frame=lambda *_: None, TIMERS=2, OUTBOX=4
    )
    net = declared.Net(protocol, FIELDS, graph_of("pair"), {})
    return net, net.begin(declared.Budget()).state


@pytest.mark.parametrize("waits", [(0,), (1,), (7, 9), (9, 7), (0, 0), (5, 5)])
def test_a_timer_fires_when_it_is_due_and_time_has_passed_so_far(waits):
    net, state = started(*waits)
    first = min(waits)
    (move,) = net.due(state, 0)
    assert move.words == f"Timer {waits.index(first)} of n0 fires"
    step = happen(move)
    at, left = step.state.nodes[0].values
    assert (at, left) == (MOMENT - first, MOMENT - first)
    assert step.state.nodes[0].timers == tuple(
        (timer, wait - first) for timer, wait in enumerate(waits) if timer != waits.index(first)
    )
    assert step.state.nodes[1] == state.nodes[1]


def explored(wait_of):
    """Two nodes whose timer, when it fires, is set anew to `wait_of(node)` from now."""

    def on_start(node, params, now, cause, out):
        node.left = 0
        set_timer(out, 0, (now + 5) & MASK30)

    def on_timer(node, params, now, timer, out):
        node.left = (node.left + 1) % 100
        set_timer(out, 0, (now + wait_of(node)) & MASK30)

    drawn = (("rng", 0, 1, 1 << 30, "raw", ""), ("choice", 0, -1, 1 << 30, "raw", ""),
             ("asked", 0, 0, 1 << 30, "raw", ""))  # fmt: skip
    fields = SimpleNamespace(STATE=STATE + drawn, FRAME=(), PARAMS=())
    protocol = SimpleNamespace(
        on_start=on_start, on_timer=on_timer, on_frame=lambda *_: None, TIMERS=1, OUTBOX=4
    )
    net = declared.Net(protocol, fields, graph_of("pair"), {})
    return net, declared.explore(net, declared.Budget(restart=0), 400, lambda *_: False, "pair")


@pytest.mark.parametrize("wait_of", [lambda _node: 0, lambda _node: -3,
                                     lambda node: 7 * (node.left == 0)])  # fmt: skip
def test_who_sets_a_timer_at_once_for_ever_lets_time_stand_still(wait_of):
    _net, (tally, story) = explored(wait_of)
    if wait_of(SimpleNamespace(left=0)) > 0:  # every hundredth time only
        assert not story.title
        return
    assert tally.ended == "broken"
    assert story.title == (
        "on_timer of n0 sets a timer that is due at once, again and again: time stands still"
    )
    assert story.sentences[0].startswith("Timer 0 of n0 fires")


def test_who_may_draw_no_wait_goes_on_and_what_was_looked_at_is_noted_nowhere():
    net, (_tally, story) = explored(lambda node: draw(node, 4))
    assert not story.title
    assert (net.draws.sizes, net.draws.some) == ({4}, set())


@pytest.mark.parametrize(("wait", "delays", "words"), [
    (5, (3, 8), ["A delayed frame of n0 leaves"]), (3, (5,), ["Timer 0 of n0 fires"]),
    (4, (4,), ["Timer 0 of n0 fires", "A delayed frame of n0 leaves"]),
])  # fmt: skip
def test_what_is_due_first_comes_first_and_at_once_in_either_order(wait, delays, words):
    net, state = started(wait, delays=delays)
    steps = list(map(happen, net.due(state, 0)))
    assert [step.words for step in steps] == words
    for step in steps:
        passed = min(wait, *delays)
        assert step.state.nodes[0].values[0] == MOMENT - passed
        assert step.state.nodes[1] == state.nodes[1]


@pytest.mark.parametrize(("name", "unit", "high", "moves"), [
    ("at", "us", MASK30, True), ("at", "us ahead", MASK30, False), ("at", "us", MASK30 - 1, False),
    ("made_at", "us", MASK30, False),
])  # fmt: skip
def test_a_reading_of_the_clock_moves_as_time_passes_and_an_offset_does_not(
    name, unit, high, moves
):
    """`innervate docs own-network` says by what one is known."""

    def on_start(node, params, now, cause, out):
        setattr(node, name, MOMENT)
        set_timer(out, 0, (now + 20) & MASK30)

    fields = SimpleNamespace(STATE=((name, 0, 0, high, unit, ""),), FRAME=(), PARAMS=())
    protocol = SimpleNamespace(on_start=on_start, on_timer=lambda *_: None, TIMERS=1)
    net = declared.Net(protocol, fields, graph_of("pair"), {})
    (move,) = net.due(net.begin(declared.Budget()).state, 0)
    assert happen(move).state.nodes[0].values == (MOMENT - 20 if moves else MOMENT,)
