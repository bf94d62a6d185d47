"""What is said of one exploration of a mesh."""

from types import SimpleNamespace

import pytest

from innervate.networks.mesh.verify.command import _extent
from innervate.verify.explore import Tally


@pytest.mark.parametrize(
    ("fair", "beats", "said"),
    [
        (0, 0, "all states"),
        (9, 0, "all states; settled in 7 events at most"),
        (8, 0, "all states; settled from 8 of them in 7 events at most"),
        (9, 5, "all states; one gateway after 0.0 s at most"),
        (8, 5, "all states; one gateway from 8 of them after 0.0 s at most"),
    ],
)
def test_how_far_it_came_and_from_where_it_settles(fair, beats, said):
    tally = Tally()
    tally.states, tally.ended = 9, "complete"
    model = SimpleNamespace(beats=beats)
    found = SimpleNamespace(fair=fair, longest=7, model=model, tally=tally)
    assert _extent(SimpleNamespace(found=found)) == said
