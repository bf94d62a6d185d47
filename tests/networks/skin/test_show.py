"""The lines on a run of a skin that stand in its report and on the terminal."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.skin import show

QUIET = {"data": {"loss_ratio": None}, "commands": None,
         "loops": {"longest_ms": None, "episodes": 0}}  # fmt: skip


@pytest.mark.parametrize(
    ("loads", "factor", "line"),
    [
        ([3], 1.0, None),
        ([3, 4], None, None),
        ([3, 1004], 0.5, "3, 1,004 (balance factor 0.500)"),
        (range(8), 0.25, "0, 1, 2, 3, 4, 5, 6, 7 (balance factor 0.250)"),
        (range(9), 0.25, "0, 1, 2, 3, 4, 5, 6, 7, ... (balance factor 0.250)"),
    ],
)
def test_loads_of_ports_are_shown_where_there_are_several(loads, factor, line, monkeypatch):
    monkeypatch.setattr(show, "command_lines", lambda commands: [])
    found = show.state_lines(QUIET | {"port_loads": list(loads), "balance_factor": factor})
    said = [f"Cells behind each interface port: {line}."] if line else []
    assert found == [*said, "No forwarding loop."]


WAITS = {"p50": 0.5, "p99": 1.25, "max": 17.04}
COMMANDS = {"sent": 1200, "addressed": 3600, "lost": 36, "loss_ratio": 0.01,
            "lost_by": {"off": 6, "no_route": 30, "on_the_way": 0},
            "latency_ms": {"p50": 0.5, "max": 2.5}}  # fmt: skip
SAID = ("Commands: 1,200 sent, for 3,600 cells in all, 36 not reached (1 %), 30 without a way to "
        "the PC, 6 switched off")  # fmt: skip


@pytest.mark.parametrize(("more", "line"), [
    ({}, [f"{SAID}; half within 0.5 ms, the slowest 2.5 ms."]), ({"loss_ratio": None}, []),
    *(({"latency_ms": COMMANDS["latency_ms"] | {name: None}}, [f"{SAID}."])
      for name in ("p50", "max")),
])  # fmt: skip
def test_what_became_of_commands_is_told_with_the_most_frequent_reason_first(more, line):
    assert show.command_lines(COMMANDS | more) == line


def test_how_long_samples_took_is_told_where_some_came():
    assert show.latency_lines(WAITS) == [
        "From sensor to PC: half within 0.5 ms, 99 % within 1.25 ms, the slowest 17.0 ms "
        "(samples received)."
    ]
    for name in WAITS:
        assert show.latency_lines(WAITS | {name: None}) == []


@pytest.mark.parametrize(("early", "more"), [
    (None, ""), (0, ""), (1, "; 1 of them before cells had a way for the first time"),
    (40, "; all before cells had a way for the first time"),
])  # fmt: skip
def test_samples_and_loops_are_told_with_their_reasons(monkeypatch, early, more):
    """And those that the headline does not count: else it and this line seem to disagree."""
    monkeypatch.setattr(show, "command_lines", lambda commands: [])
    data = {"sent": 4000, "lost": 40, "loss_ratio": 0.01, "latency_ms": WAITS,
            "lost_by": {"cut": 10, "noise": 30, "loop": 0}}  # fmt: skip
    loops = {"longest_ms": 0.0, "episodes": 1}
    found = show.state_lines({"data": data, "port_loads": [3], "balance_factor": 1.0,
                              "commands": None, "loops": loops,
                              "lost_at_start": early})  # fmt: skip
    assert found == [
        "Samples: 4,000 sent, 40 lost (1 %), 30 noise or a loose plug, 10 on a cut cable"
        f"{more}.",
        *show.latency_lines(WAITS), "1 forwarding loop, the longest for less than 0.001 ms.",
    ]  # fmt: skip


def broken(count):
    return [{"cell": f"c{i}", "port": "N", "since_s": 1.0} for i in range(count)]


@pytest.mark.parametrize(("count", "more"), [(1, []), (5, []), (6, ["... and 1 more."]),
                                             (9, ["... and 4 more."])])  # fmt: skip
def test_the_first_cables_that_are_broken_are_named(count, more):
    named = [f"Broken at the end: cable at c{i} N, since 1.000 s." for i in range(min(count, 5))]
    assert show._broken({"broken": broken(count)}) == [*named, *more]
    assert show._broken({"broken": []}) == ["No cable is broken at the end."]


def run_of(events, **more):
    summary = {"recoveries": list(range(events)), "name": "arm", "duration_s": 2.0, "depth_max": 1,
               "wall_s": 0.126, "seed": 3, "broken": [], "warnings": ["odd"],
               "headline": {"level": "good", "text": "all well."}} | more  # fmt: skip
    plan = Of(faults=list(range(events)), graph=Of(cells=40, interfaces=2))
    return Of(skin=summary, plan=plan, result=Of(has_deliveries=True))


@pytest.mark.parametrize(("events", "more"), [
    (8, []), (9, ["... and 1 more event."]), (11, ["... and 3 more events."]),
])  # fmt: skip
def test_the_first_events_are_told(events, more, monkeypatch):
    monkeypatch.setattr(show.skin_words, "headline", lambda graph, *pair: f"{pair}")
    assert show.event_lines(run_of(events)) == [*(f"({i}, {i})" for i in range(8)), *more]
    late = run_of(1, interrupted_at_s=1.5)
    assert show.event_lines(late)[1:] == ["Interrupted at 1.500 s of simulated time."]


def test_a_run_is_told_from_its_first_line_on(monkeypatch):
    monkeypatch.setattr(show, "state_lines", lambda summary: ["No forwarding loop."])
    first = "arm: 40 cells, 2 interface ports, at most 1 hop deep; {} simulated in 0.13 s, seed 3"
    assert show.summary_lines(run_of(0)) == [
        first.format("2 s"), "good: all well.", "Warning: odd.", "No cable is broken at the end.",
        "No forwarding loop.",
    ]  # fmt: skip
    assert show._first(run_of(0, interrupted_at_s=1.5)) == first.format("1.5 of 2 s")
