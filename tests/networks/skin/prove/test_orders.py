"""Any order of a cell's ports comes of those that are proved to change nothing."""

from itertools import permutations
from types import SimpleNamespace as Of

import pytest

from innervate.dialect.outbox import REPORT, SEND, SET_TIMER
from innervate.networks.skin.protocol.constants import NONE, PORTS
from innervate.networks.skin.prove import forgetting, pc
from innervate.networks.skin.prove.mirror import ORDERS, Mirror, _same_sent
from innervate.networks.skin.prove.reductions import SAID
from innervate.prove.records import Action
from innervate.prove.terms import Terms
from innervate.prove.theory import source


def test_all_orders_of_four_ports_come_of_the_two():
    found = edge = {tuple(range(PORTS))}
    while edge:
        edge = {tuple(order[p] for p in one) for one in edge for order in ORDERS.values()} - found
        found = found | edge
    assert found == set(permutations(range(PORTS)))


class Side:
    """What one of two runs sends: on each port, a timer last."""

    def __init__(self, terms, order, said):
        self.store, self.actions = {}, []
        zero, three = terms.number(0), terms.number(3)
        for place, port in enumerate((*order, None)):
            kind = SET_TIMER if port is None else SEND
            a = terms.number(1 if port is None else place)
            self.actions.append(Action(kind, terms.true, a, zero, three, f"frame {place}", ""))
            for name in SAID:
                self.store[f"frame {place}", name, None] = terms.number(said.get(port, 7))
        self.actions.append(Action(REPORT, terms.true, *[terms.number(place)] * 3, "", ""))
        self.all = self.store, Of(out=Of(actions=self.actions))


def same(how, said, image=None, timer=3):
    """Is what a cell sends the image of what another does? Both send on all ports."""
    terms, order = Terms(), ORDERS[how]
    back = [order.index(port) for port in range(PORTS)]
    one, other = Side(terms, range(PORTS), said), Side(terms, back, image or said)
    other.actions[PORTS].c = terms.number(timer)
    found = terms.all(*_same_sent(terms, Mirror(terms, order), one.all, other.all))
    return found is terms.true


@pytest.mark.parametrize("how", ORDERS)
def test_what_goes_out_on_a_port_goes_out_on_its_image(how):
    said = {port: 10 + port for port in range(PORTS)}
    assert same(how, said)
    assert not same(how, said, timer=4)
    for port in range(PORTS):
        assert not same(how, said, said | {port: 9})


@pytest.mark.parametrize(("rule", "count"), [(forgetting.ANY_RULE, 5), (0, 2)])
def test_a_dead_port_is_the_parents_or_another_is_or_none(rule, count):
    """Whose parent it is says no route alone; all others may have any reason to be dead."""
    asked = [step.args[3:] for step in forgetting.steps(rule)]
    others = {NONE, forgetting.PORT + 1}
    assert len(set(asked)) == len(asked) == count
    assert {parent for parent, why in asked if why != forgetting.NO_ROUTE} == others
    own = [(forgetting.PORT, forgetting.NO_ROUTE)] if rule == forgetting.ANY_RULE else []
    assert [one for one in asked if one[0] == forgetting.PORT] == own


def test_a_number_may_be_heard_at_any_port_that_there_is():
    step = pc._heard_alike(source(pc.ENTRY, None))
    there = step.terms.unknown("port'", 0, PORTS - 1)
    assert step.terms.less(there, step.was("own", "ports")) in step.facts
    assert [goal.name for goal in step.goals] == ["the same comes of it, and nothing is sent"]
