"""Where a result comes from: enough to get it again, and nothing of whose machine it was."""

import hashlib
import platform
import subprocess
from importlib import metadata
from pathlib import Path
from typing import Any

import innervate

SCHEMA = 1
GIT_TIMEOUT_S = 10
PACKAGES = ("numba", "llvmlite", "numpy", "polars", "msgspec")


def provenance(
    *,
    scenario_toml: str,
    seeds: list[int],
    fingerprint: str,
    wall_s: float,
    checks: bool,
    interrupted: bool,
) -> dict[str, Any]:
    """Version, commit, seeds, package versions, platform and the trajectory's fingerprint.

    `commit` is None outside a git checkout of innervate; `modified` says that tracked files
    differed from it.
    """
    commit, modified = checkout()
    return {
        "schema": SCHEMA,
        "innervate": innervate.__version__,
        "commit": commit,
        "modified": modified,
        "seeds": seeds,
        "fingerprint": fingerprint,
        "scenario_sha256": hashlib.sha256(scenario_toml.encode()).hexdigest(),
        "checks": checks,
        "interrupted": interrupted,
        "wall_s": wall_s,
        "python": platform.python_version(),
        "implementation": platform.python_implementation(),
        "packages": {name: version_of(name) for name in PACKAGES},
        "system": platform.system(),
        "machine": platform.machine(),
    }


def checkout(root: Path | None = None) -> tuple[str | None, bool | None]:
    """(commit, modified) of the checkout that innervate runs from; (None, None) outside one."""
    root = root or Path(__file__).parents[3]
    if not (root / ".git").exists():
        return None, None
    command = ["git", "-C", str(root), "describe", "--always", "--abbrev=40", "--exclude=*"]
    try:
        done = subprocess.run(
            [*command, "--dirty"], capture_output=True, text=True, timeout=GIT_TIMEOUT_S, check=True
        )
    except (OSError, subprocess.SubprocessError):
        return None, None
    commit, _, dirty = done.stdout.strip().partition("-")
    return commit, dirty == "dirty"


def version_of(package: str) -> str | None:
    """The version of an installed package; None = it is not installed."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None
