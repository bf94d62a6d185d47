"""What the simulation showed once, by the seeds that did: keys, and what radios believed."""

import pytest

from innervate.live.keys import Sealer
from innervate.wire.seal import Window
from tests.livesim import runs

SMALL = {"nodes": 6, "storms": 1, "storm_s": 60, "calm_s": 0, "rate": 20}


def broken(seed, **given):
    """What is broken in a seed's run."""
    return runs.run(seed, "mesh", **SMALL | given).broken


@pytest.mark.parametrize("seed", [1, 2])
def test_no_nonce_comes_twice_where_the_disk_is_full_and_processes_are_killed(seed):
    soon = {"storm_s": 20, "rate": 10, "hurts": ("full", "restarts")}
    found = broken(seed, sealed=True, in_order=False, **soon)
    assert [line for line in found if "nonce" in line] == []


def played_back(seed):
    """What is broken where somebody plays back what he recorded, to nodes that are killed."""
    hurts = ("replays", "restarts")
    return broken(seed, sealed=True, in_order=False, hurts=hurts, old_lives=True)


# Seeds 1 to 8 find, each, what is planted below.
@pytest.mark.parametrize("seed", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_nothing_is_taken_from_a_recording_by_a_node_that_was_killed(seed):
    assert played_back(seed) == []


@pytest.mark.parametrize(
    ("owner", "name", "planted"),
    [(Window, "is_new", lambda *_: True), (Sealer, "take", lambda *_: None)],
    ids=["a window that is not asked", "a window that is not told"],
)
def test_a_frame_that_is_taken_once_more_is_broken(monkeypatch, owner, name, planted):
    monkeypatch.setattr(owner, name, planted)
    (found,) = played_back(2)
    assert "takes frame" in found


# A packet of an earlier life that was under way for seconds: it came behind messages of the next
# life, or had the router forget which of those it had handed up.
@pytest.mark.slow
@pytest.mark.parametrize("seed", [900_009, 900_078])
def test_a_packet_of_an_earlier_life_is_not_taken_for_a_new_one(seed):
    assert runs.run(seed, "mesh").broken == []


def test_who_is_switched_on_again_and_again_for_a_minute_is_heard_by_all():
    found = runs.run(900_883, "mesh", nodes=6, storms=1, storm_s=60)
    assert found.broken == []
    assert found.told["lives"] > 30
    assert found.told["delivered"] > 300


# A node that was stopped for two minutes passed on what had waited at its sockets.
@pytest.mark.slow
@pytest.mark.parametrize("seed", [7, 9])
def test_what_waits_for_who_was_stopped_for_long_does_not_come_twice(seed):
    hurts = ("held_up", "lossy", "cut")
    assert broken(seed, storm_s=300, rate=10, long=0.0, hurts=hurts) == []


# The last pieces of two long messages were tried one after the other, and in vain, for 52 s.
@pytest.mark.slow
def test_who_was_started_anew_says_which_long_messages_it_cannot_have():
    assert runs.run(920_019, "mesh").broken == []


# A channel that was started anew told stations that had sent meanwhile that they listen again, and
# an answer to somebody else was proof of what nobody had heard.
@pytest.mark.parametrize("seed", [9_000_001, pytest.param(333_057, marks=pytest.mark.slow)])
def test_a_packet_that_a_channel_took_with_it_is_not_delivered(seed):
    assert runs.run(seed, "radio").broken == []
