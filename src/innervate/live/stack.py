"""What engines run of protocols whose handlers take a node, its parameters and an outbox."""

from collections.abc import Collection
from typing import Any

from innervate.dialect import plain


def filled(record: Any, values: dict[str, Any]) -> Any:
    """A record with these values in its fields."""
    for name, value in values.items():
        setattr(record, name, value)
    return record


class CabledStack:
    """A node whose ports are cables.

    Args:
        do: the module with its handlers.
        node, params: the records that these are given.
        frame: the kind of record that frames are.
        room: actions that an outbox must hold.
        ports: the port of each path, in order of the paths.

    Attributes:
        coder: what says frames in bytes: `encode(frame)`, `decode(data, frame)`.
    """

    coder: Any

    def __init__(
        self, do: Any, node: Any, params: Any, frame: Any, room: int, ports: list[int]
    ) -> None:
        self.do = do
        self.node, self.params = node, params
        self.out, self.inbox = plain.Outbox(frame, room), frame()
        self.port_of_path = ports
        self.path_of_port = {port: path for path, port in enumerate(ports)}

    def on_start(self, now: int, cause: int) -> None:
        """Switch the node on at `now`, us; `cause` 0 is the first time."""
        self.do.on_start(self.node, self.params, now, cause, self.out)

    def on_frame(self, now: int, port: int) -> None:
        """The frame in the inbox was received on a path."""
        own = self.port_of_path[port]
        self.do.on_frame(self.node, self.params, now, own, self.inbox, self.out)

    def on_timer(self, now: int, timer: int) -> None:
        """A timer of the node's protocol fires at `now`, us."""
        self.do.on_timer(self.node, self.params, now, timer, self.out)

    def on_input(self, now: int, kind: int, item: Any) -> None:
        """The node's own user hands something down."""
        self.do.on_input(self.node, self.params, now, kind, item, self.out)

    def encode(self, frame: Any) -> bytes:
        """The bytes of a frame."""
        data: bytes = self.coder.encode(frame)
        return data

    def decode(self, data: bytes) -> int:
        """Read bytes into the inbox; 0, or why not."""
        reason: int = self.coder.decode(data, self.inbox)
        return reason

    def objection(self, sender: int | None) -> str:
        """Frames name nobody: they speak for the far end of their cable, whoever that is."""
        return ""

    def behind(self, count: int) -> Collection[int]:
        """Frames leave in the order in which they were sent."""
        return ()

    def ports_of(self, port: int, frame: Any, attempt: int) -> list[int] | None:
        """The path of a port; a free one has none."""
        path = self.path_of_port.get(port)
        return [] if path is None else [path]
