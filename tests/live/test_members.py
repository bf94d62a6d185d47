"""Members of a group: whose keys are known, when all are called, who is asked, by time."""

from types import SimpleNamespace

import pytest

from innervate.live import group, noise
from innervate.live.engine import clock_us
from innervate.live.group import CALL_US, CALLS, SEEK_US, GroupContact
from innervate.live.keyring import ANYBODY, LIFE_BYTES, About, Proven, read_about
from innervate.live.session import COUNTERS, REKEY_US, Session
from tests.live.pair import Wire, begin, join, network_sealer, own_sealer, settle
from tests.live.test_rotation import timed


def who(number, life=1):
    return Proven(number, bytes([life]) * LIFE_BYTES, 1)


def member(number=1):
    """A contact that notes whom it asks and what it tells."""
    contact = GroupContact(network_sealer(number), Wire(is_group=True))
    contact.asked, contact.told = [], []
    contact.ask = contact.asked.append
    contact.tell = lambda session, kind, body=b"": contact.told.append((session.who.number, kind))
    return contact


def session(number, age_us=0, life=1):
    keys = (key(number), key(number))
    one = Session(number, number, keys, who(number, life), True)
    one.made_at -= age_us
    one.heard_at = 1
    return one


def key(number):
    return bytes([number]) * 32


def test_the_two_newest_keys_of_each_member_are_known_and_each_is_learnt_once():
    contact = member()
    for epoch in (10, 11):
        contact._learn(who(2), epoch, 0, key(epoch))
    contact._learn(who(3), 10, 5, key(3))
    known = dict(contact._heard)
    known[2, 11].window.take(7)
    contact._learn(who(2), 11, 4, key(11))
    assert contact._heard == known, "what was taken stays taken"
    contact._learn(who(2), 12, 0, key(12))
    assert list(contact._heard) == [(2, 11), (3, 10), (2, 12)]
    contact._learn(who(2, life=2), 12, 9, key(13))
    assert contact._heard[2, 12].who == who(2, life=2)
    assert [contact._heard[2, 12].window.is_new(counter) for counter in (8, 9)] == [False, True]
    assert [contact._heard[3, 10].window.is_new(counter) for counter in (4, 5)] == [False, True]


@timed
async def test_all_are_called_with_the_first_waits_and_then_now_and_then():
    contact = member()
    assert [contact._wants_session(clock_us()) for _ in range(CALLS + 1)] == [True] * CALLS + [
        False
    ]
    last = clock_us()
    for after_us, calls in ((CALL_US - 1, False), (CALL_US, True), (CALL_US + 1, False),
                            (2 * CALL_US - 1, False), (2 * CALL_US, True)):  # fmt: skip
        assert contact._wants_session(last + after_us) == calls
    assert contact.asked == []


@timed
async def test_members_whose_sessions_are_worn_or_of_a_key_that_leaves_are_asked():
    contact = member()
    contact._calls = CALLS
    contact.sessions = {2: [session(2, REKEY_US + 1)], 3: [session(3)], 4: [session(4)]}
    contact._due = {4}
    contact._wants_session(clock_us())
    assert contact.asked == [2, 4]
    assert contact.told == []


@timed
async def test_a_key_that_is_half_used_up_is_made_anew_and_all_are_told():
    contact = member()
    contact.sessions = {2: [session(2)], 3: [session(3)]}
    before = contact._key
    contact._counter = COUNTERS // 2
    contact._wants_session(clock_us())
    assert (contact._key, contact.told) == (before, [])
    contact._counter += 1
    contact._wants_session(clock_us())
    assert contact._key != before
    assert (contact._counter, contact.told) == (0, [(2, group.ALIVE), (3, group.ALIVE)])


@timed
async def test_a_member_that_is_not_known_is_asked_once_in_a_while():
    contact = member()
    contact._seek(7)
    assert contact.asked == [], "it is not started"
    contact._timer = SimpleNamespace(cancel=lambda: None)
    for number, after_us in ((7, 0), (8, SEEK_US - 1), (9, 1), (10, 0)):
        await settle(after_us / 1e6)
        contact._seek(number)
    assert contact.asked == [7, 9]


@pytest.mark.parametrize(
    ("to", "life", "is_for_us", "asked"),
    [(1, 1, True, []), (5, 1, False, []), (ANYBODY, 1, False, []), (ANYBODY, 2, False, [2])],
)
def test_a_call_to_all_is_answered_with_a_question_to_who_is_new(to, life, is_for_us, asked):
    contact = member()
    contact.sessions = {2: [session(2)]}
    about = SimpleNamespace(to=to, number=2, life=bytes([life]) * LIFE_BYTES)
    assert contact.is_for_us(about) == is_for_us
    assert contact.asked == asked
    stranger = SimpleNamespace(to=ANYBODY, number=9, life=bytes(LIFE_BYTES))
    assert not contact.is_for_us(stranger)
    assert contact.asked == [*asked, 9]


@timed
async def test_a_members_keys_are_known_as_long_as_it_has_a_session():
    contact = member()
    old, new = session(2), session(2, life=2)
    contact.sessions = {2: [new, old], 3: [session(3)]}
    for number in (2, 3):
        contact._learn(who(number), 10, 0, key(number))
    contact.forget(old)
    assert set(contact._heard) == {(2, 10), (3, 10)}
    contact.forget(new)
    assert set(contact._heard) == {(3, 10)}
    assert set(contact.sessions) == {3}


@timed
async def test_what_waits_for_the_first_member_and_what_nobody_can_seal_any_more():
    contact = member()
    assert contact.close(b"early") is None
    contact.sessions = {2: [session(2)]}
    contact._counter = COUNTERS - 1
    assert contact.close(b"last") is not None
    assert contact.close(b"one more") is None
    assert [data for _due, data in contact._held] == [b"early", b"one more"]
    assert contact.sealer.counts["held: no session yet"] == 2


@timed
async def test_of_a_group_everybody_is_heard_again_after_keys_were_used_up():
    wires = [Wire(str(number), is_group=True) for number in (1, 2)]
    join(*wires)
    for number, wire in zip((1, 2), wires, strict=True):
        begin(own_sealer(number), wire)
    await settle(1.0)
    wires[0].sealer._contacts[0]._counter = COUNTERS // 2 + 1
    await settle(6.0)
    wires[0].frame(b"under the new one")
    await settle()
    assert wires[1].got == [(1, b"under the new one")]
    assert wires[1].sealer.dropped == {}


@pytest.mark.parametrize(
    ("own", "far", "whole"), [("a", "bcd", True), ("", "", True), ("ö" * 200, "", False)]
)
def test_what_a_node_says_of_itself_is_as_the_formats_have_it(own, far, whole):
    said = About(5, ANYBODY, b"12345678", 0x01020304, own, far, b"rest").encode()
    assert said[:16] == b"\x00\x05\xff\xff12345678\x01\x02\x03\x04"
    if whole:
        assert said[16:] == b"%c%b%c%brest" % (len(own), own.encode(), len(far), far.encode())
        about = read_about(said)
        assert about == (5, ANYBODY, b"12345678", 0x01020304, own, far, b"rest")
        with pytest.raises(noise.Broken):
            read_about(said[:15])
    else:
        assert said[16] == 255
        assert len(said) == 16 + 1 + 255 + 1 + 4
