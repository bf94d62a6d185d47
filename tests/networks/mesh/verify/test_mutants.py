"""The mesh's explorer can fail: it finds small mistakes, and nothing in the protocol as it is."""

from pathlib import Path

import pytest

from innervate.networks.mesh import protocol
from innervate.networks.mesh.verify import mutants as mesh_mutants
from innervate.networks.mesh.verify import search as mesh_search
from innervate.networks.skin.verify import mutants

QUICK = (
    "a hop's ack is ignored",
    "nobody waits for a hop's ack",
    "a packet that was delivered is delivered again",
    "a retry is never due",
    "who is looked for takes nothing",
)


@pytest.mark.parametrize("name", QUICK)
def test_a_mutant_is_caught(name):
    found = mesh_mutants.hunt(next(m for m in mesh_mutants.MUTANTS if m.name == name))
    assert found.by


@pytest.mark.slow
@pytest.mark.parametrize(
    "mutant", [m for m in mesh_mutants.MUTANTS if m.name not in QUICK], ids=str
)
def test_every_mutant_is_caught(mutant):
    assert mesh_mutants.hunt(mutant).by


@pytest.mark.slow
@pytest.mark.parametrize("model", list(mesh_mutants.models()), ids=str)
def test_the_protocol_as_it_is_passes(model):
    found = mesh_search.explore(model)
    assert (found.broken, found.tally.ended) == (0, "complete")


def test_names_differ_and_a_text_that_is_not_there_is_no_mutant():
    names = {mutant.name for mutant in mesh_mutants.MUTANTS}
    assert len(names) == len(mesh_mutants.MUTANTS)
    with pytest.raises(ValueError, match="stands 0 times"):
        mesh_mutants.hunt(mutants.Mutant("none", "no such text", ""))


def test_every_mutant_changes_a_line_that_there_is():
    sources = [file.read_text("utf-8") for file in Path(*protocol.__path__).glob("*.py")]
    for mutant in mesh_mutants.MUTANTS:
        assert sum(source.count(mutant.old) for source in sources) == 1, mutant.name
