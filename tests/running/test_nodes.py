"""`run.nodes`: the states of an own network's nodes at the end, on any medium."""

import pytest

import innervate
from innervate.running import RunError
from tests.own import alone, made

__all__ = ["alone"]


@pytest.mark.parametrize("medium", ["cables", "channel", "field"])
def test_the_nodes_of_a_run_are_its_states_by_number(alone, medium):
    own = made(alone / "mine", medium)
    run = innervate.run(own.scenario, plain=True)
    assert [node.number for node in run.nodes] == list(range(run.summary["nodes"]))


def test_arrays_of_a_plain_run_take_slices(alone):
    run = innervate.run(made(alone / "mine", "field").scenario, plain=True)
    seen = run.nodes[0].seen
    assert seen[:3] == [seen[0], seen[1], seen[2]]
    with pytest.raises(IndexError, match=r"seen\[-1\]: an index is 0 to 7"):
        seen[-1]


def test_the_nodes_of_a_compiled_run_have_their_fields_as_attributes():
    run = innervate.run("babel-patch", overrides={"duration_s": 3.0, "event": []})
    assert list(run.nodes.number) == list(range(run.summary["nodes"]))
    assert run.nodes[0].number == 0


def test_a_network_that_keeps_them_otherwise_says_where_they_are():
    run = innervate.run("loop-five", plain=True)
    with pytest.raises(RunError, match=r"a run of skin has no nodes; see run\.result\.world"):
        _ = run.nodes
