"""What happens in a mesh and who sends what: events and flows, from tables written here."""

from types import SimpleNamespace as Of

import pytest

import innervate
from innervate.networks.mesh.protocol.constants import ALL, MONITOR
from innervate.networks.mesh.scenario import access, events, traffic
from innervate.networks.mesh.scenario.nodes import Nodes
from innervate.scenario import ScenarioError
from innervate.scenario.actions.field import ACTIONS
from innervate.scenario.source import Source

EVENT, FLOW = innervate.Mesh.Event, innervate.Mesh.Flow
ROLES = {"gateway": 0, "monitor": 4}
GOOD = [(0, 1), (1, 2), (2, 3), (3, 4)]


def nodes(count=5, links=()):
    return Nodes(
        Source("", ""), [f"n{k}" for k in range(count)], links=dict.fromkeys(links, (1, 1))
    )


def told(*tables, spared=(), links=()):
    """(moment in s, what, to whom) of each fault."""
    model = innervate.Mesh(nodes=5, event=list(tables))
    found = events.faults(model, nodes(links=links), GOOD, spared, ROLES, -9000)
    return [
        (one.at_us / 1e6, ACTIONS[one.action], (one.node, one.other), one.value) for one in found
    ]


def kill(at_s, **whom):
    return EVENT(at_s=at_s, action="kill", **whom)


def test_events_are_told_in_order_of_time_then_of_the_file():
    found = told(kill(2.0, node=1), kill(1.0, node="n3"), kill(2.0, node="monitor"))
    assert [(at, node) for at, _, (node, _), _ in found] == [(1.0, 3), (2.0, 1), (2.0, 4)]


def test_random_events_hit_what_is_whole():
    """Not who is dead, who is spared, or who is away until an event switches it on."""
    there = [kill(1.0, random=1), EVENT(at_s=9.0, action="revive", node=3)]
    assert told(*there, spared=(0, 1, 4))[0][2] == (2, 0)
    with pytest.raises(ScenarioError, match="there is 1 node that is alive and no flow's end"):
        told(kill(1.0, random=2), there[1], spared=(0, 1, 4))
    there = [kill(2.0, random=2), kill(1.0, node=2)]
    assert [whom for *_, whom, _ in told(*there, spared=(0, 1))] == [(2, 0), (3, 0), (4, 0)]
    with pytest.raises(ScenarioError, match=r"event\.0\.random = 3, but there are 2 nodes that ar"):
        told(kill(1.0, random=3), spared=(0, 1, 2))
    assert len(told(kill(1.0, random=2), spared=(0, 1, 2))) == 2


def test_each_event_draws_for_itself():
    quiet = EVENT(at_s=9.0, action="quiet", node=0)
    hits = {told(*[quiet] * k, kill(1.0, random=1))[0][2][0] for k in range(9)}
    assert len(hits) > 2


def test_random_repairs_hit_what_is_broken():
    cut = EVENT(at_s=1.0, action="cut", random=3)
    found = told(cut, EVENT(at_s=2.0, action="cut", random=1),
                 EVENT(at_s=3.0, action="restore", random=4))  # fmt: skip
    assert sorted(whom for _, what, whom, _ in found if what == "cut") == GOOD
    assert [whom for _, what, whom, _ in found if what == "restore"] == GOOD
    with pytest.raises(ScenarioError, match="there is 1 link that is whole"):
        told(cut, EVENT(at_s=2.0, action="cut", random=2))
    with pytest.raises(ScenarioError, match="there are 2 links that are cut"):
        told(cut, EVENT(at_s=2.0, action="restore", link=("n1", "n2")),
             EVENT(at_s=3.0, action="restore", random=3),
             EVENT(at_s=2.5, action="cut", link=("n1", "n2")),
             EVENT(at_s=2.7, action="restore", link=("n2", "n1")))  # fmt: skip
    with pytest.raises(ScenarioError, match="there is 1 node that is dead"):
        told(kill(1.0, node=2), EVENT(at_s=2.0, action="revive", random=2))


def test_links_are_those_that_are_given():
    def cut(a, b):
        return EVENT(at_s=1.0, action="cut", link=(a, b))

    assert told(cut("n3", 2))[0][2] == (2, 3)
    assert told(cut("monitor", "gateway"))[0][2] == (0, 4)
    assert told(cut(3, 2), links=[(2, 3)])[0][2] == (2, 3)
    with pytest.raises(ScenarioError, match="there is no link n2 - n4; name one of those given"):
        told(cut(2, 4), links=[(2, 3)])
    with pytest.raises(ScenarioError, match="names n2 twice"):
        told(cut(2, "n2"))


def test_a_noise_is_20_db_above_the_radios_50_percent_point_unless_said():
    for noise_dbm, value in ((None, -7000), (-60.25, -6025)):
        assert told(EVENT(at_s=1.0, action="jam", node=1, noise_dbm=noise_dbm))[0][3] == value
    assert told(EVENT(at_s=1.0, action="quiet", node=1))[0][3] == 0


@pytest.mark.parametrize(("tables", "away"), [
    ([("revive", 1.0)], 1),
    ([("revive", 1.0), ("kill", 2.0)], 1),
    ([("kill", 1.0), ("revive", 2.0)], 0),
    ([("revive", 2.0), ("kill", 1.0)], 0),
    ([("revive", 2.0), ("restart", (1.0, 3.0))], 0),
    ([("revive", (1.0, 5.0)), ("kill", 2.0)], 1),
    ([("jam", 1.0), ("revive", 2.0)], 1),
    ([("revive", 1.0), ("kill", 1.0)], 1),
    ([("kill", 1.0), ("revive", 1.0)], 0),
])  # fmt: skip
def test_who_is_away_until_its_first_event(tables, away):
    event = [EVENT(at_s=at_s, action=action, node="monitor") for action, at_s in tables]
    model = innervate.Mesh(nodes=5, event=event)
    assert events.absent(model, nodes(), ROLES) == [0, 0, 0, 0, away]


def paired(monitor=MONITOR, **flow):
    return traffic.pairs(innervate.Mesh(nodes=5, flow=[FLOW(**flow)]), nodes(), 0, monitor)[0]


def test_who_sends_to_whom():
    assert paired(from_="all", to="monitor") == [(k, MONITOR) for k in (1, 2, 3, 4)]
    assert paired(monitor=2, from_="all", to="monitor") == [(k, MONITOR) for k in (0, 1, 3, 4)]
    assert paired(from_="all", to="gateway") == [(k, 0) for k in (1, 2, 3, 4)]
    assert paired(from_="all", to="all") == [(k, ALL) for k in range(5)]
    assert paired(from_="gateway", to="n3") == [(0, 3)]
    assert paired(from_=2, to="n3", pairs=2) == [(2, 3), (2, 3)]
    found = paired(from_="random", to="n3", pairs=4)
    assert sorted(found) == [(k, 3) for k in (0, 1, 2, 4)]
    others = [other for _, other in paired(from_="n2", to="random", pairs=40)]
    assert set(others) == {0, 1, 3, 4}
    with pytest.raises(ScenarioError, match="pairs = 5, but only 4 nodes can be drawn"):
        paired(from_="random", to="n3", pairs=5)
    with pytest.raises(ScenarioError, match="goes from n3 to n3"):
        paired(from_=3, to="n3")


def offered(duration_us=1_000_000, mtu=127, pairs=((1, 2),), always=True, **flow):
    model = innervate.Mesh(nodes=5, flow=[FLOW(from_=1, **flow)],
                           protocol=innervate.Mesh.Protocol(reliable=always))  # fmt: skip
    return traffic.offers(model, nodes(), [list(pairs)], 0.25, duration_us, mtu)


def at_ms(**flow):
    return [round(one.at_us / 1e3) for one in offered(**flow)]


def test_when_messages_are_offered():
    assert at_ms(to="gateway", duration_us=3_000_000) == [250]
    assert at_ms(to="gateway", start_s=0.1) == [100]
    assert at_ms(to="gateway", every_s=0.25) == [250, 500, 750]
    assert at_ms(to="gateway", every_s=0.25, count=2) == [250, 500]
    assert at_ms(to="gateway", every_s=0.25, stop_s=0.75) == [250, 500]
    assert at_ms(to="gateway", every_s=0.25, stop_s=5.0) == [250, 500, 750]
    assert at_ms(to="gateway", count=3, duration_us=9_000_000) == [250, 1250, 2250]
    late = at_ms(to="gateway", every_s=0.1, jitter_s=0.05)
    assert len(late) in (7, 8)
    assert all(250 + 100 * k <= at <= 300 + 100 * k for k, at in enumerate(late))
    assert late != [250 + 100 * k for k in range(len(late))]
    late = at_ms(to="gateway", every_s=0.01, jitter_s=0.4)
    assert late == sorted(late)
    assert late[-1] < 1000
    assert 20 < len(late) < 70
    drawn = offered(to="gateway", rate_hz=1000.0, stop_s=0.9, start_s=0.0)
    assert 700 < len(drawn) < 1100
    assert 0 < drawn[0].at_us < drawn[-1].at_us < 900_000


def test_messages_of_one_moment_are_in_the_order_of_the_file():
    found = offered(to="gateway", every_s=0.5, pairs=[(3, 0), (1, 0)])
    assert [(one.at_us, one.node) for one in found] == [
        (250_000, 3), (250_000, 1), (750_000, 3), (750_000, 1),
    ]  # fmt: skip


def test_messages_to_all_have_no_end_that_could_acknowledge():
    flags = [
        offered(to="gateway", pairs=[(1, dest)], always=always, **flow)[0].flags
        for dest, always, flow in (
            (2, True, {}), (2, False, {}), (ALL, True, {}), (2, True, {"reliable": False}),
            (2, False, {"reliable": True}), (2, False, {"priority": True}),
        )
    ]  # fmt: skip
    assert flags == [traffic.END_TO_END, 0, 0, 0, traffic.END_TO_END, traffic.PRIORITY]


def test_a_message_fits_into_a_frame(monkeypatch):
    most = traffic.payload_max(127)
    assert offered(to="gateway", bytes=most)[0].length == most
    with pytest.raises(ScenarioError, match=f"at an MTU of 127 it is at most {most}"):
        offered(to="gateway", bytes=most + 1)
    monkeypatch.setattr(traffic, "OFFERS_MAX", 6)
    assert len(offered(to="gateway", every_s=0.25, pairs=[(1, 0), (2, 0)])) == 6
    with pytest.raises(ScenarioError, match=r"more than 6 messages.* or raise flow\.0\.every_s"):
        offered(to="gateway", every_s=0.24, pairs=[(1, 0), (2, 0)])
    with pytest.raises(ScenarioError, match=r"more than 6 messages.* or lower flow\.0\.rate_hz"):
        offered(to="gateway", rate_hz=50.0, pairs=[(1, 0), (2, 0)])


def test_the_farthest_points_of_two_rectangles():
    assert access._farthest_cm((0, 0, 3, 4), (0, 0, 3, 4)) == 5
    assert access._farthest_cm((0, 0, 1, 1), (3, 4, 3, 4)) == 5
    assert access._farthest_cm((3, 4, 3, 4), (0, 0, 1, 1)) == 5


def hearing(least_cdb, count=3):
    radio = Of(rssi50_cdb=-9000, rssi_cdb=[-5000] * count**2)
    radio.rssi_cdb[2 * count + 1] = least_cdb
    return Of(nodes=nodes(count), radio=radio)


def test_all_hear_each_other_where_they_share_a_channel():
    good = -9000 + access.GOOD_CDB
    access._check_one_cell(innervate.Mesh(nodes=3), hearing(good), "dcf")
    with pytest.raises(ScenarioError, match="n1 does not hear n2 well enough"):
        access._check_one_cell(innervate.Mesh(nodes=3), hearing(good - 1), "dcf")
    for mac, count, fits in (("csma-cd-r", 120, True), ("csma-cd-r", 121, False), ("dcf", 121, 1)):
        if fits:
            access._check_one_cell(None, hearing(good, count), mac)
            continue
        with pytest.raises(ScenarioError, match="120 places in a round, too few for 121 nodes"):
            access._check_one_cell(None, hearing(good, count), mac)
