"""From a node file to a station."""

from __future__ import annotations

from innervate.live.channel_radio import MediumRadio
from innervate.live.errors import LiveError
from innervate.live.machine import machine
from innervate.live.nodefile import Loaded, MediumTable, address
from innervate.networks.radio.live.node import RadioNode
from innervate.networks.radio.live.parameters import check_slots, radio_parameters
from innervate.networks.radio.live.stack import StationStack


def build(loaded: Loaded) -> RadioNode:
    """The station of a file, not yet started.

    Raises:
        LiveError: it cannot be as written.
    """
    table, where = loaded.table, f"{loaded.path}"
    if len(table.link) != 1 or not isinstance(table.link[0], MediumTable):
        raise LiveError(f'{where}: a station has one [[link]], of kind = "medium"')
    if table.keys is not None:
        raise LiveError(f"{where}: frames on a shared channel are not sealed; remove [keys]")
    params = radio_parameters(dict(table.protocol), where)
    check_slots(params)
    stack = StationStack(table.number, params, machine().chance.getrandbits(60))
    radio = MediumRadio(table.number, address(table.link[0].address, where))
    return RadioNode(loaded.name, stack, radio, f"medium {table.link[0].address}")
