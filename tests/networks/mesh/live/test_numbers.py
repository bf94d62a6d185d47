"""Numbers of packets are kept ahead of those in use, so that a restart repeats none."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.live.node import NUMBERS, MeshNode


class Kept:
    """A node's state, and what was written of it."""

    def __init__(self, numbers, is_full=False):
        self.numbers, self.is_full = numbers, is_full
        self.written, self.is_aside = [], False

    def write(self):
        self.written.append(self.numbers)
        return not self.is_full

    def set_aside(self):
        self.is_aside = True


@pytest.mark.parametrize(("seq", "left", "kept"), [
    (100, NUMBERS, True), (100, NUMBERS + 1, False), (100, NUMBERS // 2, True),
    (100, NUMBERS // 2 - 1, False), (100, 0, False), (65_000, NUMBERS, True),
    (65_000, NUMBERS // 2 - 1, False),
])  # fmt: skip
def test_more_are_kept_when_half_of_them_are_gone_or_they_lie_elsewhere(seq, left, kept):
    state = Kept((seq + left) & 0xFFFF)
    MeshNode._reserve(Of(state=state, stack=Of(node=Of(seq=seq))))
    assert state.written == ([] if kept else [(seq + NUMBERS) & 0xFFFF])
    assert state.numbers == (seq + (left if kept else NUMBERS)) & 0xFFFF


def test_who_has_kept_none_yet_does():
    state = Kept(-1)
    MeshNode._reserve(Of(state=state, stack=Of(node=Of(seq=0xFFFF - NUMBERS))))
    assert (state.written, state.is_aside) == ([0xFFFF], False)


def test_numbers_that_cannot_be_kept_are_not_gone_by_in_the_next_life():
    state = Kept(-1, is_full=True)
    MeshNode._reserve(Of(state=state, stack=Of(node=Of(seq=0))))
    assert state.is_aside
