import numpy as np

from innervate.networks.skin.analysis import load
from innervate.networks.skin.plot.history import History, hops_of


def connected(graph, moment):
    """Cells that live cables connect to the PC, by plain search."""

    def is_live(end):
        return min(end, graph.peer[end]) not in moment.down

    found, front = set(), [graph.sink]
    while front:
        node = front.pop()
        for end in graph.ends_of(node):
            other = graph.peer[end]
            if other >= 0 and is_live(end) and graph.node_of(other) not in found:
                found.add(graph.node_of(other))
                front.append(graph.node_of(other))
    return found - {graph.sink}


def test_the_end_is_the_worlds_end(many):
    moment = History(many.result).at(many.result.ended_us)
    assert moment.server.tolist() == load.interface_of(many.result).tolist()
    assert moment.parent.tolist() == list(many.result.world.watch.port)
    loads = np.bincount(moment.server[moment.server >= 0], minlength=2)
    assert loads.tolist() == many.summary["port_loads"]


def test_counts_of_lost_cells_agree_with_the_observer_at_any_time(many):
    history, graph = History(many.result), many.plan.graph
    for time_us in range(0, many.result.ended_us, 7_003):
        moment = history.at(time_us)
        lost = sum(moment.server[cell] < 0 for cell in connected(graph, moment))
        unrouted = history.lacking_at(time_us) - history.cut_off_at(time_us)
        assert lost == unrouted, time_us


def test_damage(many):
    history = History(many.result)
    dead = many.plan.faults[1].node
    assert history.at(240_000).dead == frozenset()
    assert history.at(260_000).dead == {dead}
    assert history.at(410_000).dead == frozenset()
    assert len(history.at(199_999).down) == 0
    assert len(history.at(200_000).down) == 1
    assert len(history.at(260_000).down) == 5  # the cell's four and the cut one


def test_hops_follow_the_parents(cut):
    moment = History(cut.result).at(290_000)
    assert hops_of(moment, cut.plan.graph.sink).tolist() == cut.plan.depths
    early = History(cut.result).at(0)
    assert hops_of(early, cut.plan.graph.sink).tolist() == [0] * 30


def test_worst_and_half_way(cut):
    history = History(cut.result)
    when, most = history.lacking_max(300_000, 400_000)
    assert (when, most) == (300_000, cut.summary["recoveries"][0]["cut_cells"])
    half_us, half = history.first_below(when, 400_000, most / 2)
    assert 0 < half <= most / 2
    assert history.lacking_at(half_us) == half
    assert history.lacking_at(half_us - 1) > most / 2
    assert history.first_below(450_000, 460_000, -1) == (460_000, 0)
