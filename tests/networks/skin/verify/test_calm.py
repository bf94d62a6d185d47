"""What a fair schedule starts from: a state, and those that the search may have left out."""

from functools import partial
from itertools import chain, combinations, product
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.skin.verify import calm, fair, row
from innervate.networks.skin.verify import world as w
from innervate.networks.skin.verify.row import IS_PARENT
from innervate.networks.skin.verify.system import system_of
from innervate.verify import search as s
from tests.networks.skin.verify.tiny import PC, Tiny

BEACON = (1, 40, 0)
OTHER = (2, 41, 0)


def kept(tiny, insert, index=0, among=1):
    """The states that an insertion keeps of one, beside others that are no matter."""
    here = tiny.twin.row()
    rows = np.frombuffer(here * among, np.int64).copy()
    space = fair._Space(tiny.model, True, 1 << 20)
    source, target = space.rows(rows.data), space.rows()
    insert(tiny.world, source.search, target.search, index)
    tiny.twin.put(here)
    return [target.row(i) for i in range(target.count)], list(target.search.before[: target.count])


def changed(tiny, change):
    """The state as a change of the world would leave it, and the world as it was."""
    here = tiny.twin.row()
    change(tiny)
    after = tiny.twin.image()
    tiny.twin.put(here)
    return after


def waiting(*holds):
    """Cells that have had no route for so long, by what is known."""
    tiny = Tiny(3, keep=True)
    for cell, hold in enumerate(holds):
        tiny.cell(cell, HOLD=hold)
    return tiny


@pytest.mark.parametrize(("holds", "may"), [
    ((5, 5), (0, 1)), ((4, 5), (1,)), ((5, 4), (0,)), ((4, 4), ()),
])  # fmt: skip
def test_any_of_those_that_may_have_waited_long_enough_may_forget_in_the_next_round(holds, may):
    tiny = waiting(*holds)
    periods = int(tiny.world.params[0].hold_periods)
    some = chain.from_iterable(combinations(may, count) for count in range(len(may) + 1))

    def forgets(cells):
        return changed(tiny, lambda one: [one.cell(c, HOLD=periods - 1) for c in cells])

    wanted = {forgets(cells) for cells in some}
    found, before = kept(tiny, calm.insert_expiring, index=1, among=2)
    assert set(found) == wanted
    assert len(found) == len(wanted) == 2 ** len(may)
    assert set(before) == {1}


def test_who_is_cut_off_or_has_a_parent_does_not_forget():
    tiny = waiting(5, 5).cut(0, 1)
    tiny.port(0, PC, 0, 40, IS_PARENT)
    assert len(kept(tiny, calm.insert_expiring)[0]) == 1


@pytest.mark.parametrize(("loss", "queues", "more"), [
    (1, {}, 0), (0, {(0, 1): 1}, 0), (1, {(0, 1): 1}, 1), (1, {(0, 1): 2, (1, 0): 1}, 2),
])  # fmt: skip
def test_the_last_beacon_of_each_direction_may_have_been_lost(loss, queues, more):
    def put(tiny, counts):
        for way, count in counts.items():
            tiny.queue(*way, *[BEACON, OTHER][:count])
        return tiny

    tiny = put(Tiny(updates="periodic", lean=False, faults={"loss": loss}), queues)
    assert tiny.model.merges
    found, before = kept(tiny, calm.insert_lost)
    assert len(found) == 1 + more
    assert found[0] == changed(tiny, lambda one: None)
    assert set(before) == {0}
    tiny.twin.put(found[-1])
    if more:
        lost = max(queues, key=lambda way: tiny.way(*way))
        assert tiny.queue(*lost) == [BEACON, OTHER][: queues[lost] - 1]
        assert tiny.budget()[0] == loss - 1


def test_what_comes_before_a_round_is_told_by_a_number():
    """A state from which one may forget, and one whose beacon may have been lost."""
    play = fair.build(system_of())

    def played(tiny, which):
        kept_of = partial(play, nodes=which, begin=0, end=1)
        return kept(tiny, lambda world, source, target, _: kept_of(world, source, target))

    old, late = waiting(5, 4), Tiny(updates="periodic", lean=False, faults={"loss": 1})
    late.queue(0, 1, BEACON)
    for tiny, which, insert in (
        (old, fair.EXPIRY, calm.insert_expiring), (late, fair.LOST, calm.insert_lost),
    ):  # fmt: skip
        found = played(tiny, which)
        assert len(found[0]) == 2
        assert found == kept(tiny, insert)


def test_a_table_that_grows_still_knows_its_states():
    tiny = Tiny(3, keep=True)
    space = fair._Space(tiny.model, True, 1 << 20)
    rows = space.rows()
    assert s.insert(tiny.world, rows.search, 0)
    slots = len(rows.search.table)
    rows.grow(space.refill())
    assert rows.seen is rows.search  # plain: what is played on is the table itself
    assert len(rows.search.table) == 2 * slots == rows.search.run[s.SLOTS]
    assert not s.insert(tiny.world, rows.seen, 0)
    assert rows.count == 1


def draw(world, sizes):
    """Draws of a round, out of so many each: what they gave."""
    given = []
    for size in sizes:
        given.append(row.next_draw(world))
        row.note_draw(world, size)
    return tuple(given)


SIZES = (), (2,), (3, 2), (2, 4, 3)


@pytest.mark.parametrize("sizes", SIZES)
@pytest.mark.parametrize("said", [s.TOO_MANY, 0])
def test_where_there_is_no_room_for_what_comes_before_a_round_it_is_counted(said, sizes):
    """Once for each way in which draws turn out: all of them, not the same for all draws."""
    drawn = []

    def settle(world):
        world.found[0] = said
        drawn.append(draw(world, sizes))
        return True

    play = fair.build(Of(settle=settle, turn=None, is_settled=None))
    seen = []

    def played(world, source, target, _):
        play(world, source, target, fair.CALM, 0, 1)
        seen.append(target.run[s.LEFT_OUT])

    assert len(kept(Tiny(), played)[0]) == 1
    assert drawn == list(product(*map(range, sizes)))
    assert seen == [len(drawn) if said else 0]


@pytest.mark.parametrize("sizes", SIZES)
@pytest.mark.parametrize("said", [s.TOO_MANY, 0])
def test_where_there_is_no_room_for_what_a_round_sends_it_is_counted(said, sizes):
    """Once for each order in which the nodes have their turns, and each way draws turn out."""
    drawn = []

    def turn(world, node):
        world.found[0] = said
        if node == 1:
            drawn.append(draw(world, sizes))
        return True

    play = fair.build(Of(settle=None, turn=turn, is_settled=lambda world: True))
    seen = []

    def played(world, source, target, _):
        play(world._replace(orders=[0, 1, 2] * 3), source, target, 3, 0, 1)
        seen.extend((target.run[s.LEFT_OUT], target.run[s.GENERATED]))

    assert kept(Tiny(), played) == ([], [])
    assert drawn == 3 * list(product(*map(range, sizes)))
    assert seen == [len(drawn) if said else 0, len(drawn)]


def test_of_a_round_with_very_many_draws_the_first_are_tried_in_every_way():
    world = Tiny(3).world
    calm.draw_first(world)
    sizes = [1] * (w.DRAWS - 1) + [2, 2]
    seen = {draw(world, sizes)}
    while calm.draw_otherwise(world):
        seen.add(draw(world, sizes))
    assert seen == {(0,) * (w.DRAWS - 1) + (last, 0) for last in (0, 1)}


def test_what_rounds_had_no_room_for_is_added_up():
    def play(world, source, target, nodes, begin, end):
        target.run[s.LEFT_OUT], target.run[s.GENERATED], target.run[s.NEXT] = 3, 5, -end

    tiny = Tiny()
    given = np.frombuffer(tiny.twin.row(), np.int64).copy()
    space = fair._Space(tiny.model, True, 1 << 20)
    source = space.rows(given.data)
    player = fair._Player(space, play, fair.Fair(bound=9), None)
    for _ in range(2):
        player.round(source, player.nodes)
    assert (player.fair.left_out, player.fair.played) == (6, 10)
