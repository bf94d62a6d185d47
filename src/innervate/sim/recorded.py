"""What a run keeps of what happens, whatever the medium."""

from typing import NamedTuple


class Recorded(NamedTuple):
    """What a run keeps.

    Attributes:
        checks: check what must hold.
        observe: note what nodes report, and what they send.
        deliveries: a row per delivered frame of a network over cables; others observe them.
        trail: a row per handler call.
        tap: copies of frames as they leave and come in.
    """

    checks: bool = True
    observe: bool = True
    deliveries: bool = False
    trail: bool = False
    tap: bool = False

    @property
    def is_watchful(self) -> bool:
        """True if something is to be done after every handler call."""
        return self.checks or self.trail
