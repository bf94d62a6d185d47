"""What is proved of the mesh's duplicate caches, and that mistakes in them are refuted."""

from dataclasses import replace

import pytest

from innervate.network import networks
from innervate.networks.mesh.prove import theories
from innervate.prove.faults import faults_of, hunt
from innervate.prove.theory import prove
from tests.networks.mesh.prove import twins as mesh_twins
from tests.networks.mesh.prove.twins import twins
from tests.prove.outcomes import held

MESH = networks()["mesh"]
# The theory and the step that are quick to refute it.
QUICK = {"what is behind is not noted": (0, 1), "every packet is noted in the same place": (1, 1)}


@pytest.mark.parametrize("number", range(2))
def test_a_packet_is_delivered_and_passed_on_once(number):
    assert held(theories.theories(MESH)[number]).lemmas > 10


@pytest.mark.parametrize("name", QUICK)
def test_a_mistake_is_refuted(name):
    fault = next(one for one in faults_of(MESH) if one.name == name)
    theory, step = QUICK[name]
    wrong = theories.theories(MESH, (fault.old, fault.new))[theory]
    wrong = replace(wrong, steps=wrong.steps[step : step + 1])
    assert prove(wrong, first_only=True).is_refuted, name


@pytest.mark.slow
@pytest.mark.parametrize("fault", faults_of(MESH), ids=lambda one: one.name)
def test_every_mistake_is_refuted(fault):
    assert hunt(MESH, fault)[1], fault.name


def test_drawn_calls_leave_the_same_state():
    assert [one.calls(300, 1) for one in twins()] == ["", ""]
    fault = next(one for one in faults_of(MESH) if one.name == "what is behind is not noted")
    assert "in the formula" in twins((fault.old, fault.new))[0].calls(4_000, 1)


def test_a_formula_has_what_its_function_reads_and_no_path_or_body(monkeypatch):
    made = []
    monkeypatch.setattr(mesh_twins, "twin", lambda *given: made.append(given))
    mesh_twins.twins()
    (_, accept, _, one, _), (_, record, _, other, _) = made
    assert (accept, record) == ("accept", "record_packet")
    names = {name: {field[0] for field in fields} for name, fields in (one | other).items()}
    assert names["params"] == {"forget"}
    assert {"kind", "origin", "seq"} <= names["frame"]
    assert not {"path", "body"} & names["frame"]
    assert all(name.startswith(("done_", "skip_")) for name in names["node"])


@pytest.mark.slow
@pytest.mark.parametrize("number", range(2))
def test_a_hundred_thousand_drawn_calls_do(number):
    assert twins()[number].calls(50_000, 2) == ""


def test_every_distance_from_the_newest_is_looked_at_once():
    ends = [-1, *(high for _, high in theories.AHEAD)]
    assert [low for low, _ in theories.AHEAD] == [end + 1 for end in ends[:-1]]
    assert ends[-1] == 65_535
