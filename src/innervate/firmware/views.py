"""A role's records in the memory of C, read and written like those of `dialect.plain`."""

import ctypes
from collections.abc import Iterable
from operator import attrgetter
from typing import Any

from innervate.firmware.records import TYPES, Field, initial

NUMBERS = {name: getattr(ctypes, f"c_{name.removesuffix('_t')}") for name in TYPES}
Fields = dict[str, Field]


def struct_of(fields: Fields) -> Any:
    """The class of a record that lives for a moment, as what a user hands down does."""
    members = [
        (field.name, NUMBERS[field.type] * field.length if field.length else NUMBERS[field.type])
        for field in fields.values()
    ]
    return type("Record", (ctypes.Structure,), {"_fields_": members})


class Kept(ctypes.Structure):
    """A record that stays: its arrays are looked up once."""

    arrays: tuple[str, ...] = ()
    ref: Any  # a pointer to it, for calls


def kept_of(fields: Fields) -> type[Kept]:
    """The class of a record that stays; `ready` has to be called on each of its instances."""
    members: list[tuple[str, Any]] = []
    own: dict[str, Any] = {}
    arrays = tuple(field.name for field in fields.values() if field.length)
    for field in fields.values():
        if field.length:
            members.append((f"_in_{field.name}", NUMBERS[field.type] * field.length))
            own[field.name] = property(attrgetter(f"_of_{field.name}"))
        else:
            members.append((field.name, NUMBERS[field.type]))
    return type("Kept", (Kept,), {"_fields_": members, "arrays": arrays, **own})


def ready(record: Any) -> Any:
    """A record that stays, with its arrays at hand."""
    for name in record.arrays:
        setattr(record, f"_of_{name}", getattr(record, f"_in_{name}"))
    record.ref = ctypes.byref(record)
    return record


def copy(fields: Iterable[Field], source: Any, target: Any) -> None:
    """Set all fields of a record to what another's are; those that it lacks begin anew."""
    for field in fields:
        value = getattr(source, field.name, None)
        if field.length:
            filled = value if value is not None else [initial(field)] * field.length
            getattr(target, field.name)[: field.length] = list(filled)
        else:
            setattr(target, field.name, initial(field) if value is None else value)


class Outbox:
    """The outbox of a role in C, as `dialect.plain.Outbox` in Python; one frame an action."""

    def __init__(self, frame: Fields, action: Fields, room: int) -> None:
        one = kept_of(frame)
        byte = ctypes.c_uint8
        self.struct = type("Out", (ctypes.Structure,), {"_fields_": [
            ("count", byte * 1), ("overflow", byte * 1), ("frames", byte), ("place", byte * room),
            ("frame", one * room), ("action", struct_of(action) * room),
        ]})  # fmt: skip
        memory = self.struct()
        self.ref = ctypes.byref(memory)
        self.count, self.overflow = memory.count, memory.overflow
        self.limit = [room]
        self.action = list(memory.action)
        self.frame = _Frames(memory.place, [ready(one()), *map(ready, memory.frame)])


class _Frames:
    """Frames by the action that they belong to; a blank one where a handler asked for none."""

    def __init__(self, place: Any, frames: list[Any]) -> None:
        self._place, self._frames = place, frames

    def __getitem__(self, action: int) -> Any:
        return self._frames[self._place[action]]
