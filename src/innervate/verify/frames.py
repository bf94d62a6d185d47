"""Frames that an explored call puts into its outbox: what of them is not set, or out of range."""

from typing import Any

from innervate.dialect.folder import LOOKED_AT, MEASURED
from innervate.dialect.outbox import DELIVER, SEND
from innervate.dialect.plain import Row
from innervate.network import dropped_of, layouts_of

TIMED = "made_at"  # what latencies are measured by


class Frames:
    """Looks at frames, and makes them blank before a call.

    Args:
        declared: the fields of a frame.
        layouts: of its kinds (see wire/layout.py); () = they do not say what is on a wire.
        looked_at: fields that the medium looks at, whatever a layout says.

    A protocol that does not set a field of a frame sends what an earlier one had there.
    """

    def __init__(self, declared: Any, layouts: Any = (), looked_at: Any = ()) -> None:
        self.declared, self.looked_at = declared, looked_at
        self.names = {name for name, *_ in declared}
        self.laid = {kind: {one[0] for one in fields} for kind, _name, fields in layouts}
        self.dropped = dropped_of(declared, layouts)

    def blank(self, frame: Any) -> None:
        """Let none of a frame's fields be set."""
        for name, length, *_ in self.declared:
            setattr(frame, name, Row([None] * length) if length else None)

    def wrong(self, frame: Any, action: int, handler: str, found: str = "") -> str:
        """What is wrong with a frame that a handler sends or delivers; all of it is set then.

        What a layout has no bits for is not sent. What was `found` before stays.
        """
        if action not in (SEND, DELIVER):
            return found
        does = "sends" if action == SEND else "delivers"
        kind = getattr(frame, "kind", None)
        wanted = self.wanted(kind, action)
        dropped = self.dropped.get(kind, ()) if action == SEND else ()
        for name, length, low, high, *_ in self.declared:
            given = getattr(frame, name)
            if not length and given is not None and low <= given <= high and name not in dropped:
                continue
            each = given if length else [given]
            if None in each and name in wanted and not found:
                found = f"{name} of a frame that {handler} {does} is not set"
            each = [min(max(0, low), high) if one is None else one for one in each]
            out = [one for one in each if not low <= one <= high]
            if out and name not in MEASURED and not found:
                found = (f"{name} of a frame that {handler} {does} is {out[0]}, "
                         f"declared {low} to {high}")  # fmt: skip
            if name in dropped:
                each = [0] * len(each)
            setattr(frame, name, each if length else each[0])
        if action == SEND and self.laid and kind not in self.laid and not found:
            found = f"{handler} sends a frame of kind {kind}, which has no layout"
        return found

    def wanted(self, kind: int | None, action: int) -> set[str]:
        """The fields that a frame of a kind must have, as it is sent or delivered."""
        if action != SEND:
            return {TIMED} & self.names
        known = {"kind", TIMED, *self.laid.get(kind, ())} if self.laid else set()
        return {*known, *self.looked_at} & self.names


def frames_of(network: Any) -> Frames:
    """What looks at the frames of a network."""
    return Frames(network.fields.FRAME, layouts_of(network), LOOKED_AT[network.medium])
