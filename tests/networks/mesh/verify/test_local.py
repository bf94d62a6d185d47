"""What nodes of an explored mesh draw is theirs alone, and another after every start."""

import pytest

from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify.local import Locals
from innervate.networks.mesh.verify.model import MeshModel


@pytest.mark.parametrize("count", [1 << 16, 254])
def test_draws_out_of_many_differ_between_nodes_and_starts(count):
    made = Locals(MeshModel(mesh_model.parse("spare")))
    drawn = []
    for made.boots in range(2):
        drawn += [made._who(number, count) for number in range(made.model.nodes)]
    assert all(0 <= one < count for one in drawn)
    assert len(set(drawn)) == len(drawn)


def test_the_fence_is_a_square_of_ten_metres_round_which_one_comes_back():
    fence = mesh_model.FENCE
    corners = list(zip(fence["px"], fence["py"], strict=True))
    assert corners[: fence["points"]] == [(0, 0), (1000, 0), (1000, 1000), (0, 1000)]
    assert fence["after"][: fence["points"]] == [1, 2, 3, 0]
    unused = mesh_fields.POINTS - fence["points"]
    assert corners[4:] == [(0, 0)] * unused
    assert fence["after"][4:] == [0] * unused
