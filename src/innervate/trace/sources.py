"""A hash of the sources that results depend on: results of other sources are not mixed in."""

import hashlib
from functools import cache
from pathlib import Path

# Rooms whose sources decide what a simulation gives.
ROOMS = ("dialect", "kernel", "sim", "topology", "trace", "scenario", "analysis", "networks")


@cache
def stamp(*more: str) -> str:
    """Hash of all sources that results depend on, and of those of `more` rooms."""
    root = Path(__file__).resolve().parent.parent
    digest = hashlib.blake2b(digest_size=8)
    files = [path for room in (*ROOMS, *more) for path in (root / room).rglob("*")]
    for path in sorted(path for path in files if path.suffix in (".py", ".toml")):
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()
