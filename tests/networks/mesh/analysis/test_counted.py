"""A mesh's summary, part by part: who was joined, what came after a death, flows, detours."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.analysis import summary as mesh
from innervate.networks.mesh.analysis.messages import messages
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.protocol.constants import (
    ALARM,
    ALL,
    DATA,
    FLOOD,
    MONITOR,
    PARITY,
    REPORT_ACCEPTED,
    REPORT_FULL,
    REQUEST,
)
from innervate.networks.mesh.scenario.plan import Offer
from innervate.scenario.actions.field import CUT, KILL, REVIVE
from tests.networks.mesh.analysis.test_summary import S, fault, given, made

FREE = 255


def run(*sent, came=(), refused=(), **plan):
    """Messages (s, from, to, flow); `came` has (which, receiver, ms, hops) of those delivered."""
    offers = [Offer(at * S, node, dest, 0, 8, flow) for at, node, dest, flow in sent]
    rows = [(one.at_us, one.node, REPORT_FULL if k in refused else REPORT_ACCEPTED, k, 100 + k)
            for k, one in enumerate(offers)]  # fmt: skip
    told = [given(offers[k].at_us + 1000 * ms, receiver, offers[k].node, 100 + k, hops=hops)
            for k, receiver, ms, hops in came]  # fmt: skip
    result = made(rows=rows, delivered=told, offers=offers, **plan)
    return messages(result), Ground(result.plan)


def shares(found):
    return found["sent"], found["delivered"], found["delivery_ratio"]


def test_a_message_is_connected_while_good_links_join_its_ends():
    cut = [fault(20 * S, CUT, 2, 3)]
    sent = (10, 1, 4, 0), (19, 1, 4, 0), (20, 1, 4, 0), (30, 1, 2, 0), (40, 1, ALL, 0)
    found, ground = run(*sent, came=((0, 4, 5, 3), (3, 2, 5, 1)), faults=cut)
    assert shares(mesh.connected(found, ground)) == (3, 2, 2 / 3)
    assert shares(mesh.connected(*run((50, 1, 4, 0), faults=cut))) == (0, 0, None)


@pytest.mark.parametrize(("monitor", "receiver", "joined"), [
    (4, None, False), (0, None, True), (MONITOR, None, True),  # that is the gateway, node 0
    (4, 0, True), (0, 4, False),  # whoever took it was the monitor then
])  # fmt: skip
def test_what_is_for_the_monitor_is_for_who_took_it_or_else_for_who_should(
    monitor, receiver, joined
):
    params = made().plan.params | {"monitor": monitor}
    came = () if receiver is None else ((0, receiver, 5, 1),)
    cut = [fault(5 * S, CUT, 3, 4)]
    found, ground = run((10, 1, MONITOR, 0), came=came, faults=cut, params=params)
    assert mesh.connected(found, ground)["sent"] == joined


def test_after_the_last_death_the_first_message_of_each_sender_counts_by_itself():
    dies = [fault(10 * S, KILL, 3), fault(20 * S, KILL, 4), fault(60 * S, REVIVE, 3)]
    sent = (10, 1, 2, 0), (19, 2, 1, 0), (20, 1, 2, 0), (21, 2, 1, 0), (22, 1, 2, 0)
    found, ground = run(*sent, came=((0, 2, 5, 1), (1, 1, 5, 1), (3, 1, 5, 1), (4, 2, 5, 1)),
                        faults=dies)  # fmt: skip
    after = mesh._after_deaths(found, ground, 100 * S)
    assert shares(after["first"]) == (2, 1, 0.5)
    assert shares(after["all"]) == (3, 2, 2 / 3)
    assert mesh._after_deaths(*run((10, 1, 2, 0), faults=dies[2:]), 100 * S) is None


def test_each_flow_is_counted_by_itself():
    sent = (10, 1, 4, 7), (11, 1, 4, 7), (12, 2, ALL, 7), (13, 3, 4, 2), (14, 3, 4, 2)
    found, ground = run(*sent, came=((0, 4, 5, 3), (3, 4, 8, 1)), refused=(4,))
    flows = mesh.flows(found, ground.plan)
    names = ("flow", "offered", "delivered", "lost", "refused", "counted", "broadcasts",
             "delivery_ratio")  # fmt: skip
    assert [tuple(flow[name] for name in names) for flow in flows] == [
        (2, 2, 1, 0, 1, 2, 0, 0.5), (7, 2, 1, 1, 0, 2, 1, 0.5),
    ]  # fmt: skip
    assert [flow["latency_ms"]["max"] for flow in flows] == [8.0, 5.0]


def test_stretch_is_of_the_shortest_way_there_was():
    sent = (10, 1, 4, 0), (11, 1, 2, 0), (12, 3, 3, 0), (13, 1, 4, 0), (30, 1, 4, 0)
    came = (0, 4, 5, 6), (1, 2, 5, 1), (2, 3, 5, 0), (4, 4, 5, 9)
    cut = [fault(20 * S, CUT, 2, 3)]
    found, ground = run(*sent, came=came, faults=cut)
    made_of = mesh.stretch(found, ground)  # 6 of 3 hops, 1 of 1; that over no good link has none
    assert made_of["mean"] == pytest.approx(1.5)
    assert made_of["p99"] == pytest.approx(1.99)
    assert made_of["hops_mean"] == pytest.approx(16 / 3)
    nothing = mesh.stretch(*run((10, 1, 4, 0)))
    assert nothing == {"mean": None, "p99": None, "hops_mean": None}


def test_who_has_a_next_hop_may_have_an_alternate_for_it():
    width = 6
    blank = [FREE] * 2 * width

    def node(bank, next_, alt, version=1):
        first = width * bank
        ways, spare = list(blank), list(blank)
        ways[first : first + 5], spare[first : first + 5] = next_, alt
        ways[5] = spare[5] = 1  # nobody's
        return Of(version=version, bank=bank, next=ways, alt=spare)

    known = node(1, [1, 2, FREE, 3, 1], [2, FREE, 4, FREE, 3])
    other = node(0, [FREE] * 4 + [0], [1] * 5)
    none = node(0, [1] * 5, [1] * 5, version=0)
    params = made().plan.params | {"width": width}
    result = Of(plan=Of(nodes=3, params=params), world=Of(nodes=[known, other, none]))
    result.plan.nodes = 5
    result.world.nodes += [none, none]
    assert mesh.alternates(result) == 3 / 5
    result.world.nodes = [none] * 5
    assert mesh.alternates(result) is None


def packet(at, node, length, *, kind=DATA, flags=0, seq=7, origin=1, to=3):
    return (at, at + 900, node, kind, flags, to, origin, 4, seq, length, 30, 1)


FIRST = packet(S, 2, 2)


@pytest.mark.parametrize(("again", "count"), [
    (packet(S + 100, 2, 3), 1), (packet(S + 100, 2, 2), 0),  # a retry of the hop
    (packet(S + 249_999, 2, 3), 1), (packet(S + 250_000, 2, 3), 0),  # one from end to end
    (packet(S + 100, 3, 3), 0), (packet(S + 100, 2, 3, seq=8), 0),
    (packet(S + 100, 2, 3, origin=0), 0), (packet(S + 100, 2, 3, kind=ALARM), 0),
    (packet(S + 100, 2, 3, flags=PARITY), 0), (packet(S + 100, 2, 3, to=ALL), 0),
    (packet(S + 100, 2, 3, flags=FLOOD), 0),
])  # fmt: skip
def test_a_node_has_a_packet_again_if_it_passes_it_on_with_a_longer_path(again, count):
    assert mesh.looped(made(sent=[FIRST, again])) == count
    assert mesh.looped(made(sent=[again, FIRST])) == count


def test_a_packet_that_met_nodes_twice_counts_once():
    met = [packet(S + k, 2, 2 + k) for k in range(4)]
    told = given(2 * S, 4, 1, 7, looped=1)
    assert mesh.looped(made(sent=met, delivered=[told, given(2 * S, 4, 1, 9)])) == 1
    assert mesh.looped(made(sent=met, delivered=[given(2 * S, 4, 1, 9, looped=1)])) == 2
    asked = [packet(S, 2, 2, kind=REQUEST), packet(S + 9, 2, 3, kind=REQUEST)]
    assert mesh.looped(made(sent=asked)) == mesh.looped(made()) == 0
