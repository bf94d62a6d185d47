"""Successor states that the explorer generates and looks up per second, on one core.

PC and triangle under `feasible`, periodic updates, all states within the budgets of `verify`. The
best of a few runs counts, because other work on the machine only ever slows one down.
"""

from innervate.networks.skin.verify import graphs
from innervate.networks.skin.verify.system import SkinModel
from innervate.verify import explore

RUNS = 3


def measure():
    """States, successors and successors per second."""
    model = SkinModel(graphs.parse("triangle"))
    best = explore.explore(model).tally
    for _ in range(RUNS - 1):
        tally = explore.explore(model).tally
        best = max(best, tally, key=lambda one: one.per_s)
    return {
        "graph": "pc-1 1-2 1-3 2-3",
        "states": best.states,
        "successors": best.generated,
        "successors_per_s": best.per_s,
    }
