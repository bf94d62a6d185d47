"""The state of running nodes that declare nothing of their ways: who is joined, cut off, silent."""

from types import SimpleNamespace

import pytest

from innervate.web.live_map import Link, Place
from innervate.web.live_state import State

P = [Place(node, -1) for node in range(4)]
# A ring of three, and one alone. Numbers are those of paths at either end.
LINKS = [Link(P[0], P[1], (0,), (0,)), Link(P[1], P[2], (1, 2), (0,)), Link(P[0], P[2], (), (1,))]
ROOM = SimpleNamespace(places=P, links=LINKS, number={p: i for i, p in enumerate(P)},
                       key=lambda link: (link.a, link.b))  # fmt: skip


def said(*down, ports=(0, 1, 2), **more):
    """What a node says: its paths, of which some are down."""
    return {"paths": [{"port": port, "up": port not in down} for port in ports], **more}


def told(**changes):
    return {i: said() for i in range(4)} | {int(who[1:]): one for who, one in changes.items()}


def state(room=ROOM, off=(), leave=(), **changes):
    known = told(**changes)
    return State(room, {i: known[i] for i in known if i not in leave}, off)


@pytest.mark.parametrize(("leave", "changes", "up"), [
    ((), {}, [1, 1, 1]), ((1,), {}, [0, 0, 1]), ((), {"n1": said(0)}, [0, 1, 1]),
    ((), {"n1": said(1)}, [1, 1, 1]),  # one of two paths is enough
    ((), {"n1": said(1, 2)}, [1, 0, 1]), ((), {"n0": said(0, 1, 2)}, [0, 1, 0]),
    ((), {"n2": said(1)}, [1, 1, 0]), ((), {"n1": said(ports=(5,))}, [1, 1, 1]),
])  # fmt: skip
def test_a_link_is_up_while_both_ends_answer_and_take_what_comes_over_it(leave, changes, up):
    assert state(leave=leave, **changes).link_up.tolist() == up


@pytest.mark.parametrize(("leave", "changes", "look"), [
    ((), {}, (1, 0, 2)),  # the fourth has no link; two others have one to the first
    ((3,), {}, (0, 0, 2)), ((0,), {}, (1, 0, 1)), ((0, 1, 2), {}, (0, 0, 0)),
    ((3,), {"n1": said(0, 1, 2)}, (1, 0, 1)), ((3,), {"n0": said(0), "n2": said(1)}, (2, 0, 0)),
    ((0, 1, 2, 3), {}, (0, 0, 0)),
])  # fmt: skip
def test_those_have_a_way_whom_links_join_with_the_first_that_answers(leave, changes, look):
    one = state(leave=leave, **changes)
    assert (one.unconnected, one.lacking, one.left) == look


def test_without_any_links_nobody_lacks_one():
    room = SimpleNamespace(**vars(ROOM) | {"links": []})
    one = state(room, leave=(3,))
    assert (one.unconnected, one.lacking, one.left) == (0, 0, 3)


@pytest.mark.parametrize(("off", "changes", "up"), [
    ((), {"n1": said(0, 1, 2)}, [1, 1, 1, 1]), ((P[1],), {"n1": said(0, 1, 2)}, [1, 0, 1, 1]),
    ((P[1],), {"n1": said(0, 1)}, [1, 1, 1, 1]), ((P[1],), {"n1": said(ports=())}, [1, 1, 1, 1]),
])  # fmt: skip
def test_who_was_cut_off_counts_as_off_while_nothing_comes_over_any_path(off, changes, up):
    one = state(off=off, **changes)
    assert one.node_up.tolist() == up
    assert one.fields()["cut_off"] == [1 - value for value in up]


@pytest.mark.parametrize(("leave", "changes", "level", "text"), [
    ((), {"n3": said()}, "degraded", "No links join 1 of 4 nodes with the others."),
    ((3,), {}, "degraded", "1 of 4 nodes does not answer or is cut off."),
    ((0, 3), {}, "degraded", "2 of 4 nodes do not answer or are cut off."),
])  # fmt: skip
def test_the_headline_says_what_is_wrong(leave, changes, level, text):
    found = state(leave=leave, **changes).headline()
    assert (found.level, found.text) == (level, text)
    assert tuple(found.nodes) == leave


def test_the_headline_of_those_that_are_all_joined():
    room = SimpleNamespace(**vars(ROOM) | {"links": [*LINKS, Link(P[2], P[3], (), ())]})
    found = state(room).headline()
    assert (found.level, found.text) == ("ok", "All 4 nodes answer.")


def test_the_headline_of_one_and_of_two_that_answer():
    room = SimpleNamespace(**vars(ROOM) | {"places": P[:2], "links": LINKS[:1]})
    room.number = {place: at for at, place in enumerate(P[:2])}
    told = {at: {"counters": {}} for at in range(2)}
    assert State(room, told).judge().text == "Both nodes answer."


def test_where_nobody_answers_nodes_are_counted_and_not_their_ports():
    places = [P[0], Place(1, 0), Place(1, 1)]
    room = SimpleNamespace(**vars(ROOM) | {"places": places, "links": []})
    room.number = {place: at for at, place in enumerate(places)}
    assert State(room, {}).headline().text == "None of the 2 nodes answers."
    assert State(room, {}).fields()["unconnected"] is None
    one = State(room, {0: said(), 1: said(0, ports=(0, 1))}, [places[1]])
    assert one.cut_off == [False, True, False], "of a port its own path alone"


class Cut(State):
    is_off_when_cut = True


@pytest.mark.parametrize(("kind", "changed"), [(State, []), (Cut, [(P[1], False)])])
def test_what_has_changed_is_told_of_links_and_of_nodes_that_answered_all_the_time(kind, changed):
    before, after = kind(ROOM, told()), kind(ROOM, told(n1=said(0, 1, 2)))
    assert before.changed_links(after) == [(LINKS[0], False), (LINKS[1], False)]
    assert after.changed_links(before) == [(LINKS[0], True), (LINKS[1], True)]
    assert before.changed_places(after) == changed
    assert after.changed_places(before) == [(place, not up) for place, up in changed]
    gone = kind(ROOM, {i: one for i, one in told().items() if i != 1})
    assert before.changed_links(gone) == []
    assert before.changed_places(gone) == []
    assert after.changed_places(gone) == gone.changed_places(after) == []
    assert before.changed_links(gone) == gone.changed_links(after) == []
    fewer = SimpleNamespace(**vars(ROOM) | {"links": LINKS[:1], "places": P[:3]})
    assert kind(fewer, told()).changed_links(before) == [], "links that were not known before"
    less = SimpleNamespace(**vars(fewer) | {"links": [], "places": P[:1]})
    assert kind(less, told()).changed_places(after) == [], "nor nodes"


def test_whole_numbers_that_all_say_are_shown_of_everybody():
    one = state(n0=said(fields={"a": 1, "words": "x"}), n2=said(fields={"a": 3, "b": True}))
    assert one.more()["fields"] == {"a": [1, None, 3, None], "b": [None, None, True, None]}
    assert one.word(P[0], "nothing", 9) == 9
