"""Networks to watch, small ones of each kind."""

import pytest

from innervate import scenario
from innervate.web.history import LOG
from innervate.web.simulated import Simulated
from tests.networks.skin.runs import patch

SKIN = patch(6, 5, (0, 2), (4, 3), duration_s=1.0, data={"rate_hz": 100})
RADIO = {
    "kind": "radio", "duration_s": 6.0, "stations": 6,
    "traffic": {"kind": "saturated", "packets": 40},
}  # fmt: skip
MESH = {
    "kind": "mesh", "duration_s": 12.0, "seed": 4, "nodes": 12, "radio": {"mean_degree": 5},
    "flow": [{"from": "all", "to": "gateway", "every_s": 1.0, "jitter_s": 1.0}],
}  # fmt: skip
KINDS = {"skin": SKIN, "radio": RADIO, "mesh": MESH}


def plan_of(tables, **more):
    return scenario.plan(scenario.from_dict({**tables, **more}))


def simulated(tables, speed=0, **more):
    """A simulation that is ready."""
    made = Simulated(plan_of(tables, **more), speed)
    made.prepare()
    return made


@pytest.fixture
def few_points(monkeypatch):
    """A tenth of the points of plots, which take longer than what is simulated."""
    monkeypatch.setattr("innervate.web.simulated.POINTS", 50)


def go_to(made, t_s):
    """Have a simulation go on to a time, or back."""
    made._seek(t_s)
    while made._target_us is not None:
        made.work()


def items(made, stream):
    """All that the page is told of a stream."""
    return made.history.after(stream, 0, made.history.newest, 100_000)


def texts(made):
    """What the page's log says."""
    return [item.what["text"] for item in items(made, LOG)]
