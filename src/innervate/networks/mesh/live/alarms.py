"""Alarms of the virtual fence, as they come in at the monitor [mesh 2 FENCE_ALARM]."""

from collections import deque
from typing import Any, NamedTuple

from innervate.live.machine import machine
from innervate.live.streams import Arrivals
from innervate.networks.mesh.payloads import FIELDS
from innervate.networks.mesh.protocol.constants import ALARM
from innervate.wire.layout import BROKEN, read

KINDS = ("predict", "cross", "lost", "clear")
SHOWN = 16  # alarms that a status shows
CM_S = 2  # unit of speeds, cm/s
PLACE_MAX = 32_767  # units
SPEED_MAX = 127


class Alarm(NamedTuple):
    """An alarm of the virtual fence."""

    kind: str  # "predict" (it is about to cross), "cross", "lost" (not heard any more) or "clear"
    robot: int  # whom it is about
    reporter: int  # who raised it: the robot, a witness or the monitor
    fence: int  # the fence's number
    number: int  # counts its reporter's alarms, modulo 256
    # x_cm, y_cm: where the robot was, from the fence's origin
    x_cm: int
    y_cm: int
    margin_cm: int  # how far inside, negative outside


def read_alarm(reporter: int, body: bytes, unit_cm: int) -> Alarm | None:
    """The alarm in a packet's payload; None if it is of no kind that is known."""
    found: list[tuple[str, int]] = []
    if read(FIELDS[ALARM], body, 0, 8 * len(body), found) == BROKEN:
        return None
    told = dict(found)
    if told["alarm"] >= len(KINDS):
        return None
    x, y, gap = (told[name] * unit_cm for name in ("x", "y", "margin"))
    return Alarm(
        KINDS[told["alarm"]], told["robot"], reporter, told["fence"], told["number"], x, y, gap
    )


def place_of(
    at_cm: tuple[float, float], speed_cm_s: tuple[float, float], unit_cm: int
) -> tuple[int, int, int, int]:
    """Position and speed in the protocol's units; beyond their ranges the last value of them."""
    x, y = (_bound(value / unit_cm, PLACE_MAX) for value in at_cm)
    vx, vy = (_bound(value / CM_S, SPEED_MAX) for value in speed_cm_s)
    return x, y, vx, vy


def _bound(value: float, most: int) -> int:
    return max(-most, min(most, round(value)))


class Alarms:
    """Alarms that came in, and who waits for them."""

    def __init__(self) -> None:
        self.arrivals: Arrivals[Alarm] = Arrivals()
        # The newest, with when they came, s of a clock that nobody sets.
        self.recent: deque[tuple[float, Alarm]] = deque(maxlen=SHOWN)

    def note(self, alarm: Alarm) -> None:
        """An alarm came: remember it, and tell those who asked."""
        self.recent.append((machine().monotonic_ns() / 1e9, alarm))
        self.arrivals.put(alarm)

    def status(self) -> list[dict[str, Any]]:
        """The newest alarms, with how long ago they came, s."""
        now = machine().monotonic_ns() / 1e9
        return [{**alarm._asdict(), "ago_s": round(now - at, 3)} for at, alarm in self.recent]
