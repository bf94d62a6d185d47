"""A station's functions that are proved, as formulas beside themselves, for drawn calls."""

from __future__ import annotations

from innervate.dialect.arith import MASK30
from innervate.dialect.source import Change
from innervate.networks.radio.protocol import fields
from innervate.networks.radio.protocol.constants import WIDE_MOST
from innervate.networks.radio.prove.theories import ENTRY, PLACES, STATION
from tests.prove.parity import Twin, twin


def twins(change: Change | None = None) -> list[Twin]:
    """A station's handlers that are proved, each beside its formula."""
    declared = {"station": STATION, "params": fields.PARAMS, "frame": fields.FRAME}
    given = ("station", "params", ("now", 0, MASK30))
    items = {**declared, "item": fields.PACKET}
    return [
        twin(ENTRY, "on_start", (*given, ("cause", 0, 1), "out"), declared, change),
        twin(ENTRY, "on_input", (*given, ("kind", 0, 3), "item", "out"), items, change),
    ]


STATIONS = ("station", "params", ("now", 0, MASK30))
WIDE = ("params", ("wide", 0, WIDE_MOST))
TURNS = {
    "least_delay": WIDE,
    "most_delay": WIDE,
    "guard": WIDE,
    "turn_timeout": WIDE,
    "enter_turn": (*STATIONS, ("place", 0, PLACES - 1), "out"),
    "hear_report": (*STATIONS, "frame", "out"),
    "hear_data": (*STATIONS, "frame", "out"),
}


def turn_twin(name: str, change: Change | None = None) -> Twin:
    """One of the functions that turns rest on, beside its formula; whole, with what they cut."""
    declared = {"station": STATION, "params": fields.PARAMS, "frame": fields.FRAME}
    return twin(ENTRY, name, TURNS[name], declared, change)
