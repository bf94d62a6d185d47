"""Who has a place in the router now, from tables set by hand, on both sides of every limit."""

import pytest

from innervate.networks.mesh.live import turns
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.mesh.live.turns import FEW, FIRST, SILENT, SPARE, Places, Turns
from innervate.networks.mesh.protocol.constants import ALL, CONTROL, DATA, END_TO_END, OWN, PRIORITY
from innervate.networks.mesh.protocol.duplicates import UNREACHABLE
from innervate.networks.mesh.protocol.retransmission import AHEAD_MAX, SURE_AFTER

KEPT = 32


@pytest.fixture
def stack():
    made = MeshStack(1, -1, mesh_parameters(3, {}), 5)
    made.node.kept, made.node.seq = KEPT, 1000
    return made


def hold(stack, dest, count, tries=1, age=1):
    """The router keeps so many messages to a recipient."""
    node = stack.node
    free = [k for k in range(KEPT) if not node.wait_kind[k]][:count]
    for k in free:
        node.wait_kind[k], node.wait_dest[k] = DATA, dest
        node.wait_tries[k], node.wait_seq[k] = tries, node.seq + 1 - age


def takes(stack, dest=2, urgent=False, flags=END_TO_END, gone=(), all_wait=False, most=None):
    item = stack.item()
    item.dest, item.flags = dest, flags | (PRIORITY if urgent else 0)
    places = Places(stack, set(gone), all_wait, {} if most is None else most)
    return places.takes(item)


@pytest.mark.parametrize(("urgent", "limit"), [(False, OWN), (True, CONTROL)])
def test_the_queue_keeps_room_for_others(stack, urgent, limit):
    size = len(stack.node.q_state)
    for free, fits in ((limit, False), (limit + 1, True)):
        stack.node.q_state[:] = [0] * free + [1] * (size - free)
        assert takes(stack, urgent=urgent) == takes(stack, ALL, urgent, 0) == fits
        assert takes(stack, dest=1)  # oneself


@pytest.mark.parametrize("most", [None, FIRST, 10])
def test_a_recipient_has_so_many_places_and_urgent_messages_two_more(stack, most):
    limit, given = most or FIRST, {2: most} if most else {}
    hold(stack, 2, limit - 1)
    assert takes(stack, most=given)
    hold(stack, 2, 1)
    assert not takes(stack, most=given)
    assert takes(stack, dest=3, most=given)
    assert takes(stack, flags=0, most=given)  # nobody waits for its end
    assert takes(stack, ALL, flags=0, most=given)
    hold(stack, 2, SPARE - 1)
    assert takes(stack, urgent=True, most=given)
    hold(stack, 2, 1)
    assert not takes(stack, urgent=True, most=given)


@pytest.mark.parametrize(("urgent", "own"), [(False, 2), (True, 1)])
def test_the_last_places_are_for_who_has_none(stack, urgent, own):
    hold(stack, 2, 1)
    for other in range(10, 10 + KEPT - 1 - own - SPARE):
        hold(stack, other, 1)
    assert stack.node.wait_kind[:].count(0) == own + SPARE
    assert takes(stack, urgent=urgent)
    hold(stack, 100, 1)
    assert not takes(stack, urgent=urgent)
    assert takes(stack, 3, urgent)
    hold(stack, 101, SPARE - 1)
    assert takes(stack, 3, urgent)
    hold(stack, 102, 1)
    assert not takes(stack, 3, urgent)


def test_while_a_message_is_sent_again_its_recipient_has_half(stack):
    hold(stack, 2, 4)
    assert takes(stack, most={2: 10})
    stack.node.wait_tries[3] = 2
    assert takes(stack, most={2: 10})
    hold(stack, 2, 1)
    assert not takes(stack, most={2: 10})
    assert takes(stack, most={2: 12})
    stack.node.wait_tries[3] = 1
    assert takes(stack, most={2: 10})
    hold(stack, 3, 1, tries=2)  # that of another
    assert takes(stack, most={2: 10})


def test_half_is_as_many_as_at_first_at_least(stack):
    hold(stack, 2, FIRST + SPARE - 1, tries=2)
    assert takes(stack, urgent=True, most={2: FIRST + 1})
    hold(stack, 2, 1, tries=2)
    assert not takes(stack, urgent=True, most={2: FIRST + 1})


def test_who_does_not_answer_for_long_has_as_few_as_at_first(stack):
    hold(stack, 2, FIRST, tries=SURE_AFTER)
    most = {2: 10}
    assert takes(stack, most=most)
    assert most == {2: 10}
    stack.node.wait_tries[1] = SURE_AFTER + 1
    assert not takes(stack, most=most)
    assert most == {}  # also when it answers again


def test_a_message_is_not_too_far_ahead_of_one_that_is_kept_for_the_same(stack):
    hold(stack, 2, 1, age=AHEAD_MAX)
    assert takes(stack)
    assert takes(stack, ALL, flags=0)
    stack.node.wait_seq[0] -= 1
    assert not takes(stack)
    assert not takes(stack, urgent=True)
    assert not takes(stack, ALL, flags=0)
    assert takes(stack, dest=3)


def test_all_that_are_gone_have_a_few_places_together(stack):
    gone = (2, 3)
    hold(stack, 2, 1)
    hold(stack, 3, SILENT - 2)
    assert takes(stack, gone=gone)
    hold(stack, 3, 1)
    assert not takes(stack, gone=gone)
    assert takes(stack, urgent=True, gone=gone)
    assert takes(stack, 4, gone=gone)
    assert takes(stack, gone=(3,))
    hold(stack, 3, 1)
    assert not takes(stack, urgent=True, gone=gone)


def test_a_neighbour_that_is_heard_is_not_gone(stack):
    node = stack.node
    hold(stack, 3, SILENT)
    assert not takes(stack, gone=(2, 3))
    node.neighbour[2 % len(node.neighbour)] = 2
    assert takes(stack, gone=(2, 3))
    node.suspect[2 % len(node.neighbour)] = 1
    assert not takes(stack, gone=(2, 3))


def test_nobody_is_waited_for_in_vain_while_a_message_to_all_waits(stack):
    hold(stack, 4, 1, age=AHEAD_MAX + 1)
    assert takes(stack, gone=(2,))
    assert not takes(stack, gone=(2,), all_wait=True)
    assert takes(stack, gone=(), all_wait=True)
    stack.node.wait_seq[0] += 1
    assert takes(stack, gone=(2,), all_wait=True)


def item_to(stack, dest, urgent=False):
    item = stack.item()
    item.dest, item.flags = dest, END_TO_END | (PRIORITY if urgent else 0)
    return item


def test_who_is_first_of_its_queue_may_go(stack):
    made = Turns(stack, None)
    assert made.put(1, item_to(stack, 2))
    assert not made.put(2, item_to(stack, 2))
    assert not made.put(3, item_to(stack, 2))
    assert made.put(4, item_to(stack, 3))
    assert made.put(5, item_to(stack, 2, urgent=True))
    assert not made.put(6, item_to(stack, 2, urgent=True))
    assert (len(made), made.waiting()) == (6, {2: 5, 3: 1})


@pytest.mark.parametrize(("others", "own", "room"), [
    (0, turns.MOST - 1, True), (0, turns.MOST, False), (turns.MOST, FEW - 1, True),
    (turns.MOST, FEW, False), (turns.MOST - FEW - 1, FEW, True), (turns.MOST - FEW, FEW, False),
])  # fmt: skip
def test_room_is_for_all_together_and_a_little_for_each(stack, others, own, room):
    made = Turns(stack, None)
    made._count.update({2: own, 3: others})
    made._total = own + others
    assert made.has_room(2) == room


def test_places_grow_with_what_arrives_up_to_three_quarters(stack):
    made = Turns(stack, None)

    def ends(is_there):
        made._under_way[7] = 2
        made.ended(7, is_there)

    ends(True)
    assert made._most == {2: FIRST + 1}
    ends(None)
    assert made._most == {2: FIRST + 1}
    assert made._gone == set()
    for _ in range(40):
        ends(True)
    assert made._most == {2: stack.params.kept * 3 // 4} == {2: 24}
    ends(False)
    assert (made._most, made._gone) == ({}, {2})
    made._in_vain = "nobody"
    ends(None)
    assert made._gone == {2}
    made.heard(3)
    assert (made._gone, made._in_vain) == ({2}, "nobody")
    made.heard(2)
    assert (made._gone, made._in_vain) == (set(), None)


def test_places_are_so_many():
    assert (turns.MOST, FEW, FIRST, SILENT, SPARE) == (4096, 16, 4, 4, 2)


@pytest.mark.parametrize(("tries", "unreachable", "is_calm"), [
    (SURE_AFTER, False, True), (SURE_AFTER + 1, False, False), (SURE_AFTER, True, False),
    (SURE_AFTER + 1, True, False),
])  # fmt: skip
def test_all_is_calm_while_nobody_is_tried_for_long_and_nobody_unreachable(
    stack, tries, unreachable, is_calm
):
    hold(stack, 3, 1, tries=tries)
    if unreachable:
        stack.node.bad_neighbour[1], stack.node.bad_dest[1] = UNREACHABLE, 9
    assert Places(stack, set(), False, {})._is_calm == is_calm
