"""The summary and headline of any network, number by number and on both sides of each condition."""

from types import SimpleNamespace

import numpy as np
import pytest

from innervate.analysis import summary as summaries
from innervate.analysis.headline import DEGRADED, DOWN, NO_DATA, OK, Headline, silent
from innervate.analysis.summary import headline, known_latencies_us, latency_ms, summarize
from innervate.sim.counts import Counts


def counts(lost=0, dropped=0, **more):
    """Of three nodes that are well, unless something is said."""
    given = {"nodes": 3, "sent": 10, "arrived": 9, "offered": 4, "delivered": 4} | more
    return Counts(**given, lost_by={"noise": lost, "cut": 0}, dropped_by={"no_way": dropped})


CASES = [
    (counts(offered=0, delivered=0), 0, NO_DATA, "Nothing has happened yet."),
    (counts(delivered=0, off=(0, 1, 2)), 0, DOWN, "All 3 nodes are off."),
    (counts(), 1, OK, "All 4 messages are delivered once, none of 10 frames is lost."),
    (counts(offered=0, delivered=0), 1, OK, "None of 10 frames is lost."),
    (counts(off=(0, 1, 2)), 1, DOWN, "All 3 nodes are off."),
    (counts(nodes=2, off=(0, 1)), 1, DOWN, "Both nodes are off."),
    (counts(nodes=1, off=(0,)), 1, DOWN, "The only node is off."),
    (counts(off=(0, 2)), 1, DEGRADED, "2 of 3 nodes are off."),
    (counts(off=(1,)), 1, DEGRADED, "1 of 3 nodes is off."),
    (counts(lost=1), 1, DEGRADED, "1 of 10 frames is lost."),
    (counts(lost=2, arrived=1), 1, DEGRADED, "2 of 10 frames are lost."),
    (counts(lost=2, arrived=0), 1, DOWN, "None of 10 frames arrived."),
    (counts(sent=1, lost=1, arrived=0), 1, DOWN, "The only frame did not arrive."),
    (counts(offered=1, delivered=0), 1, DOWN, "The only message was not delivered."),
    (counts(sent=1, offered=1, delivered=1), 1, OK,
     "The only message is delivered once, no frame is lost."),
    (counts(offered=2, delivered=2), 1, OK,
     "Both messages are delivered once, none of 10 frames is lost."),
    (counts(arrived=0), 1, OK, "All 4 messages are delivered once, none of 10 frames is lost."),
    (counts(delivered=5), 1, OK, "4 messages are delivered 5 times, none of 10 frames is lost."),
    (counts(unheard=1), 1, DEGRADED, "1 of 4 messages is not delivered."),
    (counts(delivered=9, unheard=2), 1, DEGRADED, "2 of 4 messages are not delivered."),
    (counts(delivered=3), 1, DEGRADED, "1 of 4 messages is not delivered."),
    (counts(delivered=1), 1, DEGRADED, "3 of 4 messages are not delivered."),
    (counts(delivered=2, dropped=1), 1, DEGRADED,
     "1 of 4 messages is given up, 1 of 4 messages is not delivered."),
    (counts(delivered=3, dropped=1), 1, DEGRADED, "1 of 4 messages is given up."),
    (counts(dropped=1), 1, DEGRADED, "1 of 4 messages is given up."),
    (counts(dropped=1, delivered=0), 1, DOWN, "None of 4 messages was delivered."),
    (counts(delivered=0), 1, DOWN, "None of 4 messages was delivered."),
    (counts(delivered=0, off=(1,)), 1, DOWN,
     "None of 4 messages was delivered, 1 of 3 nodes is off."),
    (counts(arrived=0, lost=1, off=(0, 1)), 1, DOWN,
     "None of 10 frames arrived, 2 of 3 nodes are off."),
    (counts(offered=1, delivered=2), 1, OK,
     "1 message is delivered 2 times, none of 10 frames is lost."),
    (counts(offered=1, delivered=4), 1, OK,
     "1 message is delivered 4 times, more often than once at each of 3 nodes, "
     "none of 10 frames is lost."),
    (counts(sent=0, arrived=0, offered=0, delivered=0), 1, NO_DATA, "No frame was sent."),
    (counts(sent=0, arrived=0, offered=0, delivered=0, off=(1,)), 1, DEGRADED,
     "1 of 3 nodes is off."),
    (counts(dropped=2, lost=3, off=(1,)), 1, DEGRADED,
     "2 of 4 messages are given up, 1 of 3 nodes is off, 3 of 10 frames are lost."),
    (counts(nodes=0), 1, OK, "All 4 messages are delivered once, none of 10 frames is lost."),
    (counts(sent=12_345, lost=1_000), 1, DEGRADED, "1,000 of 12,345 frames are lost."),
    # On the air a message is there or not, whoever else did not hear a copy of it.
    (counts(is_shared=True), 1, OK,
     "All 4 messages are delivered once, none of 10 receptions is lost."),
    (counts(is_shared=True, sent=1), 1, OK,
     "All 4 messages are delivered once, no reception is lost."),
    (counts(is_shared=True, lost=3), 1, OK,
     "All 4 messages are delivered once, 3 of 10 receptions are lost."),
    (counts(is_shared=True, lost=3, off=(1,)), 1, DEGRADED, "1 of 3 nodes is off."),
    (counts(is_shared=True, lost=3, delivered=3), 1, DEGRADED,
     "1 of 4 messages is not delivered, 3 of 10 receptions are lost."),
    (counts(is_shared=True, lost=3, dropped=1), 1, DEGRADED,
     "1 of 4 messages is given up, 3 of 10 receptions are lost."),
    (counts(is_shared=True, lost=3, delivered=5), 1, DEGRADED, "3 of 10 receptions are lost."),
    (counts(is_shared=True, lost=3, offered=0, delivered=0), 1, DEGRADED,
     "3 of 10 receptions are lost."),
    (counts(is_shared=True, lost=9, arrived=0), 1, DOWN, "None of 10 receptions succeeded."),
]  # fmt: skip


@pytest.mark.parametrize(("counted", "handled", "level", "text"), CASES)
def test_a_headline_names_the_worst_that_there_is(counted, handled, level, text):
    found = headline(counted, handled)
    assert found[:2] == (level, text)
    assert found.nodes == (counted.off if level in (DEGRADED, DOWN) else ())


def test_while_a_run_goes_on_what_is_not_delivered_is_under_way():
    some, none = counts(delivered=3), counts(delivered=4)
    assert headline(some, 1, goes_on=True)[:2] == (
        OK, "1 of 4 messages is under way, none of 10 frames is lost."
    )  # fmt: skip
    assert headline(none, 1, goes_on=True) == headline(none, 1)
    lost = counts(delivered=3, lost=1)
    assert headline(lost, 1, goes_on=True)[:2] == (DEGRADED, "1 of 10 frames is lost.")
    heard = counts(delivered=3, lost=1, is_shared=True)
    assert headline(heard, 1, goes_on=True)[:2] == (
        OK, "1 of 4 messages is under way, 1 of 10 receptions is lost."
    )  # fmt: skip
    none = counts(delivered=0, lost=1, is_shared=True)
    assert headline(none, 1, goes_on=True)[:2] == (DEGRADED, "1 of 10 receptions is lost.")


def test_who_is_silent_is_counted():
    assert silent(1, "gateway") == Headline(NO_DATA, "The only gateway is silent.", (0,))
    assert silent(2, "node") == Headline(NO_DATA, "None of the 2 nodes answers.", (0, 1))
    assert silent(1_500, "node").text == "None of the 1,500 nodes answers."
    assert silent(2, "node").shown() == {
        "level": "no data", "text": "None of the 2 nodes answers.", "nodes": [0, 1],
    }  # fmt: skip


def deliveries(*latencies_us):
    made = np.zeros(len(latencies_us), [("latency", np.int64)])
    made["latency"] = latencies_us
    return made


def test_latencies_are_those_that_somebody_knows():
    assert known_latencies_us(deliveries(5, -1, 0, 7)).tolist() == [5, 0, 7]
    assert latency_ms(deliveries(*range(1_000, 102_000, 1_000))) == {
        "p50": 51.0, "p99": 100.0, "max": 101.0,
    }  # fmt: skip
    assert latency_ms(deliveries(0)) == {"p50": 0.0, "p99": 0.0, "max": 0.0}
    nothing = {"p50": None, "p99": None, "max": None}
    assert latency_ms(deliveries(-1)) == latency_ms(None) == nothing
    assert latency_ms(np.zeros(2, [("time", np.int64)])) == nothing


def result(**more):
    codes = np.zeros(3, [("code", np.int32)])
    codes["code"] = (4, 2, 4)
    given = {
        "plan": SimpleNamespace(kind="skin", seed=7, duration_us=2_500_000,
                                scenario=SimpleNamespace(name="x", model=None)),
        "counts": counts(lost=1, off=(2,), sent=12), "handled": 20, "wall_s": 0.25,
        "fingerprint": "f" * 16, "interrupted": False, "ended_us": 1_500_000,
        "rows": {"rows": codes, "deliveries": deliveries(2_000)},
    }  # fmt: skip
    return SimpleNamespace(**given | more)


def test_a_summary_says_what_was_counted():
    made = summarize(result())
    assert made["duration_s"] == 2.5
    assert (made["events"], made["events_per_s"]) == (29, 116)
    assert (made["nodes"], made["off"]) == (3, 1)
    assert made["frames"] == {"sent": 12, "arrived": 9, "lost": 1, "in_flight": 2,
                              "lost_by": {"noise": 1, "cut": 0}}  # fmt: skip
    assert made["messages"] == {"sent": 4, "delivered": 4, "dropped_by": {"no_way": 0},
                                "latency_ms": {"p50": 2.0, "p99": 2.0, "max": 2.0}}  # fmt: skip
    assert made["reports"] == {"2": 1, "4": 2}
    assert made["headline"]["level"] == DEGRADED
    assert "interrupted_at_s" not in made


def test_what_a_run_did_not_keep_is_not_in_its_summary():
    made = summarize(result(rows={}, wall_s=0.0, interrupted=True))
    assert "reports" not in made
    assert made["events_per_s"] is None
    assert made["interrupted_at_s"] == 1.5
    assert made["messages"]["latency_ms"]["max"] is None


@pytest.mark.parametrize("as_list", [True, False])
def test_own_figures_are_of_the_nodes_that_are_on_alone(monkeypatch, as_list):
    """Of the states there may be more than nodes: one that is blank."""
    states = np.rec.array([(10,), (20,), (40,), (80,)], dtype=[("n", np.int64)])
    world = SimpleNamespace(stations=list(states) if as_list else states)

    def measures(nodes, rows, deliveries, plan):
        return {"sum": sum(int(node.n) for node in nodes), "nodes": len(nodes)}

    network = SimpleNamespace(has=lambda _: True, measures=measures, folder=None)
    monkeypatch.setattr(summaries, "networks", lambda: {"skin": network})
    assert summarize(result(world=world))["measures"] == {"sum": 30, "nodes": 2}
    every = counts(off=(0, 1, 2))
    assert summarize(result(world=world, counts=every))["measures"] == {"sum": 0, "nodes": 0}
