"""Figures and rows of a skin's report, of numbers that are written here."""

import re
from types import SimpleNamespace as Of

import pytest

from innervate.networks.skin.plot import report
from innervate.networks.skin.plot import words as skin_words

TIMES = {"p50": 1.0, "p95": 2.0, "p99": 3.0, "max": 4.5}
GAP = "\N{NO-BREAK SPACE}"  # a number and its unit stay on one line
SAID = [f"{took}{GAP}ms" for took in ("1", "2", "3", "4.5")]


def cells(html):
    """The rows of a table below its head."""
    rows = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in html.split("<tr")[1:]]
    return [row for row in rows if row]


def test_commands_have_reached_cells_or_have_not_for_reasons():
    (why, words), *_ = skin_words.MISSED.items()
    given = {"sent": 3, "addressed": 4_000, "delivered": 1_200, "lost_by": {why: 2_700},
             "in_flight": 100, "latency_ms": TIMES}  # fmt: skip
    told = report._commands(given)
    times = [f"from PC to cell, {one}" for one in ("half within", "95 % within", "99 % within",
                                                   "slowest")]  # fmt: skip
    assert cells(told) == [
        ["reached", "1,200"], [f"not reached: {words}", "2,700"],
        ["on their way at the end", "100"],
        *[[name, took] for name, took in zip(times, SAID, strict=True)],
    ]  # fmt: skip
    assert "3 commands of the PC, for 4,000 cells in all; nobody acknowledges one." in told
    assert len(cells(report._commands(given | {"delivered": 0, "lost_by": {}}))) == 2
    assert report._commands(given | {"sent": 0}) == ""


def test_samples_took_so_long_to_each_port_that_had_some():
    slow = {name: 1000 * value for name, value in TIMES.items()}
    ports = [{"port": 0, "samples": 0, "latency_ms": TIMES},
             {"port": 1, "samples": 2_000, "latency_ms": slow}]  # fmt: skip
    data = {"latency_by_port": ports, "delivered": 2_001, "latency_ms": TIMES}
    assert cells(report._latencies(data)) == [
        ["all ports", "2,001", *SAID],
        ["port 1", "2,000", *[f"{took}{GAP}s" for took in ("1", "2", "3", "4.5")]],
    ]
    assert report._latencies(data | {"latency_by_port": ports[:1]}) == ""


def test_an_event_is_a_row(monkeypatch):
    monkeypatch.setattr(skin_words, "fault_words", lambda graph, fault: fault)
    first = {"at_s": 1.0, "cut_cells": 1_000, "cut_off_total": 3, "detected_ms": 12.5,
             "others_ms": 0, "converged_ms": None}  # fmt: skip
    second = first | {"others_ms": 20.0, "converged_ms": 2_000.0, "detected_ms": None}
    incidents = [Of(recovery=first, fault="cut <a>"), Of(recovery=second, fault="b")]
    assert cells(report._events(Of(graph=None, incidents=incidents))) == [
        [
            f"1.000{GAP}s",
            "cut &lt;a&gt;",
            "1,000",
            "3",
            f"12.5{GAP}ms",
            "had one all the time",
            "-",
        ],
        [f"1.000{GAP}s", "b", "1,000", "3", "-", f"20.0{GAP}ms", f"2{GAP}s"],
    ]
    assert report._events(Of(incidents=[])) == ""


SUMMARY = {
    "data": {"sent": 9, "lost": 3, "latency_ms": TIMES}, "balance_factor": 0.5, "lost_at_start": 1,
    "port_loads": [3, 1], "beacon_share": 0.006, "wall_s": 0.5, "events": 1_000, "duration_s": 4,
    "loops": {"episodes": 1_200, "longest_ms": 8.0},
}  # fmt: skip


@pytest.mark.parametrize(("changes", "shown"), [
    ({}, 5), ({"data": SUMMARY["data"] | {"sent": 1}}, 4), ({"balance_factor": None}, 4),
    ({"port_loads": [4]}, 4), ({"beacon_share": None}, 4),
    ({"data": SUMMARY["data"] | {"latency_ms": TIMES | {"p99": None}}}, 4),
])  # fmt: skip
def test_what_is_not_known_is_no_figure(changes, shown):
    found = report._figures(Of(summary=SUMMARY | changes))
    assert len(found) == shown + 1
    assert found[-1][1].startswith("to simulate 4 s, ")
    assert found[-2] == ("1,200", "forwarding loops, the longest 8 ms")


def test_figures_are_in_their_order_and_of_what_was_simulated():
    found = report._figures(Of(summary=SUMMARY | {"interrupted_at_s": 1.5}))
    assert [one for one, _ in found[:4]] == ["75 %", "3 ms", "0.500", "0.6 %"]
    assert found[1][1] == "from sensor to PC for 99 % of those received, 1 ms for half"
    assert found[-1][1].startswith("to simulate 1.5 s, ")
    assert found[0][1] == "of the samples not lost after the start"
    for early in (0, None):
        every = report._figures(Of(summary=SUMMARY | {"lost_at_start": early}))[0]
        assert every == ("66.7 %", "of the samples not lost")
    none = SUMMARY | {"loops": {"episodes": 0, "longest_ms": None}}
    assert report._figures(Of(summary=none))[-2] == ("0", "forwarding loops")


@pytest.mark.parametrize("count", [0, 1, 2])
def test_cables_that_are_broken_at_the_end_are_listed(monkeypatch, count):
    monkeypatch.setattr(skin_words, "broken_cables", lambda broken: [f"a{i} - b" for i in broken])
    monkeypatch.setattr(report, "BROKEN_MAX", 2)
    told = report._broken({"broken": list(range(count))})
    assert ("No cable is broken at the end." in told) == (count == 0)
    assert ("Broken at the end: a0 - b" in told) == (count == 1)
    assert told.count("<li>") == (2 if count == 2 else 0)
    more = report._broken({"broken": [0, 1, 2, 3]})
    assert "<li>and 2 more, listed under All numbers</li>" in more
