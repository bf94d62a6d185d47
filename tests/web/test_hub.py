"""Pages that look on: what each is told and when, how many there may be; what a view remembers."""

import asyncio
import json
from types import SimpleNamespace

import pytest

from innervate.web import hub as hubs
from innervate.web.errors import Refused
from innervate.web.history import LOG, SERIES, History
from innervate.web.hub import ANSWERS_MAX, Hub
from innervate.web.messages import Kill
from innervate.web.recovery import Recovery
from innervate.web.snapshot import DELTA_MAX, Part, Snapshot
from innervate.web.view import Memory, View
from tests.live import time_by_hand


class Source:
    """What is watched, held by the tests."""

    def __init__(self):
        self.history, self.scenes, self.closed = History(), 1, 0

    def close(self):
        self.closed += 1


def told(what):
    """Have `what(hub, open)` happen, where `open()` is a page that keeps what it is sent."""

    async def main():
        hub, tasks = Hub(Source()), []
        hub._loop = asyncio.get_running_loop()
        patch.setattr(hubs, "time", SimpleNamespace(monotonic=hub._loop.time))

        def open_page():
            lines = []

            async def send(text):
                lines.append(json.loads(text))

            page = hub.enter(send)
            if page is not None:
                tasks.append(asyncio.ensure_future(page.tell()))
            return page, lines

        try:
            return await what(hub, open_page)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    with pytest.MonkeyPatch.context() as patch:
        return time_by_hand.run(main())


SCENE = Part({"type": "scene"})


def newer(hub, **fields):
    hub._published(Snapshot(SCENE, fields, hub.source.history.newest, hub.newest))


async def soon():
    await asyncio.sleep(0.05)  # a state is shown thirty times a second


def test_a_page_is_told_the_newest_state_when_it_comes_and_each_later_one_once():
    async def look(hub, open_page):
        newer(hub, t_s=1.0)
        _, lines = open_page()
        await soon()
        assert lines == [{"type": "scene"}, {"type": "state", "t_s": 1.0}]
        newer(hub, t_s=2.0)
        newer(hub, t_s=3.0)  # what was between is told to nobody
        await soon()
        await soon()
        assert lines[2:] == [{"type": "state", "t_s": 3.0}]
        hub._wake_all()
        await soon()
        assert len(lines) == 3

    told(look)


def test_more_than_fits_into_one_message_follows_by_itself():
    async def look(hub, open_page):
        for at in range(2 * DELTA_MAX + 1):
            hub.source.history.add(SERIES, at, {"x": float(at)})
        newer(hub, t_s=1.0)
        _, lines = open_page()
        for _ in range(6):
            await soon()
        points = [point for line in lines for point in line.get("series", {}).get("x", [])]
        assert [value for _, value in points] == [float(at) for at in range(2 * DELTA_MAX + 1)]

    told(look)


def test_whoever_comes_after_the_end_is_told_that_it_is():
    async def look(hub, open_page):
        _, early = open_page()
        hub._ended("the network broke")
        await soon()
        assert (hub.over, early) == ("the network broke", [{"type": "end", "text": hub.over}])
        _, late = open_page()
        await soon()
        assert late == early

    told(look)


def test_there_is_room_for_so_many_and_again_when_one_has_left(monkeypatch):
    monkeypatch.setattr(hubs, "PAGES_MAX", 2)

    async def look(hub, open_page):
        (first, lines), (second, _) = open_page(), open_page()
        assert open_page()[0] is None
        hub.leave(first)
        hub.leave(first)
        assert open_page()[0] is not None
        assert second in hub.pages
        hub.say_end("over")
        await soon()
        assert lines == [], "who has left is told nothing"

    told(look)


def test_what_a_page_gives_goes_to_the_stage_and_what_is_none_is_answered():
    async def look(hub, open_page):
        given = []

        def submit(command, reply):
            given.append(command)
            if len(given) > 1:
                raise Refused("too many wait")
            reply({"type": "done"})

        hub.stage = SimpleNamespace(submit=submit)
        page, lines = open_page()
        page.take('{"do": "kill", "node": 3}')
        await soon()
        page.take('{"do": "kill", "node": 3}')
        page.take("rubbish")
        await soon()
        assert given == [Kill(3), Kill(3)]
        assert [line["type"] for line in lines] == ["done", "error", "error"]
        assert lines[1]["text"] == "too many wait"
        for number in range(ANSWERS_MAX + 3):
            page.answer({"n": number})
        await soon()
        assert [line["n"] for line in lines[3:]] == list(range(3, ANSWERS_MAX + 3))

    told(look)


class Watched(View):
    """A view of a network to which things are done."""

    def __init__(self, *faults):
        engine = SimpleNamespace(plan=SimpleNamespace(faults=faults), now_us=0, given=[])
        super().__init__(engine, History())
        self.memory = Memory()

    def _nothing(self, *_):
        return {}

    scene = points = cut = kill = make = event = arrays = note = _nothing

    def headline(self):
        return SimpleNamespace(shown=lambda: "well")

    def words(self, fault):
        return fault.words

    def takes(self, fault):
        return fault.words.startswith("-")


Watched.__abstractmethods__ = frozenset()


def fault(at_us, words):
    return SimpleNamespace(at_us=at_us, words=words)


def test_each_fault_is_told_once_in_order_of_time_and_may_be_gone_back_behind():
    cut, mend, late = fault(30, "- cut"), fault(20, "+ mended"), fault(10, "- early")
    view = Watched(cut, mend)
    view.engine.given.append(late)
    view.engine.now_us = 10
    assert view.tell_faults() == []
    memory = view.remember()
    view.engine.now_us = 30
    assert view.tell_faults() == [late, mend]
    recovery = view.memory.recovery
    assert (recovery.cause, recovery.at_us, recovery.closed) == ("- early", 10, False)
    assert view.is_open
    recovery.recovered_ms = 0.01
    assert not view.is_open
    view.engine.now_us = 31
    assert view.tell_faults() == [cut]
    assert view.memory.recovery.cause == "- cut"
    assert view.tell_faults() == []
    assert (view.memory.event_us, view.memory.fault) == (30, cut)
    view.engine.now_us = 1_000_030
    assert view.fields(flights=False)["since_cut_s"] == 1.0
    view.forget(memory)
    assert view.memory == memory
    assert view.memory is not memory
    assert view.fields(flights=False)["since_cut_s"] is None
    view.engine.now_us = 30
    assert view.tell_faults() == [late, mend]
    assert memory.recovery is None, "what is kept stays as it was"
    lines = [item.what for item in view.history.after(LOG, 0, 99, 99)]
    assert [line.get("mark") for line in lines] == ["loss", "return", "loss", "loss", "return"]


@pytest.mark.parametrize("recovered_ms", [None, 0.0, 2.5])
def test_a_recovery_is_closed_by_what_is_done_once_everybody_has_a_way(recovered_ms):
    one = Recovery("cut", 1_500_000, recovered_ms=recovered_ms)
    one.close()
    assert one.closed == (recovered_ms is not None)
    for count, worst in ((2, 2), (5, 5), (1, 5)):
        one.cut_off(count)
        assert one.apart == worst
    assert one.shown() == {"cause": "cut", "at_s": 1.5, "detected_ms": None,
                           "recovered_ms": recovered_ms, "apart": 5, "nobody": False}  # fmt: skip
