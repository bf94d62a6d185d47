"""Proofs that were done are not done again: what holds is noted, by all that it rests on.

The name of a note is a hash of the functions that were turned into formulas, of every source file
that has a part in that, of Python's version and of the solver's. Only what holds is noted: what is
refuted is refuted anew each time. INNERVATE_CACHE says where notes lie.
"""

import ast
import contextlib
import hashlib
import sys
from collections.abc import Callable, Iterable, Iterator
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from innervate.dialect.source import Function
from innervate.kernel.cache import alone, cache_root

ROOT = Path(__file__).resolve().parent.parent
ROOMS = ("dialect", "prove")
NOTES_MAX = 64


def sources(*parts: Path) -> list[Path]:
    """The files that have a part in a proof: what proves, and a network's folders and files."""
    homes = (*(ROOT / room for room in ROOMS), *parts)
    return sorted(path for home in homes
                  for path in ([home] if home.is_file() else home.rglob("*.py")))  # fmt: skip


def name_of(claim: str, known: dict[str, Function], files: Iterable[Path]) -> str:
    """The hash of a claim and all that its proof rests on."""
    digest = hashlib.blake2b(digest_size=20)
    for part in _parts(claim, known, files):
        digest.update(len(part).to_bytes(8, "little"))
        digest.update(part)
    return digest.hexdigest()


def _parts(claim: str, known: dict[str, Function], files: Iterable[Path]) -> Iterator[bytes]:
    yield claim.encode()
    yield f"{sys.version} {solver()}".encode()
    for name, function in known.items():
        text = f"{ast.dump(function.node)} {sorted(function.constants.items())}"
        yield f"{name} {function.module} {text} {sorted(function.calls.items())}".encode()
    for path in files:
        yield str(path).encode()
        yield path.read_bytes()


def solver() -> str:
    """The version of z3 and where it lies; empty where that is unknown."""
    found = find_spec("z3")
    try:
        return f"{version('z3-solver')} {found.origin if found else ''}"
    except PackageNotFoundError:  # built by hand: nothing is known of what it is
        return ""


def holds(
    claim: str, known: dict[str, Function], parts: Iterable[Path], attempt: Callable[[], bool]
) -> bool:
    """What an attempt to prove says, or what was noted of the same attempt when it held.

    Args:
        claim: what is proved.
        known: the functions that it is proved of.
        parts: folders and files of a network, with its part of the proof and what it declares.
        attempt: the proof; True if all holds.
    """
    parts = list(parts)
    name = name_of(claim, known, sources(*parts))
    home = cache_root() / "proved"
    if not solver():
        return attempt()
    with contextlib.suppress(OSError):
        home.mkdir(parents=True, exist_ok=True)
    with alone(home / f"{name}.lock"):
        note = home / name
        if note.is_file():
            return True
        held = attempt()
        if held and name == name_of(claim, known, sources(*parts)):  # nothing was edited meanwhile
            _write(note)
        return held


def _write(note: Path) -> None:
    """Note it, and forget the oldest notes."""
    with contextlib.suppress(OSError):
        note.touch()
        others = sorted(note.parent.iterdir(), key=lambda path: path.stat().st_mtime)
        for old in others[: -2 * NOTES_MAX]:
            old.unlink(missing_ok=True)
