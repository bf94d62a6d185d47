"""Whole scenarios as processes: events at their times, robots that leave a fence, radio teams."""

import asyncio
import json
import os
import signal
import subprocess
import sys

import pytest

from innervate import scenario as scenarios
from innervate.live import play, status
from innervate.live.errors import LiveError
from innervate.live.up import Processes
from innervate.networks.mesh.live import walks
from innervate.scenario.robots import Walk
from tests.live.net import running, until

FIRST_S = 40.0
YARD = {
    "kind": "mesh",
    "name": "yard",
    "duration_s": 20.0,
    "node": [{"x_m": 5.0 * i, "y_m": 0.0} for i in range(4)],
    "link": [{"a": i, "b": (i + 1) % 4} for i in range(4)],
    "radio": {"profile": "ip"},
    "fence": {"polygon": [[10, -5], [30, -5], [30, 5], [10, 5]]},
    # Along the fence outside, for who leads it may be held up by other work for a second.
    "robot": [{"node": 3, "waypoints": [[20, 0], [20, 7], [26, 7], [26, 0]], "speed_mps": 4.0,
               "start_s": 1.0}],
    "protocol": {"ack_us": 30_000, "e2e_s": 0.3},
    "event": [
        {"at_s": 0.5, "action": "cut", "link": [0, 3]},
        {"at_s": 1.0, "action": "kill", "node": 2},
        {"at_s": 1.5, "action": "restore", "link": [0, 3]},
        {"at_s": 2.0, "action": "revive", "node": 2},
    ],
}  # fmt: skip


def ask(network, name, **request):
    return status.ask_one(network.socket(name), {"do": "status", **request})


def kinds(told):
    return [alarm["kind"] for alarm in told["alarms"] if alarm["robot"] == 3]


def test_events_happen_and_the_monitor_hears_that_a_robot_left_and_came_back(tmp_path):
    async def main():
        plan = scenarios.plan(scenarios.from_dict(YARD))
        network, told = Processes(plan, tmp_path, "udp"), []
        happening = play.events(network.deployment)
        player = play.Player(network, happening, told.append)
        await network.up()
        playing = asyncio.create_task(player.play())
        try:
            await until(lambda: all(ask(network, n)["table"] for n in ("n0", "n1", "n3")), FIRST_S)
            await until(lambda: len(told) == 4, FIRST_S)
            await until(lambda: status.answers(network.socket("n2")), FIRST_S)
            await until(lambda: kinds(ask(network, "n0"))[-1:] == ["clear"], FIRST_S)
            await until(lambda: ask(network, "n2")["table"], FIRST_S)
            return told, ask(network, "n0"), ask(network, "n3"), network.links
        finally:
            playing.cancel()
            await asyncio.gather(playing, return_exceptions=True)
            await network.down()

    told, monitor, robot, links = asyncio.run(main())
    cable = "n0 - n3"
    assert (0, 3) in links
    assert [event.text for event in told] == [
        f"cut {cable}", "kill n2", f"restore {cable}", "revive n2",
    ]  # fmt: skip
    assert "cross" in kinds(monitor)
    crossed = next(alarm for alarm in monitor["alarms"] if alarm["kind"] == "cross")
    assert 1000 < crossed["y_cm"] <= 1200  # from the fence's corner, 5 m below the path
    assert crossed["margin_cm"] == 1000 - crossed["y_cm"]  # so far outside, wherever it was seen
    assert robot["robot"]["fence"] == "inside"
    assert monitor["counters"]["alarms received: cross"] >= 1


def test_what_real_cables_do_by_themselves_is_not_played_and_what_is_not_there_is_refused():
    jammed = {**YARD, "event": [{"at_s": 1.0, "action": "jam", "node": 1}]}
    plan = scenarios.plan(scenarios.from_dict(jammed))
    network = Processes(plan, None, "udp")
    (event,) = play.events(network.deployment)
    assert not play.is_played(event)
    plan.faults = [plan.faults[0].__class__(1, 2, 0, 2, 0, 0)]
    with pytest.raises(LiveError, match="no cable joins n0 and n2"):
        play.events(network.deployment)


@pytest.mark.parametrize("time_us", [0, 1_000_000, 1_500_000, 3_000_000])
def test_a_walk_is_straight_between_its_points(time_us):
    way = Walk(0, ((1_000_000, 0, 0), (2_000_000, 100, -200)))
    at, speed = walks.place_at(way, time_us)
    share = min(1.0, max(0.0, time_us / 1e6 - 1.0))
    assert at == (100 * share, -200 * share)
    assert speed == ((100.0, -200.0) if 0 <= time_us - 1_000_000 < 1_000_000 else (0.0, 0.0))


def test_a_skins_cable_comes_out_at_its_time(tmp_path):
    skin = {
        "kind": "skin", "duration_s": 5.0, "patch": [{"columns": 2, "rows": 2}],
        "interface": [{"row": 0, "column": 0}, {"row": 1, "column": 1}],
        "protocol": {"beacon_hz": 50, "k": 5},
        "event": [{"at_s": 0.1, "action": "cut", "interface": 0}],
    }  # fmt: skip

    async def main():
        plan = scenarios.plan(scenarios.from_dict(skin))
        async with running(plan, tmp_path) as network:
            happening = play.events(network.deployment)
            await until(lambda: sum(ask(network, "pc")["cells"]) == 4, FIRST_S)
            await play.Player(network, happening, lambda event: None).play()
            await until(lambda: ask(network, "pc")["cells"][1] == 4, FIRST_S)

    asyncio.run(main())


def test_a_radio_team_comes_up_and_stations_leave_and_join(tmp_path):
    team = {
        "kind": "radio", "duration_s": 5.0, "stations": 3, "packet_slots": 20,
        "event": [{"at_s": 0.1, "action": "leave", "station": 1},
                  {"at_s": 0.2, "action": "join", "station": 2}],
    }  # fmt: skip

    async def main():
        plan = scenarios.plan(scenarios.from_dict(team))
        async with running(plan, tmp_path) as network:
            happening = play.events(network.deployment)
            assert not status.answers(network.socket("s2"))  # it joins later
            await play.Player(network, happening, lambda event: None).play()
            assert network.processes["s1"].poll() == 0
            request = {"do": "send", "payload": b"here".hex()}
            listening = status.ask(network.socket("s0"), {"do": "listen"})
            assert next(listening) == {"listening": "s0"}
            states = [answer["state"] for answer in _answers(network.socket("s2"), request)]
            assert next(listening) == {"from": 2, "payload": b"here".hex()}
            return states, ask(network, "s0")["counters"]

    states, heard = asyncio.run(main())
    assert states[-1] == "delivered"
    assert heard["packets received"] >= 1


def _answers(where, request):
    for answer in status.ask(where, request):
        yield answer
        if answer["state"] in ("delivered", "refused"):
            return


def test_the_command_says_what_happens_and_ends_in_time(tmp_path):
    path = tmp_path / "team.toml"
    path.write_text('kind = "radio"\nstations = 2\nduration_s = 5.0\n'
                    '[[event]]\nat_s = 0.1\naction = "kill"\nstation = 1\n')  # fmt: skip
    command = [
        sys.executable,
        "-m",
        "innervate.cli",
        "live",
        "up",
        str(path),
        "--for",
        "1",
        "--json",
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    first, second = map(json.loads, done.stdout.splitlines())
    assert set(first["nodes"]) == {"s0", "s1"}
    assert second == {"at_s": 0.1, "event": "kill s1"}
    for node in first["nodes"].values():
        with pytest.raises(ProcessLookupError):
            os.kill(node["pid"], signal.SIGCONT)
