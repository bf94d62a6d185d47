"""Which hops a packet takes under `search`: what is proved of them, and what is not so."""

import pytest

from innervate.dialect.plain import make
from innervate.network import networks
from innervate.networks.mesh.protocol import duplicates, fields
from innervate.networks.mesh.prove import hops, theories
from innervate.prove.faults import faults_of
from innervate.prove.theory import prove, source
from tests.networks.mesh.prove.twins import HOPS, hop_twin

FAULTS = (
    "who had the packet is asked again",
    "who failed for a packet is asked again",
    "who transmits a packet is not in its path",
)


def claims(change=None):
    return hops.theories(source(theories.ENTRY, change))


def test_no_copy_goes_forward_to_who_had_it():
    outcome = prove(claims()[0])
    assert [bad.goal for one in outcome.checked for bad in one.refuted] == []
    assert outcome.is_as_expected
    assert outcome.lemmas == 7


@pytest.mark.parametrize("name", FAULTS)
def test_a_mistake_is_refuted(name):
    fault = next(one for one in faults_of(networks()["mesh"]) if one.name == name)
    assert prove(claims((fault.old, fault.new))[0], first_only=True).is_refuted


def test_what_goes_back_twice_is_told_of_three_nodes_and_so_in_python():
    outcome = prove(claims()[1])
    assert outcome.is_as_expected
    (bad,) = outcome.checked[0].refuted
    assert "The packet has gone from B to A twice, as two copies." in bad.sentences[-1]
    node, frame = make("Node", fields.packets(2))(), make("Frame", fields.FRAME)()
    frame.kind, frame.seq, frame.path_len = 1, 7, 1
    assert duplicates.record_packet(node, frame) == 0
    taken = []
    for frame.path_len in (3, 4, 4):
        taken.append(duplicates.record_return(node, frame) == 0)
    assert taken == [True, True, False]


SMALL = ("add_hop", "store", "skip", "record_return")  # a search takes long to make


@pytest.mark.parametrize("name", SMALL)
def test_drawn_calls_leave_the_same_state(name):
    assert hop_twin(name).calls(100, 1) == ""


def test_a_formula_of_another_path_differs():
    wrong = ("    node.q_path_len[i] = count + 1\n", "    node.q_path_len[i] = count\n")
    assert "in the formula" in hop_twin("add_hop", wrong).calls(300, 1)


@pytest.mark.slow
@pytest.mark.parametrize("name", HOPS)
def test_a_hundred_thousand_drawn_calls_do(name):
    assert hop_twin(name).calls(20_000, 2) == ""
