"""How good a link is taken to be, and what follows from it."""

import random
from types import SimpleNamespace

import pytest

from innervate.networks.mesh.protocol import backoff, link_quality
from innervate.networks.mesh.protocol.link_quality import (
    ALL_ACKED,
    RATIO_MIN,
    TRIES_MAX,
    learn_ack,
    learn_misses,
    note_miss,
    relief,
    tries_for,
)

PARAMS = SimpleNamespace(transmissions=3, hop_frames=0, ack_us=1000, poor=-94)
LOUD, FAINT = -94, -95  # dBm


def node(ratio=ALL_ACKED, heard=7, rssi=LOUD):
    link = {"ack_ratio": [ratio], "misses": [0], "heard": [heard], "rssi": [4 * rssi]}
    return SimpleNamespace(**link, ticks=7, strain=0, pause=-1, rng=1, choice=-1, asked=0)


def played(share, seed, rssi=LOUD, count=8000):
    """The mean ratio after acks of a node that is so often acknowledged; how often it pauses."""
    chance, one, ratios, pauses = random.Random(seed), node(rssi=rssi), [], 0
    for i in range(count):
        if chance.random() < share:
            backoff.note_answer(one, PARAMS, 0)
            if i > 100:
                ratios.append(one.ack_ratio[0] / ALL_ACKED)
        else:
            backoff.note_missed(one, PARAMS, 0, 0)
        pauses += one.strain > backoff.STRAIN_FREE
    return sum(ratios) / len(ratios), pauses / count


@pytest.mark.parametrize("share", [0.36, 0.49, 0.56, 0.81, 0.95])
def test_the_ratio_is_the_share_that_is_acknowledged(share):
    """An ack takes it an eighth of the way up from that."""
    for seed in range(3):
        assert abs(played(share, seed)[0] - share - (1 - share) / 8) < 0.025, (share, seed)


@pytest.mark.parametrize("share", [0.25, 0.28, 0.36, 0.49, 0.56, 0.81])
def test_a_link_that_loses_evenly_is_no_strain(share):
    """Its node pauses in one of twenty cases at most; with a worse one nearly always."""
    for seed in range(3):
        assert played(share, seed, FAINT)[1] < 0.05, (share, seed)
        assert share < 0.36 or played(share, seed, LOUD)[1] < 0.05, (share, seed)
    assert played(0.05, 1, FAINT)[1] > 0.95
    assert played(0.1, 1, LOUD)[1] > 0.95


def test_a_link_that_is_hardly_heard_may_lose_more_than_a_loud_one():
    """What a faint link loses is the link's fault; where a loud one loses as much it is full."""
    for seed in range(3):
        assert played(0.18, seed, FAINT)[1] < 0.2
        assert played(0.18, seed, LOUD)[1] > 0.8


def test_the_ratio_keeps_within_its_range():
    one = node()
    for _ in range(100):
        learn_ack(one, 0)
        assert one.ack_ratio[0] == ALL_ACKED
    for _ in range(100):
        note_miss(one, 0)
        assert one.misses[0] <= link_quality.MISSES_MAX
    learn_misses(one, 0)
    assert 0 < one.ack_ratio[0] < RATIO_MIN
    for _ in range(100):
        learn_ack(one, 0)
    assert one.ack_ratio[0] == ALL_ACKED
    backoff.note_answer(one, PARAMS, -1)
    note_miss(one, -1)
    assert one.ack_ratio == [ALL_ACKED]


# p of 255 -> transmissions, relief in quarters of an ack: (1.4 - p) / p acks, at least one.
KNOWN = [(255, 3, 4), (192, 3, 4), (191, 4, 4), (128, 5, 7), (92, 8, 11), (64, 11, 18), (7, 11, 18)]


@pytest.mark.parametrize(("ratio", "tries", "quarters"), KNOWN)
def test_a_poor_link_takes_more_transmissions_and_excuses_more_misses(ratio, tries, quarters):
    assert tries_for(node(ratio), PARAMS, 0) == tries
    assert relief(node(ratio), PARAMS, 0) == quarters


def test_who_was_not_heard_in_this_tick_is_not_tried_more_often():
    assert tries_for(node(92, heard=6), PARAMS, 0) == 3
    assert tries_for(node(92), PARAMS, -1) == 3
    one = node(92)
    one.strain = 3 * link_quality.UNIT
    backoff.note_answer(one, PARAMS, -1)
    assert one.strain == 2 * link_quality.UNIT
    assert one.ack_ratio == [92]


def test_a_faint_link_excuses_misses_down_to_an_eighth():
    assert relief(node(64, rssi=FAINT), PARAMS, 0) == relief(node(64), PARAMS, 0) == 18
    assert relief(node(32, rssi=FAINT), PARAMS, 0) == 40
    assert relief(node(7, rssi=FAINT), PARAMS, 0) == 40


def test_nobody_is_tried_more_often_than_most_or_less_than_asked():
    many = SimpleNamespace(transmissions=6)
    assert tries_for(node(64), many, 0) == TRIES_MAX
    assert tries_for(node(64), SimpleNamespace(transmissions=15), 0) == 15
    assert tries_for(node(64), SimpleNamespace(transmissions=1), 0) == 1


def test_silence_is_learned_once_it_is_over():
    """Else a neighbour that died would be tried the more often, the longer it is silent."""
    one = node()
    for _ in range(100):
        note_miss(one, 0)
        assert tries_for(one, PARAMS, 0) == PARAMS.transmissions
    learn_misses(one, 0)
    learn_ack(one, 0)
    assert one.misses == [0]
    assert tries_for(one, PARAMS, 0) == 11
