"""What a watched plain run sees of timers: a node that sets them for now, again and again."""

from types import FrameType

from innervate.dialect.arith import HALF30, MASK30
from innervate.dialect.bounded import AGAIN, AT_ONCE_MOST
from innervate.folders import NetworkError


class Timers:
    """Counts, node by node, how often timers are set that are due at once."""

    def __init__(self) -> None:
        self.set: dict[int, tuple[int, int]] = {}  # by node: at which reading, how often

    def look(self, handler: FrameType, place: str, at: int) -> None:
        """A handler sets a timer, at a place in its file, for a reading of its node's clock.

        Raises:
            NetworkError: it has done so too often while its clock stood still.
        """
        node, _params, now, *_ = handler.f_code.co_varnames
        who, reading = id(handler.f_locals[node]), handler.f_locals[now]
        if 0 < (at - reading) & MASK30 < HALF30:
            return
        before, count = self.set.get(who, (reading, 0))
        count = count + 1 if before == reading else 1
        self.set[who] = reading, count
        if count > AT_ONCE_MOST:
            name = handler.f_code.co_name
            raise NetworkError(f"{place}: {name} {AGAIN}; set it for later, (now + ...) & MASK30")
