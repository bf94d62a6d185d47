"""Numbers of packets are kept ahead of those in use, so that a restart repeats none."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.live.node import NUMBERS, MeshNode


@pytest.mark.parametrize(("seq", "left", "kept"), [
    (100, NUMBERS, True), (100, NUMBERS + 1, False), (100, NUMBERS // 2, True),
    (100, NUMBERS // 2 - 1, False), (100, 0, False), (65_000, NUMBERS, True),
    (65_000, NUMBERS // 2 - 1, False),
])  # fmt: skip
def test_more_are_kept_when_half_of_them_are_gone_or_they_lie_elsewhere(seq, left, kept):
    written = []
    state = Of(numbers=(seq + left) & 0xFFFF, write=lambda: written.append(state.numbers))
    MeshNode._reserve(Of(state=state, stack=Of(node=Of(seq=seq))))
    assert written == ([] if kept else [(seq + NUMBERS) & 0xFFFF])
    assert state.numbers == (seq + (left if kept else NUMBERS)) & 0xFFFF


def test_who_has_kept_none_yet_does():
    written = []
    state = Of(numbers=-1, write=lambda: written.append(state.numbers))
    MeshNode._reserve(Of(state=state, stack=Of(node=Of(seq=0xFFFF - NUMBERS))))
    assert written == [0xFFFF]
