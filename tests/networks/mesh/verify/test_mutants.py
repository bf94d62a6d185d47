"""What is tried on the mesh's protocol; what finds it is in tests/verify/test_mutants.py."""

from pathlib import Path

import pytest

from innervate.networks.mesh import protocol
from innervate.networks.mesh.verify import mutants as mesh_mutants
from innervate.networks.mesh.verify import search as mesh_search
from innervate.networks.skin.verify import mutants


@pytest.mark.slow
@pytest.mark.parametrize("model", list(mesh_mutants.models()), ids=str)
def test_the_protocol_as_it_is_passes(model):
    found = mesh_search.explore(model)
    assert (found.broken, found.tally.ended) == (0, "complete")


def test_a_text_that_is_not_there_is_no_mutant():
    with pytest.raises(ValueError, match="stands 0 times"):
        mesh_mutants.hunt(mutants.Mutant("none", "no such text", ""))


def test_every_mutant_changes_a_line_that_there_is():
    sources = [file.read_text("utf-8") for file in Path(*protocol.__path__).glob("*.py")]
    for mutant in mesh_mutants.MUTANTS:
        assert sum(source.count(mutant.old) for source in sources) == 1, mutant.name
