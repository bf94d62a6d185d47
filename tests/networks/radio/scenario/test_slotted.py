"""The slotted level uses a setting, or refuses it: it ignores none."""

import pytest

import innervate
from innervate.networks.radio.scenario.model import MACS as EVERY_MAC
from innervate.networks.radio.scenario.model import ChannelTable, MediumAccessTable, TrafficTable
from innervate.networks.radio.scenario.slotted import EVENT_ONLY, UNUSED, USED_BY
from innervate.networks.radio.slotted.drive import USED_BY as OPTIONS
from innervate.scenario import ScenarioError, dump, from_dict, inline, loads
from innervate.scenario import summary as check
from innervate.scenario.given import load

MACS = [mac for mac in EVERY_MAC if mac not in EVENT_ONLY]
# Another value of every key whose table says what a protocol does.
OTHER = {
    "protocol": {
        "mode": "paper", "tau_bounds_us": [60, 80], "turns": 7, "per_turn": 3, "wait_us": 900,
        "p": 0.37, "cw_min": 8, "cw_max": 512, "backoff_slots": 3, "reading": "B",
        "received_by": "everybody", "answers": "turnaround",
    },
    "channel": {
        "tau_us": [60, 80], "turnaround_us": 2000, "loss": 0.2, "hidden": [[0, 1]],
    },
    "traffic": {"spread_us": 5000, "start_s": 0.2},
}  # fmt: skip
# They choose another run, not another setting of it: the kinds of packets, and time's unit.
ASIDE = {
    "protocol": {"mac"},
    "channel": {"level", "bit_rate"},
    "traffic": {"kind", "load", "packets"},
}
KEYS = [(table, name) for table, names in OTHER.items() for name in names]


def scenario(mac, **changes):
    base = {
        "kind": "radio", "stations": 3, "packet_slots": 5, "traffic": {"kind": "saturated",
        "packets": 20}, "channel": {"level": "slotted"}, "protocol": {"mac": mac},
    }  # fmt: skip
    return {name: {**value, **changes.pop(name, {})} if isinstance(value, dict) else value
            for name, value in base.items()} | changes  # fmt: skip


def run(tables):
    return innervate.run(tables, plain=True).summary["fingerprint"]


@pytest.fixture(scope="module")
def before():
    return {mac: run(scenario(mac)) for mac in MACS}


def test_no_key_is_left_out():
    tables = {"protocol": MediumAccessTable, "channel": ChannelTable, "traffic": TrafficTable}
    for table, model in tables.items():
        known = set(OTHER[table]) | ASIDE[table]
        assert known == set(model.__struct_fields__)
    assert set(UNUSED) | set(USED_BY) == set(KEYS)
    for (_, name), macs in USED_BY.items():
        assert OPTIONS[name.replace("_us", "_slots")] == macs


@pytest.mark.parametrize("mac", MACS)
def test_a_setting_changes_the_run_or_is_refused(mac, before):
    for table, name in KEYS:
        changes = {table: {name: OTHER[table][name]}}
        if table == "traffic" and name == "spread_us":
            changes = {"traffic": {"kind": "disaster", "spread_us": 5000}}
        if mac in USED_BY.get((table, name), ()):
            assert run(scenario(mac, **changes)) != before[mac], (table, name)
        else:
            with pytest.raises(ScenarioError) as found:
                from_dict(scenario(mac, **changes))
            assert f"{table}.{name} goes with " in str(found.value)
            assert "\n" not in str(found.value)


@pytest.mark.parametrize("mac", MACS)
def test_what_it_has_no_use_for_is_refused_at_its_default_too(mac):
    whole = from_dict({"kind": "radio", "protocol": {"mac": mac}}).model  # on the event level
    for table, name in KEYS:
        by_itself = getattr(getattr(whole, table), name)
        tables = scenario(mac, **{table: {name: by_itself}})
        text = f"{table}.{name}={inline(by_itself)}"
        if by_itself is None:
            assert from_dict(tables) == from_dict(scenario(mac))
        elif mac in USED_BY.get((table, name), ()):
            assert from_dict(tables).model == from_dict(scenario(mac)).model
        else:
            for given in ((tables,), (scenario(mac), [text])):
                with pytest.raises(ScenarioError, match=rf"{table}\.{name} goes with "):
                    from_dict(*given)


@pytest.mark.parametrize("mac", MACS)
def test_what_is_written_of_it_is_read_back_and_can_be_changed(mac):
    made = from_dict(scenario(mac))
    text = dump(made)
    assert loads(text).model == made.model
    assert "tau_us" not in text
    assert "packets = 20" in text
    assert load(made, overrides={"packet_slots": 7}).model.packet_slots == 7


def test_a_scenario_of_events_can_be_put_on_the_slotted_level():
    """Nobody gave what it has by itself, though the scenario knows it."""
    changes = {"channel.level": "slotted"}
    made = load(from_dict({"kind": "radio", "stations": 3}), overrides=changes)
    assert made.model.channel.level == "slotted"
    given = from_dict({"kind": "radio", "stations": 3, "channel": {"loss": 0.0}})
    with pytest.raises(ScenarioError, match=r"channel\.loss goes with"):
        load(given, overrides=changes)


@pytest.mark.parametrize("mac", MACS)
def test_a_range_of_lengths_is_refused_and_another_length_is_not(mac, before):
    with pytest.raises(ScenarioError, match="a range of packet_slots goes with level"):
        from_dict(scenario(mac, packet_slots=[5, 9]))
    assert run(scenario(mac, packet_slots=[9, 9])) == run(scenario(mac, packet_slots=9))
    assert run(scenario(mac, packet_slots=9)) != before[mac]


def test_check_prints_what_is_used():
    shown = check(from_dict(scenario("dcf")))
    assert "slotted level, 38,400 bit/s, a slot of 208 us\n" in shown
    assert "turnaround" not in shown
    assert "delays" not in shown
    assert shown.splitlines()[4] == "  protocol   dcf"
    ours = check(from_dict(scenario("csma-cd-r", channel={"turnaround_us": 2000})))
    assert "a slot of 208 us, turnaround 2 ms\n" in ours
    assert ours.splitlines()[4] == "  protocol   csma-cd-r, reading A"
    assert "practical" not in ours
    p = check(from_dict(scenario("p-persistent", protocol={"p": 0.2})))
    assert "p-persistent, p 0.2" in p
    assert "csma-cd-d2, backoff slots 1" in check(from_dict(scenario("csma-cd-d2")))


def test_the_time_of_a_scenario_ends_a_slotted_run():
    done = innervate.run(scenario("csma-cd-r"), plain=True)
    whole = done.summary
    assert done.result.ended_us == round(208 * whole["duration_slots"])
    assert whole["headline"]["level"] == "ok"
    cut_s = whole["duration_slots"] / 2 * 208e-6
    half = innervate.run(scenario("csma-cd-r", duration_s=cut_s), plain=True).summary
    assert 0.4 * whole["delivered"] < half["delivered"] < 0.6 * whole["delivered"]
    assert half["duration_slots"] <= whole["duration_slots"] / 2
    assert half["throughput"] == pytest.approx(whole["throughput"], rel=0.2)
    # A disaster that has no time to come to its end says so; one that has none delivers nothing.
    tables = {"traffic": {"kind": "disaster"}, "stations": 10}
    done = innervate.run(scenario("csma-cd-r", **tables), plain=True).summary
    assert done["headline"] == {"level": "ok", "text": "All 10 packets were delivered."}
    some_s = 0.9 * done["duration_slots"] * 208e-6
    some = innervate.run(scenario("csma-cd-r", **tables, duration_s=some_s), plain=True).summary
    assert some["headline"]["level"] == "degraded"
    none = innervate.run(scenario("csma-cd-r", **tables, duration_s=0.001), plain=True).summary
    assert none["headline"]["level"] == "down"
    assert none["throughput"] == 0


@pytest.mark.parametrize("mac", EVENT_ONLY)
def test_what_the_slotted_level_does_not_have_is_refused(mac):
    with pytest.raises(ScenarioError, match=f"{mac} goes with level"):
        from_dict({"kind": "radio", "channel": {"level": "slotted"}, "protocol": {"mac": mac}})
