"""Files are there whole or not at all: written beside their place, and moved there at the end."""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from innervate.export.errors import ExportError


@contextmanager
def whole(path: Path) -> Iterator[BinaryIO]:
    """A binary file that takes the place of `path` when all went well, and goes if not.

    Raises:
        ExportError: it cannot be written.
    """
    with beside(path) as fresh, fresh.open("wb") as file:
        yield file


@contextmanager
def beside(path: Path) -> Iterator[Path]:
    """An empty file for others to write, which takes the place of `path` as whole() says.

    Raises:
        ExportError: it cannot be written.
    """
    fresh: Path | None = None
    try:
        if path.is_dir():
            raise ExportError(f"{path} is a folder; name a file")
        place = path.with_name(f".{path.name[:40]}-{secrets.token_hex(4)}")
        place.touch(exist_ok=False)
        fresh = place
        yield fresh
        fresh.replace(path)
    except OSError as error:
        why = error.strerror or type(error).__name__
        raise ExportError(f"{path} cannot be written: {why}; choose another place") from None
    finally:
        if fresh is not None:
            with suppress(OSError):
                fresh.unlink()


def write_text(path: Path, text: str) -> None:
    """Write a text file, whole or not at all.

    Raises:
        ExportError: it cannot be written.
    """
    with whole(path) as file:
        file.write(text.encode())


def check_folder(path: Path) -> None:
    """See that a folder is there, or can be made, before long work whose files come into it.

    Raises:
        ExportError: it cannot.
    """
    try:
        there = next((one for one in (path, *path.parents) if one.exists()), path)
        why = "" if there.is_dir() else f"{there} is no folder"
        if not why and not os.access(there, os.W_OK | os.X_OK):
            why = "no permission"
    except OSError as error:  # even to look
        why = error.strerror or str(error)
    if why:
        raise ExportError(f"{path} cannot be written: {why}; choose another place")


def make_folder(path: Path) -> None:
    """Make a folder to write into, and those above it, if they are not there.

    Raises:
        ExportError: it cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        why = error.strerror or type(error).__name__
        raise ExportError(f"{path} cannot be written: {why}; choose another place") from None
