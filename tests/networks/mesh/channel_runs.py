"""Teams of nodes that all hear each other, for tests: a mesh over a channel that all share."""

from innervate.networks.mesh.scenario.access import DELAY_US
from innervate.networks.mesh.scenario.plan import HEADER_SLOTS
from innervate.networks.radio.scenario.baselines import NUMBERS, baseline
from innervate.networks.radio.scenario.plan import parameters
from tests.networks.mesh.runs import mesh_plan, radio

SLOT_US = 208  # a byte at 38.4 kbit/s
TURN_US = 2000
PHY_BYTES = 7
MTU = 64
PRACTICAL = "csma-cd-r/practical"
SLOW_RADIO = {"byte_ns": 208_333, "phy_bytes": PHY_BYTES, "turnaround_us": TURN_US}


def slots(payload, path=1):
    """Slots of a message on the air."""
    return PHY_BYTES + HEADER_SLOTS + 11 + path + payload + 2


def mac_params(mac, n):
    """Parameters of a medium access protocol for n stations."""
    params = parameters(PHY_BYTES + HEADER_SLOTS + MTU, TURN_US, DELAY_US)
    return baseline(mac, n, params) if mac in NUMBERS else params


def team(n, offers=(), mac=PRACTICAL, chance=32_768, **more):
    """A plan of n nodes in one room, for the pinger; see mesh_runs.mesh_plan."""
    medium = radio(n, prob=chance, **SLOW_RADIO)
    return mesh_plan(n, medium, offers, mac=mac, mac_params=mac_params(mac, n), **more)
