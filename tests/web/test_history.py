"""What pages are told once: numbers, how much is kept, what a way back undoes, floods of lines."""

import pytest

from innervate.web.history import BACK, LOG, LOSS, SERIES, TIMELINE, History, Logbook


def numbers(history, stream, number=0, upto=10**9, most=10**9):
    return [item.number for item in history.after(stream, number, upto, most)]


@pytest.mark.parametrize(("stream", "kept"), [
    (LOG, 2_000), (SERIES, 40_000), (TIMELINE, 20_000), (BACK, 1_000),
])  # fmt: skip
def test_so_much_is_kept_and_up_to_twice_that_until_the_oldest_go(stream, kept):
    history = History()
    for at in range(2 * kept):
        history.add(stream, at, None)
    assert len(numbers(history, stream)) == 2 * kept
    history.add(stream, 2 * kept, None)
    assert numbers(history, stream) == list(range(kept + 2, 2 * kept + 2))


def test_items_of_all_streams_share_their_numbers():
    history = History()
    assert history.newest == 0
    for stream in (LOG, SERIES, LOG, LOG):
        history.add(stream, 5, stream)
    assert history.newest == 4
    assert (numbers(history, LOG), numbers(history, SERIES)) == ([1, 3, 4], [2])
    assert numbers(history, LOG, 1) == numbers(history, LOG, 2) == [3, 4]
    assert numbers(history, LOG, 0, 3) == [1, 3]
    assert numbers(history, LOG, 0, 2) == [1]
    assert numbers(history, LOG, 0, 4, 2) == [1, 3]
    assert numbers(history, LOG, 4) == []


def test_what_happened_from_then_on_has_not_happened():
    history = History()
    for stream in (LOG, SERIES, TIMELINE):
        for at in (99, 100, 101):
            history.add(stream, at, None)
    history.go_back(100)
    left = {stream: [item.at_us for item in history.after(stream, 0, 99, 99)]
            for stream in (LOG, SERIES, TIMELINE, BACK)}  # fmt: skip
    assert left == {LOG: [99], SERIES: [99, 100], TIMELINE: [99], BACK: [100]}
    assert history.newest == 10
    history.go_back(50)
    assert numbers(history, BACK) == [10, 11]


def test_of_a_flood_the_first_lines_are_written():
    history = History()
    book = Logbook(history)
    for i in range(12):
        book.often("lost", i, f"line {i}", "bad")
    book.often("late", 20, "another kind")
    said = [item.what["text"] for item in history.after(LOG, 0, 99, 99)]
    assert said == [*(f"line {i}" for i in range(8)), "... and more of that", "another kind"]
    book.calm()
    book.often("lost", 30, "again")
    book.say(2_500_000, "cut", "bad", LOSS)
    *_, again, last = (item.what for item in history.after(LOG, 0, 99, 99))
    assert again == {"type": "log", "t_s": 3e-05, "text": "again", "level": "info"}
    assert last == {"type": "log", "t_s": 2.5, "text": "cut", "level": "bad", "mark": "loss"}
