"""What of a network runs on a board (see `boards/`): its protocols, their records, their frames.

A role is one protocol: a node's own, or a layer below it. A network whose protocol, fields and
frame layouts are declared, and that lies over cables, has a role without saying so.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from innervate.network import Network
from innervate.wire.layout import SPARE

Declaration = tuple[tuple[str, Any, int, int, str, str], ...]
Kinds = dict[int, tuple[tuple[str, Any], ...]]
OUTBOX = 16
# What an action has where a network's `fields` declare no ACTION: see dialect/outbox.py.
ACTION: Declaration = (
    ("kind", 0, 0, 15, "kind", "1 SEND, 2 SET_TIMER, 3 DELIVER, 4 REPORT"),
    ("a", 0, -32768, 65535, "number", "port, timer, kind of frame or code"),
    ("b", 0, -1073741823, 1073741823, "number", "delay, time of the timer or a of the report"),
    ("c", 0, -1073741823, 1073741823, "number", "flags or b of the report"),
)


class Watched(NamedTuple):
    """The plain run in which everything that one node is told is written down.

    Attributes:
        scenario: a file of `boards/parity`, without its ending; "" = one with its kind alone.
        simulation: "module:function", (plan, plain=) -> sim.driver.Simulation.
        on_frame: "module:function" that the run calls for the protocol's `on_frame`, with world,
            node, time, port and frame; "" = the protocol's own.
        table: of the world, that holds the states.
        node: which of them.
    """

    scenario: str = ""
    simulation: str = "innervate.sim.cables.declared:simulation"
    on_frame: str = ""
    table: str = "cells"
    node: int = 1


class Emulated(NamedTuple):
    """What an emulated micro:bit (10,000 bytes for programs) has to know to hold a protocol.

    Attributes:
        left_out: functions that do not fit beside the rest, and that the calls played do not need.
        repeated: the only type of frame that one call sends more than one of.
    """

    left_out: tuple[str, ...]
    repeated: int


class Program(NamedTuple):
    """What a maker's board runs.

    Attributes:
        main: the file of `boards/micropython` that becomes main.py, without its ending.
        drivers: files of `boards/micropython` that it needs.
        sources: files of `src/innervate` that it needs.
        node: "file:class" that main.py calls its node; "" = it knows by itself.
    """

    main: str
    drivers: tuple[str, ...]
    sources: tuple[str, ...]
    node: str = ""


class Form(NamedTuple):
    """Frames of some kinds, as they lie on the wire behind the kind.

    Attributes:
        kinds: what each is called, by number.
        fields: of fixed number, but for arrays as many as an earlier field says, and at the very
            end one up to the end of the frame (see wire/layout.py).
        most: how many such an array has at most, and what a decoder says of more, by its name.
        length: the field that holds how many that array at the end has, if there is one.
        step: it has a multiple of that.
        payloads: what that array has to be, by kind.
        same: fields that are set to what another is, by name.
        has_payload: behind the fields are bytes that are none of the record's.
    """

    kinds: Mapping[int, str]
    fields: tuple[Any, ...]
    most: Mapping[str, tuple[int, str]] = {}
    length: str = ""
    step: int = 1
    payloads: Mapping[int, tuple[Any, ...]] = {}
    same: Mapping[str, str] = {}
    has_payload: bool = False


class Coded(NamedTuple):
    """Frames that are more than a kind and fields of fixed number; all have a CRC at the end.

    Attributes:
        version: what stands in front of the kind, and in how many bits.
        kind_bits: how many the kind has.
        forms: of frames, each of some kinds.
        reasons: words for what a decoder says, 0 is "read".
        size_max: bytes of a frame at most, but for those of a payload.
        lead, trail: flags, in the field `flags`, of a payload that begins with a number of bytes
            and these, or may end with bytes and their number, besides what its kind has.
        alone: a byte that is a frame by itself, its kind, and what fields it then has.
        payload_max: "module:function", parameters -> bytes of a payload at most.
        clears: a decoder makes 0 what only other forms have.
    """

    version: tuple[int, int]
    kind_bits: int
    forms: tuple[Form, ...]
    reasons: tuple[str, ...]
    size_max: int
    lead: int = 0
    trail: int = 0
    alone: tuple[int, int, Mapping[str, int]] | None = None
    payload_max: str = ""
    clears: bool = False


class Role(NamedTuple):
    """A node's protocol.

    Attributes:
        name: what commands call it.
        entry: the module with the five functions.
        state, params, frame, item: declarations of its records; `item` is what its user hands
            down. One that looks into no frame declares none.
        kinds: what a frame of each kind has on the wire: (field, how many: 0 one, a number, or
            the field that says).
        room: actions that its outbox must hold.
        in_ram: 16 KiB hold its code, too.
        noted: fields of a frame that only a simulation fills in.
        counted: fields that say how much of an array is used, by the array's name.
        gate: declaration of a second record that handlers are given behind the state, on nodes
            that have one; () = the protocol knows none.
        made_in: parameters that are numbers in C as it is made: what they leave out takes no room.
        parameters: "module:function", (changes, where) -> all parameters by name; "" = those of
            the network's plainest scenario.
        action: declaration of what an action of the outbox has.
        frames: frames that one call sends and delivers at most; 0 = as many as it has actions.
        frame_bytes: bytes that they have together at most, in C, each up to where its last array
            is in use, the newest whole; 0 = each has a place where it would be whole.
        timers: how many it has.
        nodes: nodes of a network that its arrays hold at most; 0 = they do not depend on it.
        coded: how its frames lie on the wire, where that is more than the network's `LAYOUTS`.
        driver: what carries it on a board: "node" over cables; "field", whose frames leave by all
            lines; "station" on a channel; "" nothing.
        hooks: "package:file", C of its own beside the driver: where frames leave, which come in.
        sized: "module:function", nodes -> the role with arrays for so many; "" = there is one size.
        live: "module:function", parameters -> the role as a live node with these has it; "" = the
            same as on a board.
        usual: what stands in files of usual live nodes, besides their kind, number and links: a
            wheel brings what these take as C.
        wide: all its numbers have 32 bits, whatever is declared, and a coder says which does not
            fit: so C does with values out of range what Python does.
    """

    name: str
    entry: str
    state: Declaration
    params: Declaration
    frame: Declaration
    item: Declaration
    kinds: Kinds
    room: int = OUTBOX
    in_ram: bool = False
    noted: frozenset[str] = frozenset()
    counted: Mapping[str, str] = {}
    gate: Declaration = ()
    made_in: tuple[str, ...] = ()
    parameters: str = ""
    action: Declaration = ACTION
    frames: int = 0
    frame_bytes: int = 0
    timers: int = 0
    nodes: int = 0
    coded: Coded | None = None
    driver: str = "node"
    hooks: str = ""
    sized: str = ""
    live: str = ""
    usual: tuple[Mapping[str, Any], ...] = ()
    wide: bool = False
    watched: Watched = Watched()
    emulated: Emulated | None = None
    program: Program | None = None

    @property
    def has_gate(self) -> bool:
        """True if handlers are given a second record behind the state."""
        return bool(self.gate)


PLAIN = Program(
    "plain_main",
    ("outbox", "driver"),
    ("wire/bits", "wire/crc", "wire/layout", "wire/cobs", "wire/frames"),
    "driver:Node",
)

FIELD = PLAIN._replace(drivers=("outbox", "driver", "field"), node="field:FieldNode")

CABLES = "cables"
WATCHED = {
    CABLES: Watched(),
    "channel": Watched(simulation="innervate.sim.channel.declared:simulation", table="stations"),
    "field": Watched(simulation="innervate.sim.field.declared:simulation", table="stations"),
}


# Of networks that say nothing of boards themselves: in C, and in MicroPython.
DRIVEN = {CABLES: "node", "channel": "", "field": "field"}
PROGRAMS = {CABLES: PLAIN, "channel": None, "field": FIELD}


def only(declared: Declaration, numbers: dict[str, int]) -> Declaration:
    """A declaration where some numbers are always the same: C has those in place of the fields."""
    return tuple(
        (name, length, numbers.get(name, low), numbers.get(name, high), unit, meaning)
        for name, length, low, high, unit, meaning in declared
    )


def on_wire(fields: Any) -> tuple[tuple[str, Any], ...]:
    """(name, how many) of a layout's fields."""
    return tuple((name, many) for name, many, _bits, _signed in fields if name != SPARE)


def roles_of(network: Network) -> tuple[Role, ...]:
    """What of a network runs on a board: what it says itself, or its protocol if that is plain."""
    if network.has("boards"):
        own: tuple[Role, ...] = network.boards
        return own
    if not all(network.has(part) for part in ("protocol", "fields", "frames")):
        return ()
    if hasattr(network.frames, "encode"):
        return ()
    protocol, fields = network.protocol, network.fields
    return (Role(
        network.name, protocol.__name__, fields.STATE, fields.PARAMS, fields.FRAME, fields.FRAME,
        {kind: on_wire(layout) for kind, _name, layout in network.frames.LAYOUTS},
        getattr(protocol, "OUTBOX", OUTBOX), program=PROGRAMS[network.medium],
        watched=WATCHED[network.medium], driver=DRIVEN[network.medium],
        action=getattr(fields, "ACTION", ACTION), timers=getattr(protocol, "TIMERS", 1),
        usual=({},),
    ),)  # fmt: skip
