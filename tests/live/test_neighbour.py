"""What a node keeps of one neighbour's sessions and questions, and whose last message it takes."""

import random
from types import SimpleNamespace

import pytest

from innervate.live.contact import ANSWERED, KEY_BYTES, MAC_BYTES, OLD_US, Answer, Contact
from innervate.live.engine import clock_us
from innervate.live.identity import revoke
from innervate.live.keyring import About, read_about
from innervate.live.machine import Machine, on
from innervate.live.state import State
from tests.live.pair import (
    AUTHORITY,
    OTHER,
    Wire,
    joined,
    network_sealer,
    own_sealer,
    settle,
    two,
)
from tests.live.test_rotation import timed


def contact_of(wire):
    return wire.sealer._contacts[wire.port]


async def with_three_sessions():
    a, _b = await two()
    for _ in range(2):
        await settle(1.0)
        contact_of(a).renew_all()
        await settle(1.0)
    contact = contact_of(a)
    contact.stop()
    (known,) = contact.sessions.values()
    assert len(known) == 3
    assert known[0].made_at > known[1].made_at > known[2].made_at
    return contact, list(known)


@timed
async def test_without_the_newest_session_the_next_newest_is_used():
    contact, known = await with_three_sessions()
    contact.forget(known[0])
    assert contact._current is known[1]
    contact.forget(known[2])
    assert contact._current is known[1]
    contact.forget(known[1])
    assert contact._current is None
    assert contact.sessions == contact._by_index == {}
    contact.forget(known[2])  # it is gone already


@pytest.mark.parametrize(("age_us", "is_kept"), [(OLD_US, True), (OLD_US + 1, False)])
def test_a_session_is_taken_for_so_long(age_us, is_kept):
    @timed
    async def look():
        contact, known = await with_three_sessions()
        known[2].made_at = clock_us() - age_us
        contact.ask = lambda whom: None
        contact.beat()
        assert (contact.session_of(known[2].own) is known[2]) == is_kept
        assert contact.session_of(known[1].own) is known[1]
        contact.stop()

    look()


@timed
async def test_who_has_been_heard_stays_when_an_answer_is_forgotten():
    """Of others only so many are remembered, whoever asks how often."""
    contact, known = await with_three_sessions()
    silent = SimpleNamespace(heard_at=0)
    contact._by_index[77] = silent
    contact._answered = {}
    contact._remember(b"heard", Answer(b"", known[0].own, None, None, 1))
    contact._remember(b"silent", Answer(b"", 77, None, None, 1))
    for number in range(ANSWERED - 2):
        contact._remember(b"%d" % number, Answer(b"", 1000 + number, None, None, 1))
    assert contact.session_of(77) is silent
    for number in (98, 99):
        contact._remember(b"%d" % number, Answer(b"", 1000 + number, None, None, 1))
    assert contact.session_of(77) is None
    assert contact.session_of(known[0].own) is known[0]
    assert len(contact._answered) == ANSWERED


@pytest.mark.parametrize(("key", "length", "marked", "said"), [
    (1, 0, True, ""), (1, 1, True, ""), (1, -1, True, "wrong key or damaged"),
    (1, 0, False, "wrong key or damaged"), (2, 0, True, "unknown key"),
])  # fmt: skip
def test_a_first_message_that_was_answered_is_answered_the_same_again(key, length, marked, said):
    """Whatever else is in it: it has a key of its own, and a mark."""
    contact = object.__new__(Contact)
    sent, own = [], bytes(range(KEY_BYTES))
    ring = SimpleNamespace(keys={1: b""}, is_marked=lambda number, data: marked)
    contact.sealer = SimpleNamespace(ring=ring)
    contact.send = sent.append
    contact._answered = {own: Answer(b"reply", 3, None, None, 1)}
    data = (bytes((1,)) + own + bytes(MAC_BYTES + 1))[: 1 + KEY_BYTES + MAC_BYTES + length]
    assert contact._first(data, key) == said
    assert sent == ([] if said else [b"reply"])


class Repeating(Machine):
    """Draws the same numbers again."""

    def __init__(self):
        self.chance = random.Random(1)
        self.next = [7, 8, 7, 9]
        self.chance.getrandbits = lambda bits: self.next.pop(0)


def test_no_two_sessions_or_questions_have_one_index():
    sealer = network_sealer(1)
    with on(Repeating()):
        contact = Contact(sealer, Wire())
        contact._by_index[7], contact._asked[8] = object(), object()
        assert contact._draw_index() == 9


@pytest.mark.parametrize("field", ["number", "to", "life", "handle", ""])
def test_who_ends_a_handshake_is_who_began_it(field):
    @timed
    async def shake():
        liar, honest = joined(own_sealer(1), own_sealer(2), ("liar", "honest"))
        one = contact_of(liar)
        contact_of(honest).stop()  # it only answers
        say = one._about

        def about(to, index, certificate=b""):
            told = say(to, index, certificate)
            if not certificate or not field:
                return told
            other = bytes(8) if field == "life" else getattr(told, field) ^ 1
            return told._replace(**{field: other})

        one._about = about
        await settle(1.0)
        why = "sealed: another than who asked"
        assert (honest.sealer.dropped[why] > 0) == bool(field)
        assert bool(honest.sealer.counts["handshakes"]) == (not field)

    shake()


def test_a_list_of_another_authority_is_left_behind(tmp_path):
    path = tmp_path / "n1.state"
    for authority, is_ours in ((OTHER, False), (AUTHORITY, True)):
        state = State(path)
        state.revoked = revoke(authority, 3, frozenset({9})).data
        ring = own_sealer(1, state=state).ring
        assert ring.revoked.version == (3 if is_ours else 0)
        assert bool(state.revoked) == is_ours


def test_what_a_node_says_of_itself_has_room_for_long_names():
    long = "serial " + 300 * "x"
    told = About(1, 2, bytes(range(8)), 3, long, "\u00e4", b"certificate")
    assert read_about(told.encode()) == told._replace(own=long[:255])
