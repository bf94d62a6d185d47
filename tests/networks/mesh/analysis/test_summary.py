from types import SimpleNamespace

import numpy as np
import pytest

from innervate.networks.mesh.analysis import alarms as mesh_alarms
from innervate.networks.mesh.analysis import messages as mesh_messages
from innervate.networks.mesh.analysis import network as mesh_network
from innervate.networks.mesh.analysis import summary as mesh
from innervate.networks.mesh.analysis import way as mesh_way
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.protocol.constants import (
    ACK,
    ALARM,
    ALL,
    CROSS,
    DATA,
    END_TO_END,
    FLOOD,
    NO_ACK,
    NO_ROOM,
    PARITY,
    PREDICT,
    REPORT_ACCEPTED,
    REPORT_ALARM,
    REPORT_EXPIRED,
    REPORT_FULL,
    REPORT_GATEWAY,
    REPORT_GRAPH,
    REPORT_ROUND,
    REPORT_TABLE,
    REQUEST,
    RESPONSE,
)
from innervate.networks.mesh.scenario.plan import MeshFault, Offer
from innervate.networks.mesh.sim import world as w
from innervate.scenario.actions.field import CUT, KILL, RESTORE, REVIVE
from innervate.scenario.robots import Walk
from innervate.sim.tables import ROW
from innervate.topology.placement import UNREACHABLE, distances

S = 1_000_000


def table(fields, rows):
    full = [(*row, *[0] * (len(fields) - len(row))) for row in rows]
    return np.array(full, [(name, np.int64) for name in fields])


def made(rows=(), sent=(), delivered=(), rounds=(), ended_us=100 * S, **plan):
    """A result as if it had been simulated: five nodes in a row, 0 the gateway, 4 the monitor."""
    params = {
        "e2e_us": 250_000, "e2e_tries": 5, "reliable": 1, "mode": 0, "monitor": 4, "points": 4,
        "px": [0, 1000, 1000, 0], "py": [0, 0, 1000, 1000], "after": [1, 2, 3, 0], "unit_cm": 1,
        "clear_margin": 20,
    }  # fmt: skip
    known = {
        "nodes": 5, "ranks": [0, -1, -1, -1, -1], "robots": [0] * 5, "absent": [0] * 5,
        "starts_us": [0] * 5, "good": [(0, 1), (1, 2), (2, 3), (3, 4)], "faults": [],
        "offers": [], "walks": [], "origin_cm": (0, 0), "sample_us": 20_000, "params": params,
        "radio": SimpleNamespace(prob_q15=[32768] * 25),
    }  # fmt: skip
    return SimpleNamespace(
        plan=SimpleNamespace(**(known | plan)),
        rows=table(ROW, rows),
        sent=table(w.SENT, sent),
        delivered=table(w.DELIVERED, delivered),
        rounds=table(w.ROUND, rounds),
        ended_us=ended_us,
    )


def offer(at_us, node=1, dest=4):
    return Offer(at_us, node, dest, END_TO_END, 8, 0)


def given(time, node, origin, seq, kind=DATA, hops=3, flags=0, looped=0, body=(0, 0, 0, 0)):
    return (time, node, kind, flags, origin, node, seq, hops, looped, *body)


def fault(at_us, action, node, other=-1):
    return MeshFault(at_us, action, node, other, 0, 0)


def test_a_message_is_followed_to_its_first_delivery():
    result = made(
        rows=[(10 * S, 1, REPORT_ACCEPTED, 0, 500), (11 * S, 1, REPORT_ACCEPTED, 1, 501)],
        delivered=[given(10 * S + 7000, 4, 1, 500), given(10 * S + 9000, 4, 1, 500, hops=5)],
        offers=[offer(10 * S), offer(11 * S)],
    )
    found = mesh_messages.messages(result)
    assert found.seq.tolist() == [500, 501]
    assert found.delivered_us.tolist() == [10 * S + 7000, mesh_messages.NEVER]
    assert found.hops.tolist() == [3, mesh_messages.NEVER]
    assert found.state.tolist() == [mesh_messages.DELIVERED, mesh_messages.LOST]
    assert mesh_messages.latencies_us(found).tolist() == [7000]
    assert mesh_messages.delivery_ratio(found) == 0.5
    assert mesh_messages.duplicates(result) == 1


def test_numbers_that_come_round_again_are_other_messages():
    result = made(
        rows=[(10 * S, 1, REPORT_ACCEPTED, 0, 500), (95 * S, 1, REPORT_ACCEPTED, 1, 500)],
        delivered=[given(10 * S + 1, 4, 1, 500), given(95 * S + 2, 4, 1, 500)],
        offers=[offer(10 * S), offer(95 * S)],
    )
    found = mesh_messages.messages(result)
    assert (found.delivered_us - found.offered_us).tolist() == [1, 2]
    assert mesh_messages.duplicates(result) == 0


def test_what_became_of_messages_that_did_not_come():
    result = made(
        rows=[
            (10 * S, 1, REPORT_ACCEPTED, 0, 1),
            (12 * S, 1, REPORT_EXPIRED, 0, NO_ACK),
            (20 * S, 2, REPORT_FULL, 1, NO_ROOM),
            (99 * S + 500_000, 1, REPORT_ACCEPTED, 3, 2),
        ],
        offers=[offer(10 * S), offer(20 * S, 2), offer(30 * S, 3), offer(99 * S + 500_000)],
    )
    found = mesh_messages.messages(result)
    assert [mesh_messages.STATE_NAMES[state] for state in found.state] == [
        "lost", "refused", "sender off", "in flight"]  # fmt: skip
    assert mesh_messages.give_ups(result) == {
        "no_route": 0, "no_ack": 1, "put_out": 0, "no_room": 1}  # fmt: skip
    assert mesh_messages.delivery_ratio(found) == 0.0
    assert len(mesh_messages.counted(found).state) == 2


def test_messages_count_that_are_older_than_any_that_is_on_its_way():
    late = 99 * S + 500_000
    rows = [(10 * S, 1, REPORT_ACCEPTED, 0, 1), (late, 1, REPORT_ACCEPTED, 1, 2)]
    came = [given(late + 1, 4, 1, 2)]
    both = made(rows, delivered=came, offers=[offer(10 * S), offer(late)])
    assert mesh_messages.delivery_ratio(mesh_messages.messages(both)) == 0.5
    rows.append((late + 10, 1, REPORT_ACCEPTED, 2, 3))
    open_ = made(rows, delivered=came, offers=[offer(10 * S), offer(late), offer(late + 10)])
    assert mesh_messages.delivery_ratio(mesh_messages.messages(open_)) == 0.5
    open_.delivered = made(delivered=[given(late + 11, 4, 1, 3)]).delivered  # the younger one came
    assert mesh_messages.delivery_ratio(mesh_messages.messages(open_)) == 0.0
    open_.plan.offers[1:] = [offer(late), offer(late)]  # and is no younger
    open_.rows["time"][2] = late
    assert mesh_messages.delivery_ratio(mesh_messages.messages(open_)) == 0.0


def test_a_restart_makes_the_same_number_another_packet():
    twice = [given(10 * S, 4, 1, 7), given(11 * S, 4, 1, 7)]
    assert mesh_messages.duplicates(made(delivered=twice)) == 1
    again = made(delivered=twice, faults=[fault(10 * S + 500_000, REVIVE, 1)])
    assert mesh_messages.duplicates(again) == 0


WALK = Walk(2, ((0, 900, 500), (2 * S, 1100, 500), (4 * S, 900, 500), (6 * S, 1100, 500)))


def crossing_rows(raised_us=S + 20_000, accepted_us=S + 70_000, kind=CROSS):
    rows = [(raised_us, 2, REPORT_ALARM, kind, 2)]
    delivered = [given(accepted_us, 4, 2, 9, ALARM, 2, FLOOD, body=(2, 0, 1, kind))]
    return rows, delivered


def test_a_crossing_is_measured_from_the_sample_that_raised_it():
    rows, delivered = crossing_rows()
    result = made(rows, delivered=delivered, walks=[WALK], ended_us=4 * S)
    (crossing,) = mesh_alarms.all_crossings(result)
    assert crossing.crossed_us == S
    assert crossing.back_us == 3 * S
    assert (crossing.raised_us, crossing.accepted_us) == (S + 20_000, S + 70_000)
    assert crossing.overrun_m == pytest.approx(0.07)  # 1 m/s for 70 ms
    summary = mesh_alarms.alarms([crossing])
    assert (summary["sent"], summary["delivered"], summary["by_flood"]) == (1, 1, 1)
    assert summary["latency_ms"]["p99"] == pytest.approx(50.0)


@pytest.mark.parametrize("accepted_us", [S - 2_000, S + 40_000])
def test_an_alarm_just_before_the_crossing_is_of_that_crossing(accepted_us):
    """Places are whole units: the robot may see itself outside half a unit too soon."""
    rows, delivered = crossing_rows(S - 14_000, accepted_us)
    result = made(rows, delivered=delivered, walks=[WALK], ended_us=4 * S)
    (crossing,) = mesh_alarms.all_crossings(result)
    assert (crossing.raised_us, crossing.accepted_us) == (S - 14_000, accepted_us)
    assert crossing.overrun_m == pytest.approx(max(0, accepted_us - S) / 1e6)
    assert mesh_alarms.alarms([crossing])["delivered"] == 1


def test_an_alarm_well_inside_is_of_no_crossing():
    rows, delivered = crossing_rows(S - 60_000, S - 30_000)
    result = made(rows, delivered=delivered, walks=[WALK], ended_us=4 * S)
    summary = mesh_alarms.alarms(mesh_alarms.all_crossings(result))
    assert (summary["sent"], summary["delivered"], summary["noticed"]) == (1, 0, 0)


@pytest.mark.parametrize(("early_us", "noticed"), [(360_000, 1), (360_001, 0)])
def test_how_much_too_soon_depends_on_the_unit_of_places(early_us, noticed):
    """35 cm at 1 m/s, and up to one sample, with places in units of 25 cm along each axis."""
    corners = {"px": [0, 40, 40, 0], "py": [0, 0, 40, 40], "unit_cm": 25}
    params = made().plan.params | corners
    rows, _ = crossing_rows(S - early_us)
    result = made(rows, walks=[WALK], ended_us=4 * S, params=params)
    assert mesh_alarms.alarms(mesh_alarms.all_crossings(result))["noticed"] == noticed


@pytest.mark.parametrize(("ended_us", "is_open"), [(2_499_999, True), (2_500_000, False)])
def test_a_crossing_shortly_before_the_end_is_open_unless_its_alarm_came(ended_us, is_open):
    (crossing,) = mesh_alarms.all_crossings(made(walks=[WALK], ended_us=ended_us))
    assert crossing.open == is_open
    assert mesh_alarms.alarms([crossing])["sent"] == 1 - is_open
    rows, delivered = crossing_rows()
    result = made(rows, delivered=delivered, walks=[WALK], ended_us=ended_us)
    assert not mesh_alarms.all_crossings(result)[0].open


def test_an_alarm_of_the_stay_before_is_not_of_the_next():
    rows, delivered = crossing_rows(3 * S - 100_000, 3 * S + 30_000)
    found = mesh_alarms.all_crossings(made(rows, delivered=delivered, walks=[WALK]))
    assert [crossing.accepted_us != mesh_messages.NEVER for crossing in found] == [True, False]


def test_a_crossing_that_nobody_noticed_counts():
    found = mesh_alarms.all_crossings(made(walks=[WALK]))
    assert [crossing.crossed_us for crossing in found] == [S, 5 * S]
    summary = mesh_alarms.alarms(found)
    assert (summary["sent"], summary["delivered"], summary["noticed"]) == (2, 0, 0)
    assert summary["latency_ms"]["p50"] is None
    assert summary["overrun_m"]["max"] == pytest.approx(1.0)


def test_a_warning_is_no_alarm():
    rows, delivered = crossing_rows(S - 300_000, S - 200_000, PREDICT)
    result = made(rows, delivered=delivered, walks=[WALK], ended_us=4 * S)
    summary = mesh_alarms.alarms(mesh_alarms.all_crossings(result))
    assert (summary["delivered"], summary["warned"]) == (0, 1)
    assert summary["warning_ms"]["p50"] == pytest.approx(200.0)


def test_out_again_before_it_was_well_inside_is_one_crossing():
    near = Walk(2, ((0, 900, 500), (2 * S, 1100, 500), (3 * S, 990, 500), (4 * S, 1100, 500)))
    assert len(mesh_alarms.all_crossings(made(walks=[near]))) == 1


def alarm(start, node, to, length, flags=0, receivers=1):
    return (start, start + 2000, node, ALARM, flags, to, 2, 4, 9, length, 30, receivers)


def test_the_way_of_an_alarm_is_put_together_backwards():
    rows, _ = crossing_rows()
    sent = [
        alarm(S + 21_000, 2, 1, 1, receivers=0),
        alarm(S + 25_000, 2, 3, 1),
        alarm(S + 30_000, 2, ALL, 1, FLOOD),
        alarm(S + 68_000, 3, 4, 2),
    ]
    delivered = [given(S + 70_000, 4, 2, 9, ALARM, 2, body=(2, 0, 1, CROSS))]
    result = made(rows, sent, delivered, walks=[WALK], ended_us=4 * S)
    (crossing,) = mesh_alarms.all_crossings(result)
    assert len(mesh_way.copies(result, crossing)) == 4
    hops = mesh_way.way(result, crossing)
    assert [(hop.node, hop.to) for hop in hops] == [(2, 3), (3, 4)]


def test_packets_that_come_back_to_a_node_are_counted():
    def data(at, node, length, seq=7, flags=0):
        return (at, at + 900, node, DATA, flags, 3, 1, 4, seq, length, 30, 1)

    once = [data(S, 1, 1), data(S + 5000, 1, 1), data(S + 9000, 2, 2)]
    assert mesh.looped(made(sent=once)) == 0  # a second try of a hop is no return
    assert mesh.looped(made(sent=[*once, data(S + 15_000, 1, 3)])) == 1
    retried = [data(S, 2, 2), data(S + 260_000, 2, 3, flags=PARITY), data(S + 600_000, 2, 4)]
    assert mesh.looped(made(sent=retried)) == 0
    assert mesh.looped(made(delivered=[given(S, 4, 1, 7, looped=1)])) == 1


def test_paths_follow_deaths_and_cuts():
    plan = made(
        faults=[fault(S, KILL, 2), fault(2 * S, REVIVE, 2), fault(3 * S, CUT, 3, 4),
                fault(4 * S, RESTORE, 4, 3)]
    ).plan  # fmt: skip
    ground = Ground(plan)
    assert [ground.hops(0, 4, at) for at in (0, S, 2 * S, 3 * S, 4 * S)] == [
        4, UNREACHABLE, 4, UNREACHABLE, 4]  # fmt: skip
    assert ground.on_at(S) == [True, True, False, True, True]
    assert distances([[1], [0], []], 0) == [0, 1, UNREACHABLE]


def test_discovery_counts_acks_for_what_they_acknowledge():
    request = (S, S + 600, 0, REQUEST, 0, ALL, 0, ALL, 1, 1, 20, 1)
    response = (S + 400_000, S + 400_800, 1, RESPONSE, 1, 0, 1, 0, 5, 1, 30, 1)
    ack = (S + 401_000, S + 401_400, 0, ACK, 0, 1, 1, 0, 5, 0, 9, 1)
    data = (S + 500_000, S + 501_000, 1, DATA, 1, 0, 1, 0, 6, 1, 40, 1)
    rows = [(S, 0, REPORT_GATEWAY, 0, 1), (S, 0, REPORT_ROUND, 1, 1)]
    rows += [(2 * S, 0, REPORT_GRAPH, 4, 1)]
    rows += [(2 * S + node * 1000, node, REPORT_TABLE, 1, 1) for node in range(1, 5)]
    result = made(rows, [request, response, ack, data], rounds=[(2 * S, 0, 1, 3, 4, 3)])
    kinds = mesh_network.acked_kinds(result.sent)
    assert kinds.tolist() == [REQUEST, RESPONSE, RESPONSE, DATA]
    found = mesh_network.discovery(result, kinds)
    assert found["recall"] == 0.75
    assert found["complete_s"] == 1.0
    assert found["tables_s"] == pytest.approx(1.004)
    assert found["airtime_s"] == pytest.approx(0.0018)
    assert mesh_network.control_bytes(result, kinds) == 59
    assert mesh_network.gateways(result)[0]["tables_s"] == pytest.approx(1.004)


def test_tables_that_a_node_never_got_are_never_complete():
    rows = [(S, 0, REPORT_ROUND, 1, 1), (2 * S, 1, REPORT_TABLE, 1, 1)]
    assert mesh_network.tables(made(rows), S) == (1, None)
    dead = [fault(S, KILL, node) for node in (2, 3, 4)]
    assert mesh_network.tables(made(rows, faults=dead), S) == (1, 2 * S)
