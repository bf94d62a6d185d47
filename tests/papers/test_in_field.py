"""One world for all that do a job over a field, and what is counted of it."""

from functools import partial

import numpy as np
import pytest

from innervate.network import networks
from innervate.networks.mesh.papers import comparison as mesh
from innervate.papers import in_field
from innervate.papers.in_field import MONITOR, NEVER, Sent, World, figures, run_declared
from innervate.papers.jobs import entries, jobs
from innervate.scenario.actions.field import KILL, REVIVE
from innervate.sim.field.declared import simulation

AIR = {"byte_ns": 32_000, "phy_bytes": 6, "turnaround_us": 192, "sense_db": 3, "capture_db": 6}
SECOND = 1_000_000


def line(count, faults=(), sent=(), seconds=8):
    """Nodes in a row that hear their neighbours; node 0 is the gateway."""
    good = [(k, k + 1) for k in range(count - 1)]
    rssi, prob = [-16_000] * count**2, [0] * count**2
    for a, b in (*good, *((b, a) for a, b in good)):
        rssi[a * count + b], prob[a * count + b] = -8_000, 32_768
    return World(count, rssi, prob, good, AIR, 0, 4 * SECOND, seconds * SECOND, list(faults),
                 list(sent))  # fmt: skip


def test_what_counts_are_messages_whose_ends_are_joined():
    faults = [(5 * SECOND, KILL, 1), (7 * SECOND, REVIVE, 1)]
    sent = [Sent(at * SECOND, 3, dest, "all") for at, dest in
            ((4, 0), (6, 0), (6, 2), (7, 0), (6, 1))]  # fmt: skip
    world = line(4, faults, sent)
    assert in_field._counted(world) == [True, False, True, True, False]
    found = figures(world, [4 * SECOND + 5_000, NEVER, NEVER, 7 * SECOND + 9_000, NEVER], 80_000)
    assert found["all"] == pytest.approx(200 / 3)
    assert found["all_lost"] == pytest.approx(100 / 3)
    assert (found["p50_ms"], found["p99_ms"]) == (5.0, 9.0)
    assert found["airtime"] == 2.0, "of the four seconds from since_us on"


def test_what_is_joined_changes_in_the_order_of_the_faults():
    """Whatever order their times have in a set."""
    faults = [(7 * SECOND + 1, REVIVE, 1), (5 * SECOND + 7, KILL, 1)]
    sent = [Sent(at, 3, 0, "all") for at in (
        5 * SECOND + 6, 5 * SECOND + 7, 7 * SECOND, 7 * SECOND + 1)]  # fmt: skip
    world = line(4, sorted(faults), sent)
    assert in_field._counted(world) == [True, False, False, True]


def test_an_alarm_counts_though_nobody_is_there_to_hear_it():
    world = line(3, [(5 * SECOND, KILL, 0)], [Sent(6 * SECOND, 2, MONITOR, "alarms")])
    assert figures(world, [NEVER], 0) | {"airtime": 0} == {
        "alarms": 0.0, "alarms_lost": 100.0, "p50_ms": None, "p99_ms": None, "airtime": 0,
    }  # fmt: skip


def test_messages_come_again_when_ten_in_a_row_come():
    sent = [Sent((4 + k) * SECOND, 2, MONITOR, "alarms") for k in range(14)]
    world = line(3, [(4 * SECOND, KILL, 0), (30 * SECOND, REVIVE, 0)], sent, 40)
    world.standby, world.again = 1, {"alarms": (4 * SECOND, 30 * SECOND)}
    came = [one.at_us + SECOND for one in sent]
    assert figures(world, came, 0)["alarms_again_s"] == 1.0
    assert figures(world, [NEVER] * 3 + came[3:], 0)["alarms_again_s"] == 4.0
    assert figures(world, came[:3] + [9 * SECOND] * 3 + came[6:], 0)["alarms_again_s"] == 1.0
    assert figures(world, [NEVER] * 5 + came[5:], 0)["alarms_again_s"] is None, "nine"
    late = [*came[:9], *[31 * SECOND] * 5]
    assert figures(world, late, 0)["alarms_again_s"] is None, "when the gateway was back"
    assert world.receivers(sent[0]) == (0, 1)


def test_whose_ends_are_joined_at_the_moment_of_a_message():
    """Node 1 is off from 5 s up to 7 s; from 2 a good link leads to it, and nobody is there."""
    world = line(4, [(5 * SECOND, KILL, 1), (7 * SECOND, REVIVE, 1)])
    apart = [{0}, {2, 3}]
    whole = [{0, 1, 2, 3}]
    times = (0, 5 * SECOND - 1, 5 * SECOND, 7 * SECOND - 1, 7 * SECOND)
    for at, parts in zip(times, (whole, whole, apart, apart, whole), strict=True):
        assert world.on_at(at) == set().union(*parts)
        found = [part for part in world.joined(at) if part]
        assert sorted(map(sorted, found)) == sorted(map(sorted, parts)), at
    world.sent = [Sent(at, 3, 0, "all") for at in times]
    assert in_field._counted(world) == [True, True, False, False, True]
    for middle in range(3):  # who is off joins nobody, whatever its number
        star = line(3, [(0, KILL, middle)])
        star.good = [(min(middle, k), max(middle, k)) for k in range(3) if k != middle]
        assert [len(part) for part in star.joined(0) if part] == [1, 1]


def test_who_is_off_sends_nothing_and_only_a_monitor_is_asked_for_in_vain():
    world = line(3, [(5 * SECOND, KILL, 0), (6 * SECOND, KILL, 2)])
    world.sent = [Sent(at * SECOND, 2, dest, "all")
                  for at in (4, 5, 6) for dest in (MONITOR, 0, 1)]  # fmt: skip
    assert in_field._counted(world) == [True] * 3 + [True, False, True] + [False] * 3


def test_figures_are_of_what_counts_alone():
    """Late messages of who was not joined, or that never came, are in no latency."""
    world = line(3, [(6 * SECOND, KILL, 1)])
    world.sent = [Sent(4 * SECOND + k, 2, 0, "all") for k in range(100)]
    world.sent += [Sent(6 * SECOND, 2, 0, "all"), Sent(6 * SECOND + 1, 2, 1, "other"),
                   Sent(6 * SECOND + 2, 2, MONITOR, "alarms")]  # fmt: skip
    came = [one.at_us + 1_000 * (k + 1) for k, one in enumerate(world.sent)]
    came[99] = NEVER
    world.sent[-1] = Sent(5 * SECOND, 0, 2, "alarms")
    came[-1] = 5 * SECOND + 500
    assert figures(world, came, 4 * SECOND // 8) == {
        "all": pytest.approx(99.0), "all_lost": pytest.approx(1.0), "alarms": 100.0,
        "alarms_lost": 0.0, "p50_ms": 50.0, "p99_ms": 98.0, "airtime": 12.5,
    }  # fmt: skip


def test_of_copies_and_of_what_others_got_only_the_first_at_its_recipient_counts():
    world = line(4, sent=[Sent(4 * SECOND, 3, 0, "all"), Sent(5 * SECOND, 0, 3, "all"),
                          Sent(6 * SECOND, 2, MONITOR, "alarms")])  # fmt: skip
    rows = np.array(
        [(4 * SECOND + 10, 1, 10), (4 * SECOND + 30, 0, 30), (4 * SECOND + 70, 0, 70),
         (6 * SECOND + 5, 3, 5), (6 * SECOND + 9, 0, 9), (5 * SECOND + 8, 0, 8)],
        [(name, np.int64) for name in ("time", "node", "latency")],
    )  # fmt: skip
    assert in_field._came(world, rows) == [4 * SECOND + 30, NEVER, 6 * SECOND + 9]
    world.sent.append(Sent(4 * SECOND, 1, 2, "all"))
    with pytest.raises(AssertionError, match="two messages at one time"):
        in_field._came(world, rows)


def test_airtime_is_of_all_bytes_that_began_from_a_moment_on(monkeypatch):
    """Two messages one hop far, and their acknowledgements, as often as frames say they left."""
    network, left = networks()["flooding"], []

    def tapped(plan, **how):
        running = simulation(plan, plain=True, **how)
        finish = running.finish

        def watched(progress, tap):
            def both(rows, frames, until_us):
                out = rows["out"] == 1
                left.extend(zip(rows["time"][out].tolist(), frames["kind"][out], strict=True))
                tap(rows, frames, until_us)

            return finish(progress, both)

        running.finish = watched
        return running

    monkeypatch.setattr(network, "simulation", tapped)
    monkeypatch.setattr(in_field, "figures", lambda world, came, airtime_us: airtime_us)
    world = line(2, sent=[Sent(3 * SECOND, 0, 1, "all"), Sent(5 * SECOND, 1, 0, "all")])
    sizes = in_field.sizes_of(network.frames)
    for since_us in (0, 5 * SECOND + 192):
        left.clear()
        world.since_us = since_us
        spent = run_declared("flooding", {"hops": 2}, network.comparison.INPUTS, world)
        cost = [(AIR["phy_bytes"] + sizes[int(kind)]) * AIR["byte_ns"] // 1000
                for at, kind in left if at >= since_us]  # fmt: skip
        assert spent == sum(cost) > 0
        assert len(cost) == (len(left) if since_us == 0 else len(left) // 2)
    assert since_us in [at for at, _ in left], "no frame begins at just that moment"


@pytest.mark.parametrize(("kind", "params"), [("flooding", {"hops": 7}), ("rpl", {})])
def test_declared_networks_do_the_job(monkeypatch, kind, params):
    network = networks()[kind]
    monkeypatch.setattr(network, "simulation", partial(simulation, plain=True))
    pairs = ((3, 0), (0, 3), (1, 2), (2, 0), (0, 1))
    sent = [Sent(4 * SECOND + k * 100_000 + 1, a, b, "all") for k, (a, b) in enumerate(pairs)]
    sent.append(Sent(5 * SECOND, 3, MONITOR, "alarms"))
    found = run_declared(kind, params, network.comparison.INPUTS, line(4, sent=sent))
    assert (found["all"], found["alarms"]) == (100.0, 100.0)
    assert 0 < found["p50_ms"] < found["p99_ms"] < 500
    assert 0 < found["airtime"] < 20


def test_the_mesh_and_the_others_are_given_one_world():
    given = {"world": mesh.HERE, "nodes": 12, "rounds": 2, "dead": 2}
    one, other = in_field.world_of(given, 3), in_field.world_of(given, 3)
    assert one == other
    assert one != in_field.world_of(given, 4)
    plan = in_field.plan_in("flooding", {}, one)
    assert plan.heard.rssi_cdb == mesh.plan_of(given, 3).radio.rssi_cdb
    assert [fault.node for fault in plan.faults] == [node for _, _, node in one.faults]
    assert len(one.sent) == 2 * (12 - 2)
    dead = {node for _, _, node in one.faults}
    assert not dead & {node for each in one.sent for node in (each.source, each.dest)}


def test_more_deaths_are_the_same_and_others():
    fewer, more = ({node for _, _, node in in_field.world_of(
        {"world": mesh.HERE, "nodes": 12, "rounds": 1, "dead": dead}, 1).faults}
        for dead in (2, 4))  # fmt: skip
    assert fewer < more


def test_every_case_has_who_does_it_and_every_claim_its_case():
    job = jobs()["mesh"]
    names = {entry.name for entry in entries("mesh")}
    assert {"mesh", "flooding, 7 hops", "RPL, storing", "RPL, non-storing"} <= names
    for quick in (True, False):
        cases = {case.name: case for case in job.cases(quick)}
        left = {claim.case for claim in mesh.CLAIMS} - set(cases)
        assert left == ({mesh.MANY, mesh.MOST} if quick else set())
        assert {claim.other for claim in mesh.CLAIMS} <= names
