"""Files and folders that are nobody else's: keys, what nodes keep, captures, sockets."""

import os
import stat
from pathlib import Path
from typing import BinaryIO

from innervate.live.errors import LiveError

FILE = 0o600
FOLDER = 0o700
OTHERS_READ = stat.S_IRGRP | stat.S_IROTH
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


def create(path: Path) -> BinaryIO:
    """A file to be written, empty, that only its owner can read, also if others could before.

    Raises:
        OSError: it cannot be made.
    """
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, FILE)
    file = os.fdopen(descriptor, "wb")
    if stat.S_ISREG(os.fstat(descriptor).st_mode):  # not a pipe, nor a device
        os.fchmod(descriptor, FILE)
    return file


def write(path: Path, text: str) -> None:
    """Write a file that only its owner can read; OSError if it cannot be written."""
    with create(path) as file:
        file.write(text.encode())


def is_open(path: Path) -> bool:
    """True if other users can read a file."""
    try:
        return bool(path.stat().st_mode & OTHERS_READ)
    except OSError:
        return False


def checked(path: Path) -> Path:
    """A folder that no other user can have made, or may change; it need not be there yet.

    Raises:
        LiveError: it is not ours alone.
    """
    try:
        found = path.lstat()
    except FileNotFoundError:
        return path
    except OSError as error:
        raise LiveError(f"{path}: cannot be looked at: {error.strerror}") from None
    ours = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
    if not ours or found.st_mode & OTHERS_WRITE:
        raise LiveError(
            f"{path}: this folder is not ours alone; remove it, or name another in INNERVATE_RUN"
        )
    return path
