"""How many callers are let in at once and how fast, and what Prometheus reads."""

import asyncio
import gc
import socket
from collections import Counter
from types import SimpleNamespace

import pytest

from innervate.live import metrics, status
from innervate.live.admission import CLOSE_S, REST_S, BoundedListener, Bounds
from tests.live import time_by_hand

SMALL = Bounds(most=3, burst=2, full=b"full\n", limit=64)


class Place:
    """A listener, and callers of it."""

    def __init__(self, bounds):
        sock = socket.create_server(("127.0.0.1", 0))
        self.where = sock.getsockname()
        self.counts, self.inside, self.ended = Counter(), [], 0
        self.listener = BoundedListener("here", sock, self.serve, bounds, self.counts)
        self.listener.open()

    async def serve(self, reader, writer):
        """Served until they say something, or for ever."""
        self.inside.append(writer)
        try:
            writer.write(await reader.readline())
        finally:
            self.inside.remove(writer)
            self.ended += 1

    def call(self):
        caller = socket.create_connection(self.where)
        caller.settimeout(0.0)
        return caller

    async def close(self, callers):
        self.listener.close()
        await asyncio.sleep(0.01)
        for caller in callers:
            caller.close()


def read(caller):
    """What a caller was sent; None if nothing yet."""
    try:
        return caller.recv(99)
    except BlockingIOError:
        return None


def with_place(bounds):
    def decorate(test):
        def run():
            async def main():
                await test(Place(bounds))

            time_by_hand.run(main())

        run.__name__ = test.__name__
        return run

    return decorate


@with_place(SMALL)
async def test_a_burst_is_let_in_and_the_next_after_a_rest(place):
    callers = [place.call() for _ in range(3)]
    await asyncio.sleep(REST_S - 0.001)
    assert len(place.inside) == 2
    assert place.counts == {"here: made to wait": 1}
    await asyncio.sleep(0.002)
    assert len(place.inside) == 3
    assert [read(caller) for caller in callers] == [None] * 3
    await place.close(callers)


@with_place(SMALL)
async def test_one_too_many_is_told_and_hung_up_on_until_somebody_leaves(place):
    callers = [place.call() for _ in range(4)]
    await asyncio.sleep(3 * REST_S)
    assert len(place.inside) == 3
    told = [read(caller) for caller in callers]
    assert sorted(told, key=str) == [None, None, None, b"full\n"]
    assert read(callers[told.index(b"full\n")]) == b""
    assert place.counts["here: turned away"] == 1
    callers[told.index(None)].send(b"bye\n")
    await asyncio.sleep(REST_S)
    assert read(callers[told.index(None)]) == b"bye\n"
    callers.append(place.call())
    await asyncio.sleep(3 * REST_S)
    assert len(place.inside) == 3
    assert place.counts["here: turned away"] == 1
    await place.close(callers)


@with_place(SMALL)
async def test_who_was_served_is_hung_up_on_at_once(place):
    caller = place.call()
    await asyncio.sleep(REST_S)
    caller.send(b"bye\n")
    await asyncio.sleep(CLOSE_S / 50)
    assert (read(caller), read(caller)) == (b"bye\n", b"")
    await place.close([caller])


@with_place(SMALL)
async def test_a_caller_for_whom_there_is_no_memory_is_hung_up_on_and_counted(place):
    async def serve(reader, writer):
        raise MemoryError

    told = []
    loop = asyncio.get_running_loop()
    loop.set_exception_handler(lambda _, context: told.append(context))
    place.listener._serve = serve
    caller = place.call()
    await asyncio.sleep(REST_S)
    assert read(caller) == b""
    gc.collect()  # nobody is left who could ask what the task ended with
    assert (place.counts, told) == ({"here: no memory left": 1}, [])
    await place.close([caller])


@with_place(SMALL)
async def test_who_is_in_is_hung_up_on_at_the_end_and_nobody_comes_in(place):
    callers = [place.call(), place.call()]
    await asyncio.sleep(0.01)  # during the rest
    assert len(place.inside) == 2
    place.listener.close()
    place.listener.close()
    await asyncio.sleep(1)
    assert (place.inside, place.ended) == ([], 2)
    assert [read(caller) for caller in callers] == [b"", b""]
    with pytest.raises(ConnectionRefusedError):
        place.call()
    await place.close(callers)


@pytest.mark.parametrize(("bounds", "at_once", "each_second"), [
    (metrics.BOUNDS, 16, 160), (status.BOUNDS, 64, 1280),
])  # fmt: skip
def test_the_bounds_are_those_of_the_page_about_live_nodes(bounds, at_once, each_second):
    assert (bounds.most, bounds.burst / 0.05, REST_S) == (at_once, each_second, 0.05)


TOLD = {
    "up_s": 12.5, "state": {"trouble": ""}, "counters": {"frames": 7, 'a "b"\\': 1},
    "paths": [{"name": "udp 1", "broken": False, "counters": {"sent": 3, "received": 4}},
              {"name": "serial", "broken": True, "counters": {}}],
    "neighbours": [{"node": 2, "quality": 0.75}, {"node": 3, "quality": None}],
}  # fmt: skip
PAGE = """\
# TYPE innervate_up_seconds gauge
innervate_up_seconds{node="n1"} 12.5
# TYPE innervate_state_written gauge
innervate_state_written{node="n1"} 1
# TYPE innervate_events_total counter
innervate_events_total{node="n1",what="frames"} 7
innervate_events_total{node="n1",what="a _b__"} 1
# TYPE innervate_path_broken gauge
innervate_path_broken{node="n1",path="udp 1"} 0
innervate_path_broken{node="n1",path="serial"} 1
# TYPE innervate_path_total counter
innervate_path_total{node="n1",path="udp 1",what="sent"} 3
innervate_path_total{node="n1",path="udp 1",what="received"} 4
# TYPE innervate_link_quality gauge
innervate_link_quality{node="n1",neighbour="2"} 0.75
"""


@pytest.mark.parametrize(("state", "line"), [
    ({"trouble": ""}, 'innervate_state_written{node="n1"} 1\n'),
    ({"trouble": "no space"}, 'innervate_state_written{node="n1"} 0\n'),
    (None, ""),
])  # fmt: skip
def test_the_page_for_prometheus_has_every_count_of_the_status(state, line):
    node = SimpleNamespace(name="n1", status=lambda: TOLD | {"state": state})
    page = "".join(f"{one}\n" for one in metrics.lines(node))
    head = "# TYPE innervate_state_written gauge\n"
    ours = 'innervate_state_written{node="n1"} 1\n'
    assert page == PAGE.replace(head + ours, head + line if line else "")
