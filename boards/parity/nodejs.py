"""A node on MicroPython under Node.js, in a heap of 16 KiB that cannot grow."""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from boards import join, records
from boards.compile import mpy
from boards.errors import BoardFailed, BoardMissing
from boards.parity import replay
from boards.parity.record import Transcript, flat, layout_of, names_of
from innervate.live.board import Role

HERE = Path(__file__).resolve().parent
BOARD = HERE.parent / "micropython"
HARNESS = (BOARD / "outbox.py", HERE / "replay.py", HERE / "board.py")
PACKAGE = "node_modules/@micropython/micropython-webassembly-pyscript"
CAP = 16_384
ROM = 262_144  # besides, where code counts as flash
LIMIT_S = 120  # out of memory, it can hang
FILL = [f"=filling.fill:{size}" for size in (8192, 1024, 128, 32, 1)]


@dataclass
class Played:
    """What came of a transcript.

    Attributes:
        marks: (hash of the state, hash of the outbox) after each call.
        flash: bytes of the protocol's .mpy file.
        code: bytes of the heap that it takes as loaded.
        state: bytes of the heap that the node's state takes.
        node: state, parameters and empty outbox.
        most: the most of the 16 KiB that was in use, what is around the node included.
        left: what could still be had at the end, in small pieces, until MemoryError.
    """

    marks: list[tuple[int, int]]
    flash: int
    code: int
    state: int
    node: int
    most: int
    left: int


def home() -> Path:
    """Where the interpreter is; installed with npm into the cache folder if it is not.

    Raises:
        BoardMissing: Node.js or npm is not there, or npm could not get it.
    """
    if shutil.which("node") is None:
        raise BoardMissing("Node.js is missing; install it (Debian, Ubuntu: apt install nodejs)")
    cache = os.environ.get("INNERVATE_CACHE") or os.environ.get("XDG_CACHE_HOME")
    lock = (HERE / "package-lock.json").read_bytes()
    mark = hashlib.blake2b(lock, digest_size=4).hexdigest()
    folder = Path(cache or Path.home() / ".cache") / f"innervate-micropython-{mark}"
    if not folder.exists():
        _install(folder)
    return folder / PACKAGE


def _install(folder: Path) -> None:
    """Install beside it and move it there whole: several may want it at the same time."""
    if shutil.which("npm") is None:
        raise BoardMissing("npm is missing; install it (Debian, Ubuntu: apt install npm)")
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix="npm-") as beside:
        made = Path(beside, "made")
        made.mkdir()
        for name in ("package.json", "package-lock.json"):
            shutil.copy(HERE / name, made / name)
        command = ["npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts"]
        done = subprocess.run(command, cwd=made, capture_output=True, text=True, check=False)
        if done.returncode:
            said = [line for line in done.stderr.splitlines() if line.startswith("npm err")]
            why = said[0] if said else "npm failed"
            raise BoardMissing(f"MicroPython could not be installed with npm: {why}")
        with contextlib.suppress(OSError):  # somebody else was faster
            made.rename(folder)


def files_of(role: Role, params: dict[str, int] | None = None) -> dict[str, bytes]:
    """What a node of this role needs, as files.

    With `params` it is made for these, as a maker's cell is: it has no record of them.
    """
    node = join.joined(role.entry, noted=role.noted)
    role = role if params is None else role._replace(params=())
    sources = {
        "node": node if params is None else join.fixed(node, params),
        "records": records_of(role),
        "layouts": layouts_of(role),
        "board": join.one_text(*(path.read_text() for path in HARNESS)),
        "filling": (HERE / "filling.py").read_text(),
    }
    return {f"{name}.mpy": mpy(source, name) for name, source in sources.items()}


def records_of(role: Role) -> str:
    """The module of a role's record classes."""
    classes = {"State": role.state, "Params": role.params, "Frame": role.frame}
    if role.item is not role.frame:
        classes["Item"] = role.item
    return records.module_source(**classes)


def layouts_of(role: Role) -> str:
    """The module that says what a role's transcripts consist of."""
    item = repr(flat(layout_of(role.item, role.counted)))
    lines = [
        f"NAMES = {tuple(names_of(role.state))!r}",
        f"PARAMS = {flat((name, many) for name, many, *_ in role.params)!r}",
        f"HEARD = {flat(layout_of(role.frame, role.counted))!r}",
        f"GIVEN = {'HEARD' if role.item is role.frame else item}",
        f"KINDS = { {kind: flat(fields) for kind, fields in role.kinds.items()}!r}",
    ]
    return "\n".join([*lines, f"HAS_GATE = {role.has_gate}", f"ROOM = {role.room}"]) + "\n"


def encoded(number: int) -> bytes:
    """A number as `replay.reader` reads it."""
    value = number << 1 if number >= 0 else (-1 - number) << 1 | 1
    out = bytearray()
    while True:
        value, low = value >> 5, value & 31
        out.append(64 + low + (32 if value else 0))
        if not value:
            return bytes(out)


def script_of(transcript: Transcript, with_params: bool = True) -> bytes:
    """Parameters and calls, as `board.play` reads them."""
    params = transcript.params if with_params else []
    numbers = [*params, *(word for row in transcript.calls for word in row), replay.END]
    return b"".join(map(encoded, numbers))


def write(folder: Path, files: dict[str, bytes]) -> None:
    """Put files, some of them perhaps in subfolders, into a folder."""
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


def run(files: dict[str, bytes], heap: int, *scripts: str, limit_s: float = LIMIT_S) -> str:
    """What scripts print, with these files and that heap.

    Raises:
        BoardMissing: see home().
        BoardFailed: an exception, or it took too long.
    """
    package = home()
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder), files)
        command = ["node", HERE / "run.mjs", package, str(heap), folder, *scripts]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, check=False, timeout=limit_s
            )
        except subprocess.TimeoutExpired:
            raise BoardFailed(f"no end after {limit_s:.0f} s; out of memory it can hang") from None
    if done.returncode:
        raise BoardFailed((done.stdout + done.stderr).strip()[-600:])
    return done.stdout


def play(transcript: Transcript) -> Played:
    """Play a transcript on MicroPython.

    Raises:
        BoardMissing, BoardFailed: see run().
    """
    role = transcript.role
    names = [name for name, *_ in role.params]
    params = dict(zip(names, transcript.params, strict=True)) if role.in_ram else None
    script = script_of(transcript, with_params=params is None)
    files = {**files_of(role, params), "transcript": script}
    cap = ["=filling.reserve:16384", *FILL, "=filling.give_back"]
    scripts = [
        "import board", "=board.used", "import node", "=board.used",
        "import layouts, records", *([] if role.in_ram else cap), "=board.used",
        "=board.add_state", "=board.used", "=board.add_rest", "=board.used",
        "=board.open_transcript", "*board.step", "=board.most", "=board.left",
    ]  # fmt: skip
    heap = CAP if role.in_ram else CAP + ROM
    found = [line.split() for line in run(files, heap, *scripts).splitlines()]
    base, code, rest, state, node = (int(b) for a, b in found if a == "used")
    most, left = (int(b) for a, b in found if a in ("most", "left"))
    return Played(
        [(int(a), int(b)) for a, b in found if a.isdigit()],
        len(files["node.mpy"]),
        code - base,
        state - rest,
        node - rest,
        most if role.in_ram else most - rest,
        left,
    )
