"""The options of `innervate verify`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from cyclopts import Parameter

from innervate.cli.seeds import Seed

Flag = Annotated[bool, Parameter(negative="")]


@dataclass(frozen=True)
class VerifyOptions:
    """What to explore, and how much of it.

    Parameters
    ----------
    rule
        Skin: feasible (if left out), strict, paper, paper-lax or all. Radio: practical (if left
        out) or paper.
        Mesh: a failover, search or graph (both if left out), alternate, random or all.
    updates
        periodic, triggered or all.
    graph
        Cables like "pc-1 1-2 2-3", a name (line, star, triangle, ring, pair, complete), or all
        graphs of up to --cells cells. Mesh: links like "0-1 1-2" (0 is the gateway), or a name
        (line, triangle, square, kite, house, spare, prism).
    cells
        How many cells the graphs may have, 1 to 4 (2 if left out); stations of a radio, 2 to 4.
    budget
        How often what may happen, like "ticks=3,counts=2,loss=1,cut=1,heal=1,false=1,restart=1,
        faults=2"; these are the defaults, and faults counts all five kinds together; "ticks=any"
        lets cells tick as often as it takes. Mesh:
        "deaths=1,revivals=0,frames=0,acks=1,ticks=0".
    prompt
        Every frame arrives or is lost before anything else happens.
    liveness
        Also see from every state whether routes become shortest once faults have ended.
    starts
        Play that from so many states instead of all.
    states
        End each exploration after so many states.
    walks
        Instead of all states so many random walks, for larger budgets.
    memory
        What the states of an exploration may take, like 800M or 4G.
    random
        Simulate whole networks, all settings and faults drawn, until interrupted.
    mutants
        Try the explorer on copies of the protocols with a small mistake in each: all, or those of
        radio or mesh.
    seed
        With --random the first network's number, with --walks the walks'.
    count
        With --random end after so many networks.
    reduce
        Forget what of a state can no longer matter, and leave out states that others cover.
    plain
        Without the compiler: slower by a hundred times, needs no preparation.
    """

    rule: str = ""
    updates: str = "all"
    graph: str = "all"
    cells: int = 0
    budget: str = ""
    prompt: Flag = False
    liveness: bool = True
    starts: int = 0
    states: int = 0
    walks: int = 0
    memory: str = "2G"
    random: Flag = False
    mutants: Flag = False
    seed: Seed = None
    count: int = 0
    reduce: bool = True
    plain: Flag = False


VERIFY_DEFAULTS = VerifyOptions()
