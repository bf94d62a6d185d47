"""What `check` foresees of a skin: cells that its own events leave without a way."""

import pytest

from innervate.networks.skin.scenario.foreseen import foreseen
from innervate.networks.skin.scenario.words import describe
from tests.networks.skin.runs import line, plan_of

FIRST, LAST = {"interface": 0}, {"interface": 1}  # of pc.0 - 0 - 1 - 2 - 3 - 4 - pc.1


def cell(number):
    return {"cell": {"patch": 0, "row": 0, "column": number}}


def left(*events, **more):
    happens = [{"at_s": at_s, "action": action, **what} for at_s, action, what in events]
    return foreseen(plan_of(line(5, event=happens, **more)))


def apart(count):
    return [f"at the end no cable joins {count} of 5 cells with the PC"]


@pytest.mark.parametrize(("events", "said"), [
    ([], []),
    ([(1, "cut", FIRST)], []),
    ([(1, "cut", FIRST), (1, "cut", LAST)], apart(5)),
    ([(1, "cut", FIRST), (1, "cut", LAST), (1.4, "restore", FIRST)], []),
    ([(1, "kill", cell(2))], []),
    ([(1, "kill", cell(2)), (1, "kill", cell(4))], apart(1)),
    ([(1, "kill", cell(2)), (1, "cut", LAST)], apart(2)),
    ([(1, "kill", cell(2)), (1, "cut", LAST), (1.4, "revive", cell(2))], []),
    ([(1, "kill", cell(2)), (1, "cut", LAST), (1.4, "restart", cell(2))],
     ["at 1.4 s restart p0 r0 c2: it is off, and stays so, so nothing happens", *apart(2)]),
    ([(1, "kill", cell(number)) for number in range(5)], ["all cells are off at the end"]),
])  # fmt: skip
def test_who_is_left_without_a_cable_that_leads_to_the_pc(events, said):
    assert left(*events) == said


@pytest.mark.parametrize(("events", "said"), [
    ([(1, "cut", FIRST), (1.2, "cut", FIRST)], "at 1.2 s cut {}: it is cut already"),
    ([(1.2, "restore", FIRST)], "at 1.2 s restore {}: it is not cut"),
    ([(1, "kill", cell(2)), (1.2, "kill", cell(2))], "at 1.2 s kill p0 r0 c2: it is off already"),
    ([(1.2, "revive", cell(2))], "at 1.2 s revive p0 r0 c2: it is on"),
    ([(1, "restart", cell(2)), (1.2, "restart", {"pc": True}), (1.3, "cut", FIRST),
      (1.4, "restore", FIRST), (1.4, "cut", FIRST)], ""),
    ([(1, "loose", {**FIRST, "loss": 0.5}), (1.2, "lose", FIRST)], ""),
])  # fmt: skip
def test_events_that_change_nothing(events, said):
    cable = "pc.0 - p0 r0 c0 W"
    assert left(*events) == [f"{said.format(cable)}, so nothing happens"] * bool(said)


def test_routes_that_become_too_long():
    assert left((1, "cut", FIRST), protocol={"max_depth": 5}) == []
    assert left((1, "cut", FIRST), protocol={"max_depth": 3}) == [
        "at the end 2 of 5 cells are more than 3 hops from the PC, and can have no way; "
        "raise protocol.max_depth"
    ]


def test_few_samples_a_second_are_not_none():
    assert ", 0.05 samples a second;" in describe(plan_of(line(5, data={"rate_hz": 0.01})))
    assert ", 50 samples a second;" in describe(plan_of(line(5, data={"rate_hz": 10})))
