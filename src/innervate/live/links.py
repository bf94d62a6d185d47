"""What carries frames: a link has one or more paths, each to one neighbour or to a group."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any

FORGOTTEN_MAX = 4096  # reads of a socket or a port: what comes meanwhile does not hold us up

# Takes the path a frame came in on, and its bytes.
Receiver = Callable[["Path", bytes], None]

# What happens to a path by itself, as who is at its far end leaves and comes back.
APART, NEAR = REACH = ("apart", "near")


class Path:
    """A way on which frames leave and come in: a cable, a neighbour's address, a group.

    Attributes:
        name: as shown to people: "udp 127.0.0.1:4701".
        own: the near end's name, where it has one of its own; the far end's path leads there.
        far: where the path leads, as the far end calls itself; "" = what its name says.
        ends: what captures call the near and the far end, as the other node does; "" not known.
        port: its place in the node's file, from 0; protocols with ports know it by that.
        is_group: whoever hears it, hears all that is sent on it, and there may be many.
        up: False while its device is away.
        cut: True = it carries nothing, as if its plug had come out; for tests and experiments.
        away: True = who is at its far end is out of reach, so it carries nothing, cut or not.
        loss: share of the frames that are lost as they come in, 0 to 1; as of a loose plug.
        trouble: why it carries nothing now, for its user; "" = it does, or nothing is known.
        again: what is to be known of the end of its last trouble besides.
        heard_at: when a good frame came in last, us of the driver's clock; 0 never.
        moved: is called when it leads to another address than before.
        counters: frames and bytes out and in, and why frames were not sent.
    """

    is_group = False

    def __init__(self, name: str, port: int) -> None:
        self.name = name
        self.own = self.far = self.again = ""
        self.ends = ("", "")
        self.port = port
        self.up = True
        self.cut = self.away = False
        self.loss = 0.0
        self.trouble = ""
        self.heard_at = 0
        self.moved: Callable[[], object] = lambda: None
        self.counters: Counter[str] = Counter()

    @property
    def carries(self) -> bool:
        """True unless nothing goes over it: it is cut, or leads to who is away."""
        return not (self.cut or self.away)

    def bound_ends(self) -> tuple[str, str]:
        """Names of both ends that a node at the far end knows, too; "" = there is none."""
        return self.ends

    def send(self, data: bytes) -> None:
        """Send bytes; never waits and never raises: what cannot go is counted."""
        raise NotImplementedError

    def let_in(self, anybody: Sequence[tuple[int, int]], known: Mapping[int, int]) -> None:
        """What of sealed frames will be taken; a link may drop the rest before it is read.

        `anybody` are ranges of first bytes that are taken whoever sent them; `known` says the least
        counter that can be new for each index (of a group: sender and epoch).
        """

    def sent(self, data: bytes) -> None:
        """Note that bytes have left."""
        self.counters["sent"] += 1
        self.counters["sent bytes"] += len(data)


class Link:
    """A socket, a device or a group of them; opened, and opened again when it comes back.

    Attributes:
        frame_max: bytes that it carries at once, as sealed; on IP what Ethernet does not cut up.
    """

    paths: list[Any]
    frame_max = 1472

    async def find(self) -> None:
        """Find what has to be known before it is opened, and takes time; LiveError if it cannot."""

    async def open(self, receive: Receiver) -> None:
        """Start to receive; LiveError if it cannot be opened as written."""
        raise NotImplementedError

    def unread(self) -> int:
        """How many frames the system dropped before they were read, where it says so."""
        return 0

    def forget(self) -> None:
        """Throw away what came and was not read yet, and what could not be sent yet."""

    def close(self) -> None:
        """Stop; nothing is received any more."""
        raise NotImplementedError
