"""What goes in and out at the ends of a live skin: samples, commands; and their ranges."""

from typing import Any, NamedTuple

from innervate.dialect import plain
from innervate.networks.skin.protocol import fields as fields

Frame = plain.make("Frame", fields.FRAME)
RANGES = {name: (length, low, high) for name, length, low, high, _, _ in fields.FRAME}


class Touch(NamedTuple):
    """What a cell measured, as it comes in at the PC.

    Attributes:
        cell: who measured it.
        seq: counts the cell's samples, modulo 256.
        hops: cells that forwarded it.
        port: interface port of the PC on which it came.
        proximity: raw, 0 far, to 65535.
        force: three sensors, mN.
        temperature: half degrees from 20 degC.
        accel: along x, y, z, raw, -512 to 511.
        time_us: when it came in by the PC's clock, us since 1970 (UTC). Cells have no common
            clock and a data frame no room for one: how long it took is known to simulations only.
    """

    cell: int
    seq: int
    hops: int
    port: int
    proximity: int
    force: tuple[int, int, int]
    temperature: int
    accel: tuple[int, int, int]
    time_us: int


class Command(NamedTuple):
    """What the PC sent down, as it comes in at a cell.

    Attributes:
        number: counts the PC's commands, modulo 65536.
        code: what to do, 0 to 255; its meaning is the user's.
        value: with what, 0 to 65535; its meaning is the user's.
        to_all: it is for every cell, not for this one alone.
        hops: cells that handed it down.
        time_us: when it came in by the cell's clock, us since 1970 (UTC).
    """

    number: int
    code: int
    value: int
    to_all: bool
    hops: int
    time_us: int


class Sent(NamedTuple):
    """A command that the PC sent: nobody acknowledges it.

    Attributes:
        number: counts the PC's commands, modulo 65536.
        ports: interface ports it left by; 0 = no cell was there to hand it down.
        checked: it is for all, or for a number that a cell may have by the PC's file, `nodes`.
    """

    number: int
    ports: int
    checked: bool = True


def put(item: Any, name: str, given: tuple[int, ...], called: str = "") -> None:
    """Set a field of a frame record; `called` is its name for the user, if it has another.

    Raises:
        ValueError: a value leaves its range.
    """
    length, low, high = RANGES[name]
    if len(given) != max(1, length) or not all(low <= v <= high for v in given):
        many = f"{length} numbers, " if length else ""
        raise ValueError(f"{called or name} must be {many}{low} to {high}")
    setattr(item, name, list(given) if length else given[0])
