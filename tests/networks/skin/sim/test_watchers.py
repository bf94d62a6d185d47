"""What watches a skin beside the checkers that stop it: conservation, routes, commands.

Each law and each row is broken alone, or made to appear by one fault; without it they are silent.
"""

import ast
import inspect
from dataclasses import replace
from types import SimpleNamespace

import pytest

from innervate.dialect.outbox import report
from innervate.networks.skin.analysis.frames import FramesLost, check_conserved
from innervate.networks.skin.protocol.constants import DROP_NO_ROUTE, REPORT_BALANCE, REPORT_DROP
from innervate.networks.skin.sim import counters as own
from innervate.networks.skin.sim import observer, orders, simulate, stack
from innervate.sim.cables import calls, wires
from innervate.sim.status import DONE, ON_TIMER
from innervate.sim.wheel import FRESH, NIL
from tests.networks.skin.runs import free, line, plan_of, rows_since, run

CHAIN = [("pc.0", "n1"), ("n1", "n2"), ("n2", "n3")]

# Conservation. Every counter of a run, and which laws notice one too many of it.

DATA, BEACONS, COMMANDS = "data frames", "beacons", "commands"
SAMPLES = "samples"
BLOCKS = {0: DATA, wires.URGENT_BLOCK: BEACONS, own.COMMAND_BLOCK: COMMANDS}
LAWS = {
    **{block + word: {law} for block, law in BLOCKS.items()
       for word in (wires.SENT, wires.ARRIVED, *wires.REASONS.values())},
    **{word: {SAMPLES} for word in (wires.OFFERED, wires.DELIVERED, own.NO_ROUTE, own.LOOPED)},
}  # fmt: skip
for lost in wires.REASONS.values():
    LAWS[lost] = {DATA, SAMPLES}  # a lost frame of data is a lost sample
# These say more of what other counters count, or have a law of their own (`orders`, below).
BESIDE = {own.AGAIN, own.TOO_FAR, own.EARLY, own.GIVEN, own.ADDRESSED, own.REACHED,
          own.REPEATED, own.STRAY, *range(own.MISSED, own.MISSED + 3)}  # fmt: skip


@pytest.fixture(scope="module")
def crowded():
    """A run with frames of all kinds, lost, queued, and on their way at its end."""
    keys = line(4, duration_s=0.3, data={"rate_hz": 900, "queue": 4}, timing={"loss": 0.05})
    keys["command"] = [{"at_s": 0.2, "rate_hz": 200}]
    keys["event"] = [{"at_s": 0.25, "action": "cut", "interface": 0}]
    return run(keys, plain=True)


def laws_broken(result):
    """The laws that a result breaks, each with how many went nowhere."""
    try:
        check_conserved(result)
    except FramesLost as error:
        said = str(error).partition(": ")[2].removesuffix(" went nowhere")
        return {part.partition(" ")[2]: int(part.partition(" ")[0]) for part in said.split(", ")}
    return {}


def test_nothing_went_nowhere(crowded):
    assert laws_broken(crowded) == {}
    many = (wires.SENT, wires.ARRIVED, wires.LOST_NOISE, wires.OFFERED, wires.DELIVERED)
    assert all(crowded.counters[word] for word in (*many, own.COMMAND_BLOCK, wires.URGENT_BLOCK))


@pytest.mark.parametrize("word", LAWS)
def test_every_law_of_conservation_is_broken_by_each_of_its_counters(crowded, word):
    for by in (1, -1):
        counters = [count + by * (word == at) for at, count in enumerate(crowded.counters)]
        broken = laws_broken(replace(crowded, counters=counters))
        assert set(broken) == LAWS[word]
        adds = word in (wires.OFFERED, *(block + wires.SENT for block in BLOCKS))
        assert set(broken.values()) == {by if adds else -by}


def test_a_frame_that_vanishes_from_its_wire_is_missed(crowded):
    world = crowded.world
    first, behind = world.run[0].pool_slots, world.wheel.pool[FRESH]
    flying = [event for event in world.wheel.events[first:behind] if event.bucket != NIL]
    assert flying
    for event in flying:
        bucket, event.bucket = event.bucket, NIL
        broken = laws_broken(crowded)
        event.bucket = bucket
        law = BLOCKS[event.kind]
        assert broken == {law: 1} | ({SAMPLES: 1} if law == DATA else {})


def test_every_counter_stands_in_a_law_or_beside_one():
    told = [(node.targets[0].id, node.value.value)
            for node in ast.parse(inspect.getsource(wires)).body
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant)]  # fmt: skip
    names = [name for name, _ in told]
    told = dict(told[names.index("SENT") : names.index("OWN")])
    blocks = {told.pop("URGENT_BLOCK"), wires.OTHER_BLOCK, 0}
    in_blocks = {block + word for block in blocks for word in told.values() if word < 8}
    others = {word for word in told.values() if word >= wires.OFFERED}
    named = {name: word for name, word in vars(own).items() if name.isupper()}
    others |= {word for name, word in named.items() if name not in {*vars(wires), "COMMAND_BLOCK"}}
    assert in_blocks | others | {own.MISSED + 1, own.MISSED + 2} == {*LAWS, *BESIDE}


# Routes: rows that one fault makes appear, [(code, a, b)] as worked out by hand.

N1_N2 = {"link": ["n1", "n2"]}
ROUTES = {
    "nothing": ([], []),
    "a cable in the middle": (
        [{"at_s": 0.5, "action": "cut", **N1_N2}],
        [(observer.CUT_OFF, 0, 2), (observer.APART, 2, 2), (observer.JOINED, 1, 0)],
    ),
    "the same, mended": (
        [{"at_s": 0.5, "action": "cut", **N1_N2}, {"at_s": 0.7, "action": "restore", **N1_N2}],
        [(observer.CUT_OFF, 0, 2), (observer.APART, 2, 2), (observer.JOINED, 1, 0),
         (observer.CUT_OFF, 1, 0), (observer.APART, 0, 0), (observer.JOINED, 3, 0),
         (observer.UNROUTED, 2, 0), (observer.UNROUTED, 1, 0), (observer.UNROUTED, 0, 0)],
    ),
    "a cell in the middle": (
        [{"at_s": 0.5, "action": "kill", "node": "n2"}],
        [(observer.CUT_OFF, 0, 1), (observer.APART, 1, 1), (observer.JOINED, 1, 0)],
    ),
    "the last cell": (
        [{"at_s": 0.5, "action": "kill", "node": "n3"}],
        [(observer.CUT_OFF, 0, 0), (observer.JOINED, 2, 0)],
    ),
    "the PC's cable": (
        [{"at_s": 0.5, "action": "cut", "interface": 0}],
        [(observer.CUT_OFF, 0, 3), (observer.APART, 3, 3), (observer.JOINED, 0, 0)],
    ),
}  # fmt: skip
WATCHED = (observer.UNROUTED, observer.LOOP_OPEN, observer.LOOP_CLOSED, observer.CUT_OFF,
           observer.APART, observer.JOINED)  # fmt: skip


@pytest.mark.parametrize("what", ROUTES)
def test_what_a_fault_does_to_routes(what):
    events, expected = ROUTES[what]
    result = run(free(CHAIN, duration_s=1.0, event=events), plain=True)
    found = rows_since(result, 400_000, *WATCHED)
    assert [(int(row["code"]), int(row["a"]), int(row["b"])) for row in found] == expected


def settled(rule):
    """A skin under way whose cells 0, 1, 2 go by each other to the PC, in this order."""
    keys = free(CHAIN, duration_s=1.0, protocol={"rule": rule})
    running = simulate.simulation(plan_of(keys), plain=True)
    while running.advance(400_000, 1 << 30) != DONE:
        pass
    running.take()
    return running


def turns_to(running, cell, parent):
    """A cell takes a neighbour for its parent."""
    graph, world = running.plan.graph, running.world
    ends = (graph.peer[4 * cell + port] for port in range(4))
    port = [graph.node_of(end) if end >= 0 else -1 for end in ends].index(parent)
    before = int(world.run[0].rows)
    report(world.out, REPORT_BALANCE, 0, port)
    calls.finish(world, stack, cell, running.clock_us(), ON_TIMER, 0)
    return [(row.code, row.a) for row in world.rows[before : world.run[0].rows]
            if row.code >= observer.UNROUTED]  # fmt: skip


def test_a_loop_is_told_as_it_opens_and_as_it_closes():
    running = settled("paper")
    pc = running.plan.graph.sink
    assert turns_to(running, 1, 2) == [(observer.LOOP_OPEN, 2), (observer.UNROUTED, 2)]
    assert running.world.run[0].loops_open == running.world.run[0].loops == 1
    assert turns_to(running, 1, 0) == [(observer.LOOP_CLOSED, 0), (observer.UNROUTED, 0)]
    assert (running.world.run[0].loops_open, running.world.run[0].loops) == (0, 1)
    assert turns_to(running, 0, pc) == []
    assert running.world.run[0].broken == 0  # the rule as printed may


@pytest.mark.parametrize(("rule", "broken"), [("feasible", 1), ("strict", 1), ("paper", 0),
                                              ("paper-lax", 0)])  # fmt: skip
def test_a_loop_stops_a_run_under_the_rules_that_have_none(rule, broken):
    running = settled(rule)
    turns_to(running, 1, 2)
    assert (running.world.run[0].broken == observer.BROKEN_LOOP) == broken


def test_a_drop_before_the_first_route_is_early_and_one_later_is_not():
    running = settled("feasible")
    world = running.world
    for had, early in ((1, 0), (0, 1)):
        world.watch.had[1] = had
        before = list(world.counters)
        stack.on_report(world, 400_000, 1, REPORT_DROP, DROP_NO_ROUTE, 0)
        changed = {at: now - then for at, (now, then) in
                   enumerate(zip(world.counters, before, strict=True)) if now != then}  # fmt: skip
        assert changed == {own.NO_ROUTE: 1} | ({own.EARLY: 1} if early else {})


def test_every_row_of_the_observer_has_a_case():
    codes = {value for name, value in vars(observer).items()
             if name.isupper() and isinstance(value, int) and 100 <= value < 110}  # fmt: skip
    assert codes == set(WATCHED)
    seen = {code for _, rows in ROUTES.values() for code, *_ in rows}
    assert codes == seen | {observer.LOOP_OPEN, observer.LOOP_CLOSED}


# Commands: the book that is kept of whom the PC's commands reach.

NUMBER = 5


def ordered(cells=3):
    """A skin's book with command NUMBER, for cells 0 (had a way), 1 (had none), 2 (was off)."""
    keys = free(CHAIN, duration_s=0.1, command=[{"at_s": 0.05}])
    world = simulate.simulation(plan_of(keys), plain=True).world
    states = (orders.HAD_A_WAY, orders.HAD_NO_WAY, orders.WAS_OFF)
    world.watch.due_number[NUMBER] = NUMBER
    for cell, state in enumerate(states):
        world.watch.due[NUMBER * cells + cell] = state
    return world


def counted(world):
    """What is counted of commands, where it is not 0."""
    words = {"reached": own.REACHED, "repeated": own.REPEATED, "stray": own.STRAY,
             "off": own.MISSED, "no way": own.MISSED + 1, "lost": own.MISSED + 2,
             "no count": own.MISSED + 3}  # fmt: skip
    return {name: world.counters[word] for name, word in words.items() if world.counters[word]}


def comes(world, cell, number):
    orders.reach(world, 60_000, cell, SimpleNamespace(sq=number, made_at=50_000))


ORDERS = {
    "each once": ([(0, 5), (1, 5), (2, 5)], {"reached": 3}),
    "one twice": ([(0, 5), (0, 5)], {"reached": 1, "repeated": 1, "no way": 1, "off": 1}),
    "nobody's number": ([(0, 6)], {"stray": 1, "no way": 1, "off": 1, "lost": 1}),
    "an older one of the same slot": (
        [(1, 5 + orders.SLOTS)], {"stray": 1, "no way": 1, "off": 1, "lost": 1}),
    "none": ([], {"lost": 1, "no way": 1, "off": 1}),
    "all but who was off": ([(0, 5), (1, 5)], {"reached": 2, "off": 1}),
}  # fmt: skip


@pytest.mark.parametrize("what", ORDERS)
def test_what_becomes_of_a_command_is_booked(what):
    came, expected = ORDERS[what]
    world = ordered()
    for cell, number in came:
        comes(world, cell, number)
    orders.settle(world, NUMBER)
    assert counted(world) == expected
    orders.settle(world, NUMBER)  # nobody is missed twice
    assert counted(world) == expected


def test_every_count_of_commands_has_a_case():
    names = {name for _, expected in ORDERS.values() for name in expected}
    assert names == {"reached", "repeated", "stray", "off", "no way", "lost"}
