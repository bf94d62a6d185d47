"""failover = "auto": of tables and the whole graph what takes less of the channel."""

import re
from types import SimpleNamespace

import pytest

import innervate
from innervate.networks.mesh.protocol.constants import TABLES, WHOLE_GRAPH
from innervate.networks.mesh.scenario.distribution import first_round, less_of_both
from innervate.networks.mesh.scenario.words import describe
from innervate.scenario import ScenarioError, loads, plan

FIELD = """
kind = "mesh"
nodes = {nodes}
duration_s = 100
radio = {{ profile = "38k4", mean_degree = 8 }}
protocol = {{ failover = "{failover}", period_s = 200 }}
"""
BYTE_A_US = SimpleNamespace(turnaround_us=0, phy_bytes=0, byte_ns=1000)


def line(count):
    return [[j for j in (i - 1, i + 1) if 0 <= j < count] for i in range(count)]


def test_a_line_of_three_worked_out_by_hand():
    """A byte takes 1 us. Of a fragment 17 bytes and the path go around; a hop's ack has 9."""
    tables = 1 * (3 + 3 + 17 + 1 + 9) + 2 * (3 + 3 + 17 + 2 + 9)  # ids, and a pair of next hops
    answers = 1 * (18 + 1 + 9) + 2 * (18 + 2 + 9)
    graph = 3 * 2 * (1 + 3 + 1 + 18)  # all three send it twice: a number, ids, three bits
    found = first_round(BYTE_A_US, {"mtu": 127, "copies": 2}, line(3), 0)
    assert found == (tables + answers, graph + answers) == (187, 224)


@pytest.mark.parametrize(("copies", "mode"), [(1, WHOLE_GRAPH), (2, TABLES)])
def test_it_is_what_takes_less(copies, mode):
    assert less_of_both(BYTE_A_US, {"mtu": 127, "copies": copies}, line(3), 0) == mode


@pytest.mark.parametrize(("mtu", "most"), [(64, 85), (127, 145)])
def test_more_nodes_than_a_graph_holds_have_tables(mtu, most):
    """On long lines tables take far more, at any number."""
    params = {"mtu": mtu, "copies": 2}
    assert less_of_both(BYTE_A_US, params, line(most), 0) == WHOLE_GRAPH
    assert less_of_both(BYTE_A_US, params, line(most + 1), 0) == TABLES
    tables_us, graph_us = first_round(BYTE_A_US, params, line(most + 1), 0)
    assert graph_us < tables_us


def test_it_is_said_with_the_reason():
    few, many, more = (
        describe(plan(loads(FIELD.format(nodes=nodes, failover="auto")))) for nodes in (30, 80, 90)
    )
    reason = r"\(auto: tables (\d+\.\d\d) s, the graph (\d+\.\d\d) s on the air\), MTU 64"
    tables_s, graph_s = re.search(f"failover graph {reason}", few).groups()
    assert float(graph_s) < float(tables_s)
    tables_s, graph_s = re.search(f"failover search {reason}", many).groups()
    assert float(tables_s) < float(graph_s)
    assert re.search(r"failover search \(auto: tables .* s, the graph holds 85 nodes\)", more)


def test_a_graph_that_is_chosen_has_the_parameters_of_one_that_was_asked_for():
    auto, graph = (
        plan(loads(FIELD.format(nodes=30, failover=failover))) for failover in ("auto", "graph")
    )
    assert auto.params == graph.params
    assert plan(loads(FIELD.format(nodes=80, failover="auto"))).params["poor"] == -104


def test_without_tables_there_is_nothing_to_choose():
    text = FIELD.format(nodes=30, failover="auto")
    with pytest.raises(ScenarioError, match='tables = false and failover = "auto" are two modes'):
        plan(loads(text, ["protocol.tables=false"]))


def test_what_is_estimated_as_less_is_less_and_all_have_it():
    """Thirty nodes on a slow radio, the first round."""
    graph, tables, auto = (
        innervate.run(loads(FIELD.format(nodes=30, failover=failover))).summary
        for failover in ("graph", "search", "auto")
    )
    assert graph["airtime"]["tables_s"] < 0.9 * tables["airtime"]["tables_s"]
    assert graph["discovery"]["tables_s"] < tables["discovery"]["tables_s"]
    assert auto["fingerprint"] == graph["fingerprint"]


def test_faint_links_lose_by_themselves_but_where_the_graph_is_flooded():
    """Decision 0068: 1 dB above the radio's 50 % point."""
    text = 'kind = "mesh"\nnodes = 5\nprotocol.{}'
    said = [f'failover = "{way}"' for way in ("search", "alternate", "graph")]
    found = [plan(loads(text.format(one))).params["poor"] for one in (*said, "tables = false")]
    assert found == [-94, -94, -128, -94]
