"""Commands of the PC in whole runs: who gets one, when, and what became of the rest."""

import pytest

from innervate import scenario
from innervate.networks.skin.analysis.commands import commands_summary
from innervate.networks.skin.analysis.frames import check_conserved
from innervate.networks.skin.analysis.rows import parent_changes
from innervate.networks.skin.analysis.summary import summarize
from innervate.networks.skin.sim.orders import ORDER_CAME, ORDER_GIVEN
from tests.networks.skin.runs import line, patch, plan_of, run

SETTLED_S = 0.2


def simulated(keys, **how):
    result = run(keys, plain=True, **how)
    check_conserved(result)
    return result, commands_summary(result)


def balance(commands):
    """Every cell that a command was for is accounted for."""
    lost = sum(commands["lost_by"].values())
    assert commands["lost"] == lost
    assert commands["addressed"] == commands["delivered"] + lost + commands["in_flight"]


def test_every_cell_gets_a_command_for_all_once_after_a_latency_for_every_hop():
    keys = patch(5, 4, (0, 1), (3, 3), duration_s=0.4, timing={"hop_latency_us": [200, 200]})
    keys["command"] = [{"at_s": SETTLED_S, "rate_hz": 50}]
    result, commands = simulated(keys)
    assert commands["sent"] == 10
    assert commands["addressed"] == commands["delivered"] == 200
    assert commands["lost"] == commands["repeated"] == commands["in_flight"] == 0
    assert commands["frames"]["sent"] == 200  # over every cable of the tree once
    assert commands["frames"]["duplicates"] == 0
    depth = result.plan.depth_max
    assert 0.2 * depth <= commands["latency_ms"]["max"] < 0.2 * depth + 0.06 * (depth + 1)
    came = result.rows[result.rows["code"] == ORDER_CAME]
    for number in set(came["a"].tolist()):
        assert sorted(came["node"][came["a"] == number].tolist()) == list(range(20))


def test_a_command_for_one_cell_comes_to_it_alone():
    keys = patch(4, 3, (0, 0), duration_s=0.3)
    keys["command"] = [{"at_s": SETTLED_S, "cell": {"row": 2, "column": 3}, "code": 9}]
    result, commands = simulated(keys)
    assert commands["addressed"] == commands["delivered"] == 1
    given = result.rows[result.rows["code"] == ORDER_GIVEN]
    came = result.rows[result.rows["code"] == ORDER_CAME]
    assert given["b"].tolist() == came["node"].tolist() == [11]
    # It goes down everywhere, and ends at the cell that it is for.
    assert 1 < commands["frames"]["sent"] <= 12


def test_who_is_not_reached_is_counted_by_what_ailed_it():
    keys = line(6, duration_s=0.5, data={"rate_hz": 0})
    keys["event"] = [
        {"at_s": SETTLED_S, "action": "kill", "cell": {"row": 0, "column": 5}},
        {"at_s": SETTLED_S, "action": "cut", "link": [{"row": 0, "column": 2},
                                                      {"row": 0, "column": 3}]},
    ]  # fmt: skip
    keys["command"] = [{"at_s": SETTLED_S + 0.0001}, {"at_s": 0.45}]
    result, commands = simulated(keys)
    balance(commands)
    # Cell 5 is off; 3 and 4 had a way as the first was given, and none any more for the second.
    assert commands["lost_by"] == {"off": 2, "no_route": 2, "on_the_way": 2}
    assert commands["delivered"] == 6
    headline = summarize(result)["headline"]
    assert headline["level"] == "degraded"
    assert "commands did not reach cells that had a way, 2 times" in headline["text"]


def test_before_anybody_has_a_way_nobody_is_reached():
    _, commands = simulated(line(3, duration_s=0.1) | {"command": [{"at_s": 0}]})
    assert commands["lost_by"] == {"off": 3, "no_route": 0, "on_the_way": 0}
    assert commands["latency_ms"]["max"] is None


def test_a_command_under_way_at_the_end_is_lost_to_nobody():
    keys = line(4, duration_s=0.2, timing={"hop_latency_us": [5000, 5000]})
    keys["command"] = [{"at_s": 0.193}]
    _, commands = simulated(keys)
    balance(commands)
    assert (commands["delivered"], commands["in_flight"], commands["lost"]) == (2, 2, 0)


@pytest.mark.parametrize("rule", ["feasible", "paper", "static"])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.few(3)
def test_no_cell_that_stays_on_gets_a_command_twice_whatever_happens(rule, seed):
    events = [
        {"at_s": span, "action": action, "random": whom}
        for action, whom, span in (
            ("cut", "link", [0.15, 0.2]), ("cut", "interface", [0.15, 0.3]),
            ("kill", "cell", [0.15, 0.3]), ("cut", "link", [0.2, 0.3]),
            ("restore", "link", [0.3, 0.35]),
        )
    ]  # fmt: skip
    protocol = {"rule": rule, "restart_s": 0.05}
    keys = patch(4, 4, (0, 1), (3, 2), duration_s=0.4, seed=seed + 1, protocol=protocol)
    keys |= {"event": events, "data": {"rate_hz": 400, "queue": 2}, "timing": {"loss": 0.02}}
    keys["command"] = [{"at_s": 0.1, "rate_hz": 900}, {"at_s": 0.1, "rate_hz": 70, "random": True}]
    result, commands = simulated(keys)
    balance(commands)
    assert commands["repeated"] == 0
    assert commands["sent"] == 270 + 21
    assert commands["delivered"] > 0
    assert len(parent_changes(result).time_us) > 16


def test_without_commands_nothing_is_kept_of_them():
    result, commands = simulated(line(3, duration_s=0.1))
    assert commands["sent"] == commands["addressed"] == 0
    assert commands["loss_ratio"] is None
    assert len(result.world.watch.due) == 0


def test_commands_of_a_scenario_come_at_their_times():
    keys = patch(2, 2, (0, 0), duration_s=1.0, seed=5)
    keys["command"] = [{"at_s": 0.25, "rate_hz": 4, "random": True, "value": 3}, {"at_s": 0.5}]
    orders = plan_of(keys).orders
    assert [order.at_us for order in orders] == [250_000, 500_000, 500_000, 750_000]
    assert [order.value for order in orders] == [3, 3, 0, 3]
    assert orders[2].cell == -1
    assert plan_of(keys).orders == orders
    assert {order.cell for order in plan_of(keys | {"command": [
        {"at_s": 0, "rate_hz": 500, "random": True}]}).orders} == set(range(4))  # fmt: skip


WRONG = [
    ({"at_s": 1.0}, "command.0.at_s = 1 is not before the end; duration_s is 1"),
    ({"at_s": 0, "node": "a", "random": True}, "command.0 has 2 targets: node and random"),
    ({"at_s": 0, "rate_hz": 0.0001}, "command.0.rate_hz must be 0 (once) or at least 0.001"),
    ({"at_s": 0, "value": 65_536}, "command.0.value must be at most 65535"),
    ({"at_s": 0, "cell": {"row": 0, "column": 0, "port": "E"}}, "leave port out"),
    ({"at_s": 0, "cell": {"row": 7, "column": 0}}, "there is no row 7"),
]


@pytest.mark.parametrize(("table", "message"), WRONG)
def test_a_wrong_command_is_refused_in_a_line(table, message):
    keys = patch(2, 2, (0, 0), duration_s=1.0)
    with pytest.raises(scenario.ScenarioError) as refused:
        plan_of(keys | {"command": [table]})
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)
