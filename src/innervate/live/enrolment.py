"""The authority of a network: a folder in which nodes are enrolled, and put out again."""

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from innervate.live import identity as identities
from innervate.live import plain, private
from innervate.live.errors import LiveError
from innervate.live.identity import REVOKED_MAX, Revoked
from innervate.live.machine import machine

try:
    import fcntl
except ImportError:  # Windows: nobody enrols two nodes at once there
    fcntl = None  # type: ignore[assignment]

AUTHORITY = "authority.key"
LIST = "revoked.list"
NUMBER_MAX = 65_534
SERIAL_MAX = 2**32 - 2  # the next one is a number of 32 bits, too
NONE = "not an authority's file; name another folder"


class Authority:
    """Who says which node is which: keeps its key, and what was given to whom.

    Args:
        folder: of its files; made with a new authority if it is not there.

    Attributes:
        issued: (number, serial) of every identity.
        revoked: serials that are put out.
        version: of their list; 0 = there is none.

    Raises:
        LiveError: the folder holds something else, or cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._path = folder / AUTHORITY
        self._key, self._shared = (machine().chance.randbytes(32) for _ in range(2))
        self.issued: list[tuple[int, int]] = []
        self.revoked: set[int] = set()
        self.version = 0
        self._kept = ""  # the text of the authority's file, as it was read or written last
        if self._path.exists():
            self._read()
        else:
            self._check_new()

    def _check_new(self) -> None:
        """Nodes that another key enrolled would not know those of a new one."""
        if self.folder.exists() and not self.folder.is_dir():
            raise LiveError(f"{self.folder}: a file lies here; name a folder")
        if left := sorted(path.name for path in self.folder.glob("*.identity")):
            raise LiveError(
                f"{self.folder}: holds {left[0]}, and no {AUTHORITY}; put that back, or enrol all "
                "nodes anew in another folder"
            )

    def _read(self) -> None:
        text = plain.text(self._path, NONE)
        try:
            raw = plain.read(text)
            self._key, self._shared = (plain.octets(raw, name, 32) for name in ("key", "shared"))
            pairs = enumerate(plain.listed(raw, "issued"))
            self.issued = [_issued(pair, f"issued.{i}") for i, pair in pairs]
            revoked = plain.listed(raw, "revoked")
            self.revoked = {
                plain.whole(revoked, i, SERIAL_MAX, "revoked") for i in range(len(revoked))
            }
            self.version = plain.whole(raw, "version", SERIAL_MAX)
            self._kept = text
        except ValueError as error:
            raise LiveError(f"{self._path}: {error}; {NONE}") from None

    def check(self, number: int) -> None:
        """That a node can have the number.

        Raises:
            LiveError: it is none, or a node that was not put out has it.
        """
        if not 0 <= number <= NUMBER_MAX:
            raise LiveError(f"numbers of nodes are 0 to {NUMBER_MAX}, not {number}")
        if any(one == number and serial not in self.revoked for one, serial in self.issued):
            raise LiveError(
                f"node {number} is enrolled already; put it out first: "
                f"innervate live revoke {self.folder} {number}"
            )

    def enrol(self, number: int) -> Path:
        """Make the identity of a node; its file.

        Raises:
            LiveError: the number is none, or a node that was not put out has it.
        """
        self.check(number)
        path = self.folder / f"n{number}.identity"
        with self._alone():
            self.check(number)
            serial = 1 + max((one for _number, one in self.issued), default=0)
            self.issued.append((number, serial))
            made = identities.enrol(self._key, number, serial, self._shared)
            self._keep()
            self._write(path, made.text())
        return path

    def revoke(self, numbers: list[int]) -> Revoked:
        """Put nodes out; the list that all are to be told of.

        Raises:
            LiveError: one was never enrolled, or they are too many.
        """
        with self._alone():
            for number in numbers:
                found = [serial for one, serial in self.issued if one == number]
                if not found:
                    raise LiveError(f"node {number} was never enrolled in {self.folder}")
                self.revoked.update(found)
            if len(self.revoked) > REVOKED_MAX:
                raise LiveError(
                    f"{len(self.revoked)} are put out, and a list holds {REVOKED_MAX}; enrol all "
                    "others in another folder"
                )
            self.version += 1
            made = identities.revoke(self._key, self.version, frozenset(self.revoked))
            self._keep()
            self._write(self.folder / LIST, made.data.hex() + "\n")
        return made

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Nobody else changes the files meanwhile; what somebody has changed is read first."""
        held = None
        try:
            self.folder.mkdir(mode=private.FOLDER, parents=True, exist_ok=True)
            if fcntl is not None:
                held = os.open(self.folder, os.O_RDONLY)
                with suppress(OSError):  # not every file system locks folders: NFS does not
                    fcntl.flock(held, fcntl.LOCK_EX)
            if self._path.exists() and self._path.read_bytes() != self._kept.encode():
                self._read()
            yield
        except OSError as error:
            raise LiveError(f"{self._path}: cannot be written: {error.strerror}") from None
        finally:
            if held is not None:
                os.close(held)

    def _keep(self) -> None:
        kept: dict[str, Any] = {
            "key": self._key.hex(), "shared": self._shared.hex(),
            "issued": [list(one) for one in self.issued],
            "revoked": sorted(self.revoked), "version": self.version,
        }  # fmt: skip
        head = "# Whoever has this file can enrol nodes: keep it off all of them.\n"
        self._kept = head + "".join(f"{key} = {json.dumps(value)}\n" for key, value in kept.items())
        self._write(self._path, self._kept)

    def _write(self, path: Path, text: str) -> None:
        new = path.with_name(path.name + ".new")
        try:
            with machine().create(new) as file:
                file.write(text)
                machine().sync(file)
            machine().replace(new, path)
        except OSError as error:
            raise LiveError(f"{path}: cannot be written: {error.strerror}") from None


def _issued(pair: Any, name: str) -> tuple[int, int]:
    """Number and serial of an identity."""
    if not isinstance(pair, list) or len(pair) != 2:
        raise ValueError(f"{name}: a number and a serial are to stand there")
    return plain.whole(pair, 0, NUMBER_MAX, name), plain.whole(pair, 1, SERIAL_MAX, name)


def read_list(path: Path) -> bytes:
    """A list of nodes that are put out, from its file.

    Raises:
        LiveError: it cannot be read, or is none.
    """
    try:
        data = bytes.fromhex(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise LiveError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError:
        data = b""
    if not data:
        raise LiveError(f"{path}: not a list of nodes that are put out")
    return data
