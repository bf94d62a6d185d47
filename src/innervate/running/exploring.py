"""explore(network) -> what `innervate verify` finds, from Python."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from innervate.network import Network, NetworkError, networks, use


def explore(
    network: str | os.PathLike[str] | Network,
    *,
    graph: str = "all",
    budget: str = "",
    states: int = 0,
) -> list[Any]:
    """Explore every order of events of a network that declares its protocol, on small graphs.

    Args:
        network: its name, its folder, or itself.
        graph: cables like "n0.E-n1.W", a name ("pair", "line", "ring"), or "all" of these.
        budget: how often what may happen, like "loss=1,restart=0,input=2".
        states: each exploration ends after so many; 0 = after 20,000.

    Returns:
        A verify.cases.Case for every graph: `is_broken`, `is_complete`, `lines`, `record`.

    Raises:
        NetworkError: there is no such network.
        VerifyError: no such graph or budget.
    """
    if not isinstance(network, Network):
        network = named(network)
    options = SimpleNamespace(graph=graph, budget=budget, states=states)
    return [one(lambda what, part, of: False) for one in network.verify.explorations(
        network, options)]  # fmt: skip


def named(network: str | os.PathLike[str]) -> Network:
    """The network of a name or a folder.

    Raises:
        NetworkError: there is none.
    """
    if str(network) in networks():
        return networks()[str(network)]
    folder = Path(network)
    if not folder.is_dir():
        known = ", ".join(networks())
        raise NetworkError(f"there is no network {str(network)[:60]!r}; name a folder or {known}")
    return use(folder)
