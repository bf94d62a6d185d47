"""Robots of a network of one's own: they move, their links follow, they are told where they are."""

import asyncio
from types import SimpleNamespace as Of

import pytest

import innervate
from innervate import scenario as scenarios
from innervate.live import in_field, moving
from innervate.network import networks
from innervate.scenario.declared.field import describe
from innervate.scenario.declared.moving import placed_of
from innervate.scenario.robots import position_cm
from innervate.sim.field.declared import simulation
from innervate.web.engine import Engine
from innervate.web.field_view import AWAY, UP, FieldView
from innervate.web.history import History
from tests.own import alone, bare, refused, run_both_ways

__all__ = ["alone", "bare"]
# Two nodes that do not hear each other, and a robot that goes from one to the other.
PLACES = {"nodes": 3, "positions_m": [[0, 0], [200, 0], [5, 5]], "event": [], "duration_s": 2.2}
ROBOT = {"node": 2, "waypoints": [[10, 0], [190, 0]], "speed_mps": 90}
NEWS = [{"at_s": 0.05, "node": 0, "item": {"value": 7}},
        {"at_s": 2.0, "node": 1, "item": {"value": 9}}]  # fmt: skip
MOVING = {**PLACES, "robot": [ROBOT], "input": NEWS}
TOLD = """def on_input(node, params, now, kind, item, out):
    'Our user has news, or we are told where we are.'
    if kind == 2:
        node.x = item.x
        node.y = item.y
        node.told = (node.told + 1) & 65535
        node.missed = item.value
        return
    node.value = item.value
    pass_on(node, params, now, item, 1, out)
"""


@pytest.fixture
def told(bare):
    """A network that is told where its robots are."""
    bare.rewrite("on_input", TOLD)
    own = "".join(f'    ("{name}", 0, {low}, {high}, "{unit}", "of our place"),\n'
                  for name, low, high, unit in
                  (("x", -500, 1500, "dm"), ("y", -500, 500, "dm")))  # fmt: skip
    counted = '    ("told", 0, 0, 65535, "times", "where we are"),\n'
    text = (bare.folder / "fields.py").read_text()
    text = text.replace("STATE = (\n", "STATE = (\n" + own + counted)
    text = text.replace("FRAME = (\n", "FRAME = (\n" + own) + "PLACED = 2\n"
    (bare.folder / "fields.py").write_text(text)
    return bare


def ran(network, **changes):
    return innervate.run(network.scenario, plain=True, overrides=MOVING | changes)


def loaded(network, **changes):
    return scenarios.load(network.scenario, overrides=(MOVING | changes).items())


def heard_by(run, node):
    rows = run.result.rows["deliveries"]
    return len(rows[rows["node"] == node])


def test_a_robot_hears_those_it_comes_by(bare):
    assert heard_by(ran(bare), 2) == 2
    assert heard_by(ran(bare, robot=[]), 2) == 1
    assert heard_by(ran(bare, robot=[ROBOT | {"start_s": 2.1}]), 2) == 1


@pytest.mark.slow  # compiles a protocol that no other test runs
def test_it_is_the_same_compiled(told):
    wandering = {"node": 0, "random": True, "area": [0, -20, 40, 20], "speed_mps": 20}
    erring = ROBOT | {"position_noise_m": 2.0, "position_hold_s": 0.5}
    run_both_ways(Of(scenario=loaded(told, robot=[wandering, erring])))


def test_a_robot_is_told_where_it_is_in_the_unit_of_its_fields(told):
    last = ran(told, sample_hz=10, duration_s=1.0, input=NEWS[:1]).nodes
    assert (last[2].told, last[0].told) == (10, 0)
    assert 10 * (10 + 90 * 0.8) <= last[2].x <= 10 * (10 + 90 * 1.0)
    assert (last[2].y, last[2].missed) == (0, 0), "nothing of what others were handed before"
    assert ran(told).nodes[2].x == 1500, "beyond the range of the field it is its end"
    away = [{"at_s": 0.01, "action": "kill", "node": 2}]
    assert ran(told, sample_hz=1, duration_s=1.9, event=away, input=[]).nodes[1].told == 0


def test_what_comes_and_goes_while_a_frame_is_on_the_air_is_counted_once(bare):
    """Frames of 0.5 s; a robot that runs past."""
    slow = {"air.bits_per_s": 200, "sample_hz": 500}
    there = ROBOT | {"waypoints": [[0, 90], [0, -90]], "speed_mps": 100}
    for at_s in (0.3, 0.6, 0.7, 1.3):
        run = ran(bare, **slow, robot=[there], input=[NEWS[0] | {"at_s": at_s}])
        frames = run.summary["frames"]
        assert frames["sent"] == frames["arrived"] + frames["lost"], at_s


def test_what_moves_with_a_signal_is_heard_by_who_listens_for_the_carrier(bare):
    """A robot that comes near a node that sends is told of the carrier as it does."""
    there = ROBOT | {"waypoints": [[0, 90], [0, 0]], "speed_mps": 100}
    given = [NEWS[0] | {"at_s": 0.2}]
    run = ran(bare, robot=[there], input=given, duration_s=0.7, **{"air.bits_per_s": 200})
    assert run.nodes[2].busy == 1


def test_nodes_that_a_robot_may_join_are_not_told_to_be_apart(bare):
    for changes, is_apart in (({}, False), ({"robot": []}, True)):
        told = describe(scenarios.plan(loaded(bare, **changes)))
        assert ("falls into 2 parts" in told) == is_apart
        assert ("  robots     n2, moved 50 times a second\n" in told) != is_apart


def test_a_page_shows_it_move(bare):
    plan = scenarios.plan(loaded(bare))
    view = FieldView(Engine(simulation(plan)), History())
    scene = view.scene()
    assert [one["role"] for one in scene["nodes"]] == ["node", "node", "robot"]
    assert [(link["a"], link["b"]) for link in scene["links"]] == [(0, 2), (1, 2)]
    world, unit = view.engine.world, plan.air.reach_m / 2
    assert view.arrays(False)["position"][2].tolist() == [round(10 / unit, 3), 0]
    assert view.arrays(False)["link_up"].tolist() == [UP, AWAY]
    world.radios["x"][2], world.radios["y"][2] = 19_000, 100
    for far, near in ((2, 5), (6, 7)):  # places of n0 - n2 and n1 - n2, either way
        world.rssi[far], world.rssi[near] = world.rssi[near], world.rssi[far]
    there = view.arrays(False)
    assert there["position"][2].tolist() == [round(190 / unit, 3), round(1 / unit, 3)]
    assert there["link_up"].tolist() == [AWAY, UP]
    assert (view.cut(1, False)["node"], view.cut(1, False)["other"]) == (1, 2)


def test_live_nodes_are_told_as_simulated_ones_are(told):
    plan = scenarios.plan(loaded(told, sample_hz=10))
    (walk,) = plan.walks
    said = list(moving.told(plan, walk, placed_of(networks()["flood"].fields)))
    assert [at for at, _request in said] == list(range(0, 2_000_001, 100_000))
    for at, request in said:
        x = round(position_cm(walk, at)[0] / 10)
        assert request == {"do": "input", "kind": 2, "item": {"x": min(x, 1500), "y": 0}}
    deployment = in_field.FieldDeployment(plan)
    waiting = deployment.others(Of(deployment=deployment))
    assert len(waiting) == 3
    for one in waiting:
        one.close()


def test_links_of_live_robots_carry_as_they_come_and_go(told):
    plan = scenarios.plan(loaded(told))
    deployment = in_field.FieldDeployment(plan)
    assert deployment.links == [(0, 2), (1, 2)]
    found = list(moving.changes(plan, deployment.links))
    assert [one[1:] for one in found] == [(1, "apart"), (0, "apart"), (1, "near")]
    for at_us, cable, _what in found[1:]:
        x_m = position_cm(plan.walks[0], at_us)[0] / 100
        far_m = abs(x_m - 200 * cable)
        assert 20 < far_m < 60, "about the reach, where half of the frames are received"
    changed = []

    async def change(cable, what):
        changed.append((cable, what))

    stage = Of(deployment=deployment, change=change)
    asyncio.run(moving.follow(plan, stage))
    assert changed == [one[1:] for one in found]


def test_a_live_robot_is_asked_at_its_times(told, monkeypatch):
    changes = {"sample_hz": 100, "robot": [ROBOT | {"waypoints": [[10, 0], [19, 0]]}]}
    plan = scenarios.plan(loaded(told, **changes))
    asked = []

    async def ask(where, request):
        asked.append((where, request["item"]["x"]))

    monkeypatch.setattr(moving, "ask", ask)
    stage = Of(deployment=Of(names=["a", "b", "r"]), socket=lambda name: name)
    placed = placed_of(networks()["flood"].fields)
    asyncio.run(moving.tell(plan, plan.walks[0], placed, stage))
    assert {where for where, _x in asked} == {"r"}
    places = [x for _where, x in asked]
    assert places == sorted(places)
    assert places[-1] == 190


@pytest.mark.parametrize(("changes", "words"), [
    ({"robot": [ROBOT, ROBOT]}, "there are two robots n2; leave one out"),
    ({"robot": [ROBOT | {"node": 3}]}, "there is no node 3; they are 0 to 2"),
    ({"robot": [ROBOT | {"random": True}]}, "robot.0 is random and has waypoints"),
    ({"robot": [ROBOT | {"position_noise_m": 1.0}]}, "flood is not told where its robots are"),
    ({"link": [{"nodes": [0, 1]}], "positions_m": []}, "a robot's links follow from where it is"),
])  # fmt: skip
def test_what_cannot_be_of_robots_is_refused(bare, changes, words):
    with pytest.raises(innervate.ScenarioError, match=words):
        ran(bare, **changes)


def test_places_that_no_frame_can_say_are_refused(bare, capsys):
    fields = bare.folder / "fields.py"
    fields.write_text(fields.read_text() + "PLACED = 2\n")
    line = bare.line("fields.py", "PLACED")
    words = "PLACED is a kind of input, whose x and y in FRAME are both in cm, dm or m: 2"
    assert refused(bare, capsys) == f"innervate: flood/fields.py:{line}: {words}"
