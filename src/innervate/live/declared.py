"""A live node of a network whose record says no more than its protocol, its fields and its frames.

The protocol is a module with the handlers of a node; every port is a cable. What its records have
was declared, so that its status and what it delivers can be told without knowing what it is.
"""

from collections import Counter
from collections.abc import AsyncGenerator, Callable, Iterator
from functools import partial
from typing import Annotated, Any, Self

from msgspec import Meta

from innervate.dialect import plain
from innervate.dialect.rng import seeded
from innervate.live.build import links_of, sealer_of, state_of
from innervate.live.engine import NEVER
from innervate.live.errors import LiveError
from innervate.live.links import Path
from innervate.live.machine import machine
from innervate.live.node import Answerer, LiveNode
from innervate.live.nodefile import Loaded, NodeFile
from innervate.live.parameters import check_parameters
from innervate.live.stack import CabledStack, filled
from innervate.live.streams import Stream
from innervate.network import Network, networks
from innervate.wire.frames import REASONS, Codec

OUTBOX = 16
# Fields that the driver sets as a node is made, and that nobody wants to read.
DRIVERS = ("number", "rng", "choice")  # a node's driver sets them
HIDDEN = (*DRIVERS, "asked")  # says nothing of the network: nobody is shown it


class DeclaredFile(NodeFile, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A node; `ports` are its port of each path, in order; 0, 1, ... if left out."""

    ports: list[Annotated[int, Meta(ge=0, le=255)]] = []  # noqa: RUF012


class OneFrame:
    """The coder of a network whose bytes hold a frame each.

    Args:
        frames: with encode and decode.
        reasons: words for what `decode` says.
    """

    def __init__(self, frames: Any, reasons: tuple[str, ...]) -> None:
        self.encode = frames.encode
        self.reasons = reasons
        self._decode = frames.decode

    def read(self, data: bytes, frame: Any) -> Iterator[int]:
        """Read bytes into a frame: 0, or why not."""
        return iter((self._decode(data, frame),))


def coder_of(network: Network, number: int, params: Any) -> Any:
    """What says a node's frames in bytes: its network's packets, own functions, or layouts."""
    if network.has("packets"):
        return network.packets(number, params)
    frames = network.frames
    if hasattr(frames, "encode"):
        return OneFrame(frames, frames.REASONS)
    return OneFrame(Codec(frames.LAYOUTS, frames.KIND_BITS), REASONS)


class DeclaredStack(CabledStack):
    """One node of a network, as an engine runs it.

    Args:
        network: with the parts `protocol`, `fields` and `frames`.
        number: the node's.
        params: the protocol's parameters by name; those that are left out are the value in range
            nearest 0.
        seed: any whole number; nodes must have different ones.
        ports: the port of each path, in order of the paths.
    """

    def __init__(
        self, network: Network, number: int, params: dict[str, int], seed: int, ports: list[int]
    ) -> None:
        protocol, fields = network.protocol, network.fields
        make = partial(plain.make, array=plain.Row)
        node = make("Node", fields.STATE)()
        for name, value in zip(DRIVERS, (number, seeded(seed), -1), strict=True):
            if hasattr(node, name):
                setattr(node, name, value)
        given = filled(make("Params", fields.PARAMS)(), params)
        frame, room = make("Frame", fields.FRAME), getattr(protocol, "OUTBOX", OUTBOX)
        super().__init__(protocol, node, given, frame, room, ports)
        self.network, self.number = network, number
        self.timers: int = protocol.TIMERS
        self.coder = coder_of(network, number, self.params)
        self.reasons: tuple[str, ...] = self.coder.reasons
        self._rest: Iterator[int] = iter(())
        after_us = getattr(fields, "silent_us", lambda params: getattr(params, "silent_us", NEVER))
        self.silent_us = after_us(self.params)
        self.item = frame()

    @classmethod
    def of(cls, loaded: Loaded, ports: list[int]) -> Self:
        """That of a node file; a LiveError says which parameter cannot be as written."""
        table = loaded.table
        assert isinstance(table, DeclaredFile)
        network = networks()[table.kind]
        check_parameters(table.protocol, network.fields.PARAMS, f"{loaded.path}")
        seed = machine().chance.getrandbits(60)
        return cls(network, table.number, dict(table.protocol), seed, ports)

    def decode(self, data: bytes) -> int:
        """Read bytes into the inbox; 0, or why not."""
        self._rest = self.coder.read(data, self.inbox)
        return next(self._rest)

    def begin(self) -> None:
        """Other bytes came: what a rehearsal left of the last ones is nobody's."""
        self._rest = iter(())

    def more(self) -> bool:
        """Read the next frame that was in the same bytes into the inbox; False = there is none."""
        return next(self._rest, None) == 0

    def status(self, now: int) -> dict[str, Any]:
        """All declared fields of the node's state."""
        return {
            "kind": self.network.name,
            "role": "node",
            "number": self.number,
            "fields": values_of(self.node, self.network.fields.STATE),
        }


class DeclaredNode(LiveNode):
    """A node: tells what its protocol delivers, hands down what it is asked to."""

    stack: DeclaredStack

    def own_requests(self) -> dict[str, Answerer]:
        """Its user may hand something down."""
        return {"input": self._asked_for_input}

    def _transmit(self, port: int, frame: Any, attempt: int, flags: int) -> None:
        try:
            data = self.stack.encode(frame)
        except ValueError as error:  # the protocol's mistake, of this frame; the node goes on
            self.outcomes[f"not sent: {error}"] += 1
            return
        ports = self.stack.ports_of(port, frame, 0)
        paths = self.paths if ports is None else [self.paths[i] for i in ports]
        if attempt <= 0:
            self._leave(paths, data)
            return
        assert self.engine is not None  # on cables the number is a delay, us
        self.engine.later(attempt, partial(self._leave, paths, data))

    def _receive(self, path: Path, data: bytes) -> None:
        self.stack.begin()
        super()._receive(path, data)
        while self.engine is not None and self.stack.more():
            self.engine.receive(path.port)

    def give(self, kind: int, values: dict[str, Any]) -> None:
        """Hand something down: the protocol's `on_input`; `values` are fields of its item.

        Raises:
            ValueError: there is no such field, or the node does not run.
        """
        engine = self.running()
        ranges = {name: (low, high)
                  for name, _length, low, high, *_ in self.stack.network.fields.FRAME}  # fmt: skip
        for name, value in values.items():
            if name not in ranges:
                raise ValueError(f"{name} is no field of a frame")
            many = isinstance(getattr(self.stack.item, name), list)
            numbers = value if many and isinstance(value, list) else [value]
            count = len(getattr(self.stack.item, name)) if many else 1
            low, high = ranges[name]
            if len(numbers) != count or not all(
                type(one) is int and low <= one <= high for one in numbers
            ):
                raise ValueError(f"{name} has {count} values, whole numbers from {low} to {high}")
            setattr(self.stack.item, name, list(numbers) if many else value)
        self.outcomes["inputs"] += 1
        engine.input(kind, self.stack.item)

    def receive(
        self, callback: Callable[[dict[str, Any]], None] | None = None
    ) -> AsyncGenerator[dict[str, Any], None]:
        """What is delivered, by field: to a callback, and as an async iterator."""
        return self.arrivals.receive(callback)

    def streams(self, request: dict[str, Any]) -> list[Stream]:
        """What is delivered to the node, for those who follow it by its status socket."""
        return [(self.receive(), lambda item: {"from": self.name, **item})]

    def counters(self) -> Counter[str]:
        """Handler calls, frames dropped by reason, inputs, deliveries and reports by code."""
        reports = Counter({f"report {code}": count for code, count in self.reports.items()})
        return super().counters() + reports

    def _asked_for_input(self, request: dict[str, Any]) -> dict[str, Any]:
        self.give(int(request["kind"]), dict(request.get("item", {})))
        return {"ok": True}

    def _deliver(self, kind: int, frame: Any) -> None:
        self.outcomes["delivered"] += 1
        self.arrivals.put({"kind": kind, **values_of(frame, self.stack.network.fields.FRAME)})


def values_of(record: Any, declared: Any) -> dict[str, Any]:
    """The declared fields of a record by name, but for those that are the driver's."""
    found = {}
    for name, length, *_ in declared:
        if name not in HIDDEN:
            value = getattr(record, name)
            found[name] = list(value) if length else value
    return found


def build(loaded: Loaded) -> DeclaredNode:
    """The node of a file, not yet started; a LiveError says what cannot be as written."""
    table = loaded.table
    assert isinstance(table, DeclaredFile)
    links, state = links_of(loaded), state_of(loaded)
    paths = sum(len(link.paths) for link in links)
    ports = table.ports or list(range(paths))
    if len(ports) != paths or len(set(ports)) != paths:
        raise LiveError(
            f"{loaded.path}: ports must name the node's port of each of its {paths} paths, "
            "each once"
        )
    stack = DeclaredStack.of(loaded, ports)
    return DeclaredNode(loaded.name, stack, links, sealer_of(loaded, state), state)
