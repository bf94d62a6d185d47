"""Frames on their way, as a page shows them: from whom to whom, what they are, how far they are."""

from types import SimpleNamespace

import numpy as np
import pytest

from innervate import scenario as scenarios
from innervate.sim import wheel
from innervate.sim.cables.declared import simulation
from innervate.sim.cables.wires import DELAYED
from innervate.web.cables import Cables, nodes_of_ends

KINDS = {1: "hello", 2: "update"}


def made(**links):
    ring = {"kind": "babel", "nodes": 3, "shape": "line",
            "links": {"latency_us": [100, 100], **links}}  # fmt: skip
    plan = scenarios.plan(scenarios.from_dict(ring))
    return Cables(plan, KINDS, "data"), simulation(plan).world, plan


def put(world, place, end, time_us, kind, event=DELAYED + 1):
    """A frame that comes in at an end at a time, as the simulator's events have it."""
    run = world.run
    first = int(run["pool_slots"][0])
    world.wheel.pool[wheel.FRESH] = max(int(world.wheel.pool[wheel.FRESH]), first + place + 1)
    one = world.wheel.events[first + place : first + place + 1]
    one["bucket"], one["kind"], one["target"], one["time"] = 5, event, end, time_us
    world.frames["kind"][place] = kind


def test_ends_and_their_nodes():
    cables, _, plan = made()
    assert nodes_of_ends(plan.graph).tolist() == [0] * 4 + [1] * 4 + [2] * 4
    assert cables.ends.tolist() == [[1, 4], [5, 8]]
    assert cables.scene() == [{"id": 0, "a": 0, "b": 1}, {"id": 1, "a": 1, "b": 2}]
    assert np.flatnonzero(cables.peer >= 0).tolist() == [1, 4, 5, 8]


def test_a_cable_is_up_while_its_epoch_is_even():
    cables, world, _ = made()
    world.epoch[[1, 4]] = 1
    world.epoch[[5, 8]] = 2
    assert cables.up(world).tolist() == [0, 1]


def test_how_far_a_frame_is():
    cables, world, _ = made()
    world.ends["latency"][:] = 100
    world.ends["latency"][8] = 50
    assert cables.flights(world, 1000) == []
    put(world, 0, 4, 1100, 1)
    put(world, 1, 1, 1025, 2)
    put(world, 2, 5, 1010, 3)
    assert cables.flights(world, 1000) == [
        {"a": 0, "b": 1, "kind": "hello", "p": 0.0},
        {"a": 1, "b": 0, "kind": "update", "p": 0.75},
        {"a": 2, "b": 1, "kind": "data", "p": 0.8},
    ]
    assert [one["p"] for one in cables.flights(world, 1033)] == [0.33, 1.0, 1.0]
    assert [one["p"] for one in cables.flights(world, 10)] == [0.0] * 3


def test_what_is_over_or_only_delayed_is_not_on_its_way():
    cables, world, _ = made()
    world.ends["latency"][:] = 100
    for place in range(3):
        put(world, place, 4, 1100, 1, DELAYED if place == 1 else DELAYED + 1)
    first = int(world.run["pool_slots"][0])
    assert len(cables.flights(world, 1000)) == 2
    world.wheel.events["bucket"][first] = wheel.NIL
    assert len(cables.flights(world, 1000)) == 1


@pytest.mark.parametrize("spread", [[60, 140], [60, 141]])
def test_where_each_frame_has_its_own_latency_the_mean_is_taken(spread):
    _, world, plan = made()
    drawn = SimpleNamespace(graph=plan.graph, latency_per_frame=True, latency_us=spread)
    cables = Cables(drawn, KINDS, "data")
    world.ends["latency"][:] = 1
    put(world, 0, 4, 1050, 1)
    assert [one["p"] for one in cables.flights(world, 1000)] == [0.5]


def test_of_too_many_frames_the_first_are_shown(monkeypatch):
    cables, world, _ = made()
    world.ends["latency"][:] = 100
    for place in range(4):
        put(world, place, 4, 1100 - place, 1)
    assert len(cables.flights(world, 1000)) == 4
    monkeypatch.setattr("innervate.web.cables.FLIGHTS_MAX", 3)
    assert [one["p"] for one in cables.flights(world, 1000)] == [0.0, 0.01, 0.02]
