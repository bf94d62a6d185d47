"""explore(network) -> what `innervate verify` finds, from Python."""

import os
from pathlib import Path
from types import SimpleNamespace
from typing import TypedDict, Unpack

from innervate.network import Network, NetworkError, networks, use
from innervate.running.options import refuse_others, takes
from innervate.running.showing import Bar
from innervate.verify.cases import USUAL, Case, notice_of


class Wanted(TypedDict, total=False):
    """What to explore, and how much of it; what a network has no use for is refused.

    Attributes:
        rule: which of the protocol's rules; "all" of them.
        updates: of a skin: "periodic", "triggered" or "all".
        graph: cables like "n0.E-n1.W", a name ("pair", "line", "ring"), or "all" up to `cells`.
        cells: how many nodes the graphs may have.
        budget: how often what may happen, like "loss=1,restart=0,input=2".
        prompt: every frame arrives or is lost before anything else happens.
        liveness: also see from every state whether routes become shortest once faults have ended.
        starts: play that from so many states instead of all.
        states: each exploration ends after so many; 0 = as many as the network's usual.
        walks: so many random walks instead of all states.
        seed: of the walks.
        memory: what the states of an exploration may take, like "800M" or "4G".
        reduce: forget what of a state can no longer matter.
        plain: without the compiler: slower by a hundred times, needs no preparation.
    """

    rule: str
    updates: str
    graph: str
    cells: int
    budget: str
    prompt: bool
    liveness: bool
    starts: int
    states: int
    walks: int
    seed: int | None
    memory: str
    reduce: bool
    plain: bool


@takes(Wanted, USUAL)
def explore(network: str | os.PathLike[str] | Network, **wanted: Unpack[Wanted]) -> list[Case]:
    """Explore every order of events of a protocol on small graphs, as `innervate verify` does.

    Args:
        network: its name ("skin"), its folder, or itself.
        wanted: what to explore and how much of it, by the names of the command's options: `rule`,
            `graph`, `budget`, `states`, ... (`innervate verify --help`).

    Returns:
        A Case for every exploration: `is_broken`, `is_complete`, `lines`, `story`, `record`.

    Raises:
        NetworkError: there is no such network.
        VerifyError: no such graph, rule or budget.
        TypeError: no option of that name.
    """
    refuse_others("explore", wanted, Wanted.__annotations__)
    if not isinstance(network, Network):
        network = named(network)
    options = SimpleNamespace(**(USUAL | wanted))
    with Bar(notice_of(network, options) or "exploring") as bar:
        return [one(bar.explored) for one in network.verify.explorations(network, options)]


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
