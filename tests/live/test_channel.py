"""A shared channel, to the microsecond: who hears what, who is deaf, what is refused."""

import asyncio
import socket

import pytest

from innervate.live import channel
from innervate.live.channel import DELAY_US, LEASE_US, SLOTS_MAX, STATIONS, Medium
from innervate.live.channel_radio import JOIN, PLUG, SEND, WHO, read_heard
from innervate.live.engine import clock_us
from innervate.live.errors import LiveError
from tests.live import time_by_hand

SLOT, TURN = 10_000, 5_000
NOBODY, ONE, SOME = (False, False), (True, True), (True, False)  # (carrier, voice of one)


class Team:
    """Stations on a channel; times are from the beginning of the test, us."""

    def __init__(self, count, turnaround_us=TURN):
        self.medium = Medium(SLOT, turnaround_us)
        self.sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(count)]

    async def __aenter__(self):
        self.medium.open(("127.0.0.1", 0))
        self.began = clock_us()
        for number, sock in enumerate(self.sockets):
            sock.bind(("127.0.0.1", 0))
            sock.setblocking(False)
            self.take(number, JOIN.pack(b"J", number))
        assert [self.heard(i) for i in range(len(self.sockets))] == [
            [("L", 0, NOBODY)] for _ in self.sockets]  # fmt: skip
        return self

    async def __aexit__(self, *_):
        self.medium.close()
        for sock in self.sockets:
            sock.close()

    def where(self, number):
        return self.sockets[number].getsockname()

    def take(self, number, data, where=None):
        self.medium.take(data, where or self.where(number))

    def send(self, number, at_us, slots=2, data=b"f"):
        """Decided at a time: on the air a turnaround later."""
        self.take(number, SEND.pack(b"T", number, self.began + at_us, slots) + data)

    async def until(self, at_us):
        await asyncio.sleep((self.began + at_us - clock_us()) / 1e6)

    def heard(self, number):
        """What a station was told since it was last asked: (what, when, carrier or frame)."""
        found = []
        while True:
            try:
                data = self.sockets[number].recv(999)
            except BlockingIOError:
                return found
            if data[:1] == WHO:
                continue
            what, at, *carrier, frame = read_heard(data)
            found.append((what.decode(), at - self.began, frame or tuple(carrier)))


def with_team(count, turnaround_us=TURN):
    """A test that is run with a team, under simulated time."""

    def decorate(test):
        def run(*args, **keys):
            async def main():
                async with Team(count, turnaround_us) as team:
                    await test(team, *args, **keys)

            time_by_hand.run(main())

        run.__name__ = test.__name__
        return run

    return decorate


@with_team(3)
async def test_a_frame_alone_is_heard_by_all_but_its_sender(team):
    team.send(0, 0, 2, b"hello")
    await team.until(100_000)
    begin, end = TURN + DELAY_US, TURN + 2 * SLOT + DELAY_US
    told = [("C", begin, ONE), ("F", end, b"hello"), ("C", end, NOBODY)]
    assert team.heard(1) == team.heard(2) == told
    assert team.heard(0) == [("R", TURN + 2 * SLOT + TURN, NOBODY)]
    at = team.began + TURN
    assert list(team.medium.log) == [(at, at + 2 * SLOT, 0, b"hello")]
    assert (team.medium.collisions, team.medium.late, team.medium.unsound) == (0, 0, 0)


@with_team(3)
async def test_of_frames_that_overlap_none_is_received(team):
    team.send(0, 0, 2)
    team.send(1, 15_000, 2)  # on the air from 20 to 40 ms; the first from 5 to 25
    await team.until(100_000)
    assert [(what, at - DELAY_US, told) for what, at, told in team.heard(2)] == [
        ("C", 5_000, ONE),
        ("C", 20_000, SOME),
        ("C", 25_000, ONE),
        ("C", 40_000, NOBODY),
    ]
    # The first listens again while the second sends, and has not heard it from its start.
    assert team.heard(0) == [("R", 30_000, ONE), ("C", 40_000 + DELAY_US, NOBODY)]
    assert team.heard(1)[-1] == ("R", 45_000, NOBODY)
    assert team.medium.collisions == 1


@with_team(3)
async def test_a_frame_that_begins_as_another_ends_is_heard(team):
    team.send(0, 0, 1)  # until 15 ms
    team.send(1, 10_001, 1)  # from 15.001 ms on
    await team.until(100_000)
    assert [told for what, _, told in team.heard(2) if what == "F"] == [b"f", b"f"]
    assert team.medium.collisions == 0


@pytest.mark.parametrize(("behind_us", "hears"), [(1_000, False), (4_400, False), (4_600, True)])
def test_who_turns_round_is_deaf_to_what_begins_meanwhile(behind_us, hears):
    @with_team(3)
    async def play(team):
        team.send(0, 0, 1)  # until 15 ms; deaf until 20 ms
        team.send(1, 10_000 + behind_us, 3, b"answer")
        await team.until(100_000)
        begin, end = 15_000 + behind_us + DELAY_US, 45_000 + behind_us + DELAY_US
        assert ("F", end, b"answer") in team.heard(2)
        heard = team.heard(0)
        assert (("F", end, b"answer") in heard) == hears
        assert heard[0] == ("R", 20_000, NOBODY if hears else ONE)
        assert (("C", begin, ONE) in heard) == hears
        assert heard[-1] == ("C", end, NOBODY)

    play()


@pytest.mark.parametrize("turn_us", [0, 1, DELAY_US - 1, DELAY_US, DELAY_US + 1])
@pytest.mark.parametrize("behind_us", [None, 0, 100, DELAY_US, 2_000])
def test_a_stations_own_signal_is_no_carrier_to_it(turn_us, behind_us):
    """It may listen again before the others have heard its end. As in the simulator's medium, a
    station counts what the others send; here an answer begins so long after its own end."""

    @with_team(3, turn_us)
    async def play(team):
        end, answer = turn_us + SLOT, behind_us is not None
        team.send(0, 0, 1)
        if answer:
            team.send(1, SLOT + behind_us, 1, b"answer")
        await team.until(100_000)
        ready, began = end + turn_us, end + (behind_us or 0) + DELAY_US
        told = [("C", began, ONE), ("F", began + SLOT, b"answer"), ("C", began + SLOT, NOBODY)]
        if not answer:
            assert team.heard(0) == [("R", ready, NOBODY)]
        elif began > ready:
            assert team.heard(0) == [("R", ready, NOBODY), *told]
        elif began < ready:  # its beginning was missed
            assert team.heard(0) == [("R", ready, ONE), told[-1]]

    play()


@with_team(2)
async def test_who_begins_to_send_misses_what_it_was_hearing(team):
    team.send(0, 0, 3)  # from 5 to 35 ms
    await team.until(20_000)
    team.send(1, 20_000, 1)  # from 25 to 35 ms
    await team.until(100_000)
    assert [what for what, *_ in team.heard(1)] == ["C", "R"]
    assert team.medium.collisions == 1


@with_team(3)
async def test_without_its_aerial_a_station_neither_hears_nor_is_heard(team):
    team.take(1, PLUG.pack(b"P", 1, 0))
    assert team.heard(1) == [("C", 0, NOBODY)]
    team.take(1, PLUG.pack(b"P", 1, 0))
    assert team.heard(1) == []  # it is out already
    team.send(1, 0, 1, b"unheard")
    await team.until(40_000)
    assert team.heard(1) == [("L", 20_000, NOBODY)]  # and knows it
    assert team.heard(2) == []
    assert (len(team.medium.log), team.medium.collisions, team.medium.unsound) == (0, 0, 0)
    team.send(0, 40_000, 2)  # from 45 to 65 ms
    await team.until(50_000)
    team.take(1, PLUG.pack(b"P", 1, 1))
    await team.until(100_000)
    assert [(what, told) for what, _, told in team.heard(2)] == [
        ("C", ONE),
        ("F", b"f"),
        ("C", NOBODY),
    ]
    # In again in the middle of a frame: the carrier is there, the frame is not.
    assert team.heard(1) == [("C", 50_000, ONE), ("C", 65_000 + DELAY_US, NOBODY)]


@with_team(2)
async def test_an_aerial_that_comes_out_ends_what_is_heard(team):
    team.send(0, 0, 2)
    await team.until(10_000)
    team.take(1, PLUG.pack(b"P", 1, 0))
    team.take(1, PLUG.pack(b"P", 1, 1))
    await team.until(100_000)
    assert [(what, told) for what, _, told in team.heard(1)] == [
        ("C", ONE),
        ("C", NOBODY),
        ("C", ONE),
        ("C", NOBODY),
    ]


@with_team(2)
async def test_while_it_sends_a_station_is_not_told_that_its_aerial_moves(team):
    team.send(0, 0, 1)
    for plugged in (0, 1):
        team.take(0, PLUG.pack(b"P", 0, plugged))
    assert team.heard(0) == []
    await team.until(100_000)
    assert [what for what, *_ in team.heard(0)] == ["R"]


@pytest.mark.parametrize(("at_us", "start_us", "late"), [
    (-5_000, 0, 0), (-5_001, 0, 1), (-4_999, 1, 0), (-10_000_000, 0, 1), (-10_000_001, None, 0),
    (1_000_000, 1_005_000, 0), (1_000_001, None, 0),
])  # fmt: skip
def test_when_a_frame_goes_on_the_air(at_us, start_us, late):
    @with_team(2)
    async def play(team):
        await team.until(20_000_000)
        team.send(0, 20_000_000 + at_us, 1)
        starts = [start - team.began - 20_000_000 for start, *_ in team.medium.log]
        assert starts == ([] if start_us is None else [start_us])
        assert (team.medium.late, team.medium.unsound) == (late, start_us is None)

    play()


@with_team(2)
async def test_who_was_stopped_for_so_long_that_its_frame_is_refused_listens_again(team):
    await team.until(20_000_000)
    team.send(0, 9_999_999, 1)
    assert team.heard(0) == [("L", 20_000_000, NOBODY)]
    team.send(0, 20_000_000, 1)
    team.send(0, 9_999_999, 1)  # it sends: told when that is over, and not before
    assert team.heard(0) == []
    await team.until(20_100_000)
    assert team.heard(0) == [("R", 20_020_000, NOBODY)]


@pytest.mark.parametrize(("slots", "sound"), [(0, False), (1, True), (SLOTS_MAX, True),
                                              (SLOTS_MAX + 1, False)])  # fmt: skip
def test_how_long_a_frame_may_be(slots, sound):
    @with_team(1)
    async def play(team):
        team.send(0, 0, slots)
        assert [end - start for start, end, *_ in team.medium.log] == [slots * SLOT] * sound
        assert team.medium.unsound == (not sound)

    play()


@pytest.mark.parametrize(("next_us", "sound"), [(9_999, False), (10_000, True)])
def test_a_station_sends_one_frame_after_the_other(next_us, sound):
    @with_team(2)
    async def play(team):
        team.send(0, 0, 1)
        team.send(0, next_us, 1)
        assert len(team.medium.log) == 1 + sound
        await team.until(100_000)
        # It listens again once, after the last.
        assert [at for what, at, _ in team.heard(0)] == [15_000 + TURN + 10_000 * sound]

    play()


@pytest.mark.parametrize(("after_us", "moved"), [(LEASE_US - 1, False), (LEASE_US, True)])
def test_a_stations_place_is_its_own_for_a_while(after_us, moved):
    @with_team(2)
    async def play(team):
        await team.until(1_000_000)
        team.take(0, JOIN.pack(b"J", 0))  # still there
        await team.until(1_000_000 + after_us)
        team.take(0, JOIN.pack(b"J", 0), team.where(1))
        assert team.medium.unsound == (not moved)
        assert team.heard(0) == []
        assert team.heard(1) == ([("L", 1_000_000 + after_us, NOBODY)] if moved else [])

    play()


@with_team(4)
async def test_who_joins_again_is_told_who_is_there_with_an_aerial(team):
    def told():
        team.take(0, JOIN.pack(b"J", 0))
        return team.sockets[0].recv(99)

    await team.until(1_000_000)
    team.take(1, JOIN.pack(b"J", 1))
    team.take(2, PLUG.pack(b"P", 2, 0))
    assert told() == WHO + b"\0\0\0\1\0\3"
    await team.until(LEASE_US)
    assert told() == WHO + b"\0\0\0\1"  # the others have not joined for so long


@with_team(2)
async def test_who_joins_late_is_told_what_is_on_the_air(team):
    team.send(0, 0, 2)
    await team.until(10_000)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", 0))
        for number in (STATIONS - 1, STATIONS):
            team.take(0, JOIN.pack(b"J", number), sock.getsockname())
        assert read_heard(sock.recv(99))[2:4] == ONE
        assert team.medium.unsound == 1  # that number was too great


UNSOUND = [
    b"", b"J", JOIN.pack(b"J", 0) + b"x", b"X" + JOIN.pack(b"J", 0)[1:],
    PLUG.pack(b"P", 0, 2), PLUG.pack(b"P", 1, 0), PLUG.pack(b"P", 0, 1)[:-1],
    SEND.pack(b"T", 0, 0, 1), SEND.pack(b"T", 1, 0, 1) + b"f", SEND.pack(b"T", 9, 0, 1) + b"f",
]  # fmt: skip


@pytest.mark.parametrize("data", UNSOUND, ids=repr)
def test_what_no_station_says_is_counted_and_changes_nothing(data):
    @with_team(2)
    async def play(team):
        team.take(0, data)
        assert team.medium.unsound == 1
        await team.until(100_000)
        assert [team.heard(i) for i in (0, 1)] == [[], []]
        assert not team.medium.log

    play()


@with_team(1)
async def test_what_stations_say_comes_in_at_the_channels_address(team):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.setblocking(False)
        sock.connect(team.medium._socket.getsockname())
        for data in (JOIN.pack(b"J", 7), b"nothing", SEND.pack(b"T", 7, team.began, 1) + b"f"):
            sock.send(data)
            await team.until(1_000)
        await team.until(100_000)
        assert [read_heard(sock.recv(99))[0] for _ in range(2)] == [b"L", b"R"]
        assert [station for *_, station, _ in team.medium.log] == [7]
        assert team.medium.unsound == 1
        assert [told for what, _, told in team.heard(0) if what == "F"] == [b"f"]


@with_team(2)
async def test_a_channel_that_is_closed_says_nothing_more_and_gives_its_address_back(team):
    where = team.medium._socket.getsockname()
    other = Medium()
    with pytest.raises(LiveError, match=f"cannot use 127.0.0.1:{where[1]}: "):
        other.open(where)
    team.send(0, 0, 2)
    team.medium.close()
    team.medium.close()
    assert other.open(where) == where
    other.close()
    await team.until(100_000)
    assert team.heard(1) == []


def test_the_log_holds_the_newest_transmissions():
    @with_team(1)
    async def play(team):
        for k in range(channel.LOGGED + 3):
            team.medium.log.append((k, k, 0, b""))
        assert [team.medium.log[0][0], len(team.medium.log)] == [3, channel.LOGGED]

    play()
