"""Receipts: what becomes of a message."""

import asyncio

ACCEPTED = "accepted"
HOP_ACKED = "next hop acked"
DELIVERED = "delivered"
EXPIRED = "expired"
REFUSED = "refused"
FINAL = (DELIVERED, EXPIRED, REFUSED)
ALL = 255  # the recipient that is all nodes: nobody acknowledges to have been one of them
STOPPED = "node stopped"  # why what was under way has expired, and nothing more is accepted


def check_bytes(payload: object) -> None:
    """TypeError unless a payload is bytes, before anything is done with it."""
    if not isinstance(payload, bytes | bytearray | memoryview):
        raise TypeError(f"a payload is bytes, not {type(payload).__name__}")


class Receipt:
    """What becomes of a message.

    Attributes:
        state: "accepted", "next hop acked", then "delivered" or "expired"; "refused" at once.
        reason: why it was refused or has expired, "" else; "node stopped" if the sender was.
        seq: the packet's number once the router has it, -1 before.
    """

    __slots__ = ("_changes", "reason", "seq", "state")

    def __init__(self) -> None:
        self.state = ACCEPTED
        self.reason = ""
        self.seq = -1
        self._changes: list[asyncio.Future[str]] = []

    async def wait(self) -> str:
        """Wait until nothing changes any more; the state then.

        Messages to all, or without end-to-end acknowledgement, stay "accepted": do not wait.
        """
        while self.state not in FINAL:
            await self.change()
        return self.state

    async def change(self) -> str:
        """Wait for the next change; the state then."""
        if self.state in FINAL:
            return self.state
        future = asyncio.get_running_loop().create_future()
        self._changes.append(future)
        return str(await future)

    def move(self, state: str, reason: str = "") -> None:
        """The message's state changes; whoever waits for that is woken."""
        self.state, self.reason = state, reason
        told, self._changes = self._changes, []
        for future in told:
            if not future.done():
                future.set_result(state)

    def __repr__(self) -> str:
        return f"<Receipt {self.state}{': ' if self.reason else ''}{self.reason}>"
