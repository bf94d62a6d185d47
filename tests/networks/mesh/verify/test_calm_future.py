"""What becomes of a mesh in which nothing fails any more, of states that are set by hand."""

from types import SimpleNamespace as Of
from typing import NamedTuple

import pytest

from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol.standby import IN_VAIN
from innervate.networks.mesh.verify import fair as mesh_fair
from innervate.networks.mesh.verify.fair import End, Fair
from innervate.networks.mesh.verify.local import (
    BROKEN_DEPOSED,
    BROKEN_ENDLESS,
    BROKEN_GATEWAYS,
    BROKEN_TWICE,
    BROKEN_UNHEARD,
    NONE,
)
from innervate.networks.mesh.verify.net import DEAD

CALM = (0, 0, 0, 0)
LATE_US = 30 * 100


class Net(NamedTuple):
    """A state: the numbers of its nodes, what may fail, what came, and how late it is."""

    nodes: tuple[int, ...]
    left: tuple[int, int, int, int] = (1, 1, 1, 1)
    ticks: tuple[int, ...] = (5, 5, 5)
    got: int = 0
    at: int = 0


NOTHING = {"wait_kind": [0, 0], "q_kind": [const.DATA, 0], "q_state": [0, 0],
           "wait_dest": [0, 0], "wait_tries": [0, 0], "wait_seq": [0, 0],
           "leading": 0, "gateway": 0}  # fmt: skip


def waits(dest=2, tries=0, kind=const.DATA):
    """A node with a message in its second place, which it is to send again."""
    return NOTHING | {"wait_kind": [0, kind], "wait_dest": [0, dest], "wait_tries": [9, tries],
                      "wait_seq": [0, 7]}  # fmt: skip


def fair_of(records, *, beats=0, steps=(), waits_us=(), sets=((),), **keys):
    """Calm futures of a line of three; of a state, its time says what follows: (what came, what
    is broken); None nothing."""

    def steady(net):
        assert net.left == CALM
        told.append(net)
        if net.at >= len(steps):
            return None
        got, broken, nodes = (*steps[net.at], net.nodes)[:3]
        return "move", net._replace(got=got, at=net.at + 1, nodes=nodes), broken

    told = []
    nets = Of(
        n=3, sets=[frozenset(one) for one in sets], told=told, steady=steady,
        pack=lambda net: repr(net).encode(), calm_beats=lambda: 30,
        soonest=lambda net: (waits_us[net.at], 0, 0),
        model=Of(beats=beats, links=((0, 1), (1, 2)),
                 budget=Of(deaths=1, frames=keys.pop("frames", 2))),
        locals=Of(field=lambda number, name: records[number][name], ranks=[0, -1, 1],
                  params=Of(e2e_tries=2, tick_us=100, guard_us=keys.pop("guard_us", 1))),
    )  # fmt: skip
    return Fair(nets)


ROW = (2, 0, 7, const.DATA)


@pytest.mark.parametrize(("nodes", "records", "wanted"), [
    ((0, 1, 1), (waits(), NOTHING), {ROW}), ((0, 1, 1), (waits(tries=2), NOTHING), {ROW}),
    ((0, 1, 1), (waits(tries=3), NOTHING), set()), ((0, 1, 1), (waits(kind=0), NOTHING), set()),
    ((0, 1, DEAD), (waits(), NOTHING), set()), ((0, DEAD, 1), (waits(), NOTHING), set()),
    ((0, 1, 1), (waits(dest=3), NOTHING), set()), ((0, 1, 1), (waits(dest=255), NOTHING), set()),
    ((DEAD, 1, 1), (waits(), NOTHING), set()), ((1, 1, 0), (waits(dest=0), NOTHING),
                                               {(0, 2, 7, const.DATA)}),
    ((0, DEAD, 1), (waits(dest=1), NOTHING), set()),
    ((0, 1, DEAD), (waits(dest=1), NOTHING), {(1, 0, 7, const.DATA)}),
])  # fmt: skip
def test_a_message_is_wanted_that_is_sent_again_to_who_lives_and_is_connected(
    nodes, records, wanted
):
    assert fair_of(records)._wanted(Net(nodes)) == wanted


def test_what_came_already_is_not_wanted():
    fair = fair_of((waits(), NOTHING), sets=((), (ROW,)))
    assert fair._wanted(Net((0, 1, 1), got=1)) == set()


@pytest.mark.parametrize(("node", "is_quiet"), [
    ({}, True), ({"wait_kind": [0, const.DATA]}, False), ({"wait_kind": [const.ALARM, 0]}, False),
    ({"q_state": [1, 0]}, False), ({"q_state": [0, 1]}, True),
    ({"q_state": [0, 2], "q_kind": [0, const.E2E_ACK]}, False),
    ({"q_state": [0, 2], "q_kind": [0, const.ALARM]}, False),
    ({"q_state": [1, 1], "q_kind": [const.TABLE, const.REQUEST]}, True),
])  # fmt: skip
def test_it_is_quiet_where_no_message_is_kept_or_under_way(node, is_quiet):
    fair = fair_of((NOTHING | node, NOTHING))
    assert fair._is_quiet(Net((1, 0, DEAD))) == is_quiet
    assert fair._is_quiet(Net((1, DEAD, 1)))


def test_a_message_that_comes_in_the_end_is_heard_and_events_are_counted():
    fair = fair_of((waits(), NOTHING), steps=((0, 0), (1, 0, (1, 1, 1))), sets=((), (ROW,)))
    begun = Net((0, 1, 1), (1, 2, 3, 4))
    assert fair.check(begun) == 0
    assert (fair.longest, len(fair.ends), len(fair.nets.told)) == (2, 3, 2)
    assert fair.nets.told[0] == begun._replace(left=CALM, ticks=(1 << 20,) * 3)
    assert [(end.broken, end.got, end.events) for end in fair.ends.values()] == [
        (0, 1, 0), (0, 1, 1), (0, 1, 2)]  # fmt: skip
    assert fair.check(Net((0, 1, 1), (0, 0, 0, 0))) == 0, "what may fail does not matter"
    assert len(fair.nets.told) == 2, "it is not played again"
    assert fair.check(Net((0, 1, 1), at=1)) == 0
    assert fair.longest == 2


def test_a_message_that_never_comes_is_told():
    fair = fair_of((waits(), NOTHING), steps=((0, 0, (1, 1, 1)),))
    assert fair.check(Net((0, 1, 1))) == BROKEN_UNHEARD


def test_what_breaks_on_the_way_is_told_and_known_from_then_on():
    fair = fair_of((waits(), NOTHING), steps=((0, 0), (0, BROKEN_TWICE)), sets=((), (ROW,)))
    assert fair.check(Net((0, 1, 1))) == BROKEN_TWICE
    assert [end.events for end in fair.ends.values()] == [0, 1]
    assert fair.check(Net((0, 1, 1), at=1)) == BROKEN_TWICE
    assert (len(fair.nets.told), fair.longest) == (2, 1)


def test_what_has_no_end_is_told(monkeypatch):
    monkeypatch.setattr(mesh_fair, "EVENTS_MAX", 3)
    fair = fair_of((waits(), NOTHING), steps=((0, 0),) * 9)
    assert fair.check(Net((0, 1, 1))) == BROKEN_ENDLESS
    assert fair.longest == 3
    fair = fair_of((LEADS, FOLLOWS, NOTHING), beats=4, steps=((0, 0),) * 9, waits_us=(1,) * 9)
    assert fair.check(Net((0, 1, 1))) == BROKEN_ENDLESS
    assert len(fair.ends) == 3


LEADS = NOTHING | {"leading": 1}
FOLLOWS, ASTRAY = NOTHING | {"gateway": 0}, NOTHING | {"gateway": 2}
LEADS_TOO = LEADS | {"gateway": 2}


@pytest.mark.parametrize(("nodes", "disagree"), [
    ((0, 1, 1), False), ((0, 1, 2), True), ((0, 2, 1), True), ((0, 1, 3), True),
    ((1, 1, 1), True), ((DEAD, 2, 3), False), ((DEAD, 1, 3), True), ((0, DEAD, 3), False),
    ((0, DEAD, 1), True), ((0, 1, DEAD), False), ((DEAD, 1, DEAD), False),
    ((DEAD, DEAD, DEAD), False), ((0, 2, DEAD), True),
])  # fmt: skip
def test_those_that_are_connected_follow_one_gateway_among_them(nodes, disagree):
    """Where none of them may lead, nobody need; node 0 and node 2 may."""
    fair = fair_of((LEADS, FOLLOWS, ASTRAY, LEADS_TOO))
    assert fair._disagree(Net(nodes)) == disagree


def quarrels(flags, waits_us, more=(), broken_at=None):
    """The end of a calm time at whose beginnings they disagree, or do not."""
    records = (LEADS, FOLLOWS, ASTRAY)
    nodes = [(0, 1, 2) if flag else (0, 1, 1) for flag in flags]
    steps = tuple((0, 0, after) for after in (*nodes[1:], (0, 1, 1)))
    if broken_at is not None:
        steps = (*steps[:broken_at], (0, BROKEN_TWICE))
    fair = fair_of(records, beats=4, steps=steps, waits_us=(*waits_us, 0), **dict(more))
    return fair, fair.check(Net(nodes[0], (1, 1, 2, 1)))


@pytest.mark.parametrize(("flags", "waits_us", "longest", "broken"), [
    ((0, 0, 0), (5, 7, 11), 0, 0), ((1, 0, 0), (5, 7, 11), 5, 0), ((1, 1, 0), (5, 7, 11), 12, 0),
    ((0, 0, 1), (5, 7, 11), 23, 0), ((0, 1, 0), (5, 7, 11), 12, 0),
    ((0, 1, 0), (1000, 2000, 1), LATE_US, 0), ((0, 1, 0), (1000, 2001, 1), 3001, BROKEN_GATEWAYS),
    ((1, 0, 0), (3001, 1, 1), 3001, BROKEN_GATEWAYS),
])  # fmt: skip
def test_the_last_quarrel_is_over_when_the_next_event_ends_it(flags, waits_us, longest, broken):
    fair, found = quarrels(flags, waits_us)
    assert (fair.longest, found) == (longest, broken)
    assert len(fair.ends) == len(flags)


def test_of_gateways_too_what_is_known_is_not_played_again():
    fair, _ = quarrels((0, 1, 0), (5, 7, 11))
    assert [end.events for end in fair.ends.values()] == [NONE, 7, 12]
    known = len(fair.nets.told)
    assert fair.check(Net((0, 1, 1), (1, 0, 2, 0))) == 0
    assert (len(fair.nets.told), fair.longest) == (known, 12)


def test_what_breaks_in_a_calm_time_is_told():
    fair, found = quarrels((0, 0, 0), (5, 7, 11), broken_at=1)
    assert found == BROKEN_TWICE
    assert list(fair.ends.values()) == [End(BROKEN_TWICE, 0, 7), End(BROKEN_TWICE, 0, 12)]


@pytest.mark.parametrize(("nodes", "left", "guard_us", "is_deposed"), [
    ((1, 0, 1), (1, 1, 2, 1), 1, True), ((1, 1, 0), (1, 1, 2, 1), 1, True),
    ((0, 1, 1), (1, 1, 2, 1), 1, False), ((1, 0, 1), (0, 1, 2, 1), 1, False),
    ((1, 0, 1), (1, 1, 2, 1), 0, False), ((1, 0, 1), (1, 0, 2, 0), 1, True),
])  # fmt: skip
def test_who_leads_beside_a_gateway_that_lives_has_deposed_it(nodes, left, guard_us, is_deposed):
    fair = fair_of((LEADS, FOLLOWS), beats=4, guard_us=guard_us, waits_us=(0,))
    assert fair._is_deposed(Net(nodes, left)) == is_deposed
    if is_deposed:
        assert fair.check(Net(nodes, left)) == BROKEN_DEPOSED


@pytest.mark.parametrize(("lost", "is_deposed"), [(IN_VAIN - 1, True), (IN_VAIN, False)])
def test_who_asked_in_vain_may_think_that_it_is_dead(lost, is_deposed):
    fair = fair_of((LEADS, FOLLOWS), beats=4, frames=IN_VAIN + 2)
    assert fair._is_deposed(Net((1, 0, 1), (1, 1, IN_VAIN + 2 - lost, 1))) == is_deposed
