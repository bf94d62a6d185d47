"""The scenarios that come with innervate."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parent / "bundled"


def bundled() -> dict[str, Path]:
    """Name -> file of every bundled scenario, in order of name."""
    return {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}
