"""A handler that does something else at another reading of its clock is named."""

import json
from types import SimpleNamespace

import pytest

from innervate.cli import main
from innervate.dialect.arith import MASK30, after
from innervate.dialect.outbox import report, send, set_timer
from innervate.dialect.rng import draw
from innervate.verify import declared
from innervate.verify.graphs import graph_of
from innervate.verify.readings import Readings
from innervate.verify.states import happen
from tests.own import alone, own

__all__ = ["alone", "own"]

CLOCK = (0, 0, MASK30)
STATE = (
    ("at", *CLOCK, "us", ""),
    ("met", 2, 0, MASK30, "us", ""),
    ("value", 0, 0, 99, "", ""),
    ("rng", *CLOCK, "", ""),
    ("choice", 0, -1, MASK30, "", ""),
    ("asked", *CLOCK, "", ""),
)
FIELDS = SimpleNamespace(STATE=STATE, FRAME=(("kind", 0, 0, 9, "", ""),), PARAMS=())


def keeps(node, params, now, out):
    node.at, node.met[1] = (now + 7) & MASK30, now
    node.value = ((now - node.met[0]) & MASK30) % 5 + draw(node, 3)
    out.frame[send(out, 0, 0, 0)].kind = 1 + after(now, node.at)
    report(out, 1, now, 0)


def resets(node, params, now, out):
    node.at = 0


def divides(node, params, now, out):
    node.value = now // 1000 % 100


def passes(node, params, now, out):
    node.value = now > 300_000


def says(node, params, now, out):
    out.frame[send(out, 0, 0, 0)].kind = now & 7


def sets(node, params, now, out):
    set_timer(out, 1, 500)


def fails(node, params, now, out):
    node.value = 1 // (now < 1000)


@pytest.mark.parametrize(("does", "apart"), [
    (keeps, False), (resets, False), (divides, True), (passes, True), (says, True), (sets, True),
    (fails, True),
])  # fmt: skip
def test_a_handler_that_looks_at_its_clocks_reading_is_named(does, apart):
    def on_start(node, params, now, cause, out):
        set_timer(out, 0, (now + 20) & MASK30)

    def on_timer(node, params, now, timer, out):
        does(node, params, now, out)

    protocol = SimpleNamespace(
        on_start=on_start, on_timer=on_timer, on_frame=lambda *_: None, TIMERS=2, OUTBOX=4
    )
    net = declared.Net(protocol, FIELDS, graph_of("pair"), {})
    net.readings = Readings(net)
    (move,) = net.due(net.begin(declared.Budget()).state, 0)
    step = happen(move)
    assert not step.broken
    assert net.readings.apart == ({"on_timer"} if apart else set())
    assert bool(net.readings.words()) == apart
    assert step.state == happen(move).state


def test_programs_are_told_which_handlers_these_are(own, capsys):
    wanted = ["verify", str(own.folder), "--graph", "pair", "--states", "40", "--json"]
    assert main(wanted) == 0
    assert [one["readings"] for one in json.loads(capsys.readouterr().out)] == [[]]
    own.change("protocol.py", "    node.value = item.value\n", "    node.value = now // 1000 & 7\n")
    assert main(wanted) == 0
    assert [one["readings"] for one in json.loads(capsys.readouterr().out)] == [["on_input"]]
