"""Networks that figures of the skin paper are measured on, and how far they are watched."""

import pytest

from innervate import scenario
from innervate.networks.skin.papers import fig5, steps


def test_sizes_are_watched_from_the_300th_period_on_for_as_many_as_asked():
    """A cell of a skin in lock-step switches; all sizes are true again at the 29th of them."""
    assert steps.stale_sizes("setup-6", True, 28, 1) == []
    assert steps.stale_sizes("setup-6", True, 29, 1) == [24]


@pytest.mark.parametrize(("line", "cells", "links", "interfaces"), [
    (False, 7, 9, ["n1", "a1"]), (True, 8, 9, ["p0 r0 c0", "p0 r0 c7"]),
])  # fmt: skip
def test_a_broken_connection_is_one_of_two_in_a_graph_or_at_the_ends_of_a_line(
    line, cells, links, interfaces
):
    plan = scenario.plan(scenario.from_dict(fig5.tables(5, 1, True, line), seed=1))
    graph = plan.graph
    ends = [graph.peer[4 * graph.sink + port] for port in range(graph.interfaces)]
    assert [graph.label(graph.node_of(end)) for end in ends] == interfaces
    assert (graph.cells, len(list(graph.links()))) == (cells, links)


@pytest.mark.parametrize(("lock_step", "cut"), [(True, 2.0), (False, [2.0, 2.02])])
def test_the_first_interface_is_cut_at_a_tick_or_within_five_of_them(lock_step, cut):
    made = fig5.tables(7, 3, lock_step)
    assert made["event"] == [{"action": "cut", "interface": 0, "at_s": cut}]
    assert made["duration_s"] == 2 + 107 / 250
    assert made["protocol"] == {
        "updates": "periodic", "beacon_hz": 250, "k": 7, "balancing": False, "m": 3,
    }  # fmt: skip
    assert "m" not in fig5.tables(7, 0, lock_step)["protocol"]
