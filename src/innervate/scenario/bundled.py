"""The scenarios that come with innervate, and those to start from."""

from importlib.resources import files
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "bundled"


def bundled() -> dict[str, Path]:
    """Name -> file of every bundled scenario, in order of name."""
    return {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}


def template(network: Any) -> str:
    """The commented scenario that a network has in a file beside the keys of its scenarios."""
    return text_of(f"{network.package}.scenario", "template.toml")


def text_of(package: str, name: str) -> str:
    """A text file of a package."""
    return (files(package) / name).read_text(encoding="utf-8")
