"""Checks that take a copy of the protocol and fail if it is wrong."""

import random

from innervate.dialect.arith import MASK30
from tests.networks.skin.bench import Box, OneCell, new_cell
from tests.networks.skin.checks import (
    RULES,
    UPDATES,
    WITH_DETECT,
    check_random_network,
    check_react,
    check_select,
    random_step,
)
from tests.networks.skin.net import Net
from tests.networks.skin.runs import faulty, plain_stack, run

GRID = [("pc", "a"), ("a", "b"), ("b", "c"), ("d", "e"), ("e", "f"), ("a", "d"), ("b", "e"),
        ("c", "f"), ("f", "pc")]  # fmt: skip
DEPTHS = [1, 2, 2, 2, 2, 1]  # of a b c d e f
W, E, UP, DOWN = range(4)


def react(protocol):
    """`hear` equals select(0)."""
    for seed in range(12):
        draw = random.Random(seed)
        history = [random_step(draw) for _ in range(80)]
        for rule in RULES:
            keys = {"rule": rule, "updates": UPDATES[1 + seed % 2], "k": 1 + seed % 3}
            check_react(history, draw.randrange(65_536), protocol, balancing=True, **keys)


def select(protocol):
    """select chooses what the specification says."""
    for seed in range(400):
        draw = random.Random(seed)
        history = [random_step(draw) for _ in range(draw.randrange(1, 30))]
        keys = {"rule": draw.choice(RULES), "updates": "periodic", "k": draw.randrange(1, 4)}
        keys |= {"max_depth": draw.choice((3, 64)), "balancing": True, "balance_periods": 90}
        keys["balance_rule"] = draw.choice(("even", "paper"))
        check_select(history, 0, protocol, seed % 2, **keys)


def network(protocol):
    """No loop, no disorder, in random networks."""
    for seed in range(12):
        keys = {"rule": "feasible", "updates": UPDATES[seed % 3], "steps": WITH_DETECT}
        check_random_network(seed, protocol, **keys)


def settled(protocol, periods=40, prepare=None, **keys):
    net = Net(GRID, protocol, k=3, m=3, **keys)
    if prepare:
        prepare(net)
    for turn in range(periods):
        order = random.Random(turn).sample(range(net.graph.nodes), net.graph.nodes)
        net.turn(order)
        for cell in range(net.graph.cells):
            net.soon(cell)
        net.deliver_all()
        net.check()
    return net


def assert_settled(net):
    names = [net.graph.label(cell) for cell in range(net.graph.cells)]
    depths = dict(zip("abcdef", DEPTHS, strict=True))
    assert {n: net.distance(n) for n in names} == depths
    sizes = net.pc.size
    assert sum(sizes) == 6, sizes
    for cell in net.cells:
        assert cell.size[cell.parent] in sizes
        assert cell.size[cell.parent] > 0


def settles(protocol):
    """A quiet network has shortest routes and loads that add up."""
    for updates in UPDATES:
        assert_settled(settled(protocol, updates=updates))


def balances(protocol):
    """A cell moves to the lightest port if that lowers the sum of squares."""
    for sizes, chosen in (((50, 49, 60), W), ((50, 48, 60), E), ((50, 40, 30), UP)):
        bench = OneCell(protocol, balancing=True, balance_periods=2)
        for port, size in zip((W, E, UP), sizes, strict=True):
            bench.hear(port, dist=2, sq=3 + (port > 0), size=size)
            if port == W:
                bench.tick()
        bench.period()
        bench.period()
        assert bench.parent == chosen, sizes


def turns(protocol):
    """A cell that moved for balance does not keep its turn."""
    bench = OneCell(protocol, balancing=True, balance_periods=40)
    bench.hear(W, dist=2, sq=3, size=50)
    bench.tick()
    bench.hear(E, dist=2, sq=4, size=10)
    bench.cell.countdown = 1
    bench.cell.choice = 16
    bench.tick()
    assert (bench.parent, bench.cell.countdown) == (E, 17)


def simulation(protocol):
    """No broken invariant in small plain simulations."""
    with plain_stack(protocol.skin_stack):
        for seed in range(6):
            keys = faulty(
                seed, ["cut", "cut", "restore"], (3, 3, ((0, 1), (2, 1))), count=12, gap_s=0.008,
                rule="strict", updates=UPDATES[seed % 3], k=2,
            )  # fmt: skip
            run(keys, plain=True)


def restarts(protocol):
    """A cell that lost its memory does not take a route that leads through itself."""
    for updates in UPDATES:
        for rule in ("feasible", "strict"):
            cables = [("pc", "a"), ("a", "b"), ("b", "c"), ("c", "a")]
            net = Net(cables, protocol, rule=rule, updates=updates, k=3, m=9)
            net.cut(net.end("c", "a"))
            for _ in range(16):
                net.period()
                for cell in range(3):
                    net.soon(cell)
            net.restore(net.end("c", "a"))
            net.deliver_all()
            net.start(net.node("a"))
            for _ in range(12):
                net.tick("c")
                net.deliver(net.end("c", "a"))
                net.tick("a")
                net.check()
                net.soon("a")
                net.period()
                net.check()


def penalty(protocol):
    """p_f runs within [0, 2], breaks after k misses, mends after k+1 beacons from the cap."""
    bench = OneCell(protocol, k=3)
    bench.hear(W, dist=0, sq=1)
    bench.tick()
    for _ in range(12):
        bench.period()
        assert bench.cell.pf[W] == 0
    for missed in range(1, 10):
        bench.period(W)
        assert (bench.cell.pf[W] >= 840) == (missed >= 3)
        assert bench.cell.pf[W] <= 1680
    for heard in range(1, 10):
        bench.period()
        assert (bench.cell.pf[W] >= 840) == (heard <= 3)


def forgets(protocol):
    """A restarted PC is followed, at once if it could listen, else after FD_HOLD."""
    net = Net([("pc", "a"), ("a", "b")], protocol, k=2, m=1)
    for _ in range(300):
        net.period()
    net.start(net.graph.sink)
    for _ in range(10):
        net.period()
    assert net.parent("b") == "a"
    assert net.pc.own[0].sq > 300
    net.cut(net.end("pc", "a"))
    net.start(net.graph.sink)
    for _ in range(8):
        net.period()
    net.cells[0].fd_sq = (net.pc.own[0].sq + 20_000) & 65_535
    for cell in net.cells:
        cell.load[:] = [0] * 4
    net.restore(net.end("pc", "a"))
    net.params.rule = protocol.skin.RULE_FEASIBLE
    for _ in range(net.params.hold_periods + 12):
        net.period()
    assert (net.parent("a"), net.parent("b")) == ("pc", "a")


def believes(protocol):
    """Numbers of cells that never had a route mean nothing to the PC."""
    net = Net([("pc", "a"), ("a", "b")], protocol, k=2, m=1)
    for cell in net.cells:
        cell.sent_sq = cell.sq_own = 30_000
    for _ in range(8):
        net.period()
    assert net.pc.own[0].sq < 100


def counts(protocol):
    """The PC counts every M periods."""
    net = Net([("pc", "a")], protocol, k=2, m=4)
    for _ in range(2 + 40):
        net.period()
    assert net.pc.own[0].sq == 10


def recovers(protocol):
    """A cut cable is gone round."""
    net = settled(protocol)
    net.cut(net.end("a", "pc"))
    for _ in range(20):
        net.period()
    assert net.distance("a") == 4
    assert sum(net.pc.size[1:]) == 6


def wave(protocol):
    """A new number runs through a line within a period."""
    net = Net([("pc", "a"), ("a", "b"), ("b", "c")], protocol, k=2, m=1, updates="wave")
    for _ in range(12):
        net.period()
        for name in "abc":
            net.soon(name)
            net.deliver_all()
    before = net.cells[2].sq_own
    net.tick("pc")
    net.deliver_all()
    for name in "abc":
        net.soon(name)
        net.deliver_all()
    assert net.cells[2].sq_own == before + 1


def gap(protocol):
    """News keeps GAP from the last beacon."""
    bench = OneCell(protocol, updates="triggered")
    bench.tick()
    sent_at = bench.cell.sent_at
    actions = bench.hear(W, dist=0, sq=1)
    timers = [(a, b) for kind, a, b, *_ in actions if kind == protocol.outbox.SET_TIMER]
    assert timers == [(protocol.skin.SOON, sent_at + bench.params.gap_us)]


def data(protocol):
    """Samples reach the PC, counted, with the hops they took."""
    net = Net([("pc", "a"), ("a", "b"), ("b", "c")], protocol, k=2)
    for _ in range(14):
        net.period()
    for _ in range(3):
        net.sample(2)
        net.deliver_all()
    assert [(f.cell, f.seq, f.hops) for f in net.delivered] == [(2, n, 2) for n in range(3)]


def wraps(protocol):
    """Sequence numbers run through their wrap."""

    def near_the_end(net):
        net.pc.own[0].sq = 65_530

    for updates in UPDATES:
        net = settled(protocol, 60, near_the_end, updates=updates)
        assert_settled(net)
        assert net.pc.own[0].sq < 100
        net.cut(net.end("a", "pc"))
        for _ in range(12):
            net.turn()
            for cell in range(net.graph.cells):
                net.soon(cell)
        assert net.distance("a") == 4


def gap_wraps(protocol):
    """Clocks run through their wrap, and with them the gap after a beacon."""
    bench = OneCell(protocol, updates="triggered")
    bench.cell.tick_at = bench.now = MASK30 - 100
    bench.tick()
    found = bench.hear(W, dist=0, sq=1)
    timers = [b for kind, _a, b, *_ in found if kind == protocol.outbox.SET_TIMER]
    assert timers == [bench.params.gap_us - 101]


def listens(protocol):
    """The PC is silent for k periods."""
    net = Net([("pc", "a")], protocol, k=3)
    for turn in range(5):
        net.tick("pc")
        assert bool(net.wires[net.end("pc", "a")]) == (turn >= 3)


def draws(protocol):
    """A draw is below n."""
    cell = new_cell(protocol, seed=5)
    for n in (1, 2, 3, 4):
        assert {protocol.rng.draw(cell, n) for _ in range(400)} == set(range(n))


def overflow(protocol):
    """An outbox that is full says so."""
    out = Box(protocol, limit=2).out
    for _ in range(3):
        protocol.outbox.report(out, 1, 0, 0)
    assert out.overflow[0]


CHECKS = {
    check.__name__.replace("_", " "): check
    for check in (
        react, select, network, settles, balances, simulation, restarts, penalty, forgets,
        believes, counts, listens, recovers, wave, gap, gap_wraps, data, wraps, draws, overflow,
        turns,
    )
}  # fmt: skip
