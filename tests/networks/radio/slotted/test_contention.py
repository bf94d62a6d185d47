"""CSMA/CD with draws that are given: windows, and when whoever collided may send again."""

import pytest

from innervate.networks.radio.slotted import contend
from innervate.networks.radio.slotted.contend import Contention
from innervate.networks.radio.slotted.draws import generator
from innervate.networks.radio.slotted.recorder import DISASTER, DONE, SATURATED, new_recorder
from tests.networks.radio.slotted.test_by_hand import LATE, offered, served

RULES = Contention(slot=10, packet=20, cost=10, turn=3, back=0, backoff=25, linear=0, redraw=0)


def played(monkeypatch, recorder, draws, rules=RULES):
    """Packets that got through with these draws, and out of how many each was drawn."""
    windows, left = [], list(draws)

    def draw(_, window):
        windows.append(window)
        return left.pop(0)

    monkeypatch.setattr(contend, "draw", draw)
    contend.contend(recorder, rules)
    return served(recorder), windows


BINARY = [2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 1024, 1024]
LINEAR = [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13]


@pytest.mark.parametrize(("linear", "expected"), [(0, BINARY), (1, LINEAR)])
def test_windows_grow_with_each_collision_up_to_a_most(monkeypatch, linear, expected):
    made = new_recorder(DISASTER, 2, 1, generator(1, "x"))
    draws = [0, 0] * (len(expected) - 1) + [0, 4]
    _, windows = played(monkeypatch, made, draws, RULES._replace(linear=linear))
    assert windows == [window for window in expected for _ in range(2)]


def test_who_got_through_begins_with_the_smallest_window_again(monkeypatch):
    made = new_recorder(SATURATED, 2, 1, generator(1, "x"))
    # Twice together; 0 gets through, meets 1 as soon as it is idle, and goes first again.
    found, windows = played(monkeypatch, made, [0, 0, 0, 1, 0, 3])
    assert [who for who, *_ in found] == [0, 0]
    assert windows == [2, 2, 4, 4, 2, 8]


@pytest.mark.parametrize(("drawn", "second"), [(0, 33), (1, 58)])
def test_who_got_through_may_have_to_draw_a_step_too(monkeypatch, drawn, second):
    made = new_recorder(SATURATED, 1, 2, generator(1, "x"))
    found, windows = played(monkeypatch, made, [drawn, drawn], RULES._replace(redraw=1))
    assert [end for *_, end in found] == [23, second + 23]
    assert windows == [2, 2]


@pytest.mark.parametrize(("back", "again"), [(30, 55), (0, 35), (10, 35), (11, 36)])
def test_a_collision_ends_with_its_last_station_and_who_sent_hears_later(monkeypatch, back, again):
    """A turn of 15: who decides at 0 is not heard by who decides at 10."""
    made = offered([10, 9 * LATE], [0, LATE])
    rules = RULES._replace(turn=15, back=back)
    found, _ = played(monkeypatch, made, [0, 1], rules)
    assert made.counts[DONE] >= 2
    assert found[0] == (0, 10, again + 15 + 20)
    assert found[1] == (1, 0, max(again + 25, found[0][2] + 10) + 15 + 20)
