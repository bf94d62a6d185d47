"""A mesh over CSMA/CD-R, compiled and plain: the same rows, states, channel and fingerprint."""

import dataclasses

import numpy as np
import pytest

from innervate.networks.mesh.scenario.plan import ONE
from innervate.networks.mesh.sim.simulate import simulate
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.scenario import load, plan
from tests.networks.mesh.sim.test_parity import TABLES, states

EVENTS = (
    "event=[{at_s=3.0, action='kill', node=3}, {at_s=3.4, action='restart', node=2},"
    " {at_s=4.0, action='revive', node=3}, {at_s=4.5, action='restart', node=0}]"
)
BUSY = ("flow.0.every_s=0.3", "flow.0.jitter_s=0.2")
LOSSY = ONE * 19 // 20


def station_states(result):
    """All words of all stations of the channel at the end."""
    stations = result.world.below.stations
    found = []
    for name, length, *_ in radio_fields.STATION + radio_fields.PRACTICAL:
        for station in stations:
            value = getattr(station, name) if isinstance(stations, list) else station[name]
            found.append([int(item) for item in value] if length else int(value))
    return found


@pytest.mark.parametrize(
    ("seed", "sets", "chance"),
    [(1, (), ONE), pytest.param(2, (EVENTS,), ONE, marks=pytest.mark.slow),
     (3, (*BUSY, EVENTS), LOSSY),
     pytest.param(4, (*BUSY, "protocol.hop_acks=true"), LOSSY, marks=pytest.mark.slow)],
)  # fmt: skip
def test_compiled_equals_plain(seed, sets, chance):
    made = plan(load("mesh-team", ["flow.0.start_s=2", "robot.0.start_s=1", *sets], seed))
    made = dataclasses.replace(made, duration_us=6_000_000)
    made.radio.prob_q15 = [min(chance, here) for here in made.radio.prob_q15]
    one, other = (simulate(made, plain=plain, trail=True) for plain in (False, True))
    for name in TABLES:
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    assert one.counts == other.counts
    assert states(one) == states(other)
    assert station_states(one) == station_states(other)
    assert one.fingerprint == other.fingerprint
    assert one.counts["transmissions"] > 60
