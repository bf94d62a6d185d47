"""A radio run in plain words: frames, what stations report, traffic; by protocol where they differ.

A protocol whose frames or reports mean something else than the others' adds an entry to a table.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from innervate.dialect.access import REPORT_DELIVERED, REPORT_LEFT
from innervate.kernel.words import number_of
from innervate.networks.radio.protocol import constants as w
from innervate.plot.words import ms_words
from innervate.scenario.actions.channel import FADE, GARBLE, JOIN, KILL, LEAVE


class FrameWords(NamedTuple):
    """How a kind of frame is drawn and called."""

    # letter, name: on its box, as there is room
    letter: str
    name: str
    kind: str  # class of its fill
    height: float  # of its box, 1 = the highest
    meaning: str  # in the legend


_FRAMES = {
    w.DATA: FrameWords("D", "data", "p0", 1.0, "data: packets"),
    w.OPEN: FrameWords("O", "open", "p2 outlined", 1.0, "opening of a sequence"),
    w.CRR: FrameWords("C", "CR-R", "p1", 0.45, "CR-R: collision report with reservation"),
    w.REPORT: FrameWords("R", "report", "p3", 0.72, "report: who was heard, what follows"),
}
_UNKNOWN = FrameWords("?", "frame", "p7", 0.6, "another frame")

# Kinds of frames that a protocol uses otherwise: (protocol, kind).
_FRAMES_OF: dict[tuple[str, int], FrameWords] = {
    ("csma-cd-r/practical", w.CRR): _FRAMES[w.CRR]._replace(
        meaning='CR-R: "I want a turn", or a pulse: "heard"'
    ),
}

PROTOCOLS = {
    "csma-cd-r/practical": "CSMA/CD-R (practical)",
    "csma-cd-r/paper": "CSMA/CD-R (as in the paper)",
    "csma-cd-d1": "CSMA/CD (D1, wired)",
    "csma-cd-d2": "CSMA/CD (D2)",
    "csma-cd-d2p": "CSMA/CD (D2', the winner draws too)",
    "slotted-aloha": "slotted ALOHA",
    "nonpersistent": "nonpersistent CSMA",
    "p-persistent": "p-persistent CSMA",
    "dcf": "802.11 DCF",
    "tree": "binary tree splitting",
    "tdma": "TDMA",
    "token-ring": "token ring",
    "polling": "polling",
}

# What the numbers of a turn mean (a and b of w.REPORT_TURN).
_TURNS = {"csma-cd-r/practical": "place {a} of the round", "csma-cd-r/paper": "turn {a} of {b}"}

REPORTS = {
    REPORT_DELIVERED: "packet delivered",
    w.REPORT_FAILED: "packet not delivered, stays in the queue",
    w.REPORT_COLLISION: "own transmission taken for collided",
    w.REPORT_TURN: "own turn begins",
    w.REPORT_ROLE: "role after a collision",
    w.REPORT_BOUNDS: "pair delay outside the configured bounds",
    w.REPORT_DROPPED: "packet refused, the queue is full",
    REPORT_LEFT: "left",
    w.REPORT_SKIPPED: "own place in the round passed over",
    w.REPORT_STOPPED: "own transmission broken off",
    w.REPORT_WIDER: "greater delays are believed in from now on",
}
_REASONS = {
    w.NO_PROOF: "nobody confirmed it",
    w.HEARD_TAIL: "others were still sending",
    w.NOT_HEARD: "nobody answered",
}
_ACTIONS = {
    JOIN: "switched on",
    KILL: "switched off without warning",
    LEAVE: "told to leave",
    GARBLE: "next {many} garbled",
    FADE: "next {many} not heard by anybody",
}


def frame_words(protocol: str, kind: int) -> FrameWords:
    """How a frame of a protocol is drawn and called."""
    return _FRAMES_OF.get((protocol, kind)) or _FRAMES.get(kind, _UNKNOWN)


def protocol_words(protocol: str) -> str:
    """A protocol's name for people."""
    return PROTOCOLS.get(protocol, protocol)


def turn_words(protocol: str, a: int, b: int) -> str:
    """A turn: "place 3 of the round", "turn 2 of 4"."""
    return _TURNS.get(protocol, "turn {a}").format(a=a, b=b)


def report_kind(code: int, b: int) -> str:
    """What kind of report this is; those of a kind are counted together."""
    words = REPORTS.get(code, f"report {code}")
    return f"{words}: {_REASONS.get(b, f'reason {b}')}" if code == w.REPORT_FAILED else words


def report_words(protocol: str, code: int, a: int, b: int) -> str:
    """What a station reports, in words."""
    words = report_kind(code, b)
    if code == w.REPORT_TURN:
        return f"{words}: {turn_words(protocol, a, b)}"
    if code == REPORT_DELIVERED and b > 1:
        return f"{b} packets delivered"
    if code == w.REPORT_ROLE:
        return f"{words}: {a}"
    return words


def fault_words(fault: Any) -> str:
    """An event of the scenario."""
    many = "CR-R" if fault.value == 1 else f"{fault.value} CR-Rs"
    what = _ACTIONS.get(fault.action, "something happened").format(many=many)
    return f"station {fault.node}: {what}"


def slots_words(slots: float) -> str:
    """A time in slots: "8.5 slots", "131 slots", "12,340 slots"."""
    if slots >= 100:
        return f"{round(slots):,} slots"
    text = f"{slots:.3g}"
    return f"{text} slot{'' if text == '1' else 's'}"


def time_words(slots: float, slot_us: int) -> str:
    """A time in both units: "131 slots (27.2 ms)"."""
    return f"{slots_words(slots)} ({ms_words(slots * slot_us / 1e3)})"


def off_words(summary: Mapping[str, Any]) -> list[str]:
    """What became of the packets of robots that were switched off or left, in sentences."""
    lines = []
    abandoned, waited = summary.get("abandoned", 0), summary.get("waited_off", 0)
    if abandoned:
        whose = "of robots that were off or had left at the end"
        lines.append(f"Not counted: {number_of(abandoned, 'packet')} {whose}.")
    if waited:
        whose = "its robot was" if waited == 1 else "their robots were"
        lines.append(
            f"{number_of(waited, 'packet')} waited while {whose} off; delays leave them out."
        )
    return lines
