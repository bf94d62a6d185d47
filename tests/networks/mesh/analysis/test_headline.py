"""The headline of a mesh on both sides: all is well, and each of the ways in which it is not."""

import numpy as np
import pytest

from innervate.analysis.headline import DEGRADED, DOWN, NO_DATA, OK
from innervate.analysis.ways import NOWHERE
from innervate.networks.mesh.analysis.headline import Traffic, headline
from innervate.networks.mesh.analysis.reach import Choices, ways

WELL = Traffic(decided=91, delivered=91, crossings=2, learned=2, flows=True)


def flags(count, *those):
    return np.isin(np.arange(count), those)


def chain(named, links, *, gateway=0, off=(), leads=(0,), near=(), goes_back=True, ends=None):
    """Ways of nodes that know `named` next hops, over links given as pairs."""
    count = len(named)
    wide = max(1, *map(len, named))
    carries = np.zeros((count, count), np.bool_)
    for a, b in links:
        carries[a, b] = carries[b, a] = True
    around = np.zeros((count, count), np.bool_)
    for a, b in near or links:
        around[a, b] = around[b, a] = True
    filled = [[*row, *[NOWHERE] * (wide - len(row))] for row in named]
    known = Choices(
        gateway=np.array(ends or [gateway] * count),
        named=np.array(filled),
        neighbours=around,
        goes_back=goes_back,
    )
    on = ~flags(count, *off)
    return ways(known, carries, on, ~on, flags(count, *leads))


LINE = [(0, 1), (1, 2), (2, 3)]
RING = [*LINE, (3, 0)]
DOWNHILL = [[], [0], [1], [2]]


def all_well():
    return chain(DOWNHILL, LINE)


def test_all_is_well_only_if_nothing_is_missing():
    found = headline(all_well(), WELL)
    assert found.level == OK
    assert found.text == (
        "The monitor learned of both crossings of the fence; all 91 messages were delivered; "
        "all 4 nodes have a way to the gateway."
    )
    assert found.nodes == ()


@pytest.mark.parametrize(("change", "words", "nodes"), [
    ({"delivered": 90, "about": (2,)}, "1 of 91 messages was not delivered", (2,)),
    ({"learned": 1, "about": (3,)}, "The monitor never learned of 1 of 2 crossings", (3,)),
    ({"broadcasts": 9, "partial": 2, "about": (1,)},
     "2 of 9 broadcasts did not reach every node that was on", (1,)),
    ({"doubled": 1}, "1 message came twice", ()),
    ({"looped": 31}, "31 packets met a node twice on the way", ()),
    ({"false": 1, "about": (2,)}, "1 alarm was false, of a robot that was inside", (2,)),
    ({"false": 12}, "12 alarms were false, each of a robot that was inside", ()),
])  # fmt: skip
def test_what_was_lost_or_came_twice_is_in_the_headline(change, words, nodes):
    found = headline(all_well(), WELL._replace(**change))
    assert found.level == DEGRADED
    assert found.text.startswith(words)
    assert found.nodes == nodes


def test_the_worst_news_come_first():
    text = headline(all_well(), WELL._replace(delivered=90, learned=0, looped=1)).text
    assert text == (
        "The monitor learned of none of 2 crossings of the fence; 1 of 91 messages was not "
        "delivered; 1 packet met a node twice on the way."
    )


def test_nothing_delivered_is_down():
    found = headline(all_well(), Traffic(decided=3, delivered=0))
    assert (found.level, found.text) == (DOWN, "None of 3 messages was delivered.")
    found = headline(all_well(), Traffic(decided=1, crossings=1))
    assert found.text == ("The monitor never learned of the only crossing of the fence; "
                          "the only message was not delivered.")  # fmt: skip


def test_of_all_that_was_sent_one_alarm_that_came_is_something():
    found = headline(all_well(), Traffic(decided=3, delivered=0, crossings=2, learned=1))
    assert found.level == DEGRADED
    found = headline(all_well(), Traffic(decided=3, delivered=1, crossings=2, learned=0))
    assert found.level == DEGRADED
    assert headline(all_well(), Traffic(decided=3, crossings=2)).level == DOWN


def test_what_came_too_late_to_count_is_something_that_gets_through():
    """An old message that is still on its way keeps all that are younger out of the count."""
    lost = Traffic(crossings=1, flows=True)
    found = headline(all_well(), lost)
    assert (found.level, found.text) == (
        DEGRADED, "The monitor never learned of the only crossing of the fence."
    )  # fmt: skip
    assert headline(all_well(), Traffic(decided=2, flows=True)).level == DEGRADED
    assert headline(all_well(), lost._replace(flows=False)).level == DOWN


def test_a_dead_node_is_said_although_all_was_delivered():
    found = headline(chain(DOWNHILL, LINE, off=(3,)), WELL)
    assert found.level == DEGRADED
    assert found.text.startswith("1 of 4 nodes is off; the monitor learned of both")
    assert found.nodes == (3,)


def test_who_is_cut_off_is_told_from_who_has_no_way():
    found = headline(chain(DOWNHILL, LINE, off=(1,)))
    assert found.level == DOWN  # none of those that are on gets through
    assert found.text == (
        "2 of 4 nodes are cut off from the gateway: no link that works leads to them; "
        "1 of 4 nodes is off."
    )
    assert found.nodes == (1, 2, 3)
    # Without anything that is passed on: 2 insists on 1, although 3 would lead on.
    stuck = chain(DOWNHILL, RING, off=(1,), near=[(0, 3)], goes_back=False)
    assert stuck.astray.tolist() == [False, False, True, True]
    found = headline(chain([[], [0], [1], [0]], RING, off=(1,), near=[(0, 3)], goes_back=False))
    assert found.level == DEGRADED
    assert found.text == "1 of 4 nodes has no way to the gateway; 1 of 4 nodes is off."
    assert found.nodes == (1, 2)


def test_a_search_passes_by_whom_nobody_answers_for():
    around = chain(DOWNHILL, RING, off=(1,))
    assert not around.without.any()
    assert around.hop.tolist() == [NOWHERE, NOWHERE, 3, 0]  # not who is off
    assert around.depth.tolist() == [0, NOWHERE, NOWHERE, NOWHERE]


def test_next_hops_that_go_round_in_circles_lead_nowhere_unless_packets_search():
    circle = [[], [2], [1], [2]]
    assert chain(circle, LINE, near=[(1, 2), (2, 3)], goes_back=False).astray.sum() == 3
    assert not chain(circle, LINE, near=LINE).without.any()


def test_packets_for_a_gateway_that_does_not_lead_any_more_do_not_arrive():
    found = chain(DOWNHILL, LINE, leads=(3,), ends=[0, 0, 0, 3])
    assert found.astray.tolist() == [True, True, True, False]
    assert not found.cut_off.any()


def test_without_a_gateway_nothing_gets_through_but_between_peers():
    lost = chain(DOWNHILL, LINE, off=(0,), leads=())
    found = headline(lost)
    assert found.level == DOWN
    assert found.text.startswith("No node leads as gateway, and what is sent to it does not")
    assert headline(lost, Traffic(decided=2, delivered=2, flows=True)).level == DEGRADED


def test_before_anybody_has_heard_a_gateway_nothing_is_known():
    start = chain([[], [], []], [(0, 1)], gateway=NOWHERE, leads=())
    assert headline(start).level == NO_DATA
    assert headline(start, Traffic(decided=1)).level == DOWN  # but that something was lost


def test_all_that_is_off_is_down():
    found = headline(chain(DOWNHILL, LINE, off=(0, 1, 2, 3)), WELL)
    assert found.level == DOWN
    assert "all 4 nodes are off" in found.text


def test_a_gateway_alone_is_well():
    assert headline(chain([[]], [])).level == OK


def test_a_way_is_no_longer_than_a_path_may_be():
    count = 27
    line = [(i, i + 1) for i in range(count - 1)]
    tables = chain([[], *[[i] for i in range(count - 1)]], line)
    searching = chain([[] for _ in range(count)], line)
    for found in (tables, searching):
        assert found.astray.nonzero()[0].tolist() == [25, 26]


def test_broadcasts_that_reached_everybody_are_said_with_what_came():
    text = headline(all_well(), WELL._replace(broadcasts=2)).text
    assert "; both broadcasts reached every node that was on; all 4 nodes have" in text


def test_where_there_is_nobody_else_no_broadcast_reached_everybody():
    found = headline(chain([[]], []), Traffic(broadcasts=1))
    assert (found.level, found.text) == (OK, "The only node leads.")


def test_a_network_in_two_parts_with_a_gateway_each_is_not_well():
    halves = chain([[], [0], [3], []], [(0, 1), (2, 3)], leads=(0, 3), ends=[0, 0, 3, 3])
    assert not halves.without.any()
    found = headline(halves, WELL)
    assert found.level == DEGRADED
    assert found.text.startswith("2 nodes lead as gateways, each followed by a part")
