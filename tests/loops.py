"""Compiles what many tests run, each loop once, before the tests start: `python -m tests.loops 2`.

Tests that start side by side would wait for each other's loops, and a page or a process under test
would take half a minute to answer. A loop that a single test wants is compiled there.
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial

from innervate.network import networks
from innervate.scenario import load, plan


def simulated(name, *settings):
    """The loop that a bundled scenario runs on."""
    made = plan(load(name, list(settings)))
    networks()[made.kind].simulation(made).prepare()


def explored():
    """The skin's explorer: searching, walking, playing the fair schedule."""
    from innervate.networks.skin.verify import fair, graphs
    from innervate.networks.skin.verify.system import Budget, SkinModel
    from innervate.verify import explore

    model = SkinModel(graphs.parse("pc-1"), keep=True, budget=Budget(ticks=1))
    fair.check(explore.explore(model))
    explore.wander(model, 1)


# What shares a protocol is compiled by one process, which types its functions once: the second mesh
# takes a third of what it would alone.
GROUPS = (
    (
        partial(simulated, "mesh-team"),
        partial(simulated, "mesh-field"),
        partial(simulated, "radio-figure-1"),
    ),
    (
        partial(simulated, "demo"),
        explored,
        partial(simulated, "demo", "protocol.rule='static'"),
        partial(simulated, "radio-disaster"),
        partial(simulated, "radio-disaster", "protocol.mac='dcf'"),
    ),
)


def compiled(index):
    """Compile a group, or find it compiled."""
    for loop in GROUPS[index]:
        loop()


if __name__ == "__main__":
    with ProcessPoolExecutor(int(sys.argv[1])) as processes:
        ready = [processes.submit(compiled, index) for index in range(len(GROUPS))]
        for one in ready:
            one.result()
