"""What `check` says of a skin: overload, a touch that nobody learns of, runs that are too short."""

import pytest

from innervate import scenario
from innervate.networks.skin.scenario.warnings import port_rate, start_up_us, warnings
from innervate.networks.skin.scenario.words import describe
from innervate.networks.skin.sim.simulate import simulate
from tests.networks.skin.runs import patch, plan_of

TWO = ((0, 3), (9, 5))


def warned(columns=8, rows=10, roots=TWO, **keys):
    return warnings(plan_of(patch(columns, rows, *roots, **keys)))


def test_more_samples_than_the_ports_carry():
    (text,) = warned(data={"rate_hz": 500})
    assert text == (
        "80 cells offer 40,000 samples a second, but 2 interface ports carry at most 32,833: "
        "17 % or more are lost in the long run"
    )
    assert warned(data={"rate_hz": 400}) == []


def test_one_port():
    (text,) = warned(roots=((0, 3),), data={"rate_hz": 250})
    assert text.startswith("80 cells offer 20,000 samples a second, but the only interface port ")


def test_the_share_that_is_said_is_what_gets_lost_at_least():
    made = plan_of(patch(8, 10, *TWO, data={"rate_hz": 1000}, duration_s=1.0))
    counted = simulate(made).counters
    offered, room = 80_000, 2 * port_rate(made)
    assert counted[17] <= counted[16] * room / offered * 1.02  # delivered, offered
    assert 58 < 100 * (1 - room / offered) < 59
    assert "58 % or more" in warnings(made)[0]


def test_cells_behind_a_single_cable():
    made = plan_of({
        "kind": "skin",
        "patch": [{"columns": 8, "rows": 10}, {"columns": 4, "rows": 4}],
        "cable": [{"a": {"patch": 0, "row": 4, "column": 7}, "b": {"patch": 1, "row": 0,
                                                                  "column": 0}}],
        "interface": [{"patch": 1, "row": 3, "column": c} for c in (0, 2)],
        "data": {"rate_hz": 300},
    })  # fmt: skip
    (text,) = warnings(made)
    assert text.startswith("80 cells offer 24,000 samples a second over the only cable between")
    assert "which carries at most 16,417" in text


def test_a_touch_that_nobody_learns_of():
    (text,) = warned(touch={})
    assert "set data.rate_hz" in text
    assert warned(touch={}, data={"rate_hz": 100}) == []


@pytest.mark.parametrize(("x", "y", "felt"), [(0, -29, True), (0, -31, False), (134, 0, True),
                                             (137, 0, False), (9000, 9000, False)])  # fmt: skip
def test_a_touch_beside_the_skin(x, y, felt):
    # 8 x 10 cells are 105 x 109 mm; the touch reaches 30 mm.
    keys = {"data": {"rate_hz": 100}, "touch": {"path": [[0.0, x, y], [4.0, x, y]]}}
    found = warned(**keys)
    assert found == [] if felt else "the touch stays more than 30 mm away" in found[0]


@pytest.mark.parametrize("updates", ["periodic", "triggered", "wave"])
@pytest.mark.parametrize("k", [2, 5])
def test_a_run_that_is_too_short_for_a_way(updates, k):
    keys = {"protocol": {"beacon_hz": 1, "updates": updates, "k": k}, "duration_s": 1.0}
    (text,) = warned(**keys)
    assert text.startswith("the run may end before every cell has a way to the PC")
    needed = start_up_us(plan_of(patch(8, 10, *TWO, **keys)))
    assert warned(**keys | {"duration_s": needed / 1e6}) == []
    made = plan_of(patch(8, 10, *TWO, **keys | {"duration_s": needed / 1e6}))
    assert simulate(made).world.run["unrouted"][0] == 0


def test_check_says_it():
    made = plan_of(patch(8, 10, *TWO, data={"rate_hz": 500}, duration_s=0.01))
    text = describe(made)
    assert "500 Hz per cell, 40,000 samples a second; 2 interface ports carry at most 32,8" in text
    assert text.count("  warning    ") == 2
    assert "warning" not in scenario.check("demo")
