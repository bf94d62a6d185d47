"""Binds the protocols of a shared channel to the simulator, by name."""

from types import ModuleType
from typing import Any, NamedTuple

from innervate.kernel import compilation
from innervate.networks.radio.baselines import station
from innervate.networks.radio.baselines.fields import BASELINE
from innervate.networks.radio.protocol import fields, paper, practical
from innervate.networks.radio.protocol.station import copy_frame
from innervate.networks.radio.scenario.baselines import NUMBERS
from innervate.sim.channel import traffic
from innervate.sim.handlers import handlers


class Protocol(NamedTuple):
    """What the simulator needs of a medium access protocol."""

    entry: ModuleType  # the module with the five functions
    fields: Any  # declaration of a station's own state


PROTOCOLS: dict[str, Protocol] = {
    "csma-cd-r/practical": Protocol(practical, fields.PRACTICAL),
    "csma-cd-r/paper": Protocol(paper, fields.PAPER),
    # One stack for all baselines; a parameter says which.
    **dict.fromkeys(NUMBERS, Protocol(station, BASELINE)),
}


def digest(frame):
    """A frame in one word, for the fingerprint."""
    word = frame.kind | (frame.slots << 4) | (frame.source << 16) | (frame.handle << 26)
    word ^= (frame.pos << 42) | (frame.next << 49) | (frame.more << 56) | (frame.ok << 57)
    word ^= (frame.good[0] << 5) ^ (frame.good[1] << 21) ^ (frame.bad[0] << 13)
    return (
        word ^ (frame.bad[1] << 29) ^ (frame.window << 44) ^ (frame.span << 50) ^ (frame.wide << 60)
    )


def bind(entry: ModuleType, recorder: Any, packets: Any = traffic) -> ModuleType:
    """What the medium calls (see `sim/channel`), of the module with a protocol's five functions.

    `recorder` keeps rows and checks; `packets` follows what becomes of packets: `traffic`, or a
    protocol above whose frames they are.
    """
    return compilation.bound(
        f"{entry.__name__} on a channel",
        (*handlers(entry).values(), digest, copy_frame),
        (recorder.record_sent, recorder.record_received, recorder.watch),
        (packets.note_sent, packets.note_received, packets.note_delivered),
    )
