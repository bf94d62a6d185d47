"""A live node's protocol and coder in C, in the place of Python's: same calls, same records.

Records lie in C's memory and are seen from Python where they are, so that status, taps and whatever
else reads a node's state does so as ever.
"""

import ctypes
from collections.abc import Iterator
from pkgutil import resolve_name
from typing import Any

from innervate.firmware import compiled, views
from innervate.firmware.errors import FirmwareError
from innervate.firmware.program import GIVEN
from innervate.firmware.records import name_of, records_of
from innervate.firmware.wire import coded_of, names_of
from innervate.live.board import Coded, Role, roles_of
from innervate.network import Network


class Handlers:
    """The handlers of a role in C, called as those of its module are, with records of C's memory.

    Attributes:
        Item: a record for what a user hands down; any other object with its fields is copied.
    """

    def __init__(self, library: Any, role: Role, item: views.Fields) -> None:
        self.__name__ = role.entry
        self.Item = views.struct_of(item)
        pointers = {"frame": lambda frame: frame.ref, "item": self._pointer_of}
        call, call_with = (_gated, _gated_with) if role.has_gate else (_plain, _plain_with)
        for name in compiled.handlers_of(role):
            entry = getattr(library, f"innervate_{name}")
            entry.restype = None
            _, *more = GIVEN[name]
            made = call_with(entry, pointers.get(more[0], int)) if more else call(entry)
            setattr(self, name, made)
        self._fields, self._given = list(item.values()), self.Item()

    def _pointer_of(self, item: Any) -> Any:
        if type(item) is not self.Item:
            views.copy(self._fields, item, self._given)
            item = self._given
        return ctypes.byref(item)


# With their arguments by name: unpacked ones take twice as long.
def _plain(call: Any) -> Any:
    return lambda node, params, now, what, out: call(node.ref, params.ref, now, what, out.ref)


def _plain_with(call: Any, pointer: Any) -> Any:
    return lambda node, params, now, what, given, out: call(
        node.ref, params.ref, now, what, pointer(given), out.ref
    )


def _gated(call: Any) -> Any:
    return lambda node, gate, params, now, what, out: call(
        node.ref, gate and gate.ref, params.ref, now, what, out.ref
    )


def _gated_with(call: Any, pointer: Any) -> Any:
    return lambda node, gate, params, now, what, given, out: call(
        node.ref, gate and gate.ref, params.ref, now, what, pointer(given), out.ref
    )


class Coder:
    """A role's coder in C; `name` is what the role is called there."""

    def __init__(self, library: Any, name: str, coded: Coded) -> None:
        self._names = names_of(coded)
        self._encode = getattr(library, f"{name}_encode")
        self._decode = getattr(library, f"{name}_decode")
        self._data = ctypes.create_string_buffer(coded.size_max)
        self._seen = memoryview(self._data).cast("B")

    def encode(self, frame: Any) -> bytes:
        """The bytes of a frame.

        Raises:
            ValueError: the kind is none of ours, or a value does not fit; the caller's mistake.
        """
        size = self._encode(frame.ref, self._data)
        if size < 0:
            raise ValueError(f"{self._names[-1 - size]} does not fit into its bits")
        if not size:
            raise ValueError("no frame has this kind")
        return bytes(self._seen[:size])

    def decode(self, data: bytes, frame: Any) -> int:
        """Read bytes into a frame; 0, or why not, with the frame as it was."""
        found: int = self._decode(bytes(data), len(data), frame.ref)
        return found

    def read(self, data: bytes, frame: Any) -> Iterator[int]:
        """As networks do that may have several frames in the same bytes; here there is one."""
        return iter((self.decode(data, frame),))


def take_place(stack: Any, network: Network) -> str:
    """Let a network's stack, not yet started, call C from now on; "" if it does, else why not.

    It has `do`, `node`, `params`, `inbox`, `out`, and perhaps `gate`, `coder`, `item`.
    """
    found = _role_of(stack, network)
    if found is None:
        return "there is no C of what it runs"
    role, coded = found
    records = records_of(role)
    out = views.Outbox(records["frame"], records["action"], role.room)
    try:
        library = compiled.library_of(role, coded)
        _check(library, records, out)
    except FirmwareError as error:
        return str(error)
    stack.out = out
    for name, record in (("node", "state"), ("gate", "gate"), ("params", "params"),
                         ("inbox", "frame")):  # fmt: skip
        if record in records and getattr(stack, name, None) is not None:
            view = views.ready(views.kept_of(records[record])())
            views.copy(records[record].values(), getattr(stack, name), view)
            setattr(stack, name, view)
    stack.do = Handlers(library, role, records.get("item", records["frame"]))
    if isinstance(getattr(stack, "item", None), type):
        stack.item = stack.do.Item
    if coded is not None:
        stack.coder = Coder(library, name_of(role.name), coded)
    return ""


def _role_of(stack: Any, network: Network) -> tuple[Role, Coded | None] | None:
    """What a stack runs, with arrays and outbox as it has them, and its frames' coder in C."""
    entry = getattr(getattr(stack, "do", None), "__name__", "")
    role = next((one for one in roles_of(network) if one.entry == entry), None)
    if role is None or not role.frame:
        return None
    if role.live:
        role = resolve_name(role.live)(stack.params)
    # Of those that say themselves what runs on boards it is shown that they stay in their ranges.
    wide = not network.has("boards")
    role = role._replace(room=stack.out.limit[0], frames=0, frame_bytes=0, wide=wide)
    if network.has("packets"):
        return role, None  # its live nodes say their frames in another way
    coded = coded_of(role, network)
    if coded is not None and any(form.has_payload for form in coded.forms):
        return role, None
    return role, coded


def _check(library: Any, records: dict[str, views.Fields], out: views.Outbox) -> None:
    """Python and C lay their records out alike."""
    structs = [*map(views.struct_of, records.values()), out.struct]
    sizes = (ctypes.c_int32 * len(structs)).in_dll(library, "innervate_sizes")
    if list(sizes) != list(map(ctypes.sizeof, structs)):
        raise FirmwareError("this compiler lays structs out in another way than Python expects")
