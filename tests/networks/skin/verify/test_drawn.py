"""Skins that a seed draws, at the ends of what may be drawn, and simpler ones next to them."""

import pytest

from innervate.networks.skin.verify import fuzz
from tests.networks.draws import Draw


def test_the_least_skin_that_may_be_drawn():
    """Whatever is a matter of chance is so, as nothing is less likely."""
    assert fuzz.drawn(Draw(0, 0.0), 7) == {
        "kind": "skin", "name": "random-7", "seed": 7, "duration_s": 0.5,
        "patch": [{"columns": 1, "rows": 1, "wiring": "Z"}],
        "interface": [{"row": 0, "column": 0}],
        "protocol": {"rule": "feasible", "updates": "periodic", "k": 1, "balancing": True,
                     "beacon_hz": 50.0},
        "timing": {"drift_ppm": 0, "hop_latency_us": [60, 60], "lock_step": True, "loss": 0.0},
        "data": {"rate_hz": 0}, "event": [],
    }  # fmt: skip


def test_the_greatest_skin_that_may_be_drawn():
    """Nothing that is a matter of chance is so; restarts are of cells."""
    assert fuzz.drawn(Draw(1, 0.95), 7) == {
        "kind": "skin", "name": "random-7", "seed": 7, "duration_s": 2.0,
        "patch": [{"columns": 8, "rows": 8, "wiring": "S"}],
        "interface": [{"row": 7, "column": 7}, {"row": 7, "column": 0}, {"row": 6, "column": 7}],
        "protocol": {"rule": "strict", "updates": "wave", "k": 8, "balancing": False,
                     "beacon_hz": 500.0},
        "timing": {"drift_ppm": 20_000, "hop_latency_us": [400, 400], "lock_step": False,
                   "loss": 0.2},
        "data": {"rate_hz": 100},
        "event": 12 * [{"at_s": 1.8, "action": "restart", "cell": {"row": 7, "column": 7}}],
    }  # fmt: skip


def test_under_strict_the_pc_is_not_restarted(monkeypatch):
    monkeypatch.setattr(fuzz, "_skin_event", lambda *_: {"action": "restart", "pc": True})
    for rule, events in (("feasible", 12), ("strict", 0)):
        draw = Draw(1, 0.95)
        draw.choice = lambda values, rule=rule: rule if rule in values else values[-1]
        found = fuzz.drawn(draw, 7)
        assert (found["protocol"]["rule"], len(found["event"])) == (rule, events)


@pytest.mark.parametrize(("share", "balances", "in_step"), [
    (0.09, True, True), (0.1, True, False), (0.49, True, False), (0.5, False, False),
])  # fmt: skip
def test_how_likely_each_is(share, balances, in_step):
    found = fuzz.drawn(Draw(0, share), 7)
    assert (found["protocol"]["balancing"], found["timing"]["lock_step"]) == (balances, in_step)


def event(action, place=0, share=0.9, cables=True, columns=4):
    draw = Draw(place, share)
    choice = draw.choice
    draw.choice = lambda values: action if action in values else choice(values)
    return fuzz._skin_event(draw, 10.0, columns, 3, cables)


HERE, BESIDE = {"row": 0, "column": 0}, {"row": 0, "column": 1}


@pytest.mark.parametrize(("made", "what"), [
    (event("kill"), {"action": "kill", "cell": HERE}),
    (event("restart", share=0.5), {"action": "restart", "cell": HERE}),
    (event("restart", share=0.49), {"action": "restart", "pc": True}),
    (event("kill", share=0.1), {"action": "kill", "cell": HERE}),
    (event("cut", share=0.3), {"action": "cut", "link": [HERE, BESIDE]}),
    (event("cut", share=0.29), {"action": "cut", "interface": 0}),
    (event("restore", cables=False), {"action": "restore", "interface": 0}),
    (event("loose"), {"action": "loose", "link": [HERE, BESIDE], "loss": 0.1}),
    (event("lose"), {"action": "lose", "link": [HERE, BESIDE], "frames": 1}),
])  # fmt: skip
def test_what_may_happen_to_whom(made, what):
    assert made == {"at_s": 0.5, **what}


def test_the_latest_and_most_that_may_happen():
    ends = [{"row": 2, "column": 3}, {"row": 2, "column": 2}]
    assert event("lose", 1) == {"at_s": 9.0, "action": "lose", "link": ends, "frames": 9}
    assert event("loose", 1)["loss"] == 0.9


@pytest.mark.parametrize(("cell", "columns", "other"), [
    ((1, 0), 4, (1, 1)), ((1, 2), 4, (1, 3)), ((1, 3), 4, (1, 2)), ((0, 0), 1, (1, 0)),
    ((1, 0), 1, (2, 0)), ((2, 0), 1, (1, 0)),
])  # fmt: skip
def test_a_cable_is_to_the_next_cell_or_back_at_the_edge(cell, columns, other):
    row, column = cell
    found = fuzz._beside(None, {"row": row, "column": column}, columns, 3)
    assert found == {"row": other[0], "column": other[1]}


def test_interfaces_are_at_both_sides_and_no_more_than_there_are():
    draw = Draw(1, 0.95)
    draw.randint = lambda low, high: 2 if high == 8 else high
    found = fuzz.drawn(draw, 7)
    assert found["interface"] == [{"row": 1, "column": 1}, {"row": 1, "column": 0},
                                  {"row": 0, "column": 1}]  # fmt: skip
    draw.randint = lambda low, high: 1 if high == 8 else high
    assert fuzz.drawn(draw, 7)["interface"] == [{"row": 0, "column": 0}]


def test_simpler_skins_have_fewer_cells_or_interfaces():
    one, two = {"row": 0, "column": 0}, {"row": 1, "column": 0}
    patch = {"columns": 2, "rows": 3, "wiring": "Z"}
    found = list(fuzz.smaller({"patch": [patch], "interface": [one, two]}))
    assert {"patch": [patch | {"columns": 1}], "interface": [one, two]} in found
    assert {"patch": [patch | {"rows": 2}], "interface": [one, two]} in found
    assert {"patch": [patch], "interface": [one]} in found
    least = {"patch": [{"columns": 1, "rows": 1, "wiring": "Z"}], "interface": [one]}
    assert all(made.get("interface", [one]) == [one] for made in fuzz.smaller(least))
    assert all(made.get("patch", least["patch"]) == least["patch"] for made in fuzz.smaller(least))
