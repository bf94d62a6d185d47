"""Meshes that a seed draws: how large and how long they are, and what happens in them."""

import random

from innervate.networks.mesh.verify import fuzz

MANY = [fuzz.drawn(random.Random(seed), seed) for seed in range(700)]


def ends(values):
    found = list(values)
    return min(found), max(found)


def each(table, name):
    return [one[name] for tables in MANY for one in tables[table] if name in one]


def test_what_happens_in_them_is_of_some_number_up_to_its_end():
    assert ends(len(tables["flow"]) for tables in MANY) == (1, 4)
    assert ends(len(tables["event"]) for tables in MANY) == (0, 10)
    assert ends(len(tables["standby"]) for tables in MANY) == (0, 2)
    assert ends(each("flow", "count")) == (1, 60)


def test_slow_radios_have_five_times_as_long():
    for tables in MANY:
        times = 5 if tables["radio"]["profile"] == "38k4" else 1
        assert tables["duration_s"] in (15.0 * times, 40.0 * times)
        for one in tables["flow"]:
            assert 0 <= one["start_s"] <= 0.8 * tables["duration_s"] + 0.001
        for one in tables["event"]:
            assert one["at_s"] / tables["duration_s"] + 0.001 >= 0.05
            assert one["at_s"] / tables["duration_s"] <= 0.951


def test_the_gateway_is_0_and_stands_by_for_nobody():
    assert {tables["gateway"] for tables in MANY} == {0}
    assert all(0 < node < tables["nodes"] for tables in MANY for node in tables["standby"])
    assert all(tables["radio"]["mean_degree"] <= tables["nodes"] - 1 for tables in MANY)


def test_some_have_a_robot_that_the_last_node_bears():
    robots = [tables for tables in MANY if "robot" in tables]
    assert 0.25 < len(robots) / len(MANY) < 0.35
    assert all(tables["robot"][0]["node"] == tables["nodes"] - 1 for tables in robots)
    assert all("fence" in tables for tables in robots)


def test_whoever_needs_tables_has_them():
    for tables in MANY:
        keys = tables["protocol"]
        assert keys["tables"] or (keys["failover"] != "graph" and not keys["activation"])
    for name, share in (("retry", 0.8), ("reliable", 0.9), ("tables", 0.9), ("activation", 0.2)):
        found = sum(tables["protocol"][name] for tables in MANY) / len(MANY)
        assert abs(found - share) < 0.06, name


def test_messages_go_to_another_and_from_the_gateway_to_no_monitor():
    for one in (flow for tables in MANY for flow in tables["flow"]):
        assert one["from"] != one["to"]
        assert one["from"] or one["to"] != "monitor"


def test_the_ends_of_a_cable_are_two_in_order():
    links = each("event", "link")
    assert links
    assert all(a < b for a, b in links)


def test_simpler_ones_lack_a_flow_a_robot_a_standby_a_node_or_some_time():
    flow = {"from": 1, "to": 2, "count": 5}
    once = {"from": 2, "to": 1, "count": 1}
    tables = {"flow": [flow, once], "robot": [1], "fence": {}, "standby": [3, 1], "nodes": 3,
              "duration_s": 2.5}  # fmt: skip
    found = list(fuzz.smaller(tables))
    for change in (
        {"flow": [once]}, {"flow": [flow]}, {"flow": [flow | {"count": 2}, once]},
        {"standby": [1]}, {"standby": [3]}, {"nodes": 2}, {"duration_s": 1.75},
    ):  # fmt: skip
        assert tables | change in found, change
    bare = {name: tables[name] for name in tables if name not in ("robot", "fence")}
    assert bare in found
    least = {"flow": [once], "standby": [], "nodes": 2, "duration_s": 2.0}
    left = list(fuzz.smaller(least))
    assert all(one["nodes"] == 2 and one["duration_s"] == 2.0 for one in left)
    assert all(one["flow"] == [once] for one in left if "flow" in one)
