"""What nodes of an explored mesh draw is theirs alone, and another after every start."""

import pytest

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
