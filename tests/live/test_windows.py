"""What was taken is not taken again; a state file that cannot be is refused."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.live.errors import LiveError
from innervate.live.state import State
from innervate.wire import seal

LAST = seal.COUNTER_MAX


@pytest.mark.parametrize("epoch", ["1e999", str(1 << 60), "-1", "1.5", '"7"', "null", "true"])
def test_a_file_with_a_number_that_cannot_be_is_refused_in_one_line(tmp_path, epoch):
    path = tmp_path / "n.state"
    path.write_text(f'{{"epoch": {epoch}}}')
    with pytest.raises(LiveError, match="not a node's state; remove it"):
        State(path)


def test_a_file_of_before_is_read(tmp_path):
    path = tmp_path / "n.state"
    path.write_text('{"counter": 5, "seen": {"aa": {"1": 7}}, "epoch": 79}')
    state = State(path)
    assert (state.epoch, state.revoked, state.fresh) == (79, b"", False)


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


def test_the_edges_of_a_window_that_begins_full():
    window = seal.Window(5000)
    assert not any(map(window.is_new, (0, 5000 - seal.WINDOW, 5000 - seal.WINDOW + 1, 5000)))
    window.take(5001)
    assert not any(map(window.is_new, (5001 - seal.WINDOW + 1, 5000, 5001)))
    window.take(5000 + seal.WINDOW + 1)
    assert [window.is_new(counter) for counter in (5000, 5001, 5002)] == [False, False, True]
