"""What comes in for a user, and what becomes of a message: to whom it is told, when, how often."""

import asyncio

import pytest

from innervate.live.receipts import ACCEPTED, DELIVERED, EXPIRED, HOP_ACKED, REFUSED, Receipt
from innervate.live.streams import Arrivals, message_line


async def now(waiting):
    """Its result if it has one by now, else None; it goes on waiting."""
    task = asyncio.ensure_future(waiting)
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    return task, task.result() if task.done() else None


@pytest.mark.parametrize("is_spread", [False, True])
def test_what_waits_is_told_to_all_in_order_and_once_when_it_is_handed_up(is_spread):
    arrivals, told = Arrivals(is_spread=is_spread), []
    arrivals.receive(lambda *item: told.append(("a", *item)))
    arrivals.receive(lambda *item: told.append(("b", *item)))
    for item in ((1, "one"), (2, "two")):
        arrivals.put(item)
    assert told == []
    arrivals.hand_up()
    arrivals.hand_up()
    items = [(1, "one"), (2, "two")] if is_spread else [((1, "one"),), ((2, "two"),)]
    assert told == [(who, *item) for item in items for who in "ab"]


def test_what_a_callback_hands_down_comes_with_the_next_turn():
    arrivals, told = Arrivals(), []

    def again(item):
        told.append(item)
        if item < 3:
            arrivals.put(item + 1)

    arrivals.receive(again)
    arrivals.put(1)
    arrivals.hand_up()
    assert told == [1]
    arrivals.hand_up()
    assert told == [1, 2]


@pytest.mark.parametrize("is_spread", [False, True])
def test_an_iterator_has_all_from_its_beginning_and_takes_its_callback_with_it(is_spread):
    async def main():
        arrivals = Arrivals(is_spread=is_spread)
        arrivals.put((0, "before"))
        arrivals.hand_up()
        stream = arrivals.receive()
        for number in (1, 2):
            arrivals.put((number, "now"))
            arrivals.hand_up()
        found = [await anext(stream), await anext(stream)]
        task, none = await now(anext(stream))
        assert (found, none) == ([(1, "now"), (2, "now")], None)
        assert len(arrivals.callbacks) == 1
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        await stream.aclose()
        return arrivals.callbacks

    assert asyncio.run(main()) == []


def test_an_iterator_of_a_callback_takes_that_one_away_and_no_other():
    async def main():
        arrivals, told, kept = Arrivals(), [], []
        arrivals.receive(kept.append)
        stream = arrivals.receive(told.append)
        task, _ = await now(anext(stream))
        arrivals.put(1)
        arrivals.hand_up()
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        arrivals.put(2)
        arrivals.hand_up()
        return told, kept

    assert asyncio.run(main()) == ([1], [1, 2])


def test_a_message_as_a_line():
    assert message_line((7, b"\x00\xff")) == {"from": 7, "payload": "00ff"}


@pytest.mark.parametrize("last", [DELIVERED, EXPIRED, REFUSED])
def test_who_waits_for_the_end_is_told_it_and_who_waits_for_a_change_each_of_them(last):
    async def main():
        receipt = Receipt()
        assert (receipt.state, receipt.reason, receipt.seq) == (ACCEPTED, "", -1)
        end, at_once = await now(receipt.wait())
        change, _ = await now(receipt.change())
        assert at_once is None
        receipt.move(HOP_ACKED)
        await asyncio.sleep(0)
        assert (change.result(), end.done()) == (HOP_ACKED, False)
        second, not_yet = await now(receipt.change())
        assert not_yet is None
        receipt.move(last, "no route")
        found = [await end, await second]
        later = [(await now(ask()))[1] for ask in (receipt.wait, receipt.change)]
        return found, later, receipt

    found, later, receipt = asyncio.run(main())
    assert found == later == [last, last]
    assert (receipt.state, receipt.reason) == (last, "no route")
    assert repr(receipt) == f"<Receipt {last}: no route>"


def test_who_has_given_up_waiting_holds_up_nobody_else():
    async def main():
        receipt = Receipt()
        waiting = [(await now(ask()))[0] for ask in (receipt.wait, receipt.change, receipt.wait)]
        for task in waiting[:2]:
            task.cancel()
        receipt.move(HOP_ACKED)
        receipt.move(DELIVERED)
        return await waiting[2]

    assert asyncio.run(main()) == DELIVERED
    assert repr(Receipt()) == "<Receipt accepted>"
