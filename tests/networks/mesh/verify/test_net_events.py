"""What can happen next in a mesh, of nodes that are played by hand: who is told what, and when."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol.queue import UNACKED
from innervate.networks.mesh.verify import local
from innervate.networks.mesh.verify.local import NEVER, NONE, Outcome
from innervate.networks.mesh.verify.model import MeshBudget, MeshModel
from innervate.networks.mesh.verify.net import (
    AIR,
    DEAD,
    DIE,
    FIRE,
    OFFER,
    OUTSIDE,
    REVIVE,
    Move,
    Net,
    Nets,
)

LINE = ((0, 1), (1, 2))
QUIET = (NEVER,) * const.TIMERS
AHEAD = 10  # so much more is the number of a state after a call


def timers(**due):
    return tuple(due.get(f"t{timer}", NEVER) for timer in range(const.TIMERS))


class Nodes:
    """Node states by number; a call is noted, and leads to the number AHEAD, or to what is said."""

    def __init__(self):
        self.states, self.packets, self.said, self.asked = {}, [], {}, []
        self.records = {}
        self.params = Of(dead=3, dead_step=2, period=4)

    def call(self, number, event, elapsed):
        self.asked.append((number, event, elapsed))
        usual = (Outcome(number + AHEAD, (), (), 0, ()),)
        return self.said.get((number, event), usual)

    def start(self, who, boots):
        return Outcome(1000 + 10 * who + boots, (), (), 0, ())

    def field(self, number, name):
        return self.records[number][name]


def net(nodes=(0, 1, 2), lags=(0, 0, 0), left=(0, 0, 0, 0), ticks=(9, 9, 9), offered=0, got=0):
    return Net(nodes, lags, left, ticks, offered, got)


@pytest.fixture
def nodes():
    made = Nodes()
    for number in range(60):
        made.states[number] = Of(handed=NONE, timers=QUIET)
    return made


def nets(nodes, links=LINE, **keys):
    return Nets(MeshModel(links, "search", **{"overhear": False} | keys), nodes)


def packet(link_dst, link_src=1, origin=1, seq=7, kind=const.DATA, flags=0):
    return Of(link_dst=link_dst, link_src=link_src, origin=origin, seq=seq, kind=kind, flags=flags)


def test_neighbours_are_those_of_both_ends_in_order(nodes):
    assert nets(nodes, ((1, 2), (0, 2), (0, 1))).neighbours == [[1, 2], [0, 2], [0, 1]]


def test_a_calm_time_is_as_long_as_all_standbys_wait_one_after_the_other(nodes):
    assert nets(nodes).calm_beats() == 3 + 4 + 2
    assert nets(nodes, standby=(1, 2)).calm_beats() == 3 + 2 * 2 + 4 + 2


def test_the_next_event_is_the_nearest_of_those_that_live_or_a_frame(nodes):
    made = nets(nodes)
    nodes.states[0] = Of(handed=NONE, timers=timers(t1=50, t2=40))
    nodes.states[1] = Of(handed=NONE, timers=timers(t0=60))
    nodes.states[2] = Of(handed=NONE, timers=timers(t3=30))
    assert made.soonest(net()) == (30, 2, 3)
    assert made.soonest(net(lags=(0, 35, 0))) == (25, 1, 0)
    assert made.soonest(net(lags=(15, 0, 5))) == (25, 0, 2)
    assert made.soonest(net(lags=(20, 0, 0))) == (20, 0, 2)
    assert made.soonest(net(lags=(45, 0, 0))) == (0, 0, 2), "what is late is now"
    assert made.soonest(net((DEAD, 1, DEAD))) == (60, 1, 0)
    assert made.soonest(net((DEAD, 3, DEAD))) == (1 << 40, NONE, NONE)
    nodes.states[1] = Of(handed=4, timers=timers(t0=60))
    assert made.soonest(net()) == (0, 1, NONE)
    assert made.soonest(net((0, DEAD, 2))) == (30, 2, 3)


def test_of_a_nodes_timers_the_nearest_come_first_and_beats_only_while_there_are_some(nodes):
    made = nets(nodes)
    nodes.states[1] = Of(handed=NONE, timers=timers(**{f"t{const.TICK}": 5, "t0": 7, "t4": 7}))
    assert made.next_timers(net(), 1) == [const.TICK]
    assert made.next_timers(net(ticks=(9, 0, 9)), 1) == [0, 4]
    assert made.next_timers(net(ticks=(9, 1, 9)), 1) == [const.TICK]
    assert made.next_timers(net(), 2) == []


def test_a_message_is_handed_to_its_node_and_then_the_alarm(nodes):
    made = nets(nodes, offers=((2, 0), (1, 0)), robot=1)
    for offered, who, event, kind in ((0, 2, (local.MESSAGE, 0, 0), OFFER),
                                      (1, 1, (local.MESSAGE, 0, 1), OFFER),
                                      (2, 1, (local.SAMPLE,), OUTSIDE)):  # fmt: skip
        nodes.asked.clear()
        ((move, after, broken),) = made.offers(net(offered=offered))
        assert (move, broken) == (Move(kind, who, offered), 0)
        assert nodes.asked == [(who, event, 0)]
        assert (after.nodes[who], after.offered) == (who + AHEAD, offered + 1)
    assert made.offers(net(offered=3)) == []
    assert nets(nodes, offers=((2, 0),)).offers(net(offered=1)) == []
    ((move, after, _),) = made.offers(net((0, 1, DEAD)))
    assert (move, after) == (Move(OFFER, 2, 0), net((0, 1, DEAD), offered=1))


def test_untimed_a_timer_fires_when_it_is_due_and_other_clocks_stand(nodes):
    made = nets(nodes)
    nodes.states[1] = Of(handed=NONE, timers=timers(t2=30))
    ((move, after, _),) = made.fire(net(lags=(0, 0, 5)), 1, 2)
    assert move == Move(FIRE, 1, 2)
    assert nodes.asked == [(1, (local.TIMER, 2), 30)]
    assert after == net((0, 1 + AHEAD, 2), lags=(0, 0, 5))


def test_timed_all_clocks_of_who_lives_go_on_and_a_beat_is_used_up(nodes):
    made = nets(nodes, beats=4)
    nodes.states[1] = Of(handed=NONE, timers=timers(**{f"t{const.TICK}": 30}))
    ((_, after, _),) = made.fire(net((0, 1, DEAD), lags=(4, 10, 0)), 1, const.TICK, 20)
    assert nodes.asked == [(1, (local.TIMER, const.TICK), 30)]
    assert after == net((0, 1 + AHEAD, DEAD), lags=(24, 0, 0), ticks=(9, 8, 9))
    nodes.asked.clear()
    made.fire(net(lags=(0, 50, 0)), 1, const.TICK)
    assert nodes.asked == [(1, (local.TIMER, const.TICK), 50)], "late"


def test_what_draws_gave_stands_in_the_move_and_makes_several_ends(nodes):
    made = nets(nodes)
    nodes.states[1] = Of(handed=NONE, timers=timers(t2=30))
    nodes.said[1, (local.TIMER, 2)] = (
        Outcome(21, (), (), 0, (0,)), Outcome(22, (), (), 5, (1,)))  # fmt: skip
    found = made.fire(net(), 1, 2)
    assert [(move.script, after.nodes[1], broken) for move, after, broken in found] == [
        ((0,), 21, 0), ((1,), 22, 5)]  # fmt: skip


def sends(nodes, to, flags=const.ACK_WANTED, **keys):
    """A line in which node 1 has handed down a frame, number 0; frame 1 is its ack."""
    nodes.packets = [packet(to, flags=flags), packet(1, link_src=to, kind=const.ACK)]
    nodes.states[1] = Of(handed=0, timers=QUIET)
    return nets(nodes, **keys)


GOT, SENT, ACKED = (local.FRAME, 0), (local.SENT,), (local.FRAME, 1)


def answers(nodes, who, waits):
    """Who gets frame 0 answers with frame 1; whoever hears that waits for it still, or does not."""
    nodes.said[who, GOT] = (Outcome(who + AHEAD, (1,), (), 0, ()),)
    row = {"q_state": [UNACKED], "q_link_dst": [who], "q_origin": [1], "q_seq": [7]}
    nodes.records[1 + 2 * AHEAD] = {"busy": 0 if waits else -1, **row}


def test_a_frame_goes_to_whom_it_is_for_and_its_ack_comes_back(nodes):
    made = sends(nodes, 2)
    answers(nodes, 2, waits=False)
    ((move, after, broken),) = made.air(net(), 1)
    assert (move, broken) == (Move(AIR, 1, 0), 0)
    assert [event[:2] for event in nodes.asked] == [(2, GOT), (1, SENT), (1 + AHEAD, ACKED)]
    assert after == net((0, 1 + 2 * AHEAD, 2 + AHEAD))


@pytest.mark.parametrize(("left", "found"), [
    ((0, 0, 0, 0), [((), 0)]), ((0, 0, 1, 0), [((), 0), ((2,), 0)]),
    ((0, 0, 0, 1), [((), 0), ((), 1)]), ((4, 5, 2, 3), [((), 0), ((2,), 0), ((), 1)]),
])  # fmt: skip
def test_what_may_be_lost_is_lost_too_and_uses_that_up_alone(nodes, left, found):
    made = sends(nodes, 2)
    answers(nodes, 2, waits=False)
    some = made.air(net(left=left), 1)
    assert [(move.missed, move.deaf) for move, *_ in some] == found
    deaths, revivals, frames, acks = left
    for move, after, _ in some:
        assert after.left == (deaths, revivals, frames - len(move.missed), acks - move.deaf)
        assert after.nodes[2] == (2 if move.missed else 2 + AHEAD)
        assert after.nodes[1] == 1 + (AHEAD if move.missed or move.deaf else 2 * AHEAD)


def test_an_ack_is_lost_only_if_it_was_wanted_and_there_was_one(nodes):
    left = (0, 0, 0, 1)
    assert [move.deaf for move, *_ in sends(nodes, 2).air(net(left=left), 1)] == [0]
    made = sends(nodes, 2, flags=0)
    answers(nodes, 2, waits=False)
    assert [move.deaf for move, *_ in made.air(net(left=left), 1)] == [0]


@pytest.mark.parametrize(("to", "alive"), [(2, (0, 1, DEAD)), (5, (0, 1, 2))])
def test_a_frame_that_nobody_hears_has_left_all_the_same(nodes, to, alive):
    made = sends(nodes, to)
    some = made.air(net(alive, left=(0, 0, 1, 1)), 1)
    assert [(move.missed, move.deaf) for move, *_ in some] == [((), 0)]
    assert [event[:2] for event in nodes.asked] == [(1, SENT)]
    assert some[0][1].nodes == (0, 1 + AHEAD, alive[2])


def test_who_waits_still_for_the_ack_that_came_is_broken(nodes):
    made = sends(nodes, 2)
    answers(nodes, 2, waits=True)
    assert made.air(net(), 1)[0][2] == local.BROKEN_ACKED
    row = nodes.records[1 + 2 * AHEAD]
    for name, other in (("busy", -1), ("q_state", [UNACKED + 1]), ("q_link_dst", [0]),
                        ("q_origin", [0]), ("q_seq", [8])):  # fmt: skip
        nodes.records[1 + 2 * AHEAD] = row | {name: other}
        assert made.air(net(), 1)[0][2] == 0, name


@pytest.mark.parametrize("overhear", [False, True])
def test_who_overhears_gets_what_is_for_others_and_their_acks(nodes, overhear):
    made = sends(nodes, 2, overhear=overhear)
    answers(nodes, 2, waits=False)
    made.air(net(), 1)
    who = [number for number, event, _ in nodes.asked if event == GOT]
    assert who == ([0, 2] if overhear else [2])
    nodes.asked.clear()
    sends(nodes, 1, links=((0, 1), (0, 2), (1, 2)), overhear=overhear)
    made = nets(nodes, ((0, 1), (0, 2), (1, 2)), overhear=overhear)
    nodes.packets = [packet(2, flags=const.ACK_WANTED), packet(1, link_src=2, kind=const.ACK)]
    made.air(net(), 1)
    heard = [number for number, event, _ in nodes.asked if event == ACKED]
    assert heard == ([AHEAD, 1 + AHEAD] if overhear else [1 + AHEAD])


def test_a_frame_for_all_reaches_all_that_do_not_miss_it_and_nobody_acks(nodes):
    made = sends(nodes, const.ALL)
    nodes.said[0, GOT] = (Outcome(AHEAD, (1,), (), 0, ()),)
    for frames, missed in ((0, [()]), (1, [(), (0,), (2,)]), (3, [(), (0,), (2,), (0, 2)])):
        some = made.air(net(left=(0, 0, frames, 2)), 1)
        assert [move.missed for move, *_ in some] == missed
        for move, after, _ in some:
            assert after.left == (0, 0, frames - len(move.missed), 2)
            assert after.nodes == tuple(
                number + AHEAD * (number not in move.missed) for number in range(3)
            )
    assert not any(event == ACKED for _, event, _ in nodes.asked)


def test_faults_use_up_what_is_left_and_take_what_was_delivered_along(nodes):
    made = nets(nodes, budget=MeshBudget(deaths=2, revivals=3))
    got = made._set_of(frozenset({(1, 0, 5, const.DATA), (0, 1, 6, const.DATA)}))
    found = made.faults(net((0, 1, DEAD), lags=(4, 5, 0), left=(2, 1, 7, 8), got=got))
    assert [move for move, *_ in found] == [Move(DIE, 0), Move(DIE, 1), Move(REVIVE, 2)]
    first, second, third = (after for _, after, _ in found)
    assert first[:4] == ((DEAD, 1, DEAD), (0, 5, 0), (1, 1, 7, 8), (9, 9, 9))
    assert second[:4] == ((0, DEAD, DEAD), (4, 0, 0), (1, 1, 7, 8), (9, 9, 9))
    assert [sorted(made.sets[one.got]) for one in (first, second)] == [
        [(1, 0, 5, const.DATA)], [(0, 1, 6, const.DATA)]]  # fmt: skip
    assert third == net((0, 1, 1000 + 20 + 3), lags=(4, 5, 0), left=(2, 0, 7, 8), got=got)
    assert [broken for *_, broken in found] == [0, 0, 0]


def test_timed_faults_come_before_beats_and_deaths_before_frames_too(nodes):
    made = nets(nodes, beats=4)
    calm = made.calm_beats()
    left, some = (1, 1, 0, 0), (0, 1, DEAD)

    def kinds(ticks=calm):
        return [move.kind for move, *_ in made.faults(net(some, left=left, ticks=(ticks,) * 3))]

    assert kinds() == [DIE, DIE], "nothing is to come, as before a frame"
    nodes.states[0] = Of(handed=NONE, timers=timers(**{f"t{const.TICK}": 5}))
    assert kinds() == [DIE, DIE, REVIVE]
    assert kinds(calm - 1) == []
    nodes.states[0] = Of(handed=NONE, timers=timers(t2=5))
    assert kinds() == []
    nodes.states[0] = Of(handed=0, timers=QUIET)
    assert kinds() == [DIE, DIE]


def test_everything_that_can_happen_is_what_each_can_do_and_what_may_fail(nodes):
    made = sends(nodes, 2, offers=((0, 2),))
    nodes.states[0] = Of(handed=NONE, timers=timers(t2=30, t4=30))
    left = (1, 0, 0, 0)
    found = [move for move, *_ in made.successors(net(left=left))]
    assert found == [Move(OFFER, 0, 0), Move(FIRE, 0, 2), Move(FIRE, 0, 4), Move(AIR, 1, 0),
                     Move(DIE, 0), Move(DIE, 1), Move(DIE, 2)]  # fmt: skip
    found = [move for move, *_ in made.successors(net((DEAD, 1, DEAD), offered=1))]
    assert found == [Move(AIR, 1, 0)]


def test_timed_one_thing_happens_next_until_the_beats_are_used_up(nodes):
    made = sends(nodes, 2, beats=4, offers=((0, 2),))
    nodes.states[0] = Of(handed=NONE, timers=timers(**{f"t{const.TICK}": 30}))
    assert [move for move, *_ in made.successors(net())] == [Move(AIR, 1, 0)]
    assert made.steady(net(left=(1, 1, 1, 1)))[:2] == (Move(AIR, 1, 0), net((0, 11, 12)))
    rest = (0, DEAD, 2)
    assert [move for move, *_ in made.timed(net(rest))] == [Move(FIRE, 0, const.TICK)]
    assert made.timed(net(rest, ticks=(0, 9, 9))) == []
    assert made.steady(net(rest, ticks=(0, 9, 9))) is None
    nodes.states[0] = Of(handed=NONE, timers=timers(t2=30))
    assert [move for move, *_ in made.timed(net(rest, ticks=(0, 9, 9)))] == [Move(FIRE, 0, 2)]
    assert made.timed(net((DEAD,) * 3)) == []


def test_a_delivery_is_noted_once_and_broken_where_it_comes_again_or_was_not_offered(nodes):
    made = nets(nodes, offers=((1, 0), (1, 0), (2, 0)))
    nodes.packets = [packet(0, seq=7), packet(0, seq=8), packet(0, seq=9),
                     packet(0, seq=7, kind=const.ALARM), packet(0, origin=0)]  # fmt: skip
    one, broken = made._deliver(0, 0, 0)
    assert (sorted(made.sets[one]), broken) == ([(0, 1, 7, const.DATA)], 0)
    assert made._deliver(one, 0, 0) == (one, local.BROKEN_TWICE)
    two, broken = made._deliver(one, 0, 1)
    assert (len(made.sets[two]), broken) == (2, 0)
    three, broken = made._deliver(two, 0, 2)
    assert (len(made.sets[three]), broken) == (3, local.BROKEN_TWICE)
    alarm, broken = made._deliver(two, 0, 3)
    assert (len(made.sets[alarm]), broken) == (3, 0)
    assert made._deliver(two, 0, 4) == (two, 0), "its own"
    assert made._deliver(0, 2, 0)[1] == local.BROKEN_TWICE, "it was for another"


def test_what_is_delivered_twice_in_an_event_breaks_it(nodes):
    made = nets(nodes, offers=((1, 0),))
    nodes.packets = [packet(0)]
    nodes.said[0, GOT] = (Outcome(33, (), (0,), 0, ()),)
    (once,) = made._apply([made._part(net(lags=(6, 7, 8)))], 0, GOT)
    assert (once.nodes, once.lags, once.broken) == ((33, 1, 2), (0, 7, 8), 0)
    assert nodes.asked == [(0, GOT, 6)]
    (twice,) = made._apply([once._replace(nodes=(0, 1, 2))], 0, GOT)
    assert twice.broken == local.BROKEN_TWICE
    (still,) = made._apply([twice], 1, (local.SENT,))
    assert still.broken == local.BROKEN_TWICE
