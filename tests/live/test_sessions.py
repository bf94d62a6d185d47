"""When a node asks who is there, which sessions it keeps, and what waits for the first: by time."""

import asyncio
from itertools import pairwise
from types import SimpleNamespace

import pytest

from innervate.live import contact
from innervate.live.keyring import is_same_end
from innervate.live.rotation import Rotation
from innervate.live.session import COUNTERS, REKEY_US, Session
from innervate.wire import seal
from tests.live import time_by_hand
from tests.live.pair import KEY, OTHER, Wire, begin, join, network_sealer, settle, two
from tests.live.test_rotation import timed


def contact_of(wire):
    return wire.sealer._contacts[wire.port]


def asked(wire):
    """First messages of handshakes that left by a wire."""
    return [data for data in wire.said if data[0] >= seal.FIRST]


@pytest.mark.parametrize(
    ("age_us", "counter", "began", "worn"),
    [
        (REKEY_US, COUNTERS // 2, True, False),
        (REKEY_US + 1, 0, True, True),
        (REKEY_US * 6 // 5, 0, False, False),
        (REKEY_US * 6 // 5 + 1, 0, False, True),
        (0, COUNTERS // 2 + 1, True, True),
        (0, COUNTERS // 2 + 1, False, True),
    ],
)
def test_who_began_a_session_has_it_made_anew_first(age_us, counter, began, worn):
    session = SimpleNamespace(made_at=5, counter=counter, is_initiator=began)
    assert Session.is_worn(session, 5 + age_us) == worn


@pytest.mark.parametrize(
    ("claimed", "known", "same"),
    [
        ("", "a:1", True), ("a:1", "", True), ("a:1", "a:1", True), ("a:1", "b:1", False),
        ("0.0.0.0:1", "b:1", True), ("a:1", "0.0.0.0:1", True), ("0.0.0.0:1", "b:2", False),
        ("a:1", "a:2", False), ("[::]:1", "[fd::1]:1", True), ("[fd::1]:1", "[::]:2", False),
    ],
)  # fmt: skip
def test_ends_are_the_same_if_both_names_can_be_right(claimed, known, same):
    assert is_same_end(claimed, known) == same


@timed
async def test_who_is_alone_asks_less_and_less_often_and_of_what_it_asked_keeps_a_few():
    wire, times = Wire(), []
    wire.change = lambda data: times.append(asyncio.get_running_loop().time()) or []
    wire.others = [wire]  # nobody: it is only told when something leaves
    begin(network_sealer(1), wire)
    await settle(20.0)
    gaps = [b - a for a, b in pairwise(times)]
    wanted = [min(contact.WAIT_S * 2**k, contact.WAIT_MAX_S) for k in range(len(gaps))]
    assert len(gaps) > 15
    for gap, wait in zip(gaps, wanted, strict=True):
        assert 0.75 * wait - 1e-6 <= gap <= 1.25 * wait + 1e-6
    assert len(set(gaps)) == len(gaps)  # not in step with anybody
    assert len(contact_of(wire)._asked) == contact.ASKED


@timed
async def test_a_session_is_asked_for_anew_once_nothing_comes_back():
    a, b = await two()
    begun = len(asked(a))
    await settle(100.0)
    assert len(asked(a)) == begun  # who says nothing misses nothing
    a.others = []
    a.frame(b"first")
    for _ in range(28):
        await settle(0.1)
        a.frame(b"more")
    assert len(asked(a)) == begun
    await settle(1.0)
    assert len(asked(a)) > begun
    a.others = [b]
    await settle(2.0)
    begun = len(asked(a))
    a.frame(b"heard")
    b.frame(b"and answered")
    await settle(50.0)
    assert len(asked(a)) == begun


@timed
async def test_who_is_spoken_to_and_has_nothing_to_say_needs_no_new_session():
    """A slow mesh sends a word now and then, which nobody answers."""
    a, b = await two()
    said = len(a.said) + len(b.said)
    begun = len(asked(a)) + len(asked(b))
    for _ in range(5):
        a.frame(b"a beacon")
        await settle(60.0)
    assert len(asked(a)) + len(asked(b)) == begun
    assert len(a.said) + len(b.said) == said + 5 * 3  # and "are you there", and "I am"


@timed
async def test_a_path_on_which_nothing_goes_is_looked_after_rarely_until_something_does():
    a, b = await two()
    looks = []
    contact_of(a).path.let_in = lambda *_: looks.append(asyncio.get_running_loop().time())
    await settle(100.0)
    assert len(looks) <= 100 / contact.Contact.rest_s + 2
    looks.clear()
    for _ in range(50):
        b.frame(b"heard")
        await settle(0.2)
    gaps = [after - before for before, after in pairwise(looks)]
    assert len(looks) > 10
    assert max(gaps) <= 2 * contact.IDLE_S


@timed
async def test_who_is_told_to_hurry_asks_at_once_whatever_is_sent_meanwhile():
    a, _ = await two()
    await settle(100.0)
    begun = len(asked(a))
    contact_of(a).renew_all()
    a.frame(b"meanwhile")
    await settle(0.01)
    assert len(asked(a)) == begun + 1


@timed
async def test_of_a_neighbours_sessions_the_newest_are_kept():
    a, b = await two()
    indices = []
    for _ in range(5):
        for wire in (a, b):
            (newest,) = contact_of(wire).all_sessions()
            indices.append((wire.name, newest.own))
        contact_of(a).renew_all()
        await settle(2.0)
    for wire in (a, b):
        known = contact_of(wire).sessions[3 - wire.sealer.sender]
        assert len(known) == contact.SESSIONS
        assert [one.made_at for one in known] == sorted(
            (one.made_at for one in known), reverse=True
        )
        assert contact_of(wire)._current is known[0]
        assert {one.own for one in known} == set(contact_of(wire)._by_index)
        assert (wire.name, known[0].own) not in indices
    assert not contact_of(a)._due


@timed
async def test_a_handshake_that_nobody_ends_leaves_nothing():
    """What b answers never comes: it has a session of which nothing was ever heard."""
    a, b = Wire(), Wire()
    join(a, b)
    b.change = lambda data: []
    begin(network_sealer(1), a)
    begin(network_sealer(2), b)
    await settle(60.0)
    assert not contact_of(a)._by_index
    assert not contact_of(a).sessions
    assert not contact_of(b).sessions
    assert len(contact_of(b)._answered) == contact.ANSWERED
    assert len(contact_of(b)._by_index) <= contact.ANSWERED


@timed
async def test_what_was_said_before_the_first_contact_comes_if_it_is_not_too_old():
    a, b = Wire(), Wire()
    begin(network_sealer(1), a)
    for k in range(contact.HELD + 3):
        a.frame(bytes([k]))
        await settle(0.01)
    await settle(0.045)
    join(a, b)
    begin(network_sealer(2), b)
    await settle(0.2)
    # Of eight that were kept, those of 100 ms ago and more are too old at 155 ms.
    assert b.frames() == [bytes([k]) for k in range(6, contact.HELD + 3)]
    assert a.sealer.counts["held: no session yet"] == contact.HELD + 3


@timed
async def test_keys_leave_each_at_its_own_time_and_one_that_is_wanted_back_stays():
    wire = Wire()
    begin(network_sealer(1), wire)
    rotation, third = Rotation(wire.sealer), bytes([3]) * 32
    seen = []

    async def look(after_s):
        await settle(after_s)
        seen.append((wire.sealer.ring.use, sorted(wire.sealer.ring.keys)))

    rotation.begin({2: OTHER}, 2, 10.0)  # at 0: to 2 at 10, without 1 at 20
    await look(5.0)
    rotation.begin({3: third}, 3, 10.0)  # at 5: to 3 at 15, without 2 at 25
    for _ in range(5):
        await look(5.2)
    assert seen == [(1, [1, 2]), (2, [1, 2, 3]), (3, [1, 2, 3]), (3, [2, 3]), (3, [3]), (3, [3])]
    rotation.begin({1: KEY, 3: third}, 1, 1.0)
    rotation.begin({1: KEY}, 1, 50.0)
    rotation.begin({1: KEY, 3: third}, 1, 50.0)
    await look(300.0)
    assert seen[-1] == (1, [1, 3])
    rotation.begin({1: KEY}, 1, 1.0)
    rotation.stop()
    await look(300.0)
    assert seen[-1] == (1, [1, 3])


def test_an_event_loop_is_not_kept_busy_by_nobody():
    async def main():
        a = Wire()
        begin(network_sealer(1), a)
        await settle(60.0)
        return len(a.said)

    assert 40 < time_by_hand.run(main()) < 90
