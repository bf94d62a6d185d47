"""What was taken is not taken again: per key and sender, over restarts and changes of keys."""

import asyncio
import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.live.errors import LiveError
from innervate.live.keys import AHEAD, KEYS_KEPT, Sealer, mark_of
from innervate.live.rotation import Rotation
from innervate.live.state import State
from innervate.wire import seal
from tests.live.test_keys import FRAME, taken

FIRST, SECOND, THIRD = bytes(range(32)), bytes(32), bytes([7]) * 32
LAST = seal.COUNTER_MAX
REPLAYED = {"sealed: replayed": 1}


def sealer(number, keys, path=None, use=None):
    return Sealer("mesh", number, keys, use or min(keys), State(path))


def last_frame(keys):
    """What deafens: a genuine frame of node 1 with the greatest counter there is."""
    insider = sealer(1, keys)
    insider.counter = LAST
    return insider.close(FRAME)


def saved(node):
    node.note(False)
    assert node.state.write()


def test_the_greatest_counter_under_one_key_deafens_nobody_under_the_next():
    a, b = sealer(1, {1: FIRST}), sealer(2, {1: FIRST})
    assert taken(b, last_frame({1: FIRST})) == FRAME
    assert taken(b, a.close(FRAME)) is None
    for node in (a, b):
        node.load_keys({2: SECOND}, 2)
    assert taken(b, a.close(FRAME)) == FRAME


def test_nor_after_a_restart_with_the_next_key(tmp_path):
    path = tmp_path / "n2.state"
    b = sealer(2, {1: FIRST}, path)
    assert taken(b, last_frame({1: FIRST})) == FRAME
    saved(b)
    assert taken(sealer(2, {2: SECOND}, path), sealer(1, {2: SECOND}).close(FRAME)) == FRAME


def test_a_restart_with_the_same_key_takes_no_copy_of_what_was_seen(tmp_path):
    path = tmp_path / "n2.state"
    a, b = sealer(1, {1: FIRST}), sealer(2, {1: FIRST}, path)
    copies = [a.close(b"%d" % k) for k in range(5)]
    assert taken(b, copies[3]) == b"3"
    saved(b)
    b = sealer(2, {1: FIRST}, path)
    assert [taken(b, data) for data in copies] == [None] * 4 + [b"4"]
    assert b.dropped == {"sealed: replayed": 4}


def test_in_the_grace_time_each_key_has_its_own_window():
    keys = {1: FIRST, 2: SECOND}
    a, b = sealer(1, keys, use=1), sealer(2, keys, use=1)
    old = [a.close(b"old %d" % k) for k in range(3)]
    a.load_keys(keys, 2)
    new = [a.close(b"new %d" % k) for k in range(3)]
    a.counter += 10 * seal.WINDOW
    far = a.close(b"far")
    order = [new[0], old[2], far, old[0], new[2]]  # the last is too far behind `far`
    assert [taken(b, data) for data in order] == [b"new 0", b"old 2", b"far", b"old 0", None]
    assert [taken(b, data) for data in (old[1], old[1])] == [b"old 1", None]


def test_a_change_of_keys_ends_with_the_windows_of_both_in_the_file(tmp_path):
    async def main():
        path = tmp_path / "n2.state"
        a, b = sealer(1, {1: FIRST}), sealer(2, {1: FIRST}, path)
        old = a.close(FRAME)
        assert taken(b, old) == FRAME
        Rotation(b).begin({2: SECOND}, 2, 0.0)
        while b.keys != {2: SECOND}:
            await asyncio.sleep(0)
        a.load_keys({2: SECOND}, 2)
        new = a.close(FRAME)
        assert taken(b, new) == FRAME
        saved(b)
        return path, old, new

    path, old, new = asyncio.run(main())
    again = sealer(2, {1: FIRST, 2: SECOND}, path)
    assert [taken(again, data) for data in (old, new)] == [None, None]


def test_a_number_that_stands_for_another_key_takes_over_no_window(tmp_path):
    path = tmp_path / "n2.state"
    b = sealer(2, {1: FIRST}, path)
    taken(b, last_frame({1: FIRST}))
    saved(b)
    assert taken(sealer(2, {1: THIRD}, path), sealer(1, {1: THIRD}).close(FRAME)) == FRAME


def test_under_a_key_that_comes_back_nothing_is_taken_twice(tmp_path):
    path = tmp_path / "n2.state"
    a, b = sealer(1, {1: FIRST}), sealer(2, {1: FIRST}, path)
    old = a.close(FRAME)
    assert taken(b, old) == FRAME
    b.load_keys({2: SECOND}, 2)
    saved(b)
    b = sealer(2, {2: SECOND}, path)
    saved(b)
    b = sealer(2, {1: FIRST}, path)
    assert taken(b, old) is None
    assert b.dropped == REPLAYED


def test_of_keys_that_are_gone_a_few_are_remembered():
    b = sealer(2, {1: FIRST})
    for k in range(3 * KEYS_KEPT):
        b.load_keys({1: FIRST, 2: bytes([k]) * 32}, 1)
    assert len(b.windows) == KEYS_KEPT
    assert mark_of(FIRST) in b.windows


def test_a_file_of_before_counts_for_the_keys_of_its_node_and_for_no_later_one(tmp_path):
    path = tmp_path / "n2.state"
    a = sealer(1, {1: FIRST})
    old, counter = a.close(FRAME), a.counter
    kept = {"counter": 5, "seen": {"1": counter - 1, "9": LAST}, "epoch": 79}
    path.write_text(json.dumps(kept))
    b = sealer(2, {1: FIRST}, path)
    assert (b.state.epoch, b.state.fresh) == (79, False)
    assert taken(b, old) is None
    assert taken(b, a.close(FRAME)) == FRAME
    saved(b)
    b = sealer(2, {1: FIRST}, path)
    assert taken(b, old) is None
    for node in (a, b):
        node.load_keys({2: SECOND}, 2)
    nine = sealer(9, {2: SECOND})
    assert [taken(b, node.close(FRAME)) for node in (a, nine)] == [FRAME, FRAME]
    assert json.loads(path.read_text())["seen"].keys() == {mark_of(FIRST)}


def test_the_file_tells_nothing_of_a_key():
    assert FIRST.hex() not in mark_of(FIRST)
    assert len(mark_of(FIRST)) == 16
    assert mark_of(FIRST) != mark_of(SECOND)


@pytest.mark.parametrize("counter", ["1e999", str(1 << 60), "-1", "1.5", '"7"', "null"])
@pytest.mark.parametrize("where", ["counter", "seen", "old seen", "epoch"])
def test_a_file_with_a_number_that_cannot_be_is_refused_in_one_line(tmp_path, counter, where):
    path = tmp_path / "n.state"
    seen = {"seen": f'{{"aa": {{"1": {counter}}}}}', "old seen": f'{{"1": {counter}}}'}
    own = {"counter": "1", "epoch": "1", "seen": "{}"}
    own[where.removeprefix("old ")] = seen.get(where, counter)
    path.write_text("{" + ", ".join(f'"{name}": {text}' for name, text in own.items()) + "}")
    with pytest.raises(LiveError, match="not a node's state; remove it"):
        State(path)


def test_without_counters_left_a_node_does_not_start(tmp_path):
    path = tmp_path / "n.state"
    path.write_text(json.dumps({"counter": LAST, "seen": {}, "epoch": 0}))
    with pytest.raises(LiveError, match="no counters are left"):
        sealer(1, {1: FIRST}, path)


@pytest.mark.parametrize("frames", [0, AHEAD // 2 - 1, AHEAD // 2 + 1, 3 * AHEAD])
def test_a_node_that_is_killed_uses_no_counter_again(tmp_path, frames):
    path = tmp_path / "n1.state"
    first = sealer(1, {1: FIRST}, path)
    first.counter = first.state.counter = LAST // 2  # far ahead of the clock
    saved(first)
    for k in range(frames // 1000):  # the file is written now and then, and when it must be
        first.counter += 999
        first.close(FRAME)
        if k % 100 == 0:
            saved(first)
    assert sealer(1, {1: FIRST}, path).counter >= first.counter


OFFSETS = st.lists(st.one_of(
    st.integers(0, 5), st.integers(seal.WINDOW - 2, seal.WINDOW + 2),
    st.integers(2 * seal.WINDOW - 2, 2 * seal.WINDOW + 2)), min_size=1, max_size=60)  # fmt: skip


@settings(max_examples=300, deadline=None, database=None)
@given(OFFSETS, st.sampled_from([0, 1 << 20, LAST - 2 * seal.WINDOW - 2]))
def test_a_window_takes_what_a_list_of_all_that_was_taken_would(offsets, base):
    window, seen = seal.Window(), set()
    for counter in (base + offset for offset in offsets):
        new = counter not in seen and counter > max(seen, default=-1) - seal.WINDOW
        assert window.is_new(counter) == new
        if new:
            window.take(counter)
            seen.add(counter)
        assert window.highest == max(seen)
        assert window.bits < 1 << seal.WINDOW


def test_the_edges_of_a_window_that_a_restart_filled():
    window = seal.Window(5000)
    assert not any(map(window.is_new, (0, 5000 - seal.WINDOW, 5000 - seal.WINDOW + 1, 5000)))
    window.take(5001)
    assert not any(map(window.is_new, (5001 - seal.WINDOW + 1, 5000, 5001)))
    window.take(5000 + seal.WINDOW + 1)
    assert [window.is_new(counter) for counter in (5000, 5001, 5002)] == [False, False, True]
