"""A radio team as a capture: every station is an interface."""

from typing import Any

import numpy as np

from innervate.export import bulk, links
from innervate.networks.radio import frames as radio
from innervate.networks.radio.sim.simulate import simulate

__all__ = ["LATE_US", "frames", "interfaces", "numbers", "refusal", "simulate"]

LATE_US = 0  # a row is told at its moment


def refusal(plan: Any) -> str:
    """Why there is no capture of a plan; "" if there is one."""
    slotted = plan.scenario.model.channel.level == "slotted"
    return 'the slotted level has no frames; set channel.level = "event"' if slotted else ""


def interfaces(plan: Any) -> list[tuple[str, str]]:
    """(name, description) of every interface, in order."""
    return [(f"station {i}", links.describe("station", i)) for i in range(plan.stations)]


def numbers(plan: Any) -> Any:
    """Which interface a tap's row is of, by its column `at`."""
    return np.arange(plan.stations)


def frames(_rows: Any, kept: Any) -> list[bytes]:
    """The bytes of radio frames; packets in them have none in a simulation."""
    made = bulk.by_kind(kept, {
        kind: (fields, radio.VERSION << 4 | kind, radio.AT, radio.SIZES[kind])
        for kind, _name, fields in radio.LAYOUTS
    })  # fmt: skip
    carrier = bytes((radio.CRR_BYTE,))
    return [data or carrier for data in made]
