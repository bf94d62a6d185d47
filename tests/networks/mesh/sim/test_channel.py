"""A mesh over the medium access protocols of radio teams: frames are packets there."""

import dataclasses

import numpy as np
import pytest

from innervate import run as run_scenario
from innervate.dialect.access import QUEUE
from innervate.networks.mesh.protocol.constants import ACK, ALARM, DATA, REPORT_HOP
from innervate.networks.mesh.scenario.plan import MeshFault, Offer
from innervate.networks.mesh.sim import channel, over_channel
from innervate.networks.mesh.sim.simulate import simulate
from innervate.networks.radio.scenario.baselines import NUMBERS
from innervate.networks.radio.sim import build
from innervate.scenario import ScenarioError, load, plan
from innervate.scenario.actions.field import KILL, RESTART, REVIVE
from innervate.sim.driver import InvariantBroken
from innervate.sim.tables import Tables
from tests.networks.mesh.channel_runs import SLOT_US, TURN_US, slots, team
from tests.networks.mesh.pinger import REPORT_HEARD, REPORT_SENT
from tests.networks.mesh.runs import run

AT = 200_000
NOONE = 77  # a recipient that is not there: nobody acknowledges
ALL = 255
HEARD_US = 2  # the greatest delay


def rows_of(result, code, node=None):
    rows = result.rows[result.rows["code"] == code]
    return rows if node is None else rows[rows["node"] == node]


def test_one_frame_takes_a_turnaround_and_its_slots_and_everybody_hears_it():
    result = run(team(4, [(AT, 0, NOONE, 20)]))
    (row,) = result.sent
    assert row["time"] == AT + TURN_US
    assert row["end"] - row["time"] == slots(20) * SLOT_US
    assert (row["node"], row["bytes"], row["receivers"]) == (0, 11 + 1 + 20 + 2, 3)
    heard = rows_of(result, REPORT_HEARD)
    assert heard["node"].tolist() == [1, 2, 3]
    assert (heard["time"] == row["end"] + HEARD_US).all()
    (sent,) = rows_of(result, REPORT_SENT)
    assert sent["a"] == 1
    assert row["end"] < sent["time"] < row["end"] + 2 * TURN_US + 4 * SLOT_US  # a pulse proves it


def test_who_has_nobody_to_hear_it_is_never_told():
    result = run(team(1, [(AT, 0, NOONE, 5)]))
    assert len(rows_of(result, REPORT_SENT)) == 0
    assert (result.sent["receivers"] == 0).all()
    waits = np.diff(result.sent["time"])
    assert 10 * waits[0] < waits[-3:].min()  # it goes on trying, ever less often


@pytest.mark.parametrize("n", [2, 3, 10, 25])
def test_all_at_once_and_everything_arrives_everywhere(n):
    result = run(team(n, [(AT, i, NOONE, 9) for i in range(n)], seed=n))
    assert sorted(rows_of(result, REPORT_SENT)["node"].tolist()) == list(range(n))
    for i in range(n):
        heard = set(rows_of(result, REPORT_HEARD, i)["a"].tolist())
        assert heard == set(range(n)) - {i}
    whole = result.sent[result.sent["receivers"] == n - 1]
    whole.sort(order="time")
    assert (whole["time"][1:] >= whole["end"][:-1]).all()


def test_acknowledgements_of_hops_are_packets_as_well():
    result = run(team(3, [(AT, 0, 1, 9)]))
    assert sorted(result.sent["kind"].tolist()) == [DATA, ACK]
    assert len(rows_of(result, REPORT_HOP, 0)) == 1


def test_acknowledgements_that_find_no_room_are_left_out(monkeypatch):
    offers = [(AT + 60_000 * k, k % 2, 2, 1) for k in range(6)]
    assert run(team(3, offers)).counts["blocked"] == 0
    monkeypatch.setattr(over_channel, "QUEUE", 0)
    result = run(team(3, offers))
    assert result.counts["blocked"] == 6
    assert ACK not in result.sent["kind"]


def test_frame_errors_cost_repetitions_not_frames():
    offers = [(AT + 100_000 * k, k % 3, NOONE, 9) for k in range(15)]
    result = run(team(3, offers, chance=32_768 // 2, duration_s=4.0))
    assert len(rows_of(result, REPORT_SENT)) == 15
    assert len(result.sent) > 15


def faults(*told):
    return [MeshFault(at, action, node, -1, 0, 0) for at, action, node in told]


def test_a_death_in_mid_frame_cuts_it_short_and_the_others_go_on():
    offers = [(AT, 0, NOONE, 20), (AT + 90_000, 1, NOONE, 5)]
    death = AT + TURN_US + 10 * SLOT_US
    result = run(team(3, offers, faults=faults((death, KILL, 0))))
    first, second = result.sent
    assert (first["node"], first["end"], first["receivers"]) == (0, death, 0)
    assert (second["node"], second["receivers"]) == (1, 1)
    assert len(rows_of(result, REPORT_SENT, 0)) == 0


def test_a_death_before_its_frame_was_on_the_air_leaves_no_row():
    result = run(team(3, [(AT, 0, NOONE, 20)], faults=faults((AT + TURN_US // 2, KILL, 0))))
    assert len(result.sent) == 0


@pytest.mark.parametrize("back", [(REVIVE, 80_000), (RESTART, 0)])
def test_who_returns_has_forgotten_its_frame_and_sends_the_next(back):
    action, later = back
    death = AT + TURN_US + 10 * SLOT_US
    told = [(death, KILL, 0), (death + later, REVIVE, 0)] if action == REVIVE else [
        (death, RESTART, 0)]  # fmt: skip
    offers = [(AT, 0, NOONE, 20), (AT + 300_000, 0, NOONE, 7)]
    result = run(team(3, offers, faults=faults(*told)))
    assert len(rows_of(result, REPORT_SENT, 0)) == 1
    assert result.sent["bytes"].tolist() == [11 + 1 + 20 + 2, 11 + 1 + 7 + 2]


def test_a_broken_channel_stops_the_run(monkeypatch):
    class Small(Tables):
        def outbox(self, _, *more):
            return super().outbox(1, *more)

    monkeypatch.setattr("innervate.sim.channel.build.Tables", Small)
    with pytest.raises(InvariantBroken, match="outbox of station"):
        run(team(5, [(AT, i, NOONE, 9) for i in range(5)]))


def test_queues_grow_when_they_are_full(monkeypatch):
    offers = [(AT + 40_000 * k, k % 4, ALL, 9) for k in range(30)]
    whole = run(team(4, offers))
    grown, made, times = channel.grown, build.build, []

    def grow(world):
        times.append(world.run[0].now)
        return grown(world)

    def small(*args, **more):
        world = made(*args, **more)
        del world.heap.keys[160:]  # hardly longer than what the loop wants to have left
        return world

    monkeypatch.setattr(channel, "grown", grow)
    monkeypatch.setattr(channel.build, "build", small)
    again = run(team(4, offers))
    assert times
    assert again.fingerprint == whole.fingerprint
    assert np.array_equal(again.sent, whole.sent)


# The mesh itself, as bundled.


def team_plan(*sets, duration_us=6_500_000, seed=1):
    soon = ("flow.0.start_s=3", "robot.0.start_s=3", "robot.0.speed_mps=4")
    made = plan(load("mesh-team", [*soon, *sets], seed))
    return dataclasses.replace(made, duration_us=duration_us)


def test_the_bundled_team_delivers_everything_and_its_alarm():
    result = run_scenario("mesh-team")
    summary = result.summary
    assert summary["delivery_ratio"] == 1.0
    assert (summary["alarms"]["sent"], summary["alarms"]["delivered"]) == (1, 1)
    assert summary["alarms"]["latency_ms"]["max"] < 60
    assert summary["discovery"]["recall"] == 1.0
    assert summary["discovery"]["tables_s"] < 3
    assert summary["duplicates"] == summary["looped"] == 0
    assert ACK not in result.result.sent["kind"]
    assert result.tables["transmissions"].collect().height > 500


# Those whose stations have to be there all the time to hand on a token or to ask are not offered.
HANDED_ON = ("token-ring", "polling")


@pytest.mark.parametrize("mac", HANDED_ON)
def test_a_mesh_does_not_hand_on_the_right_to_send(mac):
    with pytest.raises(ScenarioError, match=r"radio\.mac must be"):
        team_plan(f"radio.mac={mac}")


@pytest.mark.parametrize("mac", [m for m in NUMBERS if m not in ("csma-cd-d1", *HANDED_ON)])
def test_an_alarm_arrives_over_every_medium_access(mac):
    result = simulate(team_plan(f"radio.mac={mac}"), plain=True)
    assert len(result.delivered[result.delivered["kind"] == ALARM])
    assert len(result.delivered[result.delivered["kind"] == DATA]) > 10


def test_acknowledgements_of_hops_can_be_asked_for():
    result = simulate(team_plan("protocol.hop_acks=true", duration_us=4_000_000), plain=True)
    assert ACK in result.sent["kind"]


def test_a_message_to_a_dead_node_is_tried_again_and_given_up():
    made = team_plan("protocol.e2e_s=0.3", duration_us=8_000_000)
    made.offers = [Offer(4_000_000, 1, 2, 2, 8, 0), Offer(4_010_000, 3, 4, 2, 8, 0)]
    made.faults = faults((3_900_000, KILL, 2))
    made.walks, made.robots = [], [0] * 8
    result = simulate(made, plain=True)
    data = result.sent[result.sent["kind"] == DATA]
    # Its first hop gives it back more than once: then it is hopeless for a while.
    assert 3 <= (data["dest"] == 2).sum() <= 1 + made.params["e2e_tries"]
    assert result.delivered[result.delivered["kind"] == DATA]["node"].tolist() == [4]


def test_more_than_the_queue_holds_is_never_handed_down():
    assert over_channel.KEPT > QUEUE + 1
