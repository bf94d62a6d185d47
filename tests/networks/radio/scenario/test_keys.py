"""Radio scenarios: what is refused, and with which sentence."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.networks.radio.protocol.fields import PARAMS
from innervate.networks.radio.scenario.traffic import exponential
from innervate.scenario import (
    ScenarioError,
    check,
    dump,
    from_dict,
    load,
    loads,
    plan,
    summary,
    template,
)
from innervate.scenario.actions.channel import JOIN, KILL
from innervate.trace.streams import stream

SMALL = """\
kind = "radio"
stations = 4
packet_slots = 5

[channel]
tau_us = [52, 104]

[[event]]
at_s = 1.0
action = "kill"
station = 2
"""

MISTAKES = (
    ("stations = 4", "stations = 0", "2: stations must be a whole number of stations, 1 to 1023"),
    ("stations = 4", "staions = 4", '2: a scenario has no key "staions"; did you mean "stations"?'),
    ("packet_slots = 5", "packet_slots = 2", "3: packet_slots must be 3 to 250 slots, not 2"),
    ("packet_slots = 5", "packet_slots = [9, 5]", "3: packet_slots must be [least, most]"),
    ("[52, 104]", "[104, 52]", "6: channel.tau_us must be [least, most], not [104, 52]"),
    ("[52, 104]", "[1, 104]", "6: practical mode needs delays within a factor of two"),
    ("[52, 104]", "0", "6: channel.tau_us must be 1 to 1000 microseconds, not 0"),
    ("station = 2", "station = 4", "11: there is no station 4; they are numbered 0 to 3"),
    ("station = 2", 'station = "any"', '11: event.0.station must be a station from 0, or "random"'),
    ("at_s = 1.0", "at_s = 60.0", "9: event.0.at_s = 60 is the end of the run, so it would never"),
    ("at_s = 1.0", "at_s = 99.0", "9: event.0.at_s = 99 is outside the run; duration_s is 60"),
    ('"kill"', '"kil"', '10: event.0.action must be "join", "leave", "kill"'),
    ("station = 2", "station = 2\nframes = 3", '12: event.0.frames goes with "garble" and "fade"'),
    ("tau_us = [52, 104]", "hidden = [[1, 9]]", "6: there is no station 9"),
    ("tau_us = [52, 104]", 'level = "slotted"', "8: events go with level = "),
    ("stations = 4", "stations = 121", "2: practical mode has 120 places in a round"),
)


@pytest.mark.parametrize(("old", "new", "message"), MISTAKES)
def test_mistakes(old: str, new: str, message: str) -> None:
    assert old in SMALL
    with pytest.raises(ScenarioError) as found:
        plan(loads(SMALL.replace(old, new), path="x.toml"))
    text = str(found.value)
    assert message in text
    assert text.startswith("x.toml:")
    assert "\n" not in text


@pytest.mark.parametrize("key", ["p", "wait_us", "turns", "per_turn", "cw_min", "mode", "mac"])
def test_protocol_keys_know_their_range(key: str) -> None:
    with pytest.raises(ScenarioError, match=f"protocol.{key} must be"):
        loads(SMALL, [f"protocol.{key}=-1"])


@pytest.mark.parametrize("key", ["turns", "per_turn"])
def test_what_a_station_takes_a_scenario_takes(key: str) -> None:
    most = next(high for name, _, _, high, *_ in PARAMS if name == key)
    assert plan(loads(SMALL, [f"protocol.{key}={most}"])).params[key] == most
    with pytest.raises(ScenarioError, match=f"protocol.{key} must be at most {most}"):
        loads(SMALL, [f"protocol.{key}={most + 1}"])


def test_more_packets_than_can_be_kept() -> None:
    with pytest.raises(ScenarioError, match="shorten duration_s"):
        plan(loads(SMALL, ['traffic.kind="poisson"', "traffic.load=100", "duration_s=100000"]))


def test_a_plan() -> None:
    made = plan(loads(SMALL))
    assert made.stations == 4
    assert made.protocol == "csma-cd-r/practical"
    assert made.wanted == 0  # somebody dies: nobody knows how many packets will arrive
    assert [(f.at_us, f.action, f.node) for f in made.faults] == [(1_000_000, KILL, 2)]
    for i in range(4):
        for j in range(4):
            assert made.delays_us[i][j] == made.delays_us[j][i]
            assert (i == j) == (made.delays_us[i][j] == 0)
            assert i == j or 52 <= made.delays_us[i][j] <= 104
    assert made.params["slot_us"] == 208


def test_who_joins_is_away_before() -> None:
    made = plan(loads(SMALL.replace('"kill"', '"join"')))
    assert made.absent == [0, 0, 1, 0]
    assert made.faults[0].action == JOIN


def test_poisson_arrivals_have_the_load_that_was_asked_for() -> None:
    made = plan(loads(SMALL, ['traffic.kind="poisson"', "traffic.load=0.5", "duration_s=60"]))
    offered = sum(len(times) for times in made.arrivals)
    airtime = offered * 5 * 208 / (60e6 - 100_000)
    assert airtime == pytest.approx(0.5, rel=0.03)
    for times in made.arrivals:
        assert times == sorted(set(times))


def test_exponential_times() -> None:
    draw = stream(1, "test")
    times = [exponential(draw, 1000) for _ in range(40_000)]
    assert sum(times) / len(times) == pytest.approx(1000, rel=0.02)
    assert sum(t > 1000 for t in times) / len(times) == pytest.approx(0.3679, rel=0.03)
    assert sum(t > 3000 for t in times) / len(times) == pytest.approx(0.0498, rel=0.06)


def test_template_and_dump() -> None:
    scenario = loads(template("radio"))
    assert loads(dump(scenario)).model == scenario.model
    assert "10, packets of 25 slots" in check("radio-disaster")
    assert load("radio-churn").kind == "radio"


words = st.one_of(
    st.none(), st.booleans(), st.integers(-3, 10**7), st.floats(), st.text(max_size=6),
    st.lists(st.integers(-2, 2000), max_size=3), st.lists(st.lists(st.integers(-1, 5), max_size=3)),
    st.sampled_from(["saturated", "poisson", "slotted", "paper", "dcf", "kill", "random"]),
)  # fmt: skip
KEYS = (
    "stations", "packet_slots", "duration_s", "seed", "traffic", "traffic.kind", "traffic.load",
    "traffic.start_s", "channel.level", "channel.tau_us", "channel.hidden", "channel.loss",
    "channel.turnaround_us", "protocol.mac", "protocol.mode", "protocol.tau_bounds_us",
    "protocol.per_turn", "event", "event.0.at_s", "event.0.action", "event.0.station",
    "event.0.frames",
)  # fmt: skip


@settings(max_examples=150, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(KEYS), words), max_size=4))
def test_any_value_of_any_key_is_a_scenario_or_one_line(pairs: list[tuple[str, Any]]) -> None:
    line = "fine"
    try:
        made = loads(SMALL, [("stations", 4), *pairs])
        if made.model.stations <= 50 and made.duration_s < 1000:
            plan(made)
    except ScenarioError as error:
        line = str(error)
    assert line.isprintable()


def test_from_a_dict() -> None:
    made = from_dict({"kind": "radio", "stations": 3, "channel": {"tau_us": 104}})
    assert plan(made).delays_us[0][1] == 104


def test_a_lone_station_and_hidden_pairs_are_warned_of() -> None:
    well = check_text("stations = 4")
    assert "warning" not in well
    alone = check_text("stations = 1")
    assert "  warning    One station alone: nobody can receive what it sends." in alone
    hidden = check_text("stations = 4\n[channel]\nhidden = [[0, 3], [2, 1]]")
    assert "  warning    Stations that do not hear each other (1 and 2, 0 and 3): packets" in hidden
    every = [[i, j] for i in range(4) for j in range(i)]
    assert "(0 and 1, 0 and 2, 1 and 2, 0 and 3, ...)" in check_text(
        f"stations = 4\n[channel]\nhidden = {every}"
    )


def check_text(text: str) -> str:
    return summary(loads(f'kind = "radio"\n{text}'))


def test_of_events_on_the_slotted_level_the_first_is_named() -> None:
    text = SMALL.replace("tau_us = [52, 104]", 'level = "slotted"')
    text += '\n[[event]]\nat_s = 2.0\naction = "kill"\nstation = 1\n'
    with pytest.raises(ScenarioError, match="events go with") as found:
        plan(loads(text))
    assert (found.value.key, found.value.line) == ("event.0", 8)
