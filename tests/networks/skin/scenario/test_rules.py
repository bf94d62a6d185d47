"""What the tables of a skin must hold together: both sides of each edge."""

import pytest

from innervate.networks.skin.scenario.orders import ALL
from innervate.networks.skin.scenario.plan import Plan
from innervate.networks.skin.scenario.script import DETECT
from innervate.networks.skin.scenario.warnings import start_up_us, warnings
from innervate.scenario import ScenarioError, loads, plan
from tests.fixtures.scenarios import one_port
from tests.networks.skin.runs import patch, plan_of

SMALL = one_port(3, 2, "duration_s = 0.8")


def made(*more: str, sets: tuple[str, ...] = ()) -> Plan:
    return plan(loads("\n".join([SMALL, *more]), sets))


@pytest.mark.parametrize(("at_s", "rate_hz", "times"), [
    (0.2, 10, 6), (0.1, 10, 7), (0.0, 10, 8), (0.05, 10, 8), (0.79, 0, 1), (0.79, 0.5, 1),
])  # fmt: skip
def test_commands_are_repeated_up_to_the_end_and_not_at_it(at_s, rate_hz, times):
    """0.8 - 0.2 s are 0.6 s, though not in binary numbers; the first is not sent at 0."""
    orders = made(f"[[command]]\nat_s = {at_s}\nrate_hz = {rate_hz}").orders
    assert [order.at_us for order in orders] == [
        max(1, round(at_s * 1e6) + 100_000 * i) for i in range(times)
    ]
    assert {order.cell for order in orders} == {ALL}


@pytest.mark.parametrize(("table", "words"), [
    ("[[command]]\nat_s = 0.8", "command.0.at_s = 0.8 is not before the end; duration_s is 0.8"),
    ("[[command]]\nat_s = 0.799", ""),
    ("[[command]]\nat_s = 0.1\nrate_hz = 0.0009", "0.rate_hz must be 0 (once) or at least 0.001"),
    ("[[command]]\nat_s = 0.1\nrate_hz = 0.001", ""),
    ("[data]\nrate_hz = 0.0099", "data.rate_hz must be 0 (off) or at least 0.01"),
    ("[data]\nrate_hz = 0.01", ""),
    ("[data]\nrate_hz = 0", ""),
    ("[touch]\npath = [[0.1, 0, 0], [0.1, 1, 0]]", "back in time at point 1: 0.1 s after"),
    ("[protocol]\nk = 3\nbalancing = false", ""),
])  # fmt: skip
def test_what_just_can_be_is_taken_and_what_cannot_is_refused(table, words):
    if not words:
        made(table)
        return
    with pytest.raises(ScenarioError) as caught:
        made(table)
    assert words in str(caught.value)


@pytest.mark.parametrize(("timing", "duration_s", "fits"), [
    ("drift_ppm = 10_000", 8e5, True),
    ("drift_ppm = 10_000", 8.0001e5, False),
    ("drift_ppm = 10_000\nlock_step = true", 8.0001e5, True),
])  # fmt: skip
def test_clocks_stay_in_their_range(timing, duration_s, fits):
    text = SMALL.replace("0.8", repr(duration_s)) + f"\n[timing]\n{timing}\n"
    if fits:
        assert loads(text).duration_s == duration_s
        return
    with pytest.raises(ScenarioError, match="make it at most 800000 or the drift smaller"):
        loads(text)


@pytest.mark.parametrize(("file", "sets", "place"), [
    ("k = 3\nr_f = 0.2", (), "x.toml:14: "),
    ("k = 3", ("protocol.r_f=0.2",), "x.toml:13: "),
    ("r_f = 0.2", ("protocol.k=3",), "x.toml:13: "),
])  # fmt: skip
def test_what_is_said_twice_is_refused_where_the_file_says_it(file, sets, place):
    with pytest.raises(ScenarioError, match="say the same thing twice") as caught:
        loads(f"{SMALL}\n[protocol]\n{file}\n", sets, path="x.toml")
    assert str(caught.value).startswith(place)


def test_a_run_is_long_enough_from_what_a_start_takes_on():
    keys = {"protocol": {"beacon_hz": 1}, "duration_s": 1.0}
    needed = start_up_us(plan_of(patch(8, 10, (0, 3), **keys)))
    for short, warned in ((0, 0), (1, 1)):
        keys["duration_s"] = (needed - short) / 1e6
        assert len(warnings(plan_of(patch(8, 10, (0, 3), **keys)))) == warned


def test_routes_of_a_static_rule_need_no_period_a_hop():
    waits = [
        start_up_us(plan_of(patch(8, 10, (0, 3), protocol={"rule": rule, "updates": updates})))
        for rule in ("static", "feasible")
        for updates in ("periodic", "triggered")
    ]
    assert waits[0] == waits[1] == waits[3] < waits[2]


def test_only_a_cells_port_detects():
    script = 'kind = "skin"\n[[link]]\na = "n1.0"\nb = "pc.0"\n[[link]]\na = "n1.2"\nb = "n2.0"\n'
    text = script + '[script]\nsteps = ["detect {}"]\n'
    try:
        steps = plan(loads(text.format("n1.2"))).script
    except ScenarioError as error:
        pytest.fail(str(error))
    assert steps[0].action == DETECT
    for where in ("n1", "pc.0", "pc"):
        with pytest.raises(ScenarioError, match="detect takes a cell's port"):
            plan(loads(text.format(where)))
