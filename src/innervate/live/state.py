"""What a node keeps on disk over a restart: the epoch that it has seen, who was put out."""

import errno
import json
from contextlib import suppress
from pathlib import Path
from typing import Any

from innervate.live.errors import LiveError
from innervate.live.machine import machine

# A file that can never be written there, whatever the disk does.
MISPLACED = (errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.EACCES, errno.EPERM, errno.ELOOP)


class State:
    """A file that is replaced as a whole, so that a power cut leaves the old or the new one.

    A node whose disk is full goes on without it: `write` says so here and raises nothing.

    Args:
        path: the file; None = nothing is kept.

    Attributes:
        fresh: True if there was no such file: the node runs for the first time.
        epoch: newest epoch of a gateway that was followed; 0 = none.
        revoked: the newest list of identities that are put out, signed; b"" = none.
        numbers: our packets may bear numbers from here on; -1 = nothing is known of any.
        trouble: why it could not be written, "" = it was when tried last.
        failed: how often it could not be written.
    """

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self.fresh = True
        self.epoch = 0
        self.revoked = b""
        self.numbers = -1
        self.trouble = ""
        self.failed = 0
        self._errno = 0
        self._written_at: int | None = None
        self._is_aside = False  # a file is there whose numbers are not to be gone by
        self._has_numbers = False  # the file has some
        if path is None:
            return
        aside = _aside(path)
        try:
            self._is_aside = machine().exists(aside)
            is_there = machine().exists(path)
        except OSError as error:
            raise LiveError(f"{path}: cannot be looked at: {error.strerror}") from None
        if is_there:
            self._read(path)
            self._has_numbers = self.numbers >= 0
        elif self._is_aside:
            self._read(aside)
            self.numbers = -1

    def _read(self, path: Path) -> None:
        try:
            kept = json.loads(machine().read_text(path))
            self.epoch = _whole(kept["epoch"], 255)
            self.revoked = bytes.fromhex(kept.get("revoked", ""))
            self.numbers = _whole(kept.get("numbers", -1), 65_535, -1)
        except IsADirectoryError:
            raise LiveError(f"{path}: is a folder, and no node's state; name a file") from None
        except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise LiveError(f"{path}: not a node's state; remove it") from None
        self.fresh = False

    def write(self) -> bool:
        """Write the file; False if it could not be, with the reason in `trouble`."""
        if self.path is None:
            return True
        kept = {"epoch": self.epoch, "numbers": self.numbers, "revoked": self.revoked.hex()}
        new = self.path.with_name(self.path.name + ".new")
        try:
            with machine().create(new) as file:
                file.write(json.dumps(kept))
                machine().sync(file)
            machine().replace(new, self.path)
        except OSError as error:
            with suppress(OSError):
                machine().remove(new)
            self.trouble, self._errno = error.strerror or str(error), error.errno or 0
            self.failed += 1
            return False
        self.trouble, self._written_at = "", machine().monotonic_ns()
        self._has_numbers = self.numbers >= 0
        if self._is_aside:
            self._is_aside = False
            with suppress(OSError):
                machine().remove(_aside(self.path))
        return True

    def set_aside(self) -> None:
        """Rename the file that could not be written: packets go on behind the numbers in it.

        The next life takes all else from it, and draws its numbers. A name can be changed on most
        disks that are full; numbers that come again would be taken for packets of this life.
        """
        if self.path is not None and self._has_numbers:
            with suppress(OSError):
                machine().replace(self.path, _aside(self.path))
                self._is_aside, self._has_numbers = True, False

    def check_place(self) -> None:
        """Refuse a file that could not be written where it is; a full disk is no such reason.

        Raises:
            LiveError: there is no such folder, or it is not ours.
        """
        if self.trouble and self._errno in MISPLACED:
            raise LiveError(f"{self.path}: cannot be written: {self.trouble}")

    def status(self) -> dict[str, Any] | None:
        """The file, when it was written last (s ago; None = not by us), and what is the matter."""
        if self.path is None:
            return None
        ago = None
        if self._written_at is not None:
            ago = round((machine().monotonic_ns() - self._written_at) / 1e9, 1)
        return {"file": str(self.path), "written_s": ago, "trouble": self.trouble}


def _aside(path: Path) -> Path:
    return Path(f"{path}.old")


def _whole(value: Any, most: int, least: int = 0) -> int:
    if type(value) is not int or not least <= value <= most:
        raise ValueError(f"{value} is no number from {least} to {most}")
    return value
