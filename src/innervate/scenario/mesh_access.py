"""Which medium access a mesh runs over, and whether that one can work there."""

from __future__ import annotations

from typing import Any

from innervate.scenario.mesh_model import MeshScenario
from innervate.scenario.mesh_network import Network
from innervate.scenario.mesh_profiles import GOOD_CDB, Profile
from innervate.scenario.radio_baselines import baseline
from innervate.scenario.radio_plan import parameters

DELAY_US = (1, 2)  # from one node to another; detection included
PRACTICAL_NODES_MAX = 120  # places in a round of practical CSMA/CD-R


def access(
    model: MeshScenario, network: Network, profile: Profile, mtu: int
) -> tuple[str, dict[str, int]]:
    """(the protocol's name, its parameters).

    Raises:
        ScenarioError: the protocol cannot work in this network; the message says why.
    """
    mac = model.radio.mac or ("csma" if profile.collisions else "none")
    if mac == "none":
        return mac, {}
    if not profile.collisions:
        message = f'radio.mac = "{mac}" has nothing to do: profile "{model.radio.profile}" has no '
        raise network.nodes.source.error(("radio", "mac"), message + 'collisions; use "none"')
    if mac == "csma":
        return mac, {"backoff_us": profile.backoff_us}
    _check_one_cell(model, network, mac)
    return _shared(mac, len(network.nodes.names), profile, network, mtu)


def _check_one_cell(model: MeshScenario, network: Network, mac: str) -> None:
    """That all hear each other: what those protocols conclude from silence is else wrong."""
    names, radio = network.nodes.names, network.radio
    count = len(names)
    least = radio.rssi50_cdb + GOOD_CDB
    source = network.nodes.source
    for a in range(count):
        for b in range(count):
            if a != b and radio.rssi_cdb[a * count + b] < least:
                raise source.error(
                    ("radio", "mac"),
                    f'radio.mac = "{mac}" needs all nodes to hear each other, but {names[b]} does '
                    f"not hear {names[a]} well enough: its turns rest on what everybody hears; "
                    'use "csma"',
                )
    if model.robot:
        message = f'radio.mac = "{mac}" needs all nodes to hear each other, and robots move away'
        raise source.error(("radio", "mac"), f'{message}; use "csma"')
    if mac == "csma-cd-r" and count > PRACTICAL_NODES_MAX:
        message = f'radio.mac = "{mac}" has {PRACTICAL_NODES_MAX} places in a round, too few for '
        raise source.error(("radio", "mac"), f"{message}{count} nodes")


def _shared(
    mac: str, count: int, profile: Profile, network: Network, mtu: int
) -> tuple[str, dict[str, int]]:
    """A medium access protocol of radio teams, with frames of at most this MTU."""
    params: dict[str, Any] = parameters(
        profile.phy_bytes + mtu,
        network.radio.turnaround_us,
        DELAY_US,
        bit_us=round(profile.byte_ns / 8000),
    )
    if mac == "csma-cd-r":
        return f"{mac}/practical", params
    return mac, baseline(mac, count, params, p=0.1, cw_min=32, cw_max=1024, backoff_slots=1)
