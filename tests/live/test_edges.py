"""Live nodes at the edges of what they take: the last that is taken, the first that is not."""

import asyncio

import pytest

from innervate.live.channel_radio import PLUG
from innervate.live.engine import Engine, clock_us
from innervate.live.machine import Machine, on
from innervate.live.pending import Pending
from innervate.live.serial import SerialLink
from innervate.networks.mesh.live.alarms import place_of
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from tests.live import time_by_hand
from tests.live.noted import HERE, THERE, Noted
from tests.live.time_by_hand import timed


class Full:
    """A serial port that takes nothing."""

    def fileno(self):
        return 0

    def write(self, data):
        raise BlockingIOError

    def close(self):
        pass


class Ports(Machine):
    def open_serial(self, device, baud):
        return Full()


def test_so_many_bytes_wait_for_a_serial_line(monkeypatch):
    async def main():
        loop = asyncio.get_running_loop()
        for name in ("add_reader", "add_writer", "remove_reader", "remove_writer"):
            monkeypatch.setattr(loop, name, lambda *_: None)
        link = SerialLink("/dev/ttyX", 115_200)
        await link.open(lambda *_: None)
        taken = [link.write(bytes(16_383)), link.write(b"1"), link.write(b"2"), link.write(b"3")]
        link.close()
        return taken

    with on(Ports()):
        assert asyncio.run(main()) == [True, True, True, False]


@pytest.mark.parametrize("weights", [[1] * 12, [3, 3, 4, 1, 1], [11, 10]])
def test_items_wait_up_to_their_weight(weights):
    async def main():
        pending = Pending(10, lambda item: item)
        for _ in range(2):  # there is room again for all
            for weight in weights:
                pending.put(weight)
            there, missed = await pending.take()
            assert sum(there) == 10
            assert missed == len(weights) - len(there)

    asyncio.run(main())


@pytest.mark.parametrize(
    ("frame", "is_taken"),
    [
        ({"slots": 1}, True),
        ({"slots": 0}, False),
        ({"slots": 4095}, True),
        ({"slots": 4096}, False),
        ({"slots": 5, "size": 37}, True),
        ({"slots": 5, "size": 38}, False),
        ({"late_us": 10_000_000}, True),
        ({"late_us": 10_000_001}, False),
        ({"late_us": -1_000_000}, True),
        ({"late_us": -1_000_001}, False),
        ({"where": THERE}, False),
        ({"station": 1}, False),
    ],
)
def test_what_a_medium_takes_of_a_station(frame, is_taken):
    async def main():
        air = Noted()
        assert air.join(0)
        return air.send(**{"station": 0, **frame})

    assert time_by_hand.run(main()) == is_taken


@timed
async def test_a_station_sends_one_frame_at_a_time():
    air = Noted()
    air.join(0)
    assert air.send(0, slots=3)
    await asyncio.sleep(0.0299)  # the first is on the air until 35 ms, a turnaround after
    assert not air.send(0)
    await asyncio.sleep(0.0002)
    assert air.send(0)


@pytest.mark.parametrize(("gone_s", "is_let_in"), [(2.499, False), (2.5, True)])
def test_a_station_that_is_gone_may_come_back_elsewhere(gone_s, is_let_in):
    async def main():
        air = Noted()
        assert air.join(3)
        await asyncio.sleep(1.0)
        assert air.join(3), "here it may say so again and again"
        await asyncio.sleep(gone_s)
        return air.join(3, THERE), list(air.medium._ears)

    assert time_by_hand.run(main()) == (is_let_in, [3])


def test_stations_have_numbers_below_1024():
    async def main():
        air = Noted()
        return air.join(1023), air.join(1024, THERE)

    assert time_by_hand.run(main()) == (True, False)


def test_a_plug_is_in_or_out_and_its_station_is_told_once():
    async def main():
        air = Noted()
        air.join(0)
        air.told.clear()
        for plugged in (2, 0, 0, 1):
            air.medium.take(PLUG.pack(b"P", 0, plugged), HERE)
        await asyncio.sleep(1.0)
        return air.medium.unsound, air.told

    unsound, told = time_by_hand.run(main())
    assert unsound == 1
    assert told == [("C", 0, False, False, 9), ("C", 10_000, False, False, 9)]


def test_a_frame_is_on_the_air_a_turnaround_later_for_its_slots():
    """Two hear it, half a millisecond later each time; who sent is deaf until it has turned."""

    async def main():
        air = Noted()
        for station in range(3):
            air.join(station, ("127.0.0.1", station))
        assert [told[:1] + told[4:] for told in air.told] == [("L", 0), ("L", 1), ("L", 2)]
        air.told.clear()
        air.send(1, slots=2, size=3, where=("127.0.0.1", 1))
        await asyncio.sleep(1.0)
        assert [(a - air.began, b - air.began, who) for a, b, who, _ in air.medium.log] == [
            (5_000, 25_000, 1)
        ]
        return air.told

    assert time_by_hand.run(main()) == [
        ("C", 5_500, True, True, 0),
        ("C", 5_500, True, True, 2),
        ("F", 25_500, True, True, 0, bytes(3)),
        ("F", 25_500, True, True, 2, bytes(3)),
        ("C", 25_500, False, False, 0),
        ("C", 25_500, False, False, 2),
        ("R", 30_000, False, False, 1),
    ]


def test_where_two_send_at_once_nobody_hears_either():
    async def main():
        air = Noted(slot_us=1000, turnaround_us=1000)
        for station in range(3):
            air.join(station, ("127.0.0.1", station))
        air.told.clear()
        air.send(0, slots=3, where=("127.0.0.1", 0))
        await asyncio.sleep(0.001)
        air.send(1, slots=3, where=("127.0.0.1", 1))
        await asyncio.sleep(1.0)
        return air.told, air.medium.collisions, air.medium.late

    told, collisions, late = time_by_hand.run(main())
    assert (collisions, late) == (1, 0)
    assert [one for one in told if one[4] == 2] == [
        ("C", 1500, True, True, 2),
        ("C", 2500, True, False, 2),
        ("C", 4500, True, True, 2),
        ("C", 5500, False, False, 2),
    ]
    assert [one for one in told if one[4] == 0] == [
        ("R", 5000, True, True, 0),
        ("C", 5500, False, False, 0),
    ]


@pytest.mark.parametrize(("late_us", "is_late"), [(5000, 0), (5001, 1)])
def test_what_should_have_begun_before_it_was_known_is_counted(late_us, is_late):
    async def main():
        air = Noted()
        air.join(0)
        air.send(0, late_us=late_us)
        (sent,) = air.medium.log
        assert sent[0] == air.began
        return air.medium.late

    assert time_by_hand.run(main()) == is_late


@pytest.mark.parametrize(("gone_s", "is_let_in"), [(2.499, False), (2.5, True)])
def test_an_address_may_be_another_station_once_its_own_is_gone(gone_s, is_let_in):
    async def main():
        air = Noted()
        air.join(3)
        await asyncio.sleep(gone_s)
        return air.join(4), list(air.medium._ears)

    assert time_by_hand.run(main()) == (is_let_in, [4 if is_let_in else 3])


@pytest.mark.parametrize(
    ("at_cm", "speed", "is_told"),
    [
        ((0, -7), (0, 1), (0, -4, 0, 0)),
        ((65_534, -65_534), (254, -254), (32_767, -32_767, 127, -127)),
        ((65_537, -65_537), (257, -1e9), (32_767, -32_767, 127, -127)),
        ((65_531, 65_532), (252, 251), (32_766, 32_766, 126, 126)),
    ],
)
def test_where_a_robot_is_in_what_an_alarm_can_hold(at_cm, speed, is_told):
    assert place_of(at_cm, speed, 2) == is_told


def test_of_an_engine_that_is_stopped_nothing_comes():
    async def main():
        sent = []
        stack = MeshStack(0, 0, mesh_parameters(2, {}), 5)
        engine = Engine(stack, lambda *one: sent.append(one), lambda *_: None, lambda *_: None,
                        lambda: None)  # fmt: skip
        engine.start()
        await asyncio.sleep(1.0)
        before = len(sent)
        assert before > 0
        engine.stop()
        assert engine.read(b"\x00" * 20) == "stopped"
        engine.call(lambda _: sent.append("called"), clock_us())
        await asyncio.sleep(5.0)
        return len(sent) - before, engine.counters

    more, counters = time_by_hand.run(main())
    assert more == 0
    assert not [name for name in counters if name.startswith("dropped")]
