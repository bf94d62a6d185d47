"""Rows of a mesh report's tables, of crossings, flows and events that are written here."""

import re
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.mesh.analysis.alarms import Crossing
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.plot import report
from innervate.plot import page

PLAN = Of(names=["a", "b", "c&d"])


def cells(html):
    """The rows of a table below its head."""
    rows = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in html.split("<tr")[1:]]
    return [row for row in rows if row]


def crossing(**changes):
    """One that was told by its routed alarm."""
    usual = {"robot": 2, "crossed_us": 15_000_000, "back_us": 0, "raised_us": 15_001_000,
             "raised_by": 1, "accepted_us": 15_013_500, "row": 0, "flooded": False, "hops": 3,
             "warned_us": NEVER, "overrun_m": 0.126, "open": False}  # fmt: skip
    return Crossing(**usual | changes)


AT, BY = "15.000\N{NO-BREAK SPACE}s", "0.13\N{NO-BREAK SPACE}m"  # each on one line


@pytest.mark.parametrize(("changes", "row"), [
    ({}, [AT, "c&amp;d", "b", "12.5\N{NO-BREAK SPACE}ms", "3, routed", BY, "no"]),
    ({"flooded": True, "warned_us": 13_000_000},
     [AT, "c&amp;d", "b", "12.5\N{NO-BREAK SPACE}ms", "3, flooded", BY, "2 s before"]),
    ({"accepted_us": NEVER}, [AT, "c&amp;d", "b", "never", "", BY, "no"]),
    ({"accepted_us": NEVER, "open": True, "raised_by": NEVER, "robot": 0},
     [AT, "a", "nobody noticed", "still open at the end", "", BY, "no"]),
])  # fmt: skip
def test_a_crossing_is_a_row(changes, row):
    told = report._crossings(Of(plan=PLAN), [crossing(), crossing(**changes)])
    assert cells(told)[1] == ["2", *row]
    assert report._crossings(Of(plan=PLAN), []) == ""


def test_a_flow_is_a_row_where_there_are_several():
    flows = [
        {"flow": 1, "offered": 1_200, "delivery_ratio": 0.5, "latency_ms": {"p50": 5.0, "p99": 17}},
        {"flow": 0, "offered": 3, "delivery_ratio": None, "latency_ms": {"p50": None, "p99": None}},
    ]
    asked = [Of(from_="a", to="gateway"), Of(from_="each", to="b")]
    result = Of(plan=Of(scenario=Of(model=Of(flow=asked))))
    assert cells(report._flows(result, {"flows": flows})) == [
        [
            "each to b",
            "1,200",
            "50\N{NO-BREAK SPACE}%",
            "5\N{NO-BREAK SPACE}ms",
            "17.0\N{NO-BREAK SPACE}ms",
        ],
        ["a to gateway", "3", "", "", ""],
    ]
    assert report._flows(result, {"flows": flows[:1]}) == ""


def test_events_and_reports_are_rows():
    def events(result):
        return page.events(result, lambda fault: fault.words)

    plan = Of(
        kind="mesh", faults=[Of(at_us=1_234_567, words="kill <a>"), Of(at_us=2_000_000, words="b")]
    )
    both = [["1.235\N{NO-BREAK SPACE}s", "kill &lt;a&gt;"], ["2.000\N{NO-BREAK SPACE}s", "b"]]
    assert cells(events(Of(plan=plan, ended_us=2_000_000))) == both
    assert cells(events(Of(plan=plan, ended_us=1_999_999))) == both[:1]  # interrupted
    assert events(Of(plan=Of(kind="mesh", faults=[]), ended_us=9)) == ""
    (known, name), *_ = report.REPORTS.items()
    rows = np.array([(999,), (known,), (known,)], [("code", np.int64)])
    assert cells(report._reports(Of(rows=rows))) == [[name, "2"], ["code 999", "1"]]
    assert report._reports(Of(rows=rows[:0])) == ""


def test_a_transmission_of_an_alarm_is_a_row(monkeypatch):
    hops = [
        Of(to=0, start_us=15_003_500, node=2, flooded=False, path_len=1, receivers=4),
        Of(to=255, start_us=15_001_000, node=1, flooded=True, path_len=2, receivers=0),
    ]
    monkeypatch.setattr(report, "copies", lambda result, of: hops)
    assert cells(report._steps(Of(plan=PLAN), crossing())) == [
        ["2.5", "c&amp;d", "a", "routed", "1", "4"],
        ["0.0", "b", "all", "flooded", "2", "0"],
    ]
