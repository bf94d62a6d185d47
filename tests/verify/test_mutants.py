"""Every explorer can fail: it finds small mistakes in its protocol, and none in it as it is."""

import pytest

from innervate.networks.mesh.verify import mutants as mesh
from innervate.networks.radio.verify import mutants as radio
from innervate.networks.skin.verify import mutants as skin

HUNTS = {"skin": skin, "radio": radio, "mesh": mesh}
QUICK = (
    ("skin", "the feasible distance is set once only"),
    ("skin", "older is newer"),
    ("skin", "the distance does not grow"),
    ("skin", "the feasible distance keeps its first number"),
    ("radio", "a collision's wait is not drawn"),
    ("radio", "nothing is ever proved"),
    ("mesh", "a hop's ack is ignored"),
    ("mesh", "nobody waits for a hop's ack"),
    ("mesh", "a packet that was delivered is delivered again"),
    ("mesh", "a retry is never due"),
    ("mesh", "who is looked for takes nothing"),
)
MUTANTS = {(kind, one.name): one for kind, hunts in HUNTS.items() for one in hunts.MUTANTS}


@pytest.mark.parametrize(("kind", "name"), QUICK)
def test_a_mutant_is_caught(kind, name):
    by = HUNTS[kind].hunt(MUTANTS[kind, name]).by
    assert by == "a packet is never delivered" if kind == "radio" else by


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "name"), [one for one in MUTANTS if one not in QUICK])
def test_every_mutant_is_caught(kind, name):
    assert HUNTS[kind].hunt(MUTANTS[kind, name]).by


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["skin", "radio"])
def test_the_protocol_as_it_is_passes(kind):
    text = HUNTS[kind].MUTANTS[-1].old
    assert HUNTS[kind].hunt(skin.Mutant("none", text, text)).by == ""


@pytest.mark.parametrize("kind", HUNTS)
def test_names_differ(kind):
    assert len({mutant.name for mutant in HUNTS[kind].MUTANTS}) == len(HUNTS[kind].MUTANTS)
