"""Mesh plans: who hears whom, what robots do, what is sent and what fails."""

from __future__ import annotations

import dataclasses
import hashlib
from pathlib import Path
from typing import Any

import pytest

from innervate.networks.mesh.protocol.constants import END_TO_END, MONITOR, PRIORITY
from innervate.networks.mesh.protocol.fields import PARAMS
from innervate.networks.mesh.scenario.network import quality_cdb, reception_q15
from innervate.networks.mesh.scenario.plan import ONE, MeshPlan
from innervate.networks.mesh.scenario.words import warnings
from innervate.scenario import ScenarioError, bundled, check, dump, load, loads, plan, template
from innervate.scenario.actions.field import CUT, JAM
from innervate.topology.placement import UNHEARD, components, good_links, neighbours

MESHES = sorted(name for name in bundled() if name.startswith("mesh"))


def made(text: str, *sets: Any, seed: int | None = None) -> MeshPlan:
    return plan(loads(f'kind = "mesh"\n{text}', sets, seed))


def floats_in(value: Any, where: str) -> list[str]:
    """Where something is not a whole number, a word or made of them."""
    if isinstance(value, dict):
        return [w for key, inner in value.items() for w in floats_in(inner, f"{where}.{key}")]
    if isinstance(value, list | tuple):
        return [w for inner in value for w in floats_in(inner, where)]
    if dataclasses.is_dataclass(value):
        return [
            w
            for field in dataclasses.fields(value)
            if field.name != "scenario"
            for w in floats_in(getattr(value, field.name), f"{where}.{field.name}")
        ]
    return [] if isinstance(value, int | str | None) else [f"{where}: {type(value).__name__}"]


@pytest.mark.parametrize("name", MESHES)
def test_plans_are_whole_numbers_and_stay_the_same(name: str) -> None:
    first = plan(load(name))
    assert floats_in(first, "plan") == []
    assert plan(load(name)) == first
    assert plan(load(name, seed=2)) != first
    kept = loads(dump(load(name)))
    assert dataclasses.replace(plan(kept), scenario=first.scenario) == first


def test_the_same_on_any_machine() -> None:
    """Numbers that were computed with logarithms and rounded: they must not depend on a libm."""
    p = plan(load("mesh-field"))
    text = repr((p.positions_cm, p.radio, p.good, p.walks, p.offers, p.faults, p.starts_us))
    assert hashlib.blake2b(text.encode(), digest_size=8).hexdigest() == "f7652eccbe11cf88"


@pytest.mark.parametrize("seed", range(1, 9))
@pytest.mark.parametrize(("nodes", "degree"), [(30, 8), (30, 5.6), (100, 8), (5, 4)])
def test_the_mean_degree_is_exact(nodes: int, degree: float, seed: int) -> None:
    p = made(f"nodes = {nodes}\n[radio]\nmean_degree = {degree}", seed=seed)
    assert len(p.good) == round(nodes * degree / 2)
    assert p.good == good_links(p.radio.rssi_cdb, nodes, p.radio.rssi50_cdb + 300)
    assert len(components(neighbours(nodes, p.good))) == 1


def test_reception() -> None:
    assert reception_q15(0) == ONE // 2
    assert reception_q15(100) / ONE == pytest.approx(0.7311, abs=1e-4)
    assert reception_q15(104) == reception_q15(100)
    assert reception_q15(-1200) == 0
    assert reception_q15(1200) == ONE
    assert quality_cdb(0.5) == 0
    assert reception_q15(quality_cdb(0.9)) / ONE == pytest.approx(0.9, abs=0.005)
    assert quality_cdb(1) == -quality_cdb(0) == 921
    p = made("nodes = 30")
    for rssi, share in zip(p.radio.rssi_cdb, p.radio.prob_q15, strict=True):
        assert share == (0 if rssi == UNHEARD else reception_q15(rssi - p.radio.rssi50_cdb))


def test_an_ideal_medium_loses_nothing() -> None:
    p = made("nodes = 20\n[radio]\nprofile = 'ideal'")
    assert not p.radio.collisions
    assert p.mac == "none"
    assert p.params["told"] == 0
    assert set(p.radio.prob_q15) == {0, ONE}
    assert sum(share == ONE for share in p.radio.prob_q15) == 2 * len(p.good)


def test_grids_and_lines() -> None:
    line = made("nodes = 6\n[placement]\nlayout = 'line'")
    assert line.good == [(i, i + 1) for i in range(5)]
    grid = made("nodes = 9\n[placement]\nlayout = 'grid'\n[radio]\nreach_m = 10")
    assert len(grid.good) == 12
    assert grid.positions_cm[4] == (1000, 1000)


def test_nodes_with_places() -> None:
    text = "[[node]]\nname = 'a'\nx_m = 0\ny_m = 0\n[[node]]\nx_m = 9\ny_m = 0\n"
    p = made(text + "[radio]\ntx_dbm = 0\nshadowing_db = 0\ndirection_db = 0")
    assert p.names == ["a", "n1"]
    assert p.positions_cm == [(0, 0), (900, 0)]
    assert p.radio.rssi_cdb == [UNHEARD, -4000 - 2863, -4000 - 2863, UNHEARD]
    assert p.good == [(0, 1)]


def test_links_that_are_given() -> None:
    p = made("[[link]]\na = 'y'\nb = 'x'\nquality = [0.9, 0.7]\n[[link]]\na = 'x'\nb = 'z'")
    assert p.names == ["y", "x", "z"]
    assert p.radio.prob_q15 == [0, 29491, 0, 22938, 0, ONE, 0, ONE, 0]
    assert p.radio.rssi_cdb[0 * 3 + 2] == UNHEARD
    assert p.radio.rssi_cdb[1] == p.radio.rssi50_cdb + quality_cdb(0.9)
    assert p.good == [(0, 1), (1, 2)]
    assert p.params["min_rssi"] == -94  # of the weakest link, 0.85 dB above -95
    assert p.positions_cm == []


@pytest.mark.parametrize(("discovery", "usual"), [("list", "best"), ("tree", "first"),
                                                  ("each", "first")])  # fmt: skip
def test_first_or_best_can_be_had_with_every_discovery(discovery: str, usual: str) -> None:
    said = f"[protocol]\ndiscovery = '{discovery}'\n"
    found = {uplink: made(f"nodes = 5\n{said}uplink = '{uplink}'") for uplink in ("first", "best")}
    assert (found["first"].params["faint"], found["best"].params["faint"]) == (-128, -92)
    assert made(f"nodes = 5\n{said}").params == found[usual].params
    loud = made(f"nodes = 5\n{said}uplink = 'best'\nmin_rssi_dbm = 127")
    assert loud.params["faint"] == 127


@pytest.mark.parametrize("profile", ["250k", "38k4", "ip", "ideal"])
@pytest.mark.parametrize("nodes", [2, 15, 16, 32, 33, 64, 65])
def test_parameters(profile: str, nodes: int) -> None:
    waiting = "standby = [1]\nprotocol.guard_s = 0"
    p = made(f"nodes = {nodes}\n{waiting}\n[radio]\nprofile = '{profile}'")
    assert set(p.params) == {field[0] for field in PARAMS}
    for name, length, low, high, *_ in PARAMS:
        values = p.params[name] if length else [p.params[name]]
        assert len(values) == max(length, 1)
        assert all(low <= value <= high for value in values), name
    assert p.capacity == p.params["width"] == (32 if nodes <= 32 else 64 if nodes <= 64 else 254)
    assert p.params["standby"] == 1
    seconds = p.params["tick_us"] / 1e6
    wanted = {"250k": (10, 60, 25, 5), "ideal": (10, 60, 25, 5), "ip": (2, 2, 5, 1),
              "38k4": (30, 300, 75, 5) if nodes <= 15 else (60, 300, 150, 5)}[profile]  # fmt: skip
    for name, time_s in zip(("period", "period_max", "dead", "dead_step"), wanted, strict=True):
        assert time_s <= p.params[name] * seconds < time_s + seconds
    assert p.params["ack_us"] == {"250k": 1312, "38k4": 9333, "ip": 5000, "ideal": 5760}[profile]
    assert seconds == {"ip": 0.25, "38k4": 2 if nodes > 20 else 1}.get(profile, 1)
    assert p.starts_us.index(max(p.starts_us)) == p.ranks.index(0)


def test_the_documents_reading() -> None:
    params = plan(load("mesh-document")).params
    names = ("discovery", "failover", "retry", "reliable", "transmissions", "avoid_origin")
    assert [params[name] for name in names] == [1, 0, 0, 0, 1, 0]
    params = made("nodes = 30").params
    assert [params[name] for name in names] == [3, 3, 1, 1, 3, 0]


def test_modes() -> None:
    for settings, mode in (("", 0), ('failover = "graph"', 1), ("tables = false", 2)):
        assert made(f"nodes = 30\n[protocol]\n{settings}").params["mode"] == mode


FIELD = """\
nodes = 12
[fence]
polygon = [[20, 20], [80, 20], [80, 80], [20, 80], [20, 20]]
holes = [[[40, 40], [50, 40], [50, 50]]]
[[robot]]
node = 3
waypoints = [[50, 70], [50, 90], [53, 94]]
speed_mps = 2
start_s = 5
pause_s = 1
[[robot]]
node = "n4"
random = true
area = [10, 90, 30, 10]
"""


def test_robots_walk() -> None:
    p = made(FIELD)
    straight, wandering = p.walks
    assert straight.node == 3
    assert straight.points == (
        (5_000_000, 5000, 7000), (15_000_000, 5000, 9000), (16_000_000, 5000, 9000),
        (18_500_000, 5300, 9400),
    )  # fmt: skip
    assert p.positions_cm[3] == (5000, 7000)
    assert wandering.points[0][1:] == p.positions_cm[4]
    assert wandering.points[-1][0] >= p.duration_us
    for (t0, x0, y0), (t1, x1, y1) in zip(wandering.points[1:], wandering.points[2:], strict=False):
        assert 1000 <= x1 <= 3000
        assert 1000 <= y1 <= 9000
        far = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
        assert t1 - t0 == pytest.approx(far * 10_000, abs=1)
    assert [i for i, robot in enumerate(p.robots) if robot] == [3, 4]
    n = p.nodes
    base, rssi = p.radio.base_cdb, p.radio.rssi_cdb
    assert len(base) == n * n
    assert all(base[i] > rssi[i] for i in range(n * n) if i % (n + 1))


def test_a_fence_in_its_own_coordinates() -> None:
    p = made(FIELD)
    params = p.params
    assert p.origin_cm == (2000, 2000)
    assert params["points"] == 7
    assert list(filter(any, zip(params["px"], params["py"], strict=True))) == [
        (6000, 0), (6000, 6000), (0, 6000), (2000, 2000), (3000, 2000), (3000, 3000),
    ]  # fmt: skip
    assert params["after"] == [1, 2, 3, 0, 5, 6, 4, *[0] * (len(params["after"]) - 7)]
    assert (params["unit_cm"], params["clear_margin"], params["predict_ms"]) == (1, 20, 500)
    assert params["watch"] == 1
    assert p.sample_us == 20_000


def test_a_large_fence_has_larger_units() -> None:
    text = "nodes = 3\n[placement]\nside_m = 900\n[fence]\npolygon = [[0,0],[900,0],[900,900]]\n"
    p = made(text)
    assert p.params["unit_cm"] == 10
    assert p.params["px"][:3] == [0, 9000, 9000]
    assert p.params["clear_margin"] == 2
    far = made(text + "[[robot]]\nnode = 1\nwaypoints = [[0, 0], [9000, 0]]")
    assert far.params["unit_cm"] == 100


FLOWS = """\
nodes = 10
gateway = 2
monitor = 7
[[flow]]
from = "all"
to = "monitor"
start_s = 1
count = 2
every_s = 3
jitter_s = 0.5
[[flow]]
from = 4
to = "gateway"
rate_hz = 10
reliable = false
priority = true
bytes = 90
[[flow]]
from = "random"
to = "random"
pairs = 4
"""


def test_messages() -> None:
    p = made(FLOWS)
    assert [o.at_us for o in p.offers] == sorted(o.at_us for o in p.offers)
    all_to_monitor = [o for o in p.offers if o.flow == 0]
    assert sorted(o.node for o in all_to_monitor) == sorted([n for n in range(10) if n != 7] * 2)
    assert {o.dest for o in all_to_monitor} == {MONITOR}
    assert {o.flags for o in all_to_monitor} == {END_TO_END}
    for start_s in (1, 4):
        late = [o.at_us - start_s * 1_000_000 for o in all_to_monitor]
        assert len([x for x in late if 0 <= x <= 500_000]) == 9
    poisson = [o for o in p.offers if o.flow == 1]
    assert len(poisson) == pytest.approx(10 * (60 - 8), rel=0.15)
    assert {(o.node, o.dest, o.flags, o.length) for o in poisson} == {(4, 2, PRIORITY, 90)}
    drawn = [(o.node, o.dest) for o in p.offers if o.flow == 2]
    assert len({source for source, _ in drawn}) == 4
    assert all(a != b for a, b in drawn)
    assert p.params["monitor"] == 7


def test_cuts_jams_and_late_nodes() -> None:
    p = made(
        "nodes = 8\n[[event]]\nat_s = 1\naction = 'cut'\nrandom = 2\n"
        "[[event]]\nat_s = 2\naction = 'restore'\nrandom = 2\n"
        "[[event]]\nat_s = 3\naction = 'jam'\nnode = 'gateway'\n"
        "[[event]]\nat_s = 9\naction = 'revive'\nnode = 5\n"
        "[[event]]\nat_s = 4\naction = 'kill'\nnode = 6\n"
        "[[event]]\nat_s = 8\naction = 'revive'\nnode = 6\n"
    )
    cut = [(f.node, f.other) for f in p.faults if f.action == CUT]
    assert len(set(cut)) == 2
    assert set(cut) <= set(p.good)
    assert [(f.node, f.other) for f in p.faults[2:4]] == cut
    assert (p.faults[4].action, p.faults[4].node, p.faults[4].value) == (JAM, 0, -7500)
    assert p.absent == [0, 0, 0, 0, 0, 1, 0, 0]


def test_other_medium_access_where_all_hear_each_other() -> None:
    p = made("nodes = 6\n[radio]\nmean_degree = 5\nmac = 'csma-cd-r'")
    assert p.mac == "csma-cd-r/practical"
    assert p.mac_params["packet_slots"] == 127 + 6 + 2  # the two bytes that say whose turn it is
    assert p.mac_params["slot_us"] == 32
    assert made("nodes = 6").mac_params == {"backoff_us": 320}
    assert made("nodes = 6\nradio.profile = '38k4'").mac_params == {"backoff_us": 2000}


TEAM = (
    "nodes = 6\n[radio]\nprofile = '38k4'\nmac = 'csma-cd-r'\nreach_m = 60\nshadowing_db = 0\n"
    "direction_db = 0\n[placement]\nside_m = 20\n"
)


def test_timers_over_the_medium_access_of_radio_teams() -> None:
    team, alone = made(TEAM), made(TEAM.replace("csma-cd-r", "csma"))
    round_us = 6 * ((7 + 2 + 64) * 208.333 + 2000)  # a turn of everybody
    assert (team.params["hop_acks"], alone.params["hop_acks"]) == (0, 1)
    assert team.params["copies"] == 1
    assert team.params["jitter_us"] == pytest.approx(round_us, abs=2)
    assert team.params["listen_us"] == pytest.approx(4 * round_us, abs=8)
    assert team.params["collect_us"] == pytest.approx(10 * round_us, abs=20)
    assert team.params["e2e_us"] == alone.params["e2e_us"] == 1_500_000
    assert made(TEAM, "protocol.hop_acks=true").params["ack_us"] == round(2 * round_us)
    assert made(TEAM, "protocol.listen_s=2").params["listen_us"] == 2_000_000
    assert made(TEAM, "nodes=100").params["e2e_us"] == pytest.approx(4 * round_us * 100 / 6, abs=99)


def robot(*waypoints: tuple[float, float]) -> str:
    way = [list(point) for point in waypoints]
    return f"[[robot]]\nnode = 5\nwaypoints = {way}\n"


def test_robots_that_stay_in_reach_may_take_turns() -> None:
    assert made(TEAM + robot((5, 5), (5, 50))).robots == [0, 0, 0, 0, 0, 1]


def test_robots_that_leave_the_reach_may_not() -> None:
    with pytest.raises(ScenarioError, match=r"n5 can come .* m away from n\d, out of its reach"):
        made(TEAM + robot((5, 5), (5, 90)))
    # It is in reach of everybody all the time, but not of where another robot may be then.
    two = robot((5, 5), (50, 5)) + "[[robot]]\nnode = 4\nwaypoints = [[5, 5], [-30, 5]]\n"
    with pytest.raises(ScenarioError, match="n5 can come 80 m away from n4") as told:
        made(TEAM + two)
    assert "its turns rest on what everybody hears; raise radio.reach_m" in str(told.value)


@pytest.mark.parametrize("action", ["cut", "jam"])
def test_events_that_make_nodes_deaf_need_csma(action: str) -> None:
    event = f"[[event]]\nat_s = 3\naction = '{action}'\nrandom = 1\n"
    assert made(TEAM.replace("csma-cd-r", "csma") + event).faults
    with pytest.raises(ScenarioError, match=rf'event\.0\.action = "{action}" changes who hears'):
        made(TEAM + event)


def test_what_check_says() -> None:
    text = check("mesh-field")
    assert "30, gateway n0, monitor the gateway" in text
    assert "120 good links, 8.0 a node" in text
    assert text.count("kill n") == 8
    assert "nodes      86, gateway 2" in check("mesh-leipzig")
    assert "standby n1, n2" in check("mesh-standby")
    two = check(loads('kind = "mesh"\n[[link]]\na = "x"\nb = "y"'))
    assert ", 1 good link, 1.0 a node, at most 1 hop from the gateway\n" in two
    assert ", no good links, 0.0 a node, all alone\n" in check(loads('kind = "mesh"\nnodes = 1'))


def test_warnings() -> None:
    assert warnings(made("nodes = 30\n[radio]\nmean_degree = 12", seed=3)) == []
    thin = warnings(made("nodes = 5\n[placement]\nlayout = 'line'"))
    assert thin == [
        "fewer than 3 neighbours: n1, n2, n3, n4",
        "the gateway n0 has 1 neighbour; 5 keep it reachable when some fail",
    ]
    long = warnings(made("nodes = 30\n[placement]\nlayout = 'line'"))
    assert long[2].startswith("n25, n26, n27, n28 and 1 more: more than 24 hops over good links,")
    late = warnings(made("nodes = 30\nduration_s = 6\n[[flow]]\nfrom = 1\nto = 2"))
    assert late[-1].startswith("flow.0 sends nothing: it begins after the end; set start_s")
    slow = "[placement]\nlayout = 'grid'\n[radio]\nprofile = '38k4'"
    assert "protocol.tables = false does without" in warnings(made(f"nodes = 81\n{slow}"))[-1]
    star = "".join(f"[[link]]\na = 'hub'\nb = 'n{i}'\n" for i in range(9))
    assert warnings(made(star))[0].startswith("nearly a star: 9 of 10 nodes have a single link")
    cities = {name: warnings(made(f"[import]\nfile = 'freifunk/{name}'\nmin_tq = {least}"))
              for name, least in (("ulm", 0), ("bielefeld", 0.3), ("leipzig", 0.3))}  # fmt: skip
    assert [bool(found) and "star" in found[0] for found in cities.values()] == [True, True, False]


@pytest.mark.parametrize(("better", "remedy"), [
    (100, "import.min_tq = 0.61 leaves few enough"), (270, "import.nodes = 254 takes those around"),
])  # fmt: skip
def test_an_import_that_is_too_large_says_which_links_to_leave_out(
    better: int, remedy: str, tmp_path: Path
) -> None:
    lines = [f"n{i} n{i + 1} {0.9 if i < better else 0.6}\n" for i in range(270)]
    (tmp_path / "net.txt").write_text("".join(lines))
    (tmp_path / "x.toml").write_text('kind = "mesh"\n[import]\nfile = "net.txt"\n')
    with pytest.raises(ScenarioError, match=f"271 nodes are too many: .*; {remedy}"):
        plan(load(tmp_path / "x.toml"))


def test_template_and_imports_from_a_folder(tmp_path: Path) -> None:
    assert plan(loads(template("mesh"))).nodes == 30
    (tmp_path / "net.txt").write_text("A B 0.9 0.7\nB C\n")
    (tmp_path / "x.toml").write_text('kind = "mesh"\n[import]\nfile = "net.txt"\n')
    loaded = load(tmp_path / "x.toml")
    assert plan(loaded).names == plan(loads(dump(loaded))).names == ["A", "B", "C"]
    assert 'file = "freifunk/leipzig"' in dump(load("mesh-leipzig"))
