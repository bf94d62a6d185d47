import pytest

from innervate import scenario
from innervate.networks.skin.sim.simulate import simulate


def make_line(cells, **changes):
    """A line of cells with an interface port at either end, the second one cut at 1 s."""
    tables = {
        "kind": "skin",
        "name": "line",
        "duration_s": 2.0,
        "seed": 1,
        "patch": [{"columns": cells, "rows": 1}],
        "interface": [
            {"row": 0, "column": 0, "port": "W"},
            {"row": 0, "column": cells - 1, "port": "E"},
        ],
        "protocol": {"updates": "periodic", "beacon_hz": 100, "k": 3, "m": 1, "balancing": False},
        "timing": {"drift_ppm": 0, "hop_latency_us": [60, 60]},
        "event": [{"at_s": 1.0, "action": "cut", "interface": 1}],
    }
    return scenario.from_dict(tables | changes)


@pytest.fixture(scope="session")
def line():
    return make_line


@pytest.fixture(scope="session")
def go():
    """Simulate a scenario, or a bundled one by name with overrides."""

    def simulated(what, *overrides, seed=None, seconds=None, **options):
        made = scenario.load(what, overrides, seed) if isinstance(what, str) else what
        plan = scenario.plan(made)
        if seconds is not None:
            plan.duration_us = round(1e6 * seconds)
        return simulate(plan, **options)

    return simulated
