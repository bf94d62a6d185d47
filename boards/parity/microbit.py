"""A small protocol on an emulated micro:bit: a Cortex-M0 with 16 KiB of RAM, in QEMU.

Its MicroPython (1.9.2) has no precompiled modules: every function is typed in on the serial line,
compiled there, and so is every call. What remains of the 16 KiB for programs are about 10,000
bytes.
"""

from __future__ import annotations

import os
import select
import shutil
import subprocess
import time
from ast import literal_eval
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import SimpleNamespace

from boards import join, records
from boards.errors import BoardFailed, BoardMissing
from boards.parity.record import HANDLERS, Transcript, flat, layout_of, names_of
from boards.parity.replay import SEND, START, TIMER, fold_out, fold_state
from innervate.live.board import Declaration, Emulated, Role

FIRMWARE = Path("/usr/share/firmware-microbit-micropython/firmware.hex")
QEMU = "qemu-system-arm"
LARGE = 12  # functions that need the most memory while they are compiled come first
PIECE = 32  # bytes at a time; the line has a buffer of 64
AT_ONCE = 7  # fields that a line asks for: a longer one does not compile
LIMIT_S = 20.0  # without a sign of life

INTERRUPT, PASTE, END = b"\x03", b"\x05", b"\x04"
PROMPT, MORE = b">>> ", b"=== "

ACTION = ("kind", "a", "b", "c")
ACTION_FIELDS = tuple((name, 0, 0, 0, "", "") for name in ACTION)
OUTBOX = ("count", "limit", "overflow", "action", "frame", *ACTION)


def look() -> None:
    """See whether there is a board to emulate.

    Raises:
        BoardMissing: QEMU or the firmware is not there.
    """
    if shutil.which(QEMU) is None or not FIRMWARE.exists():
        raise BoardMissing(
            f"{QEMU} or the micro:bit's firmware is missing; install them (Debian, Ubuntu: "
            "apt install qemu-system-arm firmware-microbit-micropython)"
        )


class Microbit:
    """An emulated board, and the terminal on its serial line.

    Raises:
        BoardMissing: see look().
    """

    def __init__(self) -> None:
        look()
        command = [QEMU, "-M", "microbit", "-device", f"loader,file={FIRMWARE}",
                   "-display", "none", "-monitor", "none", "-serial", "stdio"]  # fmt: skip
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )
        try:
            self._expect(PROMPT)
            self._type("import gc")
        except BoardFailed:
            self.stop()
            raise

    def __enter__(self) -> Microbit:
        return self

    def __exit__(self, *_error: object) -> None:
        self.stop()

    def stop(self) -> None:
        """Switch it off."""
        self._process.kill()
        self._process.communicate()

    def run(self, text: str, once: bool = False) -> str:
        """What a piece of Python prints.

        Left to itself, this interpreter gives up compiling while there is garbage to be collected;
        what does no harm when it is done twice is then typed again, all but `once`.

        Raises:
            BoardFailed: it ended with an exception, or the board says nothing any more.
        """
        if once:
            self.collect()
        said = self._type(text)
        if "MemoryError" in said and not once:
            self.collect()
            said = self._type(text)
        if "Error" in said:
            raise BoardFailed(f"{text[:60]!r}: {said}")
        return said

    def collect(self) -> None:
        """Collect garbage, so that all memory there is can be had in one go."""
        self._type("gc.collect()")

    def _type(self, text: str) -> str:
        """What a piece of Python prints."""
        self._send(PASTE)
        self._expect(MORE)
        for line in text.encode().splitlines():
            for at in range(0, len(line), PIECE):
                self._send(line[at : at + PIECE])
                self._expect(line[at : at + PIECE])
            self._send(b"\r")
            self._expect(MORE)
        self._send(END)
        return self._expect(PROMPT)[: -len(PROMPT)].decode("ascii", "replace").strip()

    def _send(self, data: bytes) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(data)
        self._process.stdin.flush()

    def _expect(self, end: bytes) -> bytes:
        """Everything up to these bytes."""
        assert self._process.stdout is not None
        heard = bytearray()
        until = time.monotonic() + LIMIT_S
        while not heard.endswith(end):
            left = until - time.monotonic()
            if left <= 0 or not select.select([self._process.stdout], [], [], left)[0]:
                raise BoardFailed(f"the board says nothing more after {bytes(heard[-80:])!r}")
            data = os.read(self._process.stdout.fileno(), 4096)
            if not data:
                raise BoardFailed("QEMU has ended")
            heard += data
        return bytes(heard)


class Names:
    """Short names: every name costs a board memory, in functions and in objects."""

    def __init__(self, role: Role, params: dict[str, int]) -> None:
        self.params = params
        declared = (name for fields in (role.state, role.frame) for name, *_ in fields)
        attributes = sorted({*declared, *OUTBOX})
        found, out = join.functions(role.entry, noted=role.noted), emulated(role).left_out
        self.functions = {name: found[name] for name in found if name not in out}
        inner = [name for name in self.functions if not name.startswith("on_")]
        self.short = {name: join.short(i) for i, name in enumerate(attributes)}
        self.short |= {name: join.short(i + 26) for i, name in enumerate(inner)}

    def sources(self) -> Iterator[str]:
        """The protocol's functions, callees first."""
        for source in self.functions.values():
            yield join.shortened(join.fixed(source, self.params), self.short)

    def of(self, record: str, fields: Iterable[str]) -> str:
        """Fields of a record, as a list of arguments."""
        return ",".join(f"{record}.{self.short[name]}" for name in fields)


def emulated(role: Role) -> Emulated:
    """What it has to know of a role that it can hold."""
    assert role.emulated is not None
    return role.emulated


def _fields(names: Names, record: str, declaration: Declaration) -> Iterator[str]:
    """Lines that give an object its fields."""
    for field in declaration:
        yield f"{record}.{names.short[field[0]]}={records.initial(field)}"


def _set_up(board: Microbit, role: Role, room: int, names: Names) -> None:
    """Type in the protocol and make the records; what is left is short."""
    board.run("import micropython\nfrom array import array\nmicropython.opt_level(3)")
    sources = sorted(names.sources(), key=len, reverse=True)
    for source in sources[:LARGE]:
        board.run(source, once=True)
    board.run("class R:pass")
    short = names.short
    sent = ("kind", *dict(role.kinds[emulated(role).repeated]))
    small = [field for field in role.frame if field[0] in sent]
    # Four frames are enough for four ports: those that a call sends stand next to each other. One
    # of another type is the only one of its call, and may be the one that has come in.
    frames = (("f", role.frame), ("g", small), ("j", small), ("k", small))
    for record, fields in (("c", role.state), *frames):
        for line in (f"{record}=R()", *_fields(names, record, fields)):
            board.run(line, once=True)
    for line in (
        "o=R()",
        f"o.{short['count']}=[0]",
        f"o.{short['limit']}=[{room}]",
        f"o.{short['overflow']}=[0]",
        f"o.{short['frame']}=[f,g,j,k]*{-(-room // 4)}",
        f"q=o.{short['action']}=[R() for _ in range({room})]",
    ):
        board.run(line, once=True)
    for source in sources[LARGE:]:
        board.run(source, once=True)


def play(transcript: Transcript, rows: int) -> list[tuple[int, int]]:
    """What came of the first calls of a transcript, as `Transcript.marks`.

    Every value of the state and of the outbox is read back after each call.

    Raises:
        BoardMissing, BoardFailed: see Microbit.
    """
    role = transcript.role
    names = Names(role, dict(zip(names_of(role.params), transcript.params, strict=True)))
    marks = []
    with Microbit() as board:
        _set_up(board, role, transcript.room, names)
        for row in transcript.calls[:rows]:
            _call(board, role, names, row)
            state = _read(board, names, "c", role.state)
            out = _read_out(board, role, names)
            kinds = {kind: flat(fields) for kind, fields in role.kinds.items()}
            marks.append((fold_state(state, names_of(role.state)), fold_out(out, kinds)))
    return marks


def _call(board: Microbit, role: Role, names: Names, row: list[int]) -> None:
    """Make a call of a transcript."""
    handler, now, *rest = row
    if handler == START:
        for k in range(1, 1 + 3 * rest[0], 3):
            name, i, value = names.short[role.state[rest[k]][0]], rest[k + 1], rest[k + 2]
            board.run(f"c.{name}{f'[{i}]' if i >= 0 else ''}={value}")
        given = f"{rest[-1]}"
    elif handler == TIMER:
        given = f"{rest[0]}"
    else:
        values = iter(rest[1:])
        lines = []
        for name, many in layout_of(role.frame, role.counted):
            place = f"f.{names.short[name]}"
            if many:
                lines += [f"{place}[{i}]={next(values)}" for i in range(many)]
            else:
                lines.append(f"{place}={next(values)}")
        repeated = emulated(role).repeated
        used = 1 + len(role.kinds[repeated]) if rest[1] == repeated else len(lines)
        for at in range(0, used, AT_ONCE):
            board.run(";".join(lines[at : min(at + AT_ONCE, used)]))
        given = f"{rest[0]},f"
    board.run(f"{list(HANDLERS)[handler]}(c,0,{now},{given},o)", once=True)


def _read(board: Microbit, names: Names, record: str, fields: Declaration) -> SimpleNamespace:
    """A record's fields; a few at a time, as a long line needs memory."""
    found = SimpleNamespace()
    for at in range(0, len(fields), AT_ONCE):
        part = fields[at : at + AT_ONCE]
        values = [f"{record}.{names.short[name]}" for name, *_ in part]
        asked = [f"list({v})" if f[1] else v for v, f in zip(values, part, strict=True)]
        said = literal_eval(board.run(f"print(({','.join(asked)},))"))
        for field, value in zip(part, said, strict=True):
            setattr(found, field[0], value)
    return found


def _read_out(board: Microbit, role: Role, names: Names) -> SimpleNamespace:
    """The outbox, which is emptied."""
    short = names.short
    count = literal_eval(board.run(f"print(o.{short['count']}[0])"))
    action, frame = [], []
    for i in range(count):
        board.run(f"a=q[{i}]")
        action.append(_read(board, names, "a", ACTION_FIELDS))
        frame.append(None)
        if action[i].kind == SEND:
            board.run(f"a=o.{short['frame']}[{i}]")
            kind = _read(board, names, "a", [role.frame[0]]).kind
            sent = [field for field in role.frame if field[0] in dict(role.kinds[kind])]
            frame[i] = _read(board, names, "a", sent)
            frame[i].kind = kind
    overflow = literal_eval(board.run(f"print(o.{short['overflow']}[0])"))
    board.run(f"o.{short['count']}[0]=0")
    return SimpleNamespace(count=[count], overflow=[overflow], action=action, frame=frame)
