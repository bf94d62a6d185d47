"""Binds the protocols of a shared channel to the simulator, by name."""

from types import ModuleType
from typing import Any, NamedTuple

from innervate.kernel import compilation
from innervate.networks.radio.baselines import common, contend, passing, slots, station, tree
from innervate.networks.radio.baselines.fields import BASELINE
from innervate.networks.radio.protocol import bounds as radio_bounds
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.radio.protocol import follow as radio_follow
from innervate.networks.radio.protocol import idle as radio_idle
from innervate.networks.radio.protocol import modes as radio_modes
from innervate.networks.radio.protocol import paper as radio_paper
from innervate.networks.radio.protocol import paper_idle as radio_paper_idle
from innervate.networks.radio.protocol import paper_reserve as radio_paper_reserve
from innervate.networks.radio.protocol import paper_turns as radio_paper_turns
from innervate.networks.radio.protocol import paper_verify as radio_paper_verify
from innervate.networks.radio.protocol import practical as radio_practical
from innervate.networks.radio.protocol import reporter as radio_reporter
from innervate.networks.radio.protocol import station as radio_station
from innervate.networks.radio.protocol import times as radio_times
from innervate.networks.radio.protocol import turn as radio_turn
from innervate.networks.radio.protocol import window as radio_window
from innervate.networks.radio.protocol.station import copy_frame
from innervate.networks.radio.scenario.baselines import NUMBERS
from innervate.sim.channel import traffic
from innervate.sim.handlers import handlers


class Protocol(NamedTuple):
    """What the simulator needs of a medium access protocol."""

    entry: ModuleType  # the module with the five functions
    modules: tuple[ModuleType, ...]  # all it consists of, callees first
    fields: Any  # declaration of a station's own state


# One stack for all baselines; a parameter says which.
BASELINES = Protocol(
    station, (radio_station, common, contend, slots, tree, passing, station), BASELINE
)

PROTOCOLS: dict[str, Protocol] = {
    "csma-cd-r/practical": Protocol(
        radio_practical,
        (
            radio_station, radio_times, radio_bounds, radio_modes, radio_idle,
            radio_turn, radio_reporter, radio_window, radio_follow, radio_practical,
        ),
        radio_fields.PRACTICAL,
    ),
    "csma-cd-r/paper": Protocol(
        radio_paper,
        (
            radio_station, radio_paper_idle, radio_paper_turns, radio_paper_reserve,
            radio_paper_verify, radio_paper,
        ),
        radio_fields.PAPER,
    ),
    **dict.fromkeys(NUMBERS, BASELINES),
}  # fmt: skip


def digest(frame):
    """A frame in one word, for the fingerprint."""
    word = frame.kind | (frame.slots << 4) | (frame.source << 16) | (frame.handle << 26)
    word ^= (frame.pos << 42) | (frame.next << 49) | (frame.more << 56) | (frame.ok << 57)
    word ^= (frame.good[0] << 5) ^ (frame.good[1] << 21) ^ (frame.bad[0] << 13)
    return (
        word ^ (frame.bad[1] << 29) ^ (frame.window << 44) ^ (frame.span << 50) ^ (frame.wide << 60)
    )


def bind(entry: ModuleType, recorder: Any, packets: Any = traffic) -> ModuleType:
    """What the medium calls (see `sim/channel`), of a protocol.

    Args:
        entry: the module with its five functions.
        recorder: keeps rows and checks: record_sent, record_received, watch.
        packets: follows what becomes of packets (note_sent, note_received, note_delivered):
            `traffic`, or a protocol above whose frames they are.
    """
    return compilation.bound(
        f"{entry.__name__} on a channel",
        (*handlers(entry).values(), digest, copy_frame),
        (recorder.record_sent, recorder.record_received, recorder.watch),
        (packets.note_sent, packets.note_received, packets.note_delivered),
    )
