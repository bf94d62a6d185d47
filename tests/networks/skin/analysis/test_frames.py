import dataclasses
import random
from array import array
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.skin.analysis import frames, load
from innervate.networks.skin.analysis.frames import FramesLost, check_conserved
from innervate.sim.cables import wires


def random_skin(seed):
    """A small skin that suffers a lot."""
    draw = random.Random(seed)
    events = []
    for _ in range(draw.randrange(6)):
        action = draw.choice(["cut", "restore", "kill", "revive", "loose", "restart", "lose"])
        kind = "cell" if action in ("kill", "revive", "restart") else "link"
        event = {"at_s": round(draw.uniform(0.05, 0.6), 4), "action": action}
        where = {"row": draw.randrange(3), "column": draw.randrange(3)}
        if kind == "link":
            event["link"] = [where, {**where, "column": where["column"] + 1}]
        else:
            event["cell"] = where
        if action == "loose":
            event["loss"] = 0.4
        if action == "lose":
            event["frames"] = 20
        events.append(event)
    return scenario.from_dict(
        {
            "kind": "skin",
            "duration_s": 0.7,
            "seed": seed,
            "patch": [{"columns": 4, "rows": 3}],
            "interface": [{"row": 0, "column": 0}, {"row": 2, "column": 3}][: 1 + seed % 2],
            "protocol": {
                "rule": draw.choice(["feasible", "strict", "paper", "static"]),
                "updates": draw.choice(["periodic", "triggered", "wave"]),
                "beacon_hz": 250,
            },
            "timing": {"loss": draw.choice([0.0, 0.0, 0.1])},
            "data": {"rate_hz": draw.choice([50, 400, 3000]), "queue": draw.choice([1, 8])},
            "event": events,
        }
    )


@pytest.mark.parametrize("seed", range(40))
def test_conserved_whatever_happens(go, seed):
    result = go(random_skin(seed))
    check_conserved(result)
    routed = load.interface_of(result) >= 0
    assert (routed == (np.array(result.world.watch.routed) == 1)).all()
    assert result.counters[wires.OFFERED] > 0


def test_conserved_uncompiled(go):
    compiled, plain = go(random_skin(1)), go(random_skin(1), plain=True)
    check_conserved(plain)
    for what in frames.BLOCKS:
        assert frames.traffic_of(plain, what) == frames.traffic_of(compiled, what), what


def test_a_frame_that_went_nowhere_is_noticed(go):
    result = go(random_skin(2))
    counters = list(result.counters)
    counters[wires.ARRIVED + wires.URGENT_BLOCK] -= 1
    with pytest.raises(FramesLost, match=r"seed 2.*: 1 beacons went nowhere"):
        check_conserved(dataclasses.replace(result, counters=counters))


def test_loss_has_its_reasons(go):
    data = frames.data_summary(go("setup-3", "data.rate_hz=2000", seconds=0.5))
    assert data["lost"] == sum(data["lost_by"].values())
    assert data["lost_by"]["queue_full"] > 0
    assert data["loss_ratio"] == pytest.approx(data["lost"] / data["sent"])
    assert data["sent"] == data["delivered"] + data["lost"] + data["in_flight"]


def test_no_data(go):
    data = frames.data_summary(go("setup-3", seconds=0.1))
    assert (data["sent"], data["loss_ratio"]) == (0, None)


def test_beacon_share_is_eq_9(go):
    """250 beacons a second and direction: 1.5 % (E28)."""
    result = go("setup-3", "protocol.updates=periodic", "timing.drift_ppm=0", seconds=1)
    assert frames.beacon_share(result) == pytest.approx(0.015, rel=0.02)


def test_beacons_take_a_share_of_the_time_that_was_simulated():
    """100 frames of 60 us on both ways of one cable in 30 ms, of a run that was to take longer."""
    graph = Of(peer=array("i", [4, -1, -1, -1, 0]))
    counters = [0] * 64
    counters[wires.SENT + wires.URGENT_BLOCK] = 100
    plan = Of(graph=graph, wire_us=60, duration_us=9_000_000)
    run = Of(plan=plan, counters=counters, ended_us=30_000)
    assert frames.beacon_share(run) == pytest.approx(0.1)
    run.ended_us = 0
    assert frames.beacon_share(run) is None
    graph.peer[0] = graph.peer[4] = -1
    assert frames.beacon_share(Of(plan=plan, counters=counters, ended_us=30_000)) is None
