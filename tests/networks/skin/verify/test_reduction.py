"""What is forgotten of a state, rule by rule, each with what it must not touch."""

import pytest

from innervate.networks.skin.protocol.constants import INFINITY
from innervate.networks.skin.verify.row import (
    FD_KNOWN,
    HAS_TICKED,
    IS_CHILD,
    IS_PARENT,
    IS_SOON,
    LOADED,
    NOTHING_SENT,
    PENALTY,
    SQ_KNOWN,
    WAS_PARENT,
)  # fmt: skip
from innervate.networks.skin.verify.world import ANY
from tests.networks.skin.verify.tiny import NOTHING, PC, Tiny

GOOD = (5, 40, 0)  # a port that says: 5 hops, number 40
STRICT = {"rule": "strict"}
RISING = {"rule": "strict", "faults": {"restart": 0}}
FORGETFUL = {"rule": "strict", "faults": {"restart": 1}}
PERIODIC = {"updates": "periodic"}
RESTART = {"restart": 1}


# Feasible distances.


@pytest.mark.parametrize(
    ("keys", "flags", "left"),
    [
        ({}, FD_KNOWN, (FD_KNOWN, 40, 5)),
        ({}, 0, (0, 0, 0)),  # what is left behind when it is forgotten
        (STRICT, FD_KNOWN, (0, 0, 0)),  # that rule reads none
        ({"rule": "paper"}, FD_KNOWN, (0, 0, 0)),
    ],
)
@pytest.mark.parametrize("ticks", [0, 3])
@pytest.mark.parametrize("updates", ["periodic", "triggered"])
def test_a_feasible_distance_is_read_where_it_is_set_and_by_one_rule(
    keys, flags, left, ticks, updates
):
    tiny = Tiny(ticks, updates=updates, **keys).cell(1, FLAGS=flags, FD_SQ=40, FD_DIST=5).tidy()
    assert (tiny.head(1, "FLAGS"), tiny.head(1, "FD_SQ"), tiny.head(1, "FD_DIST")) == left


def test_a_cell_that_never_ticks_again_is_left_as_it_is():
    for ticks, said in ((0, (5, 40, IS_CHILD | LOADED)), (1, NOTHING)):
        tiny = Tiny(ticks, **PERIODIC)
        tiny.port(1, 0, 5, 40, IS_CHILD | LOADED)
        assert tiny.tidy().port(1, 0) == said
    for more in ({"keep": True}, {"updates": "triggered"}):  # frames still change it
        tiny = Tiny(0, **PERIODIC | more)
        tiny.port(1, 0, 5, 40, IS_CHILD | LOADED)
        assert tiny.tidy().port(1, 0) == NOTHING


# The PC.


@pytest.mark.parametrize(("counts", "keep", "kept"), [(0, False, 0), (1, False, 7), (0, True, 7)])
def test_a_pc_that_never_sends_again_remembers_nothing(counts, keep, kept):
    names = ("PC_SQ", "PC_FLAGS", "PC_PERIODS", "PC_LISTEN")
    tiny = Tiny(counts=counts, keep=keep).pc(**dict.fromkeys(names, 7)).tidy()
    assert tuple(tiny.row[tiny.lay.pc_at : tiny.lay.pc_at + 5]) == (*[kept] * 4, counts)


# Cells.


@pytest.mark.parametrize(
    ("keys", "ticked"),
    [({}, 0), (PERIODIC, 0), (STRICT, HAS_TICKED), (STRICT | PERIODIC, 0),
     ({"rule": "paper"}, HAS_TICKED)],
)  # fmt: skip
def test_that_a_cell_has_ticked_matters_where_its_first_tick_chooses(keys, ticked):
    tiny = Tiny(**keys).cell(0, FLAGS=HAS_TICKED | SQ_KNOWN).tidy()
    assert tiny.head(0, "FLAGS") == ticked | SQ_KNOWN


def test_the_number_sent_last_is_read_by_no_rule():
    assert Tiny().cell(0, SENT_SQ=40, SENT_DIST=3).tidy().head(0, "SENT_SQ") == 0


# FD_HOLD is 9 periods for two cells.
@pytest.mark.parametrize(
    ("ticks", "hold", "keys", "left"),
    [
        (3, 5, {}, 0),
        (3, 6, {}, 6),  # at its third tick it has been without a route for 9 periods
        (ANY, 8, {}, 0),
        (1, 2, {"hold": 4}, 0),
        (1, 3, {"hold": 4}, 3),
        (3, 3, {"keep": True}, 0),
        (7, 3, {"keep": True}, 3),  # the fair schedule would have to try more times than there are
    ],
)
def test_how_long_a_cell_had_no_route_matters_where_it_can_become_too_long(ticks, hold, keys, left):
    assert Tiny(ticks, **keys).cell(1, HOLD=hold).tidy().head(1, "HOLD") == left


@pytest.mark.parametrize(
    ("cell", "change", "keys", "left"),
    [
        (1, {}, {}, 0),
        (1, {"HOLD": 8}, {}, 40),  # it may forget its feasible distance, and take any number
        (1, {}, STRICT, 40),
        (0, {}, {}, 40),  # the PC would hear it
        (0, {"SQ_OWN": 30}, {}, 0),  # and has that one
        (0, {"SQ_OWN": 31}, {}, 31),
        (0, {"SQ_OWN": 30}, {"faults": RESTART}, 30),
        (0, {}, {"counts": 0}, 0),  # a PC that never sends again
        (0, {}, {"counts": 0, "keep": True}, 40),
    ],
)
def test_the_number_of_a_cell_without_a_route_is_for_the_pc_alone(cell, change, keys, left):
    tiny = Tiny(**keys).pc(PC_SQ=30, PC_FLAGS=1).cell(cell, **{"SQ_OWN": 40} | change).tidy()
    assert tiny.head(cell, "SQ_OWN") == left


def test_a_cell_with_a_parent_keeps_its_number():
    tiny = Tiny().cell(1, SQ_OWN=40)
    tiny.port(1, 0, 5, 40, IS_PARENT)
    assert tiny.tidy().head(1, "SQ_OWN") == 40


def test_a_pc_that_knows_no_number_takes_any():
    tiny = Tiny().pc(PC_SQ=30, PC_FLAGS=0).cell(0, SQ_OWN=20).tidy()
    assert tiny.head(0, "SQ_OWN") == 20


# What ports have heard.

FEASIBLE = {"FLAGS": FD_KNOWN, "FD_SQ": 40, "FD_DIST": 5}
OWN = {"FLAGS": SQ_KNOWN, "SQ_OWN": 40}
ROUTES = [
    # Under `feasible`: a newer number, or the same one from nearer.
    ((4, 40), FEASIBLE, {}, True), ((5, 40), FEASIBLE, {}, False), ((6, 40), FEASIBLE, {}, False),
    ((9, 41), FEASIBLE, {}, True), ((1, 39), FEASIBLE, {}, False),
    ((9, 39), FEASIBLE | {"FLAGS": 0}, {}, True),  # none is set
    ((9, 39), FEASIBLE | {"HOLD": 8}, {}, True),  # it may be forgotten
    ((INFINITY, 41), FEASIBLE, {}, False), ((INFINITY, 41), {"HOLD": 8}, {}, False),
    # Under `strict`, where numbers only rise: a newer one than the own.
    ((9, 41), OWN, RISING, True), ((1, 40), OWN, RISING, False), ((1, 39), OWN, RISING, False),
    ((9, 39), OWN | {"FLAGS": 0}, RISING, True), ((9, 39), OWN, FORGETFUL, True),
    ((9, 39), OWN | FEASIBLE, FORGETFUL, True),
    ((9, 39), FEASIBLE, {"rule": "paper"}, True), ((9, 39), OWN, {"rule": "paper-lax"}, True),
    # Numbers of the row are bytes, compared as they are: 3 is not later than 250.
    ((1, 3), FEASIBLE | {"FD_SQ": 250}, {}, False),
]  # fmt: skip


@pytest.mark.parametrize(("said", "known", "keys", "kept"), ROUTES)
def test_what_can_never_become_the_route_is_forgotten(said, known, keys, kept):
    tiny = Tiny(**keys).cell(1, **known)
    tiny.port(1, 0, *said, 0)
    assert tiny.tidy().port(1, 0) == ((*said, 0) if kept else NOTHING)


@pytest.mark.parametrize(("said", "known", "keys", "kept"), ROUTES)
def test_but_not_of_the_parent(said, known, keys, kept):
    tiny = Tiny(**keys).cell(1, **known)
    tiny.port(1, 0, *said, IS_PARENT)
    gone = said[0] == INFINITY
    assert tiny.tidy().port(1, 0) == ((INFINITY, 0, IS_PARENT) if gone else (*said, IS_PARENT))


@pytest.mark.parametrize("more", [0, IS_PARENT, WAS_PARENT])
def test_who_says_that_we_are_its_parent_says_nothing_else(more):
    tiny = Tiny()
    tiny.port(1, 0, 5, 40, IS_CHILD | LOADED | more)
    assert tiny.tidy().port(1, 0) == (INFINITY, 0, more)


def test_the_load_that_a_cell_hears_is_read_by_no_rule_without_balancing():
    tiny = Tiny()
    tiny.port(1, 0, 5, 40, LOADED | PENALTY)
    assert tiny.tidy().port(1, 0) == (5, 40, PENALTY)


HEAL = {"faults": {"heal": 1}}
TWICE = (INFINITY, 0, 2 * PENALTY)


@pytest.mark.parametrize(
    ("said", "is_cut", "ticks", "keys", "gone"),
    [
        ((5, 40, PENALTY), False, 3, {}, False),
        ((5, 40, 3 * PENALTY), False, 3, {}, False),
        ((5, 40, 3 * PENALTY), False, 2, {}, True),  # more ticks than are left
        ((5, 40, 3 * PENALTY), False, 2, {"keep": True}, False),
        ((5, 40, PENALTY), False, 0, {}, True),
        ((5, 40, PENALTY), True, 3, {}, True),
        ((5, 40, PENALTY), True, 3, HEAL, False),
        ((5, 40, 0), True, 3, {}, False),  # it is not found broken yet
        ((INFINITY, 40, 0), True, 3, {}, True),
        ((INFINITY, 40, 0), False, 3, {}, False),
        ((INFINITY, 40, 0), True, 3, {"rule": "paper"}, False),
        ((INFINITY, 40, 0), True, 3, {"rule": "paper", "updates": "periodic"}, True),
        ((INFINITY, 40, 0), True, 3, {"rule": "strict"}, True),
        ((INFINITY, 40, 0), True, 3, FORGETFUL, False),
        ((5, 40, PENALTY | IS_PARENT), True, 3, {}, False),
    ],
)
def test_a_port_that_never_works_again(said, is_cut, ticks, keys, gone):
    for was in (0, WAS_PARENT):
        tiny = Tiny(ticks, **keys)
        tiny.port(1, 0, *said[:2], said[2] | was)
        tiny.queue(0, 1, (3, 90, 0))
        if is_cut:
            tiny.cut(0, 1)
        found = tiny.tidy().port(1, 0)
        if gone:
            assert found == (*TWICE[:2], TWICE[2] | was)
            assert tiny.queue(0, 1) == []
        else:
            assert found == (said[0], said[1] * (said[0] < INFINITY), said[2] | was)
            assert tiny.queue(0, 1) == [(3, 90, 0)]


# Frames on their way to a cell.


@pytest.mark.parametrize(
    ("frame", "left"),
    [((3, 90, LOADED), (3, 90, 0)), ((3, 90, IS_CHILD), NOTHING),
     ((3, 90, IS_CHILD | LOADED), NOTHING), ((INFINITY, 90, LOADED), NOTHING)],
)  # fmt: skip
def test_a_frame_that_offers_no_route_is_like_any_other_such(frame, left):
    tiny = Tiny()
    tiny.port(1, 0, *GOOD)
    tiny.queue(0, 1, (2, 80, 0), frame, (1, 70, 0))
    assert tiny.tidy().queue(0, 1) == [(2, 80, 0), left, (1, 70, 0)]


A, B, C = (3, 90, 0), (2, 90, 0), (3, 91, 0)


@pytest.mark.parametrize(
    ("frames", "left"),
    [
        ([A, A], [A]), ([A, A, A, B], [A, B]), ([B, A, A], [B, A]), ([A, B, A], [A, B, A]),
        ([A, B], [A, B]), ([A, C], [A, C]), ([A, A, B, B, B, C], [A, B, C]),
        ([A, NOTHING, (1, 1, IS_CHILD)], [A, NOTHING]),  # no route in other words
    ],
)  # fmt: skip
@pytest.mark.parametrize(("keys", "is_steady"), [
    ({}, True), (PERIODIC, True), (RISING, True), (FORGETFUL, False), ({"rule": "paper"}, False),
    ({"rule": "paper", "updates": "periodic"}, True),
])  # fmt: skip
def test_of_equal_frames_one_after_the_other_the_first_stays(frames, left, keys, is_steady):
    tiny = Tiny(9, **keys)
    tiny.port(1, 0, *GOOD)
    tiny.queue(0, 1, *frames)
    tidied = [NOTHING if says & IS_CHILD else (dist, sq, says) for dist, sq, says in frames]
    assert tiny.tidy().queue(0, 1) == (left if is_steady else tidied)


@pytest.mark.parametrize(
    ("frames", "left"),
    [([GOOD], []), ([GOOD, A, GOOD], [A, GOOD]), ([A, GOOD], [A, GOOD]),
     ([(5, 41, 0)], [(5, 41, 0)]), ([(4, 40, 0)], [(4, 40, 0)])],
)  # fmt: skip
def test_the_oldest_frames_are_none_while_they_say_what_was_heard(frames, left):
    for keys, found in (({}, left), (FORGETFUL, frames)):
        tiny = Tiny(**keys)
        tiny.port(1, 0, *GOOD)
        tiny.queue(0, 1, *frames)
        assert tiny.tidy().queue(0, 1) == found


@pytest.mark.parametrize(("says", "left"), [(0, [A]), (IS_PARENT, [(6, 39, 0), (5, 40, 0), A])])
def test_where_nothing_is_heard_frames_that_offer_no_route_change_nothing(says, left):
    tiny = Tiny().cell(1, **FEASIBLE)
    tiny.port(1, 0, INFINITY, 0, says)
    tiny.queue(0, 1, (6, 39, 0), (5, 40, 0), A)
    assert tiny.tidy().queue(0, 1) == left
    tiny = Tiny().cell(1, **FEASIBLE)
    tiny.port(1, 0, 9, 41, 0)  # a port with a route loses it by them
    tiny.queue(0, 1, (6, 39, 0), A)
    assert tiny.tidy().queue(0, 1) == [(6, 39, 0), A]


# News.


@pytest.mark.parametrize(
    ("sent", "parent", "stays"),
    [
        (6, (5, 40, IS_PARENT | WAS_PARENT), False),
        (6, (5, 40, IS_PARENT), True),  # the parent is another one than was said
        (7, (5, 40, IS_PARENT | WAS_PARENT), True),  # farther
        (5, (5, 40, IS_PARENT | WAS_PARENT), True),
        (NOTHING_SENT, (5, 40, IS_PARENT | WAS_PARENT), True),
        (NOTHING_SENT, (NOTHING_SENT - 1, 40, IS_PARENT | WAS_PARENT), True),
        (INFINITY, (INFINITY, 0, IS_PARENT | WAS_PARENT), False),
        (INFINITY, (5, 40, 0), False),  # no parent, and that was said
        (6, (5, 40, 0), True),
        (6, (5, 40, WAS_PARENT), True),
    ],
)
def test_a_timer_for_news_stays_while_there_are_news(sent, parent, stays):
    tiny = Tiny().cell(1, FLAGS=IS_SOON | SQ_KNOWN, SENT_DIST=sent)
    tiny.port(1, 0, *parent)
    assert tiny.tidy().head(1, "FLAGS") == SQ_KNOWN | IS_SOON * stays
    quiet = Tiny().cell(1, FLAGS=SQ_KNOWN, SENT_DIST=sent)
    assert quiet.tidy().head(1, "FLAGS") == SQ_KNOWN


# Frames on their way to the PC.

OLD, NEW, NEWER = (0, 30, LOADED), (0, 31, LOADED), (0, 32, LOADED)


@pytest.mark.parametrize(
    ("frames", "keys", "left"),
    [
        ([(3, 31, LOADED | IS_CHILD)], {}, [NEW]),  # the number stays, and nothing else
        ([(3, 31, IS_CHILD)], {}, []),  # without a load it has no number
        ([OLD, NEW], {}, [NEW]), ([NEW, OLD, NEWER], {}, [NEW, NEWER]),
        ([OLD], {"faults": RESTART}, [OLD]),
        ([(0, 29, LOADED)], {"counts": 0}, []), ([NEW], {"counts": 0}, []),
        ([NEW], {"counts": 0, "keep": True}, [NEW]),
        ([NEW, NEW, NEWER], {}, [NEW, NEWER]), ([NEW, NEWER, NEW], {}, [NEW, NEWER, NEW]),
        # One that comes twice matters to a PC that forgets between the two what it knew ...
        ([NEW, NEW], {"faults": RESTART}, [NEW, NEW]),
        # ... but it knew nothing new here, so that one is enough.
        ([OLD, OLD], {"faults": RESTART}, [OLD]),
        ([OLD, OLD], {"faults": {"restart": 2}}, [OLD, OLD]),
        ([OLD, OLD, OLD, NEW, NEW], {"faults": RESTART}, [OLD, NEW, NEW]),
    ],
)  # fmt: skip
def test_what_is_on_its_way_to_the_pc(frames, keys, left):
    tiny = Tiny(**keys).pc(PC_SQ=30, PC_FLAGS=1)
    tiny.queue(0, PC, *frames)
    assert tiny.tidy().queue(0, PC) == left


def test_a_pc_that_knows_no_number_has_no_old_ones():
    tiny = Tiny(faults=RESTART).pc(PC_SQ=30, PC_FLAGS=0)
    tiny.queue(0, PC, OLD, OLD)
    assert tiny.tidy().queue(0, PC) == [OLD, OLD]
