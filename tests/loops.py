"""Compiles what many tests run, each loop once, before the tests start: `python -m tests.loops 2`.

Tests that start side by side would wait for each other's loops, and a page or a process under test
would take half a minute to answer. A loop that a single test wants is compiled there.
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from functools import partial

from innervate.network import networks
from innervate.scenario import load, loads, plan, template


def simulated(name, *settings):
    """The loop that a bundled scenario runs on."""
    prepare(load(name, list(settings)))


def begun(kind):
    """The loop that a network's template runs on."""
    prepare(loads(template(kind)))


def prepare(scenario):
    made = plan(scenario)
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
# takes a third of what it would alone. Both groups take about as long, 148 to 136.
GROUPS = (
    (
        partial(simulated, "mesh-team"),
        partial(simulated, "mesh-field"),
        partial(begun, "flooding"),
        partial(simulated, "babel-patch"),
    ),
    (
        partial(simulated, "demo"),
        explored,
        partial(simulated, "demo", "protocol.rule='static'"),
        partial(simulated, "radio-disaster"),
        partial(simulated, "radio-figure-1"),
        partial(simulated, "radio-disaster", "protocol.mac='dcf'"),
    ),
)


def compiled(group, number):
    """Compile a loop of a group, or find it compiled."""
    GROUPS[group][number]()


def compiled_in_turn(group):
    """Compile a group, and say of each loop that it is there."""
    for number in range(len(GROUPS[group])):
        compiled(group, number)
        print(group, number, flush=True)


if __name__ == "__main__":
    with ProcessPoolExecutor(int(sys.argv[1])) as processes:
        list(processes.map(compiled_in_turn, range(len(GROUPS))))
