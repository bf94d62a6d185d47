"""From a node file to a station."""

from innervate.live.channel_radio import MediumRadio
from innervate.live.errors import LiveError
from innervate.live.machine import machine
from innervate.live.nodefile import Loaded
from innervate.live.on_air import medium_of
from innervate.networks.radio.live.node import RadioNode
from innervate.networks.radio.live.parameters import check_slots, radio_parameters
from innervate.networks.radio.live.stack import StationStack

STATIONS_MAX = 1023  # a frame has ten bits for its sender's number, of which one is nobody's


def build(loaded: Loaded) -> RadioNode:
    """The station of a file, not yet started; a LiveError says what cannot be as written."""
    table = loaded.table
    text, where = medium_of(loaded)
    params = radio_parameters(dict(table.protocol), f"{loaded.path}")
    check_slots(params)
    if table.number >= STATIONS_MAX:
        raise LiveError(f"{loaded.path}: number = {table.number}: stations are 0 to 1022")
    stack = StationStack(table.number, params, machine().chance.getrandbits(60))
    radio = MediumRadio(table.number, where)
    return RadioNode(loaded.name, stack, radio, f"medium {text}")
