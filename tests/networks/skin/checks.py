"""What must hold of the skin's handlers, as checks that run on any copy of the protocol.

The tests run them on the real one, verify/test_protocol_mutants.py on changed ones: there each
must find something.
"""

import random

from tests.networks.skin.bench import (
    REAL,
    Box,
    beacon,
    clone,
    differing,
    new_cell,
    out_of_range,
    params_of,
    put_values,
    values,
    words,
)
from tests.networks.skin.net import Net

RULES = ("feasible", "strict", "paper", "paper-lax")
UPDATES = ("periodic", "triggered", "wave")
HALF = 1 << 15

# Histories of one cell: ("tick",), ("soon",) or ("hear", port, dist, ahead, load, size, parent);
# `ahead` counts sequence numbers from the history's first.
DISTANCES = (0, 1, 1, 2, 2, 3, 4, 62, 63, 64, 255)


def random_step(draw):
    """A step of a history; `draw` is a random.Random."""
    if draw.random() < 0.3:
        return ("tick",) if draw.random() < 0.7 else ("soon",)
    return (
        "hear", draw.randrange(4), draw.choice(DISTANCES), draw.randrange(8),
        draw.choice((0, 1, 5, 4095)), draw.choice((0, 1, 3, 40, 4095)), int(draw.random() < 0.2),
    )  # fmt: skip


class CellBench:
    """One cell that lives through a history."""

    def __init__(self, protocol, first_sq, **keys):
        self.protocol = protocol
        self.first_sq = first_sq
        self.params = params_of(protocol, **keys)
        self.cell = new_cell(protocol, seed=first_sq + 1)
        self.box = Box(protocol)
        self.now = 0
        self.frame = None
        self.port = 0
        protocol.skin.on_start(self.cell, self.params, 0, 0, self.box.out)
        self.play(("tick",))

    def play(self, step):
        """One step; its actions."""
        skin, out = self.protocol.skin, self.box.out
        self.box.take()
        if step[0] == "hear":
            self.now += 37
            _, self.port, dist, ahead, load, size, parent = step
            sq = (self.first_sq + ahead) & 0xFFFF
            self.frame = beacon(self.protocol, dist, sq, load, size, parent)
            skin.on_frame(self.cell, self.params, self.now, self.port, self.frame, out)
        elif step[0] == "tick":
            self.now = max(self.now, self.cell.tick_at)
            skin.on_timer(self.cell, self.params, self.now, self.protocol.skin_constants.TICK, out)
        else:
            skin.on_timer(self.cell, self.params, self.now, self.protocol.skin_constants.SOON, out)
        actions = self.box.take()
        wrong = out_of_range(self.cell, self.protocol.skin_fields.CELL)
        assert not wrong, f"after {step}: {wrong}"
        return actions


def is_settled(bench, twin, box):
    """True if select(0) would leave the cell as it is; `twin` is like the cell afterwards."""
    before = values(bench.cell)
    put_values(twin, before)
    bench.protocol.skin.select(twin, bench.params, 0, box.out)
    settled = values(twin) == before and not box.take()
    put_values(twin, before)
    return settled


def check_react(history, first_sq, protocol=REAL, **keys):
    """`hear` does what storing the beacon, select(0) and sending news would do.

    Not where select(0) itself is not at rest: under the rules strict and paper it lets a parent's
    number go back, and only then sees that another port is newer than that.
    """
    bench = CellBench(protocol, first_sq, **keys)
    skin, twin, box = protocol.skin, clone(bench.cell), Box(protocol)
    compared = 0
    for place, step in enumerate(history):
        settled = is_settled(bench, twin, box)
        assert (
            settled
            or bench.params.rule != protocol.skin_constants.RULE_FEASIBLE
            or (bench.params.updates == protocol.skin_constants.PERIODIC)
        ), f"select(0) is not at rest before step {place} of {history}, {first_sq}, {keys}"
        actions = bench.play(step)
        if step[0] != "hear" or not settled:
            continue
        compared += 1
        frame, port = bench.frame, bench.port
        twin.dist[port], twin.sq[port] = frame.dist, frame.sq
        twin.load[port], twin.size[port] = frame.load, frame.size
        twin.child[port], twin.heard[port] = frame.parent, 1
        if bench.params.updates != protocol.skin_constants.PERIODIC:
            skin.select(twin, bench.params, 0, box.out)
            if skin.is_news(twin, bench.params):
                skin.announce_soon(twin, bench.params, bench.now, box.out)
        where = f"step {place} {step} of {history[: place + 1]}, first sq {first_sq}, {keys}"
        assert values(bench.cell) == values(twin), (
            f"hear and select differ in {differing(bench.cell, twin)} after {where}"
        )
        assert words(actions) == words(box.take()), f"hear and select ask otherwise after {where}"
    return compared


def is_newer(a, b):
    """RFC 1982 in other words than the protocol's."""
    return 0 < (a - b) % 65536 < 32768


def spec_candidates(cell, params, master):
    """Usable and allowed ports other than the present master (-1 none), as [skin 4], E8 print it.

    The rule `paper` compares with the number of the present master, as last heard (Alg. 2 l. 6).
    """
    candidates = []
    for p in range(4):
        usable = cell.dist[p] < params.max_depth and cell.pf[p] < 840 and not cell.child[p]
        if params.rule == 0:
            fd = (cell.fd_sq, cell.fd_dist)
            allowed = not cell.fd_known or is_newer(cell.sq[p], fd[0])
            allowed = allowed or (cell.sq[p] == fd[0] and cell.dist[p] < fd[1])
        else:
            present = params.rule == 2 and master != -1
            least = cell.sq[master] if present else cell.sq_own
            allowed = not cell.sq_known or is_newer(cell.sq[p], least)
            allowed = allowed or (params.rule in (2, 4) and cell.sq[p] == least)
        if usable and allowed and p != master:
            candidates.append(p)
    return candidates


def spec_parents(cell, params, may_balance):
    """The parents that [skin 4] select() may choose; several where the choice is random."""
    master = cell.parent
    if master != -1:
        usable = cell.dist[master] < params.max_depth and cell.pf[master] < 840
        if not usable or cell.child[master]:
            master = -1
    candidates = spec_candidates(cell, params, master)
    current = 255 if master == -1 else cell.dist[master]
    best = min((cell.dist[p] for p in candidates), default=255)
    if best < current:
        return [p for p in candidates if cell.dist[p] == best]
    equal = [p for p in candidates if cell.dist[p] == current]
    if may_balance and master != -1 and equal:
        least = min(cell.size[p] for p in equal)
        lightest = min(p for p in equal if cell.size[p] == least)
        gains = cell.size[master] - least > cell.own_load
        if params.balance_rule:  # Alg. 3 as printed
            more = least - cell.size[master]
            gains = more >= 0 and cell.own_load < more
        if gains:
            return [lightest]
    return [master]


def check_select(history, first_sq, protocol=REAL, may_balance=0, **keys):
    """select chooses what [skin 4] says; every one of several choices is reached by a draw."""
    bench = CellBench(protocol, first_sq, **keys)
    for step in history:
        bench.play(step)
    skin, box = protocol.skin, Box(protocol)
    before = clone(bench.cell)
    expected = spec_parents(before, bench.params, may_balance)
    found = []
    for choice in range(len(expected)):
        cell = clone(before)
        cell.choice = choice
        skin.select(cell, bench.params, may_balance, box.out)
        box.take()
        found.append(cell.parent)
        if cell.parent != -1:
            assert cell.sq_own == cell.sq[cell.parent]
    assert sorted(found) == sorted(expected), (
        f"select chose {found}, the specification {expected} after {history}, first sq "
        f"{first_sq}, may_balance {may_balance}, {keys}"
    )


# Networks.

STEPS = ("tick", "tick", "soon", "deliver", "deliver", "deliver", "lose", "cut", "restore", "pc")


WITH_DETECT = (*STEPS, "detect")


def random_links(draw, cells, extra):
    """A connected random graph of at most four cables a cell, as links between names."""
    free = {f"n{i}": 4 for i in range(cells)}
    links = [("pc", "n0")]
    free["n0"] -= 1
    for i in range(1, cells):
        other = draw.choice([n for n in list(free)[:i] if free[n] > 0])
        links.append((other, f"n{i}"))
        free[other] -= 1
        free[f"n{i}"] -= 1
    for _ in range(extra):
        open_ends = [n for n in free if free[n] > 0]
        if len(open_ends) < 2:
            break
        a = draw.choice(["pc", *open_ends])
        b = draw.choice([n for n in open_ends if n != a])
        links.append((a, b))
        for name in {a, b} - {"pc"}:
            free[name] -= 1
    return links


def step_net(net, action, number):
    """One event at a place that `number` chooses; what was done, in words."""
    ends = list(net.wires)
    end = ends[number % len(ends)]
    if action in ("tick", "soon"):
        node = number % net.graph.nodes
        getattr(net, action)(node)
        return f"{action} {net.graph.label(node)}"
    if action == "pc":
        net.tick(net.graph.sink)
        return "tick pc"
    if action in ("deliver", "lose"):
        loaded = [e for e in ends if net.wires[e]] or [end]
        end = loaded[number % len(loaded)]
    elif action == "restore" and net.down:
        end = sorted(net.down)[number % len(net.down)]
    elif action == "detect" and net.graph.node_of(end) == net.graph.sink:
        return "nothing"
    getattr(net, action)(end)
    return f"{action} {net.graph.label_end(end)}"


def check_network(links, steps, protocol=REAL, seed=1, **keys):
    """No closed loop, feasible distances in order, values in range after every single event.

    Under the paper's rule `rings` of the network that comes back counts the closed loops.
    """
    net = Net(links, protocol, seed=seed, numbers={"hold_periods": 60_000}, **keys)
    told, ringed = [], False
    for action, number in steps:
        told.append(step_net(net, action, number))
        try:
            net.check()
        except AssertionError as error:
            error.args = (f"{error}\n{keys}, seed {seed}, cables {links}\n" + "\n".join(told),)
            raise
        ringed, before = bool(net.ring()), ringed
        net.rings += ringed and not before
    return net


def check_random_network(seed, protocol=REAL, count=400, cells=5, steps=STEPS, **keys):
    """The same with a graph and a history drawn from `seed`."""
    draw = random.Random(seed)
    links = random_links(draw, draw.randrange(2, cells + 1), draw.randrange(5))
    history = [(draw.choice(steps), draw.randrange(1 << 20)) for _ in range(count)]
    keys = {"k": draw.randrange(1, 4), "m": draw.randrange(1, 4), "balance_periods": 2, **keys}
    return check_network(links, history, protocol, seed, balancing=True, **keys)
