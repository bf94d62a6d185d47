"""Who gets the alarms, by what a scenario says."""

import pytest

from innervate import scenario
from innervate.networks.mesh.plot.map import monitor_of

NODES = "".join(f"[[node]]\nx_m = {10 * i}\ny_m = 0\n" for i in range(5))


@pytest.mark.parametrize(("said", "monitor"), [
    ("gateway = 2\nstandby = [0, 4]\n", 2), ("gateway = 2\nstandby = [0]\nmonitor = 3\n", 3),
    ("gateway = 4\n", 4), ('gateway = 4\nmonitor = "gateway"\n', 4),
])  # fmt: skip
def test_alarms_come_to_the_monitor_or_else_to_the_first_gateway(said, monitor):
    text = f"kind = 'mesh'\n{said}radio.reach_m = 30\n{NODES}"
    assert monitor_of(scenario.plan(scenario.loads(text))) == monitor
