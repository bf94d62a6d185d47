"""A bench for skins: the protocol's nodes as plain objects, stepped by hand, without any clock.

`Net` keeps the frames on every cable in order; `tick`, `deliver`, `lose`, `cut` and the others
are its only events, so that a test can play any interleaving. `check` asserts the invariants of
[skin 6]. A bench runs on the real protocol or on a changed copy of it (see `changed_protocol`).
"""

import importlib
import types
from pathlib import Path
from types import SimpleNamespace

from innervate.dialect.copies import changed_copy
from innervate.networks.skin import protocol as skin_protocol
from innervate.networks.skin.scenario.model import ProtocolTable
from innervate.networks.skin.scenario.plan import parameters

NO_CHANGE = types.MappingProxyType({})


DIALECT = ("arith", "outbox", "plain", "rng")
STACKS = {"skin_stack": "innervate.networks.skin.sim.stack",
          "static_stack": "innervate.networks.skin.sim.static_stack"}  # fmt: skip
PARTS = {
    **{name: f"innervate.dialect.{name}" for name in DIALECT},
    **{
        "skin" if path.stem == "cell" else f"skin_{path.stem}":
            f"innervate.networks.skin.protocol.{path.stem}"
        for path in sorted(Path(skin_protocol.__file__).parent.glob("[a-z]*.py"))
    },
    **STACKS,
}  # fmt: skip


def protocol_of(modules):
    """The modules of a protocol under one roof, in the order of PARTS.

    `skin` holds everything that a cell's modules define, wherever in the folder it stands.
    """
    parts = dict(zip(PARTS, modules, strict=True))
    cell = {}
    for name, part in parts.items():
        if name.startswith("skin_") and name not in ("skin_sink", "skin_static", "skin_stack"):
            cell |= vars(part)
    return SimpleNamespace(**parts | {"skin": SimpleNamespace(**cell | vars(parts["skin"]))})


REAL = protocol_of(importlib.import_module(name) for name in PARTS.values())


def changed_protocol(*changes):
    """A second copy of the protocol with texts (old, new) replaced; each stands in it once."""
    return protocol_of(changed_copy(changes, *PARTS.values(), beside=STACKS.values()))


def params_of(protocol=REAL, depth_max=8, *, numbers=NO_CHANGE, **keys):
    """The parameters of a [protocol] table, as whole numbers; `numbers` sets some directly."""
    state = protocol.plain.make("Params", protocol.skin_fields.PARAMS)()
    keys = {"balancing": False, "updates": "periodic", **keys}
    for name, value in {**parameters(ProtocolTable(**keys), depth_max), **numbers}.items():
        assert name in state.__slots__, name
        setattr(state, name, value)
    return state


def values(state):
    """All fields of a plain state, in order of declaration."""
    fields = (getattr(state, name) for name in type(state).__slots__)
    return tuple(tuple(field) if isinstance(field, list) else field for field in fields)


def clone(state):
    """A copy of a plain state."""
    copy = object.__new__(type(state))
    for name in type(state).__slots__:
        field = getattr(state, name)
        setattr(copy, name, list(field) if isinstance(field, list) else field)
    return copy


def put_values(state, given):
    """Give a plain state's fields the values that `values` returned."""
    for name, value in zip(type(state).__slots__, given, strict=True):
        setattr(state, name, list(value) if isinstance(value, tuple) else value)


def differing(a, b):
    """Which fields of two states differ, in words."""
    return ", ".join(
        f"{name}: {one} / {two}"
        for name, one, two in zip(type(a).__slots__, values(a), values(b), strict=True)
        if one != two
    )


def out_of_range(state, declaration):
    """Fields of a state that are outside their declared range, in words."""
    wrong = []
    for name, _length, low, high, *_ in declaration:
        field = getattr(state, name)
        items = field if isinstance(field, list) else (field,)
        if min(items) < low or max(items) > high:
            wrong.append(f"{name} = {field} outside {low} .. {high}")
    return ", ".join(wrong)


class Box:
    """An outbox that can be read by name and emptied."""

    def __init__(self, protocol=REAL, limit=16):
        self.protocol = protocol
        self.frame_class = protocol.plain.make("Frame", protocol.skin_fields.FRAME)
        self.out = protocol.plain.Outbox(self.frame_class, limit)

    def take(self):
        """[(kind, a, b, c, frame)] of all actions since the last time; empties the outbox."""
        kinds = self.protocol.outbox
        assert not self.out.overflow[0], "the outbox overflowed"
        found = []
        for i in range(self.out.count[0]):
            act, frame = self.out.action[i], None
            if act.kind in (kinds.SEND, kinds.DELIVER):
                frame = clone(self.out.frame[i])
            found.append((act.kind, act.a, act.b, act.c, frame))
        self.out.count[0] = 0
        return found


def words(actions):
    """Actions as plain tuples, to be compared."""
    return [(*action[:4], action[4] and values(action[4])) for action in actions]


def new_cell(protocol=REAL, number=0, seed=1):
    """A cell before it is switched on."""
    cell = protocol.plain.make("Cell", protocol.skin_fields.CELL)()
    cell.number = number
    cell.rng = protocol.rng.seeded(seed * 40_503 * 30_011)  # small seeds draw alike
    cell.choice = protocol.rng.GENERATE
    return cell


def beacon(protocol=REAL, dist=0, sq=1, load=1, size=1, parent=0):
    """A beacon."""
    frame = protocol.plain.make("Frame", protocol.skin_fields.FRAME)()
    frame.kind = protocol.skin_constants.BEACON
    frame.dist, frame.sq, frame.load, frame.size, frame.parent = dist, sq, load, size, parent
    return frame


def sink_state(protocol, ports):
    """The PC's state before it is switched on: `own[0]` and a number per port."""
    own = protocol.plain.make("Sink", protocol.skin_fields.SINK)()
    own.ports = ports
    return SimpleNamespace(own=[own], size=[0] * ports)


class OneCell:
    """A cell on its own, told what its neighbours say; every period it hears them and ticks."""

    def __init__(self, protocol=REAL, *, seed=1, **keys):
        self.protocol = protocol
        self.params = params_of(protocol, **keys)
        self.cell = new_cell(protocol, number=7, seed=seed)
        self.box = Box(protocol)
        self.now = 0
        self.says = {}  # port: what the neighbour there says each period
        protocol.skin.on_start(self.cell, self.params, 0, 0, self.box.out)
        self.box.take()

    def hear(self, port, **said):
        """A beacon comes in; the neighbour goes on saying so. Actions that it sets off."""
        self.says[port] = said
        frame = beacon(self.protocol, **said)
        skin, out = self.protocol.skin, self.box.out
        skin.on_frame(self.cell, self.params, self.now, port, frame, out)
        return self.box.take()

    def tick(self):
        """The cell's period is over; its actions."""
        self.now = max(self.now, self.cell.tick_at)
        skin = self.protocol.skin
        skin.on_timer(
            self.cell, self.params, self.now, self.protocol.skin_constants.TICK, self.box.out
        )
        return self.box.take()

    def period(self, *silent):
        """Hear all neighbours but the silent ports once more, then tick."""
        for port, said in self.says.items():
            if port not in silent:
                self.hear(port, **said)
        return self.tick()

    @property
    def parent(self):
        """The parent port; -1 none."""
        return self.cell.parent

    def sent(self, actions):
        """The beacons among actions, by port."""
        send = self.protocol.outbox.SEND
        return {a: frame for kind, a, _b, _c, frame in actions if kind == send}

    def reported(self, actions):
        """The reports among actions: [(code, a, b)]."""
        report = self.protocol.outbox.REPORT
        return [(a, b, c) for kind, a, b, c, _frame in actions if kind == report]
