"""Delays that a scenario puts outside what stations believe are said: always, and only then."""

import pytest

import innervate
from innervate.networks.radio.plot.report import sentences
from innervate.networks.radio.scenario.words import warnings
from innervate.networks.radio.show import summary_lines
from innervate.scenario import check, from_dict, plan

SAID = "us that stations believe"
BELIEVED = [52, 104]


def team(real, believed=BELIEVED, **more):
    bounds = {} if believed is None else {"tau_bounds_us": believed}
    return {
        "kind": "radio", "stations": 3, "packet_slots": 5, "duration_s": 2.0,
        "channel": {"tau_us": real}, "protocol": {"mac": "csma-cd-r", **bounds}, **more,
    }  # fmt: skip


@pytest.mark.parametrize("mac", ["csma-cd-r", "dcf", "token-ring"])
@pytest.mark.parametrize(
    ("real", "believed", "said"),
    [
        ([51, 104], BELIEVED, "51 to 104 us lie outside the 52 to 104 us"),
        ([52, 105], BELIEVED, "52 to 105 us lie outside the 52 to 104 us"),
        ([48, 52], BELIEVED, "48 to 52 us lie outside the 52 to 104 us"),
        (51, BELIEVED, "51 us lie outside the 52 to 104 us"),
        (60, [61, 61], "60 us lie outside the 61 us"),
        ([52, 104], BELIEVED, ""),
        ([53, 103], BELIEVED, ""),
        (104, BELIEVED, ""),
        ([1, 2], None, ""),
    ],
)
def test_check_says_delays_that_nobody_believes(real, believed, said, mac):
    tables = team(real, believed)
    tables["protocol"]["mac"] = mac
    text = check(tables)
    assert (SAID in text) == bool(said)
    assert said in text
    assert ("set protocol.tau_bounds_us to what is true" in text) == bool(said)


def test_every_run_and_its_report_say_it_whether_or_not_a_station_measures_it():
    noticed = set()
    for seed in range(1, 9):
        run = innervate.run(team([50, 104], seed=seed), plain=True, out=None)
        noticed.add(run.summary["bounds_noticed"]["count"] > 0)
        lines = summary_lines(run)
        assert sum("50 to 104 us lie outside the 52 to 104 us" in line for line in lines) == 1
        assert not any("bounds;" in line for line in lines)  # once is enough
        assert any("50 to 104 us lie outside" in x for x in sentences(run.result, run.summary))
        delays = [at for row in run.plan.delays_us for at in row if at]
        shown = run.summary["headline"]
        assert (shown["level"] == "degraded") == (SAID in shown["text"]) == (min(delays) < 52)
    assert noticed == {True, False}


def test_what_no_station_can_measure_is_said_too():
    tables = team([105, 105])
    tables["protocol"]["mac"] = "dcf"
    run = innervate.run(tables, plain=True, out=None)
    assert run.summary["bounds_noticed"]["count"] == 0
    assert any("105 us lie outside" in line for line in summary_lines(run))
    assert SAID in run.summary["headline"]["text"]


@pytest.mark.parametrize("seed", range(1, 4))
def test_a_run_with_delays_as_believed_says_nothing_of_them(seed):
    run = innervate.run(team([104, 104], seed=seed), plain=True, out=None)
    said = [*summary_lines(run), *sentences(run.result, run.summary)]
    assert not any(SAID in line or "bounds" in line for line in said)
    assert run.summary["headline"]["level"] == "ok"


def test_a_run_whose_delays_happen_to_be_as_believed_is_well_and_its_scenario_warned_of():
    """The range allows for one that is outside; what was drawn has none."""
    wide = team([51, 104], seed=1, stations=2)
    assert plan(from_dict(wide)).delays_us[0][1] >= 52
    assert warnings(plan(from_dict(wide)))
    assert innervate.run(wide, plain=True, out=None).summary["headline"]["level"] == "ok"


def test_a_pair_that_hears_nothing_has_no_delay_to_believe():
    hidden = team([104, 104], channel={"tau_us": 104, "hidden": [[0, 1]]})
    assert SAID not in check(hidden)
    run = innervate.run(hidden, plain=True, out=None)
    assert SAID not in run.summary["headline"]["text"]
