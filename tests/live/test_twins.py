"""Two nodes with one number: when a node that hears both takes them for that, and tells them."""

import pytest

from innervate.live import contact, keys
from innervate.live.contact import TWIN
from innervate.live.keyring import LIFE_BYTES, Proven
from innervate.live.keys import LIVES, TELL_US, TWIN_US
from innervate.wire import seal
from tests.live import time_by_hand
from tests.live.pair import Wire, begin, join, joined, network_sealer, own_sealer, settle, two
from tests.live.test_rotation import timed


def who(life, number=5):
    return Proven(number, bytes([life]) * LIFE_BYTES, 1)


class Told:
    """In place of a contact: two sessions with a number, and what is said in them."""

    def __init__(self, *people):
        self.sessions = {5: [type("Session", (), {"who": one})() for one in people]}
        self.said = []

    def tell(self, session, kind, body):
        self.said.append((session.who.life[0], kind, body[0]))

    def stop(self):
        pass


@timed
async def test_an_older_life_is_another_node_once_the_newer_is_a_while_old():
    sealer = network_sealer(1)
    told = sealer._contacts[0] = Told(who(2), who(1))
    for life in (1, 2):
        sealer.note_life(who(life))
    sealer._look_for_twin(who(2))
    await settle((TWIN_US - 1) / 1e6)
    sealer._look_for_twin(who(1))
    assert (sealer.twins, told.said) == ({}, []), "frames of its last life, still under way"
    await settle(1e-6)
    sealer._look_for_twin(who(1))
    assert sealer.twins == {5: "both are heard here"}
    both = [(2, TWIN, 1), (1, TWIN, 2)]
    assert told.said == both, "each is told the other's life"
    await settle((TELL_US - 1) / 1e6)
    sealer._look_for_twin(who(1))
    assert told.said == both
    assert sealer.counts["two nodes with one number"] == 2
    await settle(1e-6)
    sealer._look_for_twin(who(1))
    assert told.said == both + both


@timed
async def test_who_is_heard_for_the_first_time_or_goes_on_is_no_twin():
    sealer = network_sealer(1)
    for life in (1, 1, 2, 3):
        sealer.note_life(who(life))
        sealer._look_for_twin(who(life))
        sealer._look_for_twin(who(9, number=6))
        await settle(2 * TWIN_US / 1e6)
    assert (sealer.twins, sealer.counts) == ({}, {})


def test_two_that_take_turns_are_twins_as_long_as_the_first_is_remembered():
    for between, is_twin in ((LIVES - 1, True), (LIVES, False)):
        sealer = network_sealer(1)
        for life in range(between + 1):
            sealer.note_life(who(life))
        sealer.note_life(who(0))
        assert bool(sealer.twins) == is_twin
        assert sealer._lives[5][0] == who(0).life
        assert len(sealer._lives[5]) == LIVES


@timed
async def test_a_node_is_told_of_its_twin_but_not_of_itself():
    a, b = await two()
    (session,) = contact_of(b).all_sessions()
    contact_of(b).tell(session, TWIN, a.sealer.life)
    await settle()
    assert a.sealer.twins == {}
    contact_of(b).tell(session, TWIN, bytes(LIFE_BYTES))
    await settle()
    assert a.sealer.twins == {1: "node 2 hears both"}


def contact_of(wire):
    return wire.sealer._contacts[wire.port]


@pytest.mark.parametrize("make", [network_sealer, own_sealer])
@pytest.mark.parametrize("is_group", [False, True])
def test_two_that_hear_each_other_with_one_number_both_say_so(make, is_group):
    async def main():
        wires = [Wire(name, is_group=is_group) for name in "ab"]
        join(*wires)
        for wire in wires:
            begin(make(1), wire)
        await settle(2.0)
        assert [wire.sealer.twins for wire in wires] == [{1: "it is on a"}, {1: "it is on b"}]
        assert all(not contact_of(wire).sessions for wire in wires)
        calls = [len(wire.said) for wire in wires]
        await settle(2.0)
        assert all(
            len(wire.said) - before < 20 for wire, before in zip(wires, calls, strict=True)
        ), "they do not answer each other for ever"

    time_by_hand.run(main())


@pytest.mark.parametrize("make", [network_sealer, own_sealer])
@pytest.mark.parametrize("is_group", [False, True])
def test_a_recording_of_its_own_calls_is_no_twin(make, is_group):
    async def main():
        before = Wire(is_group=is_group)
        begin(make(1), before)
        await settle()
        before.sealer.stop()
        calls = [data for data in before.said if data[0] >= seal.FIRST]
        now, listener = Wire(is_group=is_group), Wire()
        now.others = [listener]
        begin(make(1), now)
        for data in calls:
            now.hear(data)
            await settle()
        assert len(calls) >= 2
        assert now.sealer.dropped["sealed: another with our number"] == len(calls)
        assert now.sealer.twins == {}
        assert not contact_of(now).sessions

    time_by_hand.run(main())


@pytest.mark.parametrize("is_group", [False, True])
def test_two_with_one_number_whose_answers_are_lost_do_not_ask_each_other_for_ever(is_group):
    async def main():
        wires = [Wire(name, is_group=is_group) for name in "ab"]
        join(*wires)
        for wire in wires:
            wire.change = lambda data: [] if data[0] == seal.SECOND else [data]
            begin(network_sealer(1), wire)
        await settle(10.0)
        for wire in wires:
            assert sum(data[0] >= seal.FIRST for data in wire.said) < 40
            assert wire.sealer.twins == {}

    time_by_hand.run(main())


@pytest.mark.parametrize("is_group", [False, True])
def test_its_own_calls_played_back_do_not_put_out_a_question_under_way(is_group):
    async def main():
        before, now = Wire(is_group=is_group), Wire(is_group=is_group)
        begin(network_sealer(1), before)
        await settle(5.0)
        before.sealer.stop()
        calls = [data for data in before.said if data[0] >= seal.FIRST]
        begin(network_sealer(1), now)
        await settle(0.01)
        contact_of(now).stop()
        asked = list(contact_of(now)._asked)
        for data in (2 * calls)[: contact.ASKED + 1]:
            now.hear(data)
        assert set(asked) <= set(contact_of(now)._asked)
        assert len(contact_of(now)._asked) == len(asked) + 1

    time_by_hand.run(main())


@timed
async def test_a_twin_that_goes_on_calling_is_told_of_as_long_as_it_does():
    a, _twin = joined(network_sealer(1), network_sealer(1), ("a", "twin"))
    await settle(1.0)
    contact_of(a).stop()  # it has another neighbour on this path, and asks nobody
    await settle(keys.TWINS_US / 1e6 + 10)
    assert a.sealer.status()["twins"] == {"1": "it is on a"}


@pytest.mark.parametrize(("number", "why"), [
    (3, ""), (4, "from no node of ours"), (1, "another with our number"),
])  # fmt: skip
def test_whom_a_node_believes_to_be_who_he_says(number, why):
    sealer = network_sealer(1, nodes=4)
    about = keys.About(number, 1, bytes(LIFE_BYTES), 0, "", "")
    assert sealer.objection(about, Wire()) == why
    own = about._replace(number=1, life=sealer.life)
    assert sealer.objection(own, Wire()) == "our own"


@pytest.mark.parametrize(("claimed", "is_bound", "why"), [
    (("b:1", "a:1"), True, ""), (("c:1", "a:1"), True, "from another place"),
    (("b:1", "c:1"), True, "from another place"), (("c:1", "c:1"), False, ""),
])  # fmt: skip
def test_both_ends_of_a_path_have_to_be_where_they_are_known(claimed, is_bound, why):
    sealer = network_sealer(1)
    sealer.has_bound_ends = is_bound
    about = keys.About(2, 1, bytes(LIFE_BYTES), 0, *claimed)
    assert sealer.objection(about, Wire(ends=("a:1", "b:1"))) == why


@timed
async def test_a_session_whose_numbers_are_used_up_seals_nothing_more():
    a, b = await two()
    one = contact_of(a)
    one._current.counter = contact.COUNTERS - 1
    a.frame(b"the last")
    said = len(a.said)
    a.frame(b"one more")
    one.tell(one._current, contact.ALIVE)
    assert len(a.said) == said
    assert a.sealer.counts["held: no session yet"] == 1
    await settle(0.05)
    assert b.frames() == [b"the last"]
    await settle(1.0)  # it asks for a new one at its next look
    a.frame(b"goes on")
    await settle()
    assert b.frames() == [b"the last", b"goes on"]


@timed
async def test_handshakes_are_counted_as_they_are_and_those_put_out_begin_anew():
    a, b = await two()
    for wire in (a, b):
        counts = wire.sealer.counts
        assert counts["handshakes"] >= 1
        assert counts["handshake messages"] == sum(
            said[0] in (seal.SECOND, seal.THIRD) or said[0] >= seal.FIRST
            for said in wire.others[0].said
        )
        assert wire.sealer.refused == 0
    before = contact_of(a).all_sessions()
    assert not contact_of(a).put_out(lambda who: who.number != 2)
    assert contact_of(a).all_sessions() == before
    assert contact_of(a).put_out(lambda who: who.number == 2)
    assert (contact_of(a).sessions, contact_of(a)._by_index, contact_of(a)._current) == (
        {},
        {},
        None,
    )
    assert not contact_of(a)._answered
    assert not contact_of(a)._asked
    begin(b.sealer, b)
    await settle()
    assert [one.who.number for one in contact_of(a).all_sessions()] == [2]


@timed
async def test_a_twin_that_is_given_another_number_is_forgotten():
    sealer = network_sealer(1)
    sealer.note_twin(5, "both are heard here")
    sealer.note_twin(1, "it is on udp")
    await settle(keys.TWINS_US / 1e6 - 1)
    sealer.note_twin(5, "node 3 hears both")
    await settle(1.000001)
    assert sealer.status()["twins"] == {"5": "node 3 hears both"}
    await settle(keys.TWINS_US / 1e6)
    assert "twins" not in sealer.status()
