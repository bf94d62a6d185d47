"""The state that an exploration of a mesh starts from, and states as bytes."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.protocol.constants import ALL
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify import search as mesh_search
from innervate.networks.mesh.verify.first import begin
from innervate.networks.mesh.verify.local import GRAIN_US, NEVER, NONE
from innervate.networks.mesh.verify.model import SHORT, MeshBudget, MeshModel
from innervate.networks.mesh.verify.net import DEAD, DIE, REVIVE, Net, Nets
from innervate.verify.explore import Tally

BUDGET = MeshBudget(deaths=1, revivals=2, frames=3, acks=4, ticks=5)


@pytest.fixture(scope="module")
def nets():
    links = mesh_model.parse("0-1 1-2")
    return Nets(MeshModel(links, "search", settings=SHORT, offers=((1, 0),), budget=BUDGET))


@pytest.fixture(scope="module")
def first(nets):
    return begin(nets).net


def test_it_starts_with_all_that_may_happen_and_nothing_handed_in(first):
    assert first.left == (1, 2, 3, 4)
    assert first.ticks == (5, 5, 5)
    assert (first.offered, first.got, first.lags) == (0, 0, (0, 0, 0))


def test_from_then_on_clocks_go_in_coarse_steps(nets, first):
    waits = [due for number in first.nodes for due in nets.locals.states[number].timers]
    assert any(due > 0 for due in waits)
    assert all(due == NEVER or due % GRAIN_US == 0 for due in waits)
    assert nets.locals.shape.grain == nets.locals.gate_shape.grain == GRAIN_US


@pytest.mark.parametrize("net", [
    Net((7, 8, 9), (1, 2, 3), (4, 5, 6, 10), (11, 12, 13), 14, 15),
    Net((0, 2**30, 1), (0, 0, 0), (0, 0, 0, 0), (1 << 20,) * 3, 1 << 20, 0),
])  # fmt: skip
def test_a_state_comes_back_from_its_bytes(nets, net):
    row = nets.pack(net)
    assert nets.unpack(row) == net
    assert len(row) == 4 * 15


def test_who_dies_or_is_switched_on_again_uses_up_what_is_left_of_that_alone(nets, first):
    died = {move.node: after for move, after, _ in nets.faults(first) if move.kind == DIE}
    assert {node: after.left for node, after in died.items()} == dict.fromkeys(
        range(3), (0, 2, 3, 4)
    )
    assert [node for node in range(3) if died[1].nodes[node] == DEAD] == [1]
    ((move, after, broken),) = nets.faults(died[1])
    assert (move.kind, move.node, broken) == (REVIVE, 1, 0)
    assert after.left == (0, 1, 3, 4)
    assert DEAD not in after.nodes
    assert nets.faults(after._replace(left=(0, 0, 3, 4))) == []


def test_who_misses_a_frame_stays_as_it_was_and_who_hears_it_does_not(nets, first):
    """The first frame to all, however it goes; node 1 has two that hear it."""
    before = first
    while not (found := to_all(nets, before)):
        before = nets.steady(before)[1]._replace(left=first.left, ticks=first.ticks)
    assert {move.missed for move, *_ in found} == {(), (0,), (2,), (0, 2)}
    for move, after, _ in found:
        changed = {v for v in (0, 2) if after.nodes[v] != before.nodes[v]}
        assert changed == {0, 2} - set(move.missed)
        assert before.left[2] - after.left[2] == len(move.missed)


def to_all(nets, net):
    """Steps by which a frame of node 1 goes out to all."""
    number = net.nodes[1]
    handed = nets.locals.states[number].handed if number != DEAD else NONE
    if handed == NONE or nets.locals.packets[handed].link_dst != ALL:
        return []
    return nets.air(net, 1)


def test_whoever_watches_is_asked_once_a_second_at_most(nets, first, monkeypatch):
    times = iter([0.0, 1.0, 1.1, 2.0, 3.0, 3.5, 4.0, 9.0])
    monkeypatch.setattr(mesh_search, "wall_s", lambda: next(times))
    monkeypatch.setattr(mesh_search, "CHUNK", 2)
    found, asked = mesh_search.Found(nets.model, nets, Tally(ended="complete")), []
    search = Of(rows=[nets.pack(first)] * 9, tally=found.tally)

    def progress(tally):
        asked.append(found.fair)
        return len(asked) == 2

    mesh_search._look_ahead(found, search, progress)
    assert asked == [3, 7]
    assert (found.fair, found.broken) == (7, 0)
    assert found.tally.ended == "interrupted"  # though all states were found
    mesh_search._look_ahead(found, search, None)
    assert found.fair == 9
