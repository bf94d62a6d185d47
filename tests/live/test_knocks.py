"""What strangers' first messages may cost, and who is answered nevertheless."""

from innervate.live.contact import KNOCKS
from innervate.live.knocks import SHUT_S
from tests.live import time_by_hand
from tests.live.pair import Wire, begin, join, network_sealer, settle, two
from tests.live.test_contact import BOTH, VALVE


@BOTH
def test_of_a_burst_of_first_messages_few_are_answered_and_then_nobody_is_for_a_moment(make):
    async def main():
        _, b = await two(make)
        other = Wire()
        sealer = begin(make(3), other)
        for _ in range(50):
            sealer._contacts[0].ask(2)
        sealer.stop()
        before, b.others = len(b.said), []
        for data in other.said:
            b.hear(data)
        answered = len(b.said) - before
        shut = b.sealer.dropped["sealed: too many first messages"]
        await settle(1.1 * SHUT_S)
        b.hear(other.said[0])
        return answered, shut, len(b.said) - before - answered

    assert time_by_hand.run(main()) == (8, 42, 1)


def test_who_has_shut_its_door_is_still_answered():
    """A node that is started again is found by the one that is flooded, not by its own asking."""

    async def main():
        a, b = Wire("a"), Wire("b")
        join(a, b)
        begin(network_sealer(1), a)
        await settle(0)
        noise = bytes([0xD1]) + bytes(64)
        sealer = begin(network_sealer(2), b)
        for _ in range(200):
            for _ in range(2 * KNOCKS):
                b.hear(noise)
            await settle(0.01)
        assert sealer.dropped["sealed: too many first messages"] > 10_000
        a.frame(VALVE)
        await settle(0)
        return b.frames()

    assert time_by_hand.run(main()) == [VALVE]


def test_before_first_contact_people_are_told_what_comes_and_then_calls_alone_are_heard():
    """So that a neighbour without keys, or with another one, is no riddle."""

    async def main():
        b, said = Wire("b"), []
        b.let_in = lambda anybody, known: said.append((list(anybody), len(known)))
        begin(network_sealer(2), b)
        await settle(0)
        for data in (b"in the clear", bytes([0xD7]) + bytes(64)):
            b.hear(data)
        dropped = dict(b.sealer.dropped)
        a = Wire("a")
        join(a, b)
        begin(network_sealer(1), a)
        await settle(1.0)
        return said[0], dropped, said[-1][0]

    before = [(0, 0xBF), (0xD0, 0xFF)]
    told = {"not sealed": 1, "sealed: unknown key": 1}
    assert time_by_hand.run(main()) == ((before, 1), told, [(0xD1, 0xD1)])


def test_noise_in_the_clear_shuts_no_door_once_somebody_is_there():
    async def main():
        _, b = await two()
        for _ in range(10 * KNOCKS):
            b.hear(b"noise")
        return b.sealer._contacts[0].knocks.is_open

    assert time_by_hand.run(main())


def test_a_neighbour_that_is_started_again_is_found_by_the_node_that_is_flooded():
    async def main():
        a, b = await two()
        a.sealer.stop()
        begin(network_sealer(1), a)
        noise, seconds = bytes([0xD1]) + bytes(64), 0.0
        while (1, VALVE) not in b.got:
            for _ in range(2 * KNOCKS):
                b.hear(noise)
            a.frame(VALVE)
            b.frame(b"beacon")
            await settle(0.02)
            seconds += 0.02
        return seconds

    assert time_by_hand.run(main()) < 3.7  # nothing is heard for 3 s, at the most
