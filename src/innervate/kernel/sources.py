"""Which sources end up in compiled code, and a hash of them; it knows no compiler."""

import hashlib
from collections.abc import Iterable
from pathlib import Path

# What of the sources ends up in compiled code, functions or numbers: rooms and files, and of every
# network these parts.
SOURCE_ROOMS = (
    "dialect", "kernel", "sim", "verify",
    "scenario/actions", "topology/patch.py", "topology/placement.py", "topology/astray.py",
)  # fmt: skip
PARTS = (
    "protocol", "sim", "verify", "baselines", "slotted", "invariants.py",
    "scenario/baselines.py", "scenario/plan.py",
)  # fmt: skip
NAME_LENGTH = 20  # of a hash
ROOT = Path(__file__).resolve().parent.parent


def homes(root: Path) -> list[Path]:
    """Folders and files that compiled code can come from."""
    networks = [path for path in (root / "networks").iterdir() if path.is_dir()]
    inside = [network / part for network in networks for part in PARTS]
    return [root / room for room in SOURCE_ROOMS] + inside


def source_files(root: Path = ROOT) -> list[Path]:
    """All files that compiled code of the toolkit can come from, in order."""
    found = homes(root)
    return sorted(p for home in found for p in ([home] if home.is_file() else home.rglob("*.py")))


def content_hash(root: Path = ROOT) -> str:
    """Hash of all sources that compiled code can come from, wherever they lie."""
    return hash_of("", source_files(root), root)


def hash_of(begun: str, files: Iterable[Path], root: Path = ROOT) -> str:
    """Hash of some words and of files: their places below `root`, and what stands in them."""
    digest = hashlib.blake2b(digest_size=NAME_LENGTH // 2)
    digest.update(begun.encode())
    for path in files:
        where = path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name
        digest.update(where.encode())
        digest.update(path.read_bytes() if path.is_file() else b"")
    return digest.hexdigest()
