"""A scenario in a few lines, without running it."""

from __future__ import annotations

import os
from collections.abc import Iterable

from innervate.network import networks
from innervate.scenario.load import Scenario, load
from innervate.scenario.overrides import Override


def check(
    path: str | os.PathLike[str], overrides: Iterable[Override] = (), seed: int | None = None
) -> str:
    """What a scenario file holds: its network, protocol, events, and what is to be warned of.

    Raises:
        ScenarioError: it cannot be run as written.
    """
    return summary(load(path, overrides, seed))


def summary(loaded: Scenario) -> str:
    """What a scenario holds, several lines, without a newline at the end.

    Raises:
        ScenarioError: it cannot be run as written.
    """
    network = networks()[loaded.kind]
    return str(network.describe(network.plan(loaded)))
