"""Settings that an event-level run has no use for: those without which it is the same."""

from functools import cache

import pytest

from innervate import run, scenario
from innervate.networks.radio.scenario.words import warnings

OTHERS = {
    "channel.turnaround_us": [3000], "protocol.mode": ["paper"], "protocol.turns": [1],
    "protocol.wait_us": [1, 30_000], "protocol.p": [0.9], "protocol.cw_min": [4],
    "protocol.cw_max": [64], "protocol.backoff_slots": [20], "protocol.reading": ["B"],
    "traffic.packets": [7], "traffic.load": [0.8], "traffic.start_s": [0.7],
}  # fmt: skip
MODES = ("practical", "paper")
MACS = [*(("csma-cd-r", mode) for mode in MODES), *((mac, "practical") for mac in (
    "csma-cd-d1", "csma-cd-d2", "csma-cd-d2p", "dcf", "slotted-aloha", "nonpersistent",
    "p-persistent", "tdma", "tree", "token-ring", "polling"))]  # fmt: skip


def team(mac, mode, kind, key="", value=None):
    made = {
        "kind": "radio", "duration_s": 8, "stations": 8, "seed": 5, "packet_slots": 10,
        "traffic": {"kind": kind}, "channel": {}, "protocol": {"mac": mac, "mode": mode},
    }  # fmt: skip
    if key:
        table, name = key.split(".")
        made[table][name] = value
    return made


@cache
def fingerprint(*given):
    return run(team(*given)).summary["fingerprint"]


def told(*given):
    plan = scenario.plan(scenario.from_dict(team(*given)))
    return [one for one in warnings(plan) if "not used" in one]


@pytest.mark.parametrize(("mac", "mode"), MACS)
def test_what_is_set_and_makes_no_difference_is_told(mac, mode):
    kinds = ("saturated", "poisson", "disaster")
    for key, values in OTHERS.items():
        if mac == "csma-cd-r" and key == "protocol.mode":
            continue
        same = {
            kind: all(fingerprint(mac, mode, kind, key, value) == fingerprint(mac, mode, kind)
                      for value in values)
            for kind in kinds
        }  # fmt: skip
        is_told = {kind: bool(told(mac, mode, kind, key, values[0])) for kind in kinds}
        if key.startswith("traffic"):
            assert is_told == same, key
        else:  # a disaster may be over before it matters
            assert set(is_told.values()) == {all(same.values())}, key


def test_it_is_one_line_and_says_of_whom():
    made = team("tdma", "practical", "poisson", "traffic.packets", 7)
    made["protocol"] |= {"p": 0.5, "cw_min": 32}  # that is what it is anyway
    plan = scenario.plan(scenario.from_dict(made))
    line = "protocol.p and traffic.packets are set and not used by tdma with poisson traffic."
    assert line in warnings(plan)


@pytest.mark.parametrize(
    ("action", "is_told"), [("kill", True), ("leave", True), ("garble", False)]
)
def test_who_saturates_a_channel_and_loses_a_station_goes_on_until_the_end(action, is_told):
    made = team("tdma", "practical", "saturated", "traffic.packets", 7)
    event = {"at_s": 1.2, "action": action, "station": 2}
    if action == "garble":
        event |= {"frames": 3}
    plan = scenario.plan(scenario.from_dict({**made, "event": [event]}))
    assert any("traffic.packets" in one for one in warnings(plan)) == is_told
    assert (plan.wanted == 0) == is_told
