"""Whatever is done to a network, in whatever order: what is saved is what happened."""

import random

import pytest

from innervate import scenario
from innervate.running import run
from innervate.web import messages as m
from innervate.web.errors import Refused
from innervate.web.saving import saved
from tests.web.runs import KINDS, few_points, simulated

__all__ = ["few_points"]
pytestmark = pytest.mark.usefixtures("few_points")


def command(draw, scene, duration_s):
    nodes, links = len(scene["nodes"]), len(scene["links"])
    return draw.choice(
        [
            m.Cut(draw.randrange(links + 1)), m.Heal(draw.randrange(links + 1)),
            m.Kill(draw.randrange(nodes)), m.Revive(draw.randrange(nodes)),
            m.Touch(draw.randrange(nodes), draw.choice([0, 255])), m.Step(), m.Pause(), m.Go(),
            m.Seek(draw.uniform(0, 1.1 * duration_s)), m.Speed(draw.choice([0, 0, 0.01, 50])),
            m.Save(),
        ]
    )  # fmt: skip


def abuse(kind, seed):
    draw = random.Random(seed)
    made = simulated(KINDS[kind])
    scene, duration_s = made.scene(), KINDS[kind]["duration_s"]
    done = 0
    for _ in range(40):
        for _ in range(draw.randrange(4)):
            made.work()
        try:
            made.carry_out(command(draw, scene, duration_s))
            done += 1
        except Refused:
            pass
        fields = made.fields()
        assert 0 <= fields["t_s"] <= duration_s
    made._target_us = None
    made.run_to_end()
    assert not made.broken
    assert done > 10
    again = run(scenario.loads(saved(made.view)))
    assert again.result.fingerprint == made.engine.running.fingerprint
    return made, again


@pytest.mark.parametrize("kind", KINDS)
def test_a_network_that_was_played_with_is_replayed(kind):
    abuse(kind, 1)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 22))
@pytest.mark.parametrize("kind", KINDS)
def test_many_networks_that_were_played_with(kind, seed):
    made, again = abuse(kind, seed)
    shown, batch = made.fields()["recovery"], again.summary.get("recoveries")
    if batch and shown and shown["at_s"] == batch[-1]["at_s"]:
        if batch[-1]["others_ms"] is not None or batch[-1]["without_way"]:  # somebody is left
            assert shown["recovered_ms"] == batch[-1]["others_ms"]
        assert shown["detected_ms"] == batch[-1]["detected_ms"]
