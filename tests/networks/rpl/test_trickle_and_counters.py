"""RFC 6206 (Trickle), and the sequence counters of RFC 6550, sentence by sentence."""

import pytest

from innervate.networks.rpl.protocol import constants as c
from innervate.networks.rpl.protocol import kinds, timers
from innervate.networks.rpl.protocol.counters import dag_rank, following, is_newer
from tests.networks.rpl import nodes as rpl

MS = 1000


def at_root(**params):
    return rpl.node(0, **{"dio_min": 6, "dio_doublings": 3} | params)


def dios(frames):
    return [frame for frame in frames if frame.kind == kinds.DIO]


def point(one):
    """Time t, or an interval's end; the DIOs that are sent then."""
    sent = dios(one.fire(timers.TRICKLE))
    if sent:
        one.told()
    return sent


def interval(one):
    """An interval's length as its two timers give it, t first, and what is sent; us."""
    t = one.left(timers.TRICKLE)
    sent = point(one)
    length = t + one.left(timers.TRICKLE)
    point(one)
    return t, length, sent


def test_t_is_a_random_point_in_the_second_half():
    """6206, 4.2: "sets t to a random point in the interval, taken from the range [I/2, I)" """
    one = at_root(dio_doublings=0)
    points = {interval(one)[:2] for _ in range(30)}
    assert {length for _, length in points} == {64 * MS}
    times = [t for t, _ in points]
    assert 32 * MS <= min(times) < 40 * MS < 56 * MS < max(times) < 64 * MS


def test_intervals_double_up_to_imax():
    """6206, 4.2: "doubles the interval length", "sets the interval length I to be the time
    specified by Imax" """
    one = at_root()
    assert [interval(one)[1] // MS for _ in range(6)] == [64, 128, 256, 512, 512, 512]


def test_imin_is_two_to_the_dio_interval_min_ms():
    """6550, 8.3.1: "Imin: learned from the DIO message as (2^DIOIntervalMin) ms." """
    assert interval(at_root(dio_min=3))[1] == 8 * MS


def test_it_transmits_if_the_counter_is_below_k():
    """6206, 4.2: "transmits if and only if the counter c is less than the redundancy constant
    k" """
    for heard, expected in ((1, 1), (2, 0), (3, 0)):
        one = rpl.attached(dio_k=2)
        one.fire(timers.TRICKLE)  # t
        one.told()
        one.fire(timers.TRICKLE)  # the next interval begins
        one.sent.clear()
        for _ in range(heard):
            one.hear(**rpl.dio(1, 256))
        assert len(dios(one.fire(timers.TRICKLE))) == expected, heard


def test_k_zero_is_infinity():
    """6550, 8.3.1: "when k has the value of 0x00, this is to be treated as a redundancy constant of
    infinity" """
    one = rpl.attached(dio_k=0)
    one.fire(timers.TRICKLE)
    one.told()
    one.fire(timers.TRICKLE)
    one.sent.clear()
    for _ in range(50):
        one.hear(**rpl.dio(1, 256))
    assert len(dios(one.fire(timers.TRICKLE))) == 1


def test_consistent_is_a_lesser_rank_that_changes_nothing():
    """6550, 8.3: "A DIO from a sender with a lesser DAGRank that causes no changes to the
    recipient's parent set, preferred parent, or Rank SHOULD be considered consistent" """
    one = rpl.attached()
    one.hear(**rpl.dio(1, 256))
    assert one.node.counter == 1
    one.hear(**rpl.dio(2, 900))
    assert one.node.counter == 1, "a greater rank"
    one.node.interval = 3
    one.hear(**rpl.dio(1, 128))
    assert one.node.counter == 0, "our rank has changed"


def stretched(**params):
    one = rpl.attached(**params)
    one.node.interval = 3
    return one


def test_an_inconsistency_begins_an_interval_of_imin():
    """6206, 4.2: "To reset the timer, Trickle sets I to Imin and starts a new interval" """
    one = stretched()
    one.hear(kind=kinds.DIS, to=65535, src=7, rssi=-60)
    assert one.node.interval == 0
    assert 32 * MS <= one.left(timers.TRICKLE) < 64 * MS


def test_at_imin_an_inconsistency_does_nothing():
    """6206, 4.2: "If I is equal to Imin when Trickle hears an "inconsistent" transmission, Trickle
    does nothing." """
    one = rpl.attached()
    assert one.node.interval == 0
    before = one.timers[timers.TRICKLE]
    one.hear(kind=kinds.DIS, to=65535, src=7, rssi=-60)
    assert one.timers[timers.TRICKLE] == before


@pytest.mark.parametrize(
    "heard",
    [
        {"kind": kinds.DIS, "to": 65535, "src": 7},  # a multicast DIS
        rpl.dio(1, 256, version=241),  # joins a new DODAG version
        # a second inconsistency of ranks
        {
            "kind": kinds.DATA,
            "src": 8,
            "dsn": 9,
            "dest": 0,
            "hops": 9,
            "sender_rank": 1,
            "error": 1,
        },
    ],
)
def test_what_must_reset_the_timer(heard):
    """6550, 8.3: "MUST be considered inconsistencies", "cause the Trickle timer to reset" """
    one = stretched()
    one.hear(**heard)
    assert one.node.interval == 0


def test_the_only_time_it_transmits_is_t():
    """6206, 4.2: "The only time the Trickle algorithm transmits is at step 4" """
    one = stretched()
    assert dios(one.hear(kind=kinds.DIS, to=65535, src=7, rssi=-60)) == []
    assert len(dios(one.fire(timers.TRICKLE))) == 1
    one.told()
    assert dios(one.fire(timers.TRICKLE)) == []


def test_counters_go_straight_up_and_then_round():
    """6550, 7.2: "When a sequence counter increment would cause the sequence counter to increment
    beyond its maximum value, the sequence counter MUST wrap back to zero." """
    assert c.INITIAL == 240
    assert [following(one) for one in (240, 254, 255, 0, 126, 127)] == [241, 255, 0, 1, 127, 0]


def test_counters_are_compared_across_the_restart():
    """6550, 7.2: "21 is greater than SEQUENCE_WINDOW (16); thus, 240 is greater than 5", "11 is
    less than SEQUENCE_WINDOW (16); thus, 250 is less than 5" """
    assert is_newer(240, 5)
    assert not is_newer(5, 240)
    assert is_newer(5, 250)
    assert not is_newer(250, 5)


def test_counters_are_compared_within_the_window():
    """6550, 7.2: "a desynchronization has occurred and the two sequence numbers are not
    comparable" """
    assert is_newer(241, 240)
    assert not is_newer(240, 240)
    assert is_newer(2, 120)
    assert is_newer(16, 0)
    assert not is_newer(17, 0)
    assert not is_newer(0, 17)


def test_dag_rank_is_the_whole_part():
    """6550, 17: "such that DAGRank(ROOT_RANK) is 1" """
    step = rpl.RPL.fields.DEFAULTS["step"]
    assert [dag_rank(rank, step) for rank in (step, 2 * step - 1, 2 * step)] == [1, 1, 2]
