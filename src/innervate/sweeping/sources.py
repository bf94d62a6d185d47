"""What runs of a sweep come from besides its plan: innervate, a network's folder, files named."""

import hashlib
import os
import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from innervate import folders
from innervate import scenario as scenarios
from innervate.network import networks
from innervate.scenario import Scenario
from innervate.sweeping.base import leaves
from innervate.trace.sources import stamp


def sources_of(kind: str) -> str:
    """Hash of all sources that runs of a kind of network depend on."""
    return stamp("running") + folder_mark(kind)


def folder_mark(kind: str) -> str:
    """Hash of the sources of a network that is a folder; "" of any other."""
    network = networks().get(kind)
    if network is None or network.folder is None:
        return ""
    return _mark(network.folder, folders.edition(network.folder))


@cache
def _mark(folder: Path, edition: Any) -> str:
    """Of a folder as it was loaded: what is edited since is not what runs."""
    digest = hashlib.blake2b(digest_size=12)
    for path in sorted(folder.rglob("*.py")):
        digest.update(f"{path.relative_to(folder)} {path.stat().st_size} ".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def files_named(made: Scenario, folder: str, varied: Mapping[str, Any]) -> dict[str, str]:
    """The files that a scenario names, and those that it is given in turn: (in words, hash).

    Relative paths start in `folder`; `varied` are the values that it is given, by key.
    """
    whole = texts(tomllib.loads(scenarios.dump(made)))  # with full paths
    paths = [text for text in whole if os.path.isabs(text)]
    paths += [os.path.join(folder, text) for text in texts(varied) if "." in text]
    found = {}
    for path in filter(os.path.isfile, dict.fromkeys(paths)):
        content = Path(path).read_bytes()
        found[f"the file {path}"] = hashlib.sha256(content).hexdigest()
    return found


def texts(value: Any) -> Iterator[str]:
    """All texts in nested tables."""
    return (text for _, text in leaves(value) if isinstance(text, str))
