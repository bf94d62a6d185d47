"""Numbers of packets are kept ahead of those in use, so that a restart repeats none."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.arith import HALF16, MASK16
from innervate.live.machine import machine
from innervate.networks.mesh.live.node import FEW, NUMBERS, MeshNode
from tests.live import time_by_hand
from tests.live.net import Mesh
from tests.networks.mesh.live.test_order import until_simulated


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


def reserve(state, seq, ahead=-1):
    """What a node at number `seq` keeps, which last kept `ahead` of them."""
    node = Of(state=state, stack=Of(node=Of(seq=seq)), _ahead=ahead)
    MeshNode._reserve(node)
    return node._ahead


@pytest.mark.parametrize("ahead", [FEW, NUMBERS])
@pytest.mark.parametrize("seq", [100, 65_000])
def test_more_are_kept_when_half_of_them_are_gone_or_they_lie_elsewhere(seq, ahead):
    for left, kept in ((ahead, True), (ahead + 1, False), (ahead // 2, True),
                       (ahead // 2 - 1, False), (0, False)):  # fmt: skip
        state = Kept((seq + left) & 0xFFFF)
        assert reserve(state, seq, ahead) == (ahead if kept else NUMBERS)
        assert state.written == ([] if kept else [(seq + NUMBERS) & 0xFFFF])
        assert state.numbers == (seq + (left if kept else NUMBERS)) & 0xFFFF


@pytest.mark.parametrize("numbers", [-1, 0, 99, 100, 101, 100 + FEW])
def test_in_a_new_life_few_are_kept_at_first_whatever_the_file_said(numbers):
    state = Kept(numbers)
    assert reserve(state, 100) == FEW
    assert state.written == [100 + FEW]


def test_who_has_kept_none_yet_does():
    state = Kept(-1)
    reserve(state, 0xFFFF - FEW)
    assert (state.written, state.is_aside) == ([0xFFFF], False)


def test_numbers_that_cannot_be_kept_are_not_gone_by_in_the_next_life():
    state = Kept(-1, is_full=True)
    reserve(state, 0)
    assert state.is_aside


class Most:
    """Draws the most there is."""

    def getrandbits(self, bits):
        return (1 << bits) - 1


def test_seven_lives_one_after_the_other_do_not_lead_half_way_round(monkeypatch):
    """Else packets of the first are taken for later ones than those of the last: seed 950130."""

    async def main():
        async with Mesh(2, [(0, 1)]) as mesh:
            node, firsts = mesh.nodes[1], []
            node.state.numbers = 0
            monkeypatch.setattr(machine(), "chance", Most())
            for _ in range(8):
                await node.stop()
                await node.start()
                await until_simulated(lambda: node.stack.node.version != 0)
                firsts.append(node.stack.first)
            return firsts

    firsts = time_by_hand.run(main())
    assert HALF16 - 4096 < (firsts[-1] - firsts[0]) & MASK16 < HALF16
