"""A walk of a scenario is told to its robot's node: where it is, how fast, so often as it says."""

import asyncio
import json
from types import SimpleNamespace

import pytest

from innervate.live.errors import LiveError
from innervate.networks.mesh.live.walks import STANDING_S, Errors, place_at, walk
from innervate.scenario.robots import Walk
from tests.live import time_by_hand
from tests.networks.mesh.pinger import REPORT_PLACE
from tests.networks.mesh.runs import run
from tests.networks.mesh.sim.test_motion import reports, walking

WAY = Walk(0, ((1_000_000, 100, 100), (2_000_000, 300, 0), (4_000_000, 500, 400)))
PLAN = SimpleNamespace(sample_us=250_000, origin_cm=(100, -50), seed=1)


@pytest.mark.parametrize(
    ("at_us", "place", "speed"),
    [
        (0, (100, 100), (0, 0)),
        (999_999, (100, 100), (0, 0)),
        (1_000_000, (100, 100), (200, -100)),
        (1_500_000, (200, 50), (200, -100)),
        (2_000_000, (300, 0), (100, 200)),
        (3_500_000, (450, 300), (100, 200)),
        (4_000_000, (500, 400), (0, 0)),
        (9_000_000, (500, 400), (0, 0)),
    ],
)
def test_where_it_is_and_how_fast(at_us, place, speed):
    assert place_at(WAY, at_us) == (place, speed)


def told(folder, until_s, answer=lambda _: {"ok": True}, way=WAY):
    """What a node was told within so long: (when, request); and what the walk raised."""
    heard, over = [], asyncio.Event()

    async def serve(reader, writer):
        while line := await reader.readline():
            heard.append((round(asyncio.get_running_loop().time() - 1000, 3), json.loads(line)))
            said = answer(len(heard))
            if said is None:
                break
            if said == "nothing":
                await over.wait()
            writer.write(json.dumps(said).encode() + b"\n")
        writer.close()

    async def main():
        server = await asyncio.start_unix_server(serve, folder / "r.sock")
        task = asyncio.ensure_future(walk(PLAN, way, folder / "r.sock"))
        await asyncio.wait([task], timeout=until_s)
        task.cancel()
        over.set()
        server.close()
        (raised,) = await asyncio.gather(task, return_exceptions=True)
        await asyncio.sleep(0.1)
        return raised

    return heard, time_by_hand.run(main())


def test_it_is_told_each_period_and_seldom_once_it_stands(tmp_path):
    heard, _ = told(tmp_path, 6.1)
    times = [at for at, _ in heard]
    assert times == [0.25 * k for k in range(17)] + [4.25 + STANDING_S * k for k in range(4)]
    places = {at: request["at_cm"] for at, request in heard}
    assert places[0.0] == [0, 150]
    assert places[1.5] == [100, 100]
    assert places[4.0] == places[5.75] == [400, 450]
    assert {request["do"] for _, request in heard} == {"locate"}
    speeds = [request["speed_cm_s"] for _, request in heard]
    assert speeds[3:9] == [[0, 0], *[[200, -100]] * 4, [100, 200]]
    assert speeds[15:18] == [[100, 200], [0, 0], [0, 0]]


def test_a_node_that_is_away_for_a_while_is_told_again(tmp_path):
    heard, _ = told(tmp_path, 1.1, lambda count: None if count == 2 else {"ok": True})
    assert [at for at, _ in heard] == [0.0, 0.25, 0.5, 0.75, 1.0]


def test_a_node_that_does_not_answer_is_told_later_without_a_burst(tmp_path):
    heard, _ = told(tmp_path, 6.1, lambda count: "nothing" if count == 2 else {"ok": True})
    assert [at for at, _ in heard] == [0.0, 0.25, 5.25, 5.5, 6.0]
    assert heard[2][1]["at_cm"] == [400, 450]


def test_a_node_that_is_no_robot_ends_it(tmp_path):
    _, raised = told(tmp_path, 1.0, lambda _: {"error": "it bears no robot"})
    assert isinstance(raised, LiveError)
    assert str(raised) == "r: it bears no robot"


@pytest.mark.parametrize("hold_us", [0, 3_000_000])
def test_a_robot_errs_as_in_a_simulation_of_the_same_seed(hold_us):
    """What a simulated robot is told beyond where it is, sample by sample."""
    stands = ((0, 1_234, 777),)
    plan = walking(2.0, stands, seed=7)
    way = Walk(0, stands, 500_000, hold_us)
    plan.walks = [way]
    simulated = [(x - 1_234, y - 777) for _, x, y in reports(run(plan), REPORT_PLACE)]
    errors = Errors(plan, way)
    assert [errors.at(sample) for sample in range(len(simulated))] == simulated
    assert len(set(simulated)) > 20
    late = Errors(plan, way)
    assert late.at(57) == simulated[57], "whoever was not told for a while has not erred less"
    assert late.at(57) == simulated[57]
    assert Errors(plan, Walk(0, stands)).at(3) == (0, 0)


@pytest.mark.parametrize("sample_us", [250_000, 20_000])  # the second is no whole part of a float
def test_a_robot_that_errs_is_told_the_wrong_place_as_often_where_it_stands(
    tmp_path, monkeypatch, sample_us
):
    monkeypatch.setattr(PLAN, "sample_us", sample_us)
    way = Walk(0, WAY.points, 1_000_000)
    heard, _ = told(tmp_path, 6.01, way=way)
    samples = range(6_000_000 // sample_us + 1)
    assert [at for at, _ in heard] == [round(k * sample_us / 1e6, 3) for k in samples]
    exact, _ = told(tmp_path, 6.01, way=Walk(0, (*WAY.points, (7_000_000, 500, 400))))
    errors = Errors(PLAN, way)
    for k, ((_, wrong), (_, right)) in enumerate(zip(heard, exact, strict=True)):
        dx, dy = errors.at(k)
        assert wrong["at_cm"] == [right["at_cm"][0] + dx, right["at_cm"][1] + dy]
        assert wrong["speed_cm_s"] == right["speed_cm_s"], "measured by itself"
    assert len({tuple(one["at_cm"]) for _, one in heard[len(samples) * 2 // 3 :]}) > 5


def errors_of(node, seed=1, hold_us=0):
    return Errors(
        SimpleNamespace(sample_us=250_000, seed=seed), Walk(node, ((0, 0, 0),), 10**6, hold_us)
    )


def test_every_robot_errs_by_itself_and_from_the_first_sample_on():
    for hold_us in (0, 3_600_000_000):
        first = [errors_of(node, seed, hold_us).at(0) for seed in (1, 2) for node in (0, 1)]
        assert len(set(first)) == 4
        assert max(abs(x) + abs(y) for x, y in first) > 50, "in cm, of a metre"


def test_what_a_seed_has_a_robot_err_by_stays_the_same():
    errors = errors_of(0, hold_us=3_000_000)
    assert [errors.at(sample) for sample in range(5)] == [
        (21, 16), (35, 32), (22, 67), (50, 48), (127, -2),
    ]  # fmt: skip


def test_each_time_it_is_told_the_error_of_that_sample(tmp_path, monkeypatch):
    plan = SimpleNamespace(sample_us=20_000, origin_cm=(0, 0), seed=1)
    monkeypatch.setitem(globals(), "PLAN", plan)
    way = Walk(0, ((0, 0, 0),), 1_000_000)
    heard, _ = told(tmp_path, 2.01, way=way)
    errors = Errors(plan, way)
    assert len(heard) >= 100
    expected = [errors.at(sample) for sample in range(len(heard))]
    assert [tuple(request["at_cm"]) for _, request in heard] == expected
