"""Keys of scenarios: limits with the words for them, and keys that scenarios of all networks have.

A key's `description` completes the sentence "<key> must be ..." in error messages and stands in
the published JSON Schema. It is made of the limits here; that of flags, tables and choices
is made of the type (see explain.py).
"""

from typing import Annotated

from msgspec import Meta, Struct

SCHEMA = 1


def whole(of: str, least: int, most: int | None = None, *, limit: int | None = None) -> Meta:
    """Limits of a whole number: "a whole number of hops, 1 to 254", "a whole number from 0".

    Args:
        of: its unit, "" = none.
        least: the least.
        most: the most, as everybody is told.
        limit: the most where only somebody who passes it is told.
    """
    return _limits("a whole number", of, least, most, limit)


def number(of: str, least: float, most: float | None = None, *, limit: float | None = None) -> Meta:
    """Limits of a number, as `whole`: "a number of dB, 0 to 30", "a number of seconds from 0"."""
    return _limits("a number", of, least, most, limit)


def above_0(of: str, most: float | None = None, *, limit: float | None = None) -> Meta:
    """Limits of a number that is not 0: "a number of metres > 0", "... > 0, at most 268"."""
    told = "" if most is None else f", at most {most}"
    words = f"a number of {of} > 0{told}"
    return Meta(gt=0, le=limit if most is None else most, description=words)


def _limits(noun: str, of: str, least: float, most: float | None, limit: float | None) -> Meta:
    unit = f" of {of}" if of else ""
    span = f" from {least}" if most is None else f", {least} to {most}"
    words = f"{noun}{unit}{span}"
    return Meta(ge=least, le=limit if most is None else most, description=words)


class Table(Struct, frozen=True, forbid_unknown_fields=True):
    """A table of a scenario; keys that it does not know are refused."""


Schema = Annotated[int, whole("", 1)]
Name = Annotated[str, Meta(max_length=200, description="a string of at most 200 characters")]
Seed = Annotated[int, whole("", 0)]
Micros = Annotated[int, whole("microseconds", 0, 1_000_000)]
# What an event is, rules check: msgspec 0.22 crashes on limits in a union with a tuple.
When = Annotated[
    float | tuple[float, float],
    Meta(description="a number of seconds from 0, or a range [from, to]"),
]


class Scenario(Table, frozen=True, kw_only=True):
    """The keys that scenarios of all kinds begin with; how long a run lasts each says itself."""

    kind: str
    schema: Schema = SCHEMA
    name: Name = ""
    duration_s: float
    seed: Seed = 1
