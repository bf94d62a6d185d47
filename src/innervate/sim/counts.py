"""What a medium counts of a network, whatever runs on it."""

from collections.abc import Mapping
from typing import NamedTuple


class Counts(NamedTuple):
    """So far; what a medium does not count is 0 or empty.

    Attributes:
        nodes: how many there are.
        off: which of them are off.
        sent: frames handed to a link.
        arrived: frames that reached a node that is on.
        lost_by: frames lost, by reason.
        offered: messages given to nodes by their users.
        delivered: messages given to users by nodes.
        unheard: of offered messages, of how many at least nothing was delivered, where that is
            known; where messages are for many, `delivered` does not tell.
        dropped_by: messages given up by nodes, by reason.
        is_shared: all hear the same air: a frame counts for each that could hear it, as a
            reception, and one that is lost need be nobody's loss.
    """

    nodes: int = 0
    off: tuple[int, ...] = ()
    sent: int = 0
    arrived: int = 0
    lost_by: Mapping[str, int] = {}
    offered: int = 0
    delivered: int = 0
    unheard: int = 0
    dropped_by: Mapping[str, int] = {}
    is_shared: bool = False

    @property
    def in_flight(self) -> int:
        """Frames on their way, or waiting for it."""
        return self.sent - self.arrived - sum(self.lost_by.values())
