"""Starts of stations of which each overlaps with the one before, and all with the first."""

from itertools import pairwise

import pytest

from innervate.networks.radio.papers import fig1


@pytest.mark.parametrize(("n", "widest"), [(2, 5171), (10, 548), (20, 244), (22, 218), (23, 209)])
def test_starts_are_more_than_a_slot_apart_and_before_the_first_packet_ends(n, widest):
    """Gaps are from one us more than a slot (208 us) to what leaves 30 us each at the end."""
    chains = [fig1.chain(n, seed) for seed in range(1, 60)]
    assert all(len(starts) == n and starts[0] == 0 for starts in chains)
    assert max(starts[-1] for starts in chains) < 25 * 208
    gaps = {b - a for starts in chains for a, b in pairwise(starts)}
    assert min(gaps) >= 209
    assert max(gaps) <= widest
    if n > 2:
        assert {209, widest} <= gaps


def test_the_four_of_the_figure_start_when_their_packets_do():
    starts = {robot: begin for robot, begin, _ in reversed(fig1.PACKETS)}
    assert fig1.CHANNEL.starts_us == tuple(starts[robot] for robot in range(4))
