"""What is said of a mesh's run, by summaries that are written here."""

import re
from types import SimpleNamespace as Of

import pytest

import innervate
from innervate.networks.mesh.plot import report, words
from innervate.networks.mesh.protocol.constants import WHOLE_GRAPH
from innervate.scenario.actions.field import CUT, JAM, KILL, QUIET, RESTART, RESTORE, REVIVE

PLAN = Of(names=["mast", "n1", "n2"], ranks=[0, 1, -1])


@pytest.mark.parametrize(("action", "said"), [
    (CUT, "link n1 - n2 cut"), (RESTORE, "link n1 - n2 restored"), (KILL, "node n1 switched off"),
    (REVIVE, "node n1 switched on"), (RESTART, "node n1 restarted"),
    (JAM, "noise of -72.5 dBm at node n1"), (QUIET, "no noise at node n1 any more"),
])  # fmt: skip
def test_an_event_in_words(action, said):
    fault = Of(action=action, node=1, other=2, value=-7250)
    assert words.fault_words(PLAN, fault) == said


def alarms(sent, came):
    return {"sent": sent, "delivered": came, "latency_ms": {"max": 42.0},
            "overrun_m": {"max": 0.128}}  # fmt: skip


@pytest.mark.parametrize(("sent", "came", "said"), [
    (0, 0, []), (2, 0, ["2 crossings of the fence, and the monitor learned of none."]),
    (1, 1, ["1 crossing of the fence, and the monitor learned of it: the alarm took 42.0 ms, "
            "no robot got farther out than 0.13 m by then."]),
    (3, 3, ["3 crossings of the fence, and the monitor learned of all: the slowest alarm took "
            "42.0 ms, no robot got farther out than 0.13 m by then."]),
    (3, 2, ["3 crossings of the fence, and the monitor learned of 2; the slowest alarm took "
            "42.0 ms, a robot got 0.13 m out."]),
    (3, 1, ["3 crossings of the fence, and the monitor learned of 1; the alarm took 42.0 ms, "
            "a robot got 0.13 m out."]),
])  # fmt: skip
def test_how_many_crossings_the_monitor_learned_of(sent, came, said):
    assert words._alarms(alarms(sent, came)) == said


@pytest.mark.parametrize(("false", "said"), [
    (0, []), (1, ["1 alarm was false, of a robot that was inside: 90 per robot and hour."]),
    (3, ["3 alarms were false, of robots that were inside: 90 per robot and hour."]),
])  # fmt: skip
def test_how_many_alarms_were_false(false, said):
    assert words._false({"false": false, "false_per_hour": 90.0}) == said
    assert words._false({}) == []


def test_a_crossing_too_shortly_before_the_end_is_told_though_it_counts_in_nothing():
    """A robot is outside, the monitor is off, and no figure says so yet."""
    run = innervate.run({
        "kind": "mesh", "nodes": 3, "duration_s": 12, "radio": {"profile": "ideal"},
        "placement": {"layout": "line"}, "fence": {"polygon": [[0, -9], [40, -9], [40, 9], [0, 9]]},
        "robot": [{"node": 2, "waypoints": [[20, 0], [20, 15]], "start_s": 2.5}],
        "event": [{"at_s": 10, "action": "kill", "node": "monitor"}],
    })  # fmt: skip
    assert run.summary["alarms"]["sent"] == 0
    assert words.sentences(run.result, run.summary)[0] == (
        "Not counted: 1 crossing too shortly before the end to say that the monitor never learned "
        "of it."
    )


def messages(ratio, joined=10, of_joined=1.0, p50=4.0):
    return words._messages({
        "messages": {"counted": 10}, "delivery_ratio": ratio,
        "latency_ms": {"p50": p50, "p99": 9.0},
        "connected": {"sent": joined, "delivered": round(joined * (of_joined or 0.0)),
                      "delivery_ratio": of_joined},
    })  # fmt: skip


def test_how_many_messages_came_and_which_had_no_chance():
    assert messages(None) == []
    times = ", half within 4 ms, 99 % within 9 ms."
    assert messages(1.0, joined=8) == ["10 messages: every one was delivered" + times]
    assert messages(0.7, of_joined=0.7) == ["10 messages: 7 delivered (70 %)" + times]
    assert messages(0.0, of_joined=0.0, p50=None) == ["10 messages: 0 delivered (0 %)."]
    _, apart = messages(0.7, joined=8, of_joined=0.875)
    assert apart == ("Of those, 2 had no chance: sender and recipient were not connected, or off; "
                     "of the others 87.5 % were delivered.")  # fmt: skip
    assert "of the others 0 % were" in messages(0.0, joined=8, of_joined=0.0)[1]
    assert messages(0.0, joined=0, of_joined=None)[1] == (
        "None had a chance: sender and recipient were not connected, or off."
    )


def test_who_came_over_poor_links_is_not_said_to_have_had_no_chance():
    _, apart = messages(0.9, joined=6)
    assert apart == ("1 of the 4 whose sender and recipient no good links joined, or of which one "
                     "was off, did not come; of the others 100 % were delivered.")  # fmt: skip
    _, apart = messages(0.3, joined=0, of_joined=None)
    assert apart == ("7 of the 10 whose sender and recipient no good links joined, or of which one "
                     "was off, did not come.")  # fmt: skip


@pytest.mark.parametrize(("off", "counted", "said"), [
    (0, 10, []),
    (1, 9, ["Not counted: 1 message of nodes that were off."]),
    (0, 8, ["Not counted: 2 messages offered too shortly before the end."]),
    (3, 0, ["Not counted: 3 messages of nodes that were off, "
            "7 messages offered too shortly before the end."]),
])  # fmt: skip
def test_messages_that_no_ratio_counts_are_told_apart(off, counted, said):
    found = {"offered": 10, "sender_off": off, "counted": counted}
    assert words._uncounted(found) == said


@pytest.mark.parametrize(("tables_s", "with_tables", "end"), [
    (2.345, 12, "; every node had its table 2.35 s after the first request."),
    (2.345, 9, "; 9 of 12 nodes had a table 2.35 s after the first request."),
    (None, 9, "; 9 of 12 nodes got a table."), (None, None, "."),
])  # fmt: skip
def test_what_the_first_round_found(tables_s, with_tables, end):
    found = {"recall": 0.5, "complete_s": 1.2345, "tables_s": tables_s,
             "with_tables": with_tables}  # fmt: skip
    begin = "The first round found 50 % of the good links within 1.23 s"
    assert words._discovery(found, 12) == [begin + end]
    graph = re.sub("its table|a table", "the graph", end)
    assert words._discovery(found, 12, WHOLE_GRAPH) == [begin + graph]
    assert words._discovery({"recall": None}, 12) == ["No discovery round was completed."]


def test_who_became_gateway_last_and_how_long_that_one_took():
    """Of several takeovers each has a time of its own: the summary's is that of the first."""
    led = [{"node": node, "at_s": at_s, "tables_s": tables_s}
           for node, at_s, tables_s in ((0, 0.0, 1.0), (1, 2.0, 0.5), (2, 3.5, 0.25))]  # fmt: skip
    deaths = [Of(at_us=at, action=KILL, node=node) for at, node in ((1_300_000, 0), (3_000_000, 1))]
    never = [*led[:2], led[2] | {"tables_s": None}]
    returned = [led[0], led[1] | {"node": 0}]
    for leaders, faults, said in (
        (led[:1], deaths, None), (led, [], "n2 became gateway at 3.500 s."),
        (led[:2], deaths, "n1 became gateway at 2.000 s; its tables were everywhere 1.2 s after "
                          "the old one died."),
        (led, deaths, "n2 became gateway at 3.500 s; its tables were everywhere 0.75 s after "
                      "the old one died."),
        (led, deaths[:1], "n2 became gateway at 3.500 s."),
        (never, deaths, "n2 became gateway at 3.500 s."),
        (returned, deaths, "mast became gateway again at 2.000 s; its tables were everywhere 1.2 s "
                           "after it had died."),
    ):  # fmt: skip
        plan, summary = Of(names=PLAN.names, faults=faults), {"gateways": leaders}
        assert words._gateways(plan, summary) == ([f"Node {said}"] if said else [])


@pytest.mark.parametrize(("doubled", "looped", "said"), [
    (0, 0, "No message came twice; none met a node twice on the way."),
    (1, 0, "1 message came twice; none met a node twice on the way."),
    (0, 1200, "No message came twice; 1,200 packets met a node twice on the way."),
])  # fmt: skip
def test_what_came_twice(doubled, looped, said):
    assert words._trouble({"duplicates": doubled, "looped": looped}) == said


@pytest.mark.parametrize(("count", "folded"), [(40, False), (41, True)])
def test_nodes_one_by_one_and_many_folded(monkeypatch, count, folded):
    one = Of(node=0, on=False, neighbours=2, depth=None, version=0, control_bytes=1, forwarded=1,
             share=0.5, suspected=0)  # fmt: skip
    top = Of(**vars(one) | {"depth": 0, "on": True, "version": 3})
    monkeypatch.setattr(report, "nodes", lambda _: [one, *[top] * (count - 1)])
    monkeypatch.setattr(report.mesh_map, "roles", lambda _: {0: "robot"})
    made = report.nodes_section(Of(plan=PLAN))
    cells = re.findall("<td[^>]*>([^<]*)</td>", made)
    assert (cells[1], cells[3:5]) == ("robot, off", ["unknown", "none"])
    assert (cells[10], cells[12:14]) == ("robot", ["0", "3"])
    assert (f"All {count} nodes" in made) == folded


@pytest.mark.parametrize(("node", "depth", "on", "said"), [
    (0, 0, True, "gateway"), (1, 0, True, "standby, leads"), (1, 1, True, "standby"),
    (1, 0, False, "standby, off"), (2, 1, True, ""),
])  # fmt: skip
def test_a_standby_that_leads_is_told_from_one_that_waits(monkeypatch, node, depth, on, said):
    one = Of(node=node, on=on, neighbours=2, depth=depth, version=0, control_bytes=1, forwarded=1,
             share=0.5, suspected=0)  # fmt: skip
    monkeypatch.setattr(report, "nodes", lambda _: [one])
    monkeypatch.setattr(report.mesh_map, "roles", lambda _: {0: "gateway", 1: "standby", 2: ""})
    cells = re.findall("<td[^>]*>([^<]*)</td>", report.nodes_section(Of(plan=PLAN)))
    assert cells[1] == said
