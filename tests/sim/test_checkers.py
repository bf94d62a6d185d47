"""The checkers of runs, each made to find what it watches for, on both sides of it."""

from types import SimpleNamespace

import pytest

from innervate.networks.mesh.sim import recorder as mesh
from innervate.networks.radio.protocol.constants import DATA, REPORT
from innervate.networks.radio.sim import recorder as radio
from innervate.networks.skin.protocol.constants import (
    NONE,
    RULE_FEASIBLE,
    RULE_PAPER,
    RULE_STRICT,
)  # fmt: skip
from innervate.networks.skin.sim import checks, observer
from innervate.sim.cables import recorder as cables
from innervate.sim.cables.world import BROKEN_RANGE, DEAD
from innervate.sim.channel import medium

LOW, HIGH = [0, -5, 1], [0, 5, 100]
WELL = [0, 0, 50]


def ranged(words, **run):
    """A world of two nodes; `words` are those of node 1."""
    zero = {"broken": 0, "broken_node": -1, "checks": 1, "trail_limit": 0}
    return SimpleNamespace(
        words=[WELL, words], low=LOW, high=HIGH, run=[SimpleNamespace(**zero | run)]
    )


def check_cables(world):
    cables.check_range(world, 1)


def check_radio(world):
    radio.watch(world, 1, 0, 0, 0)


CHECKERS = {"cables": (check_cables, BROKEN_RANGE), "radio": (check_radio, medium.BROKEN_RANGE)}


@pytest.mark.parametrize("name", CHECKERS)
@pytest.mark.parametrize("place", range(3))
def test_a_value_below_or_above_its_range_is_found_and_one_at_its_end_is_not(name, place):
    check, code = CHECKERS[name]
    for value, found in ((LOW[place] - 1, True), (LOW[place], False), (HIGH[place], False),
                         (HIGH[place] + 1, True)):  # fmt: skip
        words = WELL.copy()
        words[place] = value
        world = ranged(words)
        check(world)
        run = world.run[0]
        assert (run.broken, run.broken_node) == ((code, 1) if found else (0, -1))


@pytest.mark.parametrize("name", CHECKERS)
def test_what_broke_first_is_told(name):
    check, _ = CHECKERS[name]
    world = ranged([0, 6, 50], broken=9, broken_node=0)
    check(world)
    assert (world.run[0].broken, world.run[0].broken_node) == (9, 0)


def test_without_checks_a_radio_is_not_looked_at():
    world = ranged([0, 6, 50], checks=0)
    check_radio(world)
    assert world.run[0].broken == 0


@pytest.mark.parametrize(
    ("time", "kind", "exclusive", "found"),
    [(1000, DATA, 1, False), (999, DATA, 1, True), (999, DATA, 0, False), (999, REPORT, 1, False)],
)
def test_data_begins_where_the_data_before_it_has_ended(time, kind, exclusive, found):
    run = SimpleNamespace(ta_us=50, slot_us=100, tap_limit=0, sent_limit=0, exclusive=exclusive,
                          data_until=0, broken=0, broken_node=-1)  # fmt: skip
    world = SimpleNamespace(run=[run])
    radio.record_sent(world, 2, SimpleNamespace(kind=DATA, slots=10), 0)  # from 50 to 1050
    radio.record_sent(world, 3, SimpleNamespace(kind=kind, slots=1), time)
    assert (run.broken, run.broken_node) == ((radio.BROKEN_TURNS, 3) if found else (0, -1))


# A mesh delivers a packet once.

FORGET_US = 1000


def delivered(*deliveries, boots=((0, 0, 0),), hops=1):
    """What is found of deliveries (receiver, origin, number, time) over so many hops."""
    run = SimpleNamespace(nodes=3, broken=0, broken_node=-1, duplicates=0, forget=FORGET_US,
                          checks=1, delivered_limit=0)  # fmt: skip
    world = SimpleNamespace(run=[run], duplicate_key=[0] * 16, duplicate_at=[0] * 16, radios=[])
    for k, (node, origin, seq, time) in enumerate(deliveries):
        now = boots[min(k, len(boots) - 1)]
        world.radios = [SimpleNamespace(boots=count) for count in now]
        frame = SimpleNamespace(origin=origin, seq=seq, path_len=hops)
        mesh.record_delivered(world, node, frame, time)
    return (run.broken, run.broken_node)


TWICE = (mesh.BROKEN_TWICE, 1)


@pytest.mark.parametrize(
    ("again", "found"),
    [
        ((1, 2, 7, 900), TWICE), ((1, 2, 7, 500 + FORGET_US - 1), TWICE),
        ((1, 2, 7, 500 + FORGET_US), (0, -1)),  # it may be forgotten by now
        ((0, 2, 7, 900), (0, -1)), ((1, 0, 7, 900), (0, -1)), ((1, 2, 8, 900), (0, -1)),
        ((1, 3, 7, 900), (0, -1)),  # of nobody who is there
    ],
)  # fmt: skip
def test_a_packet_that_is_delivered_again_is_found(again, found):
    assert delivered((1, 2, 7, 500), again) == found


def test_what_a_node_says_to_itself_is_on_no_path_and_none_of_them():
    assert delivered((1, 1, 7, 500), (1, 1, 7, 900), hops=0) == (0, -1)


def test_a_packet_that_keeps_coming_is_found_each_time_since_the_last():
    assert delivered((1, 2, 7, 0), (1, 2, 7, FORGET_US), (1, 2, 7, 2 * FORGET_US)) == (0, -1)
    assert delivered((1, 2, 7, 0), (1, 2, 7, FORGET_US), (1, 2, 7, 2 * FORGET_US - 1)) == TWICE


@pytest.mark.parametrize(("node", "found"), [(0, TWICE), (1, (0, -1)), (2, (0, -1))])
def test_whoever_was_switched_on_again_begins_anew(node, found):
    later = tuple(int(i == node) for i in range(3))
    assert delivered((1, 2, 7, 500), (1, 2, 7, 600), boots=((0, 0, 0), later)) == found


def test_keys_that_meet_in_the_table_are_told_apart():
    many = [(node, 2, seq, 10 * seq) for seq in range(5) for node in range(3)]
    assert delivered(*many) == (0, -1)
    assert delivered(*many, (2, 2, 0, 200))[0] == mesh.BROKEN_TWICE


@pytest.mark.parametrize(
    ("path", "looped"), [([], 0), ([3], 0), ([3, 4, 5], 0), ([3, 4, 3], 1), ([3, 4, 4], 1),
                         ([9, 1, 2, 3, 9], 1)],
)  # fmt: skip
def test_a_packet_that_a_node_sent_twice_has_been_round(path, looped):
    frame = SimpleNamespace(path=[*path, 3, 3], path_len=len(path))
    assert mesh.is_looped(frame) == looped


# Routes of a skin: a line PC - 0 - 1 - 2, and back from 2 to 0; ports 0 up, 1 down, 2 across.

PEERS = {0: 12, 1: 4, 4: 1, 5: 8, 8: 5, 2: 10, 10: 2, 12: 0}


class Routes:
    """A world as the observer sees it, and what it notes."""

    def __init__(self, rule=RULE_FEASIBLE, checked=1):
        also = "broken", "rows", "next_command", "commands"
        numbers = dict.fromkeys((*observer.NUMBERS, *also), 0)
        self.run = SimpleNamespace(cells=3, checks=checked, observe=1, broken_node=-1,
                                   broken_other=-1, row_limit=50, **numbers)  # fmt: skip
        self.watch = SimpleNamespace(port=[NONE] * 3, routed=[0] * 3, had=[0] * 3, joined=[1] * 3,
                                     apart=[NONE] * 3, ring=[NONE] * 3, before=[0] * 3,
                                     stack=[0] * 3)  # fmt: skip
        cells = [SimpleNamespace(fd_known=1, fd_sq=40, fd_dist=depth, parent=0)
                 for depth in range(3)]  # fmt: skip
        self.world = SimpleNamespace(
            run=[self.run], watch=self.watch, params=[SimpleNamespace(rule=rule)], cells=cells,
            ends=[SimpleNamespace(peer=PEERS.get(end, -1)) for end in range(13)],
            epoch=[0] * 13, alive=[1] * 4, rows=[SimpleNamespace() for _ in range(50)],
        )  # fmt: skip

    def follow(self, *routes):
        for time, (cell, port) in enumerate(routes):
            observer.follow(self.world, time, cell, port)
        return self

    def cut(self, *ends):
        for end in ends:
            self.world.epoch[end] ^= 1
        observer.remember(self.world)
        observer.on_links_changed(self.world, 100, 3, 0)
        return self

    def noted(self, code):
        rows = self.world.rows[: self.run.rows]
        return [(row.time, row.node, row.a, row.b) for row in rows if row.code == code]


DOWN = [(0, 0), (1, 0), (2, 0)]  # everybody goes towards the PC
RING = [(1, 0), (2, 0), (0, 2)]  # the last closes it


@pytest.mark.parametrize(
    ("own", "parent", "rule", "found"),
    [(2, 1, RULE_FEASIBLE, False), (1, 1, RULE_FEASIBLE, True), (1, 2, RULE_FEASIBLE, True),
     (1, 2, RULE_STRICT, False), (1, 2, RULE_PAPER, False)],
)  # fmt: skip
def test_a_route_to_who_is_no_nearer_is_found(own, parent, rule, found):
    routes = Routes(rule).follow(*DOWN)
    routes.world.cells[2].fd_dist, routes.world.cells[1].fd_dist = own, parent
    checks.check_route(routes.world, 2)
    run = routes.run
    told = (run.broken, run.broken_node, run.broken_other)
    assert told == ((observer.BROKEN_FEASIBLE, 2, 1) if found else (0, -1, -1))
    for cell, broken in ((0, 0), (2, 9)):  # to the PC, or when something broke before
        run.broken = broken
        checks.check_route(routes.world, cell)
        assert run.broken == broken
    run.broken = 0
    routes.world.epoch[8] = routes.world.epoch[5] = 1  # over a dead cable nothing goes
    checks.check_route(routes.world, 2)
    assert run.broken == 0


@pytest.mark.parametrize(
    ("rule", "checked", "found"),
    [(RULE_FEASIBLE, 1, True), (RULE_STRICT, 1, True), (RULE_PAPER, 1, False),
     (RULE_FEASIBLE, 0, False)],
)  # fmt: skip
def test_a_forwarding_loop_is_found_where_the_rule_promises_none(rule, checked, found):
    routes = Routes(rule, checked).follow(*RING)
    run = routes.run
    assert (run.broken, run.broken_node, run.broken_other) == (
        (observer.BROKEN_LOOP, 0, 2) if found else (0, -1, -1))  # fmt: skip
    assert routes.noted(observer.LOOP_OPEN) == [(2, 0, 3, 0)]
    assert (run.loops, run.loops_open) == (1, 1)


def test_a_loop_stands_until_one_leaves_it_or_its_cable_dies():
    routes = Routes(RULE_PAPER).follow(*RING, (1, NONE))
    assert routes.noted(observer.LOOP_CLOSED) == [(3, 0, 0, 0)]
    assert (routes.watch.ring, routes.run.loops_open) == ([NONE] * 3, 0)
    torn = Routes(RULE_PAPER).follow(*RING).cut(5, 8)
    assert torn.noted(observer.LOOP_CLOSED) == [(100, 0, 0, 0)]
    assert torn.run.loops_open == 0
    mended = torn.cut(5, 8)  # and closes again with the cable
    assert (mended.run.loops, mended.run.loops_open) == (2, 1)
    elsewhere = Routes(RULE_PAPER).follow(*RING).cut(0, 12)
    assert elsewhere.run.loops_open == 1


def test_who_has_a_route_is_known_whoever_takes_it_first():
    for order in (DOWN, DOWN[::-1], [DOWN[1], DOWN[2], DOWN[0]]):
        routes = Routes().follow(*order)
        assert (routes.watch.routed, routes.run.unrouted) == ([1, 1, 1], -3)
    assert Routes().follow(*DOWN[:2]).watch.routed == [1, 1, 0]
    assert Routes().follow(*DOWN, (1, NONE)).watch.routed == [1, 0, 0]
    assert Routes().follow(*DOWN, (1, NONE)).watch.had == [1, 1, 1]


@pytest.mark.parametrize(
    ("ends", "routed", "joined"),
    [((0, 12), [0, 0, 0], [0, 0, 0]), ((1, 4), [1, 0, 0], [1, 1, 1]),
     ((5, 8), [1, 1, 0], [1, 1, 1]), ((2, 10), [1, 1, 1], [1, 1, 1]),
     ((1, 4, 2, 10), [1, 0, 0], [1, 0, 0])],
)  # fmt: skip
def test_who_is_cut_off_and_who_only_lost_its_route(ends, routed, joined):
    routes = Routes().follow(*DOWN).cut(*ends)
    assert (routes.watch.routed, routes.watch.joined) == (routed, joined)
    lost, apart = 3 - sum(routed), 3 - sum(joined)
    assert routes.noted(observer.CUT_OFF) == [(100, 3, 0, lost)]
    assert routes.run.unrouted == lost - apart
    assert routes.noted(observer.APART) == ([(100, 3, apart, apart)] if apart else [])
    assert routes.noted(observer.JOINED) == [(100, 3, sum(joined), 0)] * (sum(joined) > 0)
    back = routes.cut(*ends)
    assert (back.watch.routed, back.watch.joined, back.run.unrouted) == ([1] * 3, [1] * 3, 0)
    assert back.run.apart == 0


def test_a_cell_that_is_off_is_not_cut_off():
    routes = Routes().follow(*DOWN)
    routes.world.alive[1] = DEAD
    routes.cut(1, 4, 5, 8, 2, 10)
    assert routes.noted(observer.APART) == [(100, 3, 1, 1)]
    assert routes.watch.apart == [NONE, NONE, 100]
