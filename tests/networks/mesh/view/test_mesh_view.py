"""What pages are told of a simulated mesh, by rows that are written here; nothing is run."""

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.mesh.analysis.reach import Ways
from innervate.networks.mesh.protocol import constants as c
from innervate.networks.mesh.scenario.plan import MeshFault
from innervate.networks.mesh.scenario.profiles import GOOD_CDB
from innervate.networks.mesh.view import view as room
from innervate.networks.mesh.view.view import MeshView
from innervate.scenario.actions.field import CUT, KILL, QUIET, RESTORE, REVIVE
from innervate.sim.field.states import ALIVE, COMMITTED, DEAD, HELD, OFF, ON_AIR
from innervate.web.engine import engine_of
from innervate.web.errors import Refused
from innervate.web.history import LOG, History
from innervate.web.messages import Cut, Heal, Kill, Revive
from tests.web.runs import plan_of

CHAIN = {
    "kind": "mesh", "duration_s": 60.0,
    "node": [{"name": f"n{i}", "x_m": 20.0 * i, "y_m": 5.0 * i} for i in range(5)],
    "radio": {"reach_m": 22}, "gateway": 0, "standby": [1], "monitor": "n2",
    "robot": [{"node": 4, "waypoints": [[80, 20], [85, 20]], "speed_mps": 0.1}],
    "fence": {"polygon": [[0, -30], [90, -30], [90, 50], [0, 50]],
              "holes": [[[10, 30], [20, 30], [20, 40]]]},
}  # fmt: skip
NAMES = ("n0", "n1", "n2", "n3", "n4")


@pytest.fixture
def view():
    return MeshView(engine_of(plan_of(CHAIN)), History())


def rows_of(view, name, *rows):
    """Rows of a table of the world: dicts of what is not 0."""
    made = np.zeros(len(rows), getattr(view.engine.world, name).dtype)
    for i, row in enumerate(rows):
        for key, value in row.items():
            made[key][i] = value
    return made


def noted(view, rows=(), sent=(), delivered=(), until_us=0):
    """Have the view take in rows: what it says then, (us, text, level)."""
    view.engine.now_us = until_us
    before = view.history.newest
    given = {"rows": rows, "sent": sent, "delivered": delivered}
    view.note({name: rows_of(view, name, *some) for name, some in given.items()})
    items = view.history.after(LOG, before, view.history.newest, 100)
    return [(item.at_us, item.what["text"], item.what["level"]) for item in items]


def report(code, node, a=0, b=0, at=1000):
    return {"time": at, "node": node, "code": code, "a": a, "b": b}


def test_what_happened_is_told_in_the_order_in_which_it_did(view):
    """An alarm's arrival is no report; at one moment reports go first."""
    rows = [report(c.REPORT_ALARM, 4, c.CROSS, 4, at=1000), report(c.REPORT_SUSPECT, 2, 3, at=2000),
            report(c.REPORT_SUSPECT, 1, 3, at=3000)]  # fmt: skip
    came = {"kind": c.ALARM, "body0": 4, "body3": c.CROSS}
    told = noted(view, rows, delivered=[came | {"time": 2000}])
    assert [at for at, *_ in told] == [1000, 2000, 2000, 3000]
    assert told[2][1] == "alarm of robot n4 at the monitor after 1.0 ms"


@pytest.mark.parametrize(("row", "told"), [
    (report(c.REPORT_SUSPECT, 2, 3), [("n3 does not answer n2", "info")]),
    (report(c.REPORT_GATEWAY, 1, 1), [("n1 leads as gateway", "info")]),
    (report(c.REPORT_GATEWAY, 1, 0), []),  # another leads
    (report(c.REPORT_TABLES, 0, 4, 0), [("tables are out", "info")]),
    (report(c.REPORT_TABLES, 0, 4, 1), [("tables are out, but 1 node has none", "bad")]),
    (report(c.REPORT_TABLES, 0, 4, 2), [("tables are out, but 2 nodes have none", "bad")]),
    (report(c.REPORT_EXPIRED, 3), [("n3 gave a message up", "bad")]),
    (report(c.REPORT_ALARM, 4, c.CROSS, 4), [("robot n4 has crossed the fence", "bad")]),
    (report(c.REPORT_ALARM, 3, c.LOST, 4), [("robot n4 is lost, says n3", "bad")]),
    (report(c.REPORT_ALARM, 4, c.PREDICT, 4), [("robot n4 is about to cross", "bad")]),
    (report(c.REPORT_ALARM, 4, c.CLEAR, 4), [("robot n4 is inside again", "good")]),
    (report(c.REPORT_ACCEPTED, 3, 0, 7), []),
])  # fmt: skip
def test_reports_are_told_in_words(view, row, told):
    assert noted(view, [row]) == [(1000, *one) for one in told]


def message(number, taken_us, came_us, dest=0):
    taken = report(c.REPORT_ACCEPTED, 3, 0, number, taken_us)
    came = {"time": came_us, "node": dest, "kind": c.DATA, "origin": 3, "seq": number,
            "dest": dest}  # fmt: skip
    return taken, came


def test_the_latency_of_a_point_is_the_mean_since_the_last(view):
    assert view.points()["latency"] is None
    takens, cames = zip(message(1, 1000, 5000), message(2, 2000, 12_000), strict=True)
    noted(view, takens, (), [*cames, cames[0], {**cames[0], "seq": 9}])  # once more; unknown
    noted(view, [message(3, 0, 0)[0]], (), [{**message(3, 0, 9000)[1], "dest": c.ALL}])
    assert view.points()["latency"] == 7.0  # (4 + 10) / 2 ms
    assert view.points()["latency"] is None


def test_of_messages_that_never_come_the_newest_are_remembered(view):
    most = room.MESSAGES_MAX
    noted(view, [report(c.REPORT_ACCEPTED, 3, 0, k) for k in range(most + 2)])
    assert list(view.memory.messages) == [(3, k) for k in range(2, most + 2)]


@pytest.mark.parametrize(("kind", "said"), [(c.CROSS, True), (c.PREDICT, True), (c.CLEAR, False)])
def test_an_alarm_that_comes_to_the_monitor_is_told_with_its_time(view, kind, said):
    came = {"time": 26_400, "node": 2, "kind": c.ALARM, "body0": 4, "body3": kind}
    # Counted from the first who raised it; it comes a second time, which is no news.
    told = noted(view, [report(c.REPORT_ALARM, 4, kind, 4, 4000),
                        report(c.REPORT_ALARM, 3, kind, 4, 9000)], (), [came, came])  # fmt: skip
    found = [one for one in told if "monitor" in one[1]]
    words = "alarm of robot n4 at the monitor after 22.4 ms"
    assert found == ([(26_400, words, "good")] if said else [])


def test_airtime_is_the_share_of_the_time_since_the_last_point(view):
    frames = [{"time": 0, "end": 20_000, "node": 1}, {"time": 30_000, "end": 40_000, "node": 3},
              {"time": 50_000, "end": 60_000, "node": 1}]  # fmt: skip
    noted(view, (), frames, until_us=100_000)
    assert view.points()["airtime"] == 40.0
    assert view.arrays(False)["load"].tolist() == [0, 0.09, 0, 0.03, 0]  # three tenths of it
    noted(view, (), (), until_us=200_000)
    assert view.points()["airtime"] == 0.0
    noted(view, (), [{"time": 200_000, "end": 220_000, "node": 1}], until_us=240_000)
    assert view.points()["airtime"] == 50.0
    view.memory.load = np.array([0, 0.063, 0, 0.021, 0])
    assert view.memory.load.tolist() == pytest.approx([0, 0.063, 0, 0.021, 0])


def fault(view, action, node, other=0, at_us=50_000):
    made = MeshFault(at_us, action, node, other, 0, 0)
    view.memory.told_us = at_us
    view.begin_fault(made)
    return view.memory.recovery


@pytest.mark.parametrize(("action", "suspect", "detects"), [
    (KILL, (1, 2), True), (KILL, (3, 2), True), (KILL, (2, 3), False),
    (CUT, (2, 3), True), (CUT, (3, 2), True), (CUT, (1, 2), False), (CUT, (3, 4), False),
])  # fmt: skip
def test_who_misses_what_was_taken_away_has_detected_it(view, action, suspect, detects):
    recovery = fault(view, action, 2, 3)
    noted(view, [report(c.REPORT_SUSPECT, *suspect, at=49_999)], until_us=50_000)
    assert recovery.detected_ms is None  # that was before
    noted(view, [report(c.REPORT_SUSPECT, *suspect, at=53_500),
                 report(c.REPORT_SUSPECT, *suspect, at=60_000)], until_us=61_000)  # fmt: skip
    assert recovery.detected_ms == (3.5 if detects else None)


def test_to_kill_the_dead_changes_nothing(view):
    assert fault(view, KILL, 2) is fault(view, KILL, 2, at_us=90_000)
    assert (view.memory.fault.at_us, view.memory.event_us) == (50_000, 50_000)
    last = view.history.after(LOG, 0, 10_000_000, 100)[-1].what
    assert (last["text"], "mark" in last) == ("node n2 switched off: nothing changed", False)
    assert fault(view, CUT, 1, 2, at_us=91_000) is fault(view, CUT, 2, 1, at_us=92_000)


@pytest.mark.parametrize(("action", "takes"), [(CUT, True), (KILL, True), (RESTORE, False),
                                               (REVIVE, False), (QUIET, False)])  # fmt: skip
def test_what_takes_something_away_begins_a_recovery(view, action, takes):
    assert (fault(view, action, 2, 3) is not None) == takes


def radios(view, **states):
    for node, state in states.items():
        view.engine.world.radios["state"][int(node[1:])] = state


def test_links_and_nodes_that_are_up(view):
    world = view.engine.world
    radios(view, n0=ALIVE, n1=ALIVE, n2=ALIVE, n3=ALIVE, n4=ALIVE)
    fixed = [pair for pair in view.field.pairs if 4 not in pair]
    assert fixed == [(0, 1), (1, 2), (2, 3)]
    assert [pair for pair in view.field.pairs if 4 in pair] == [(i, 4) for i in range(4)]
    where = {pair: i for i, pair in enumerate(view.field.pairs)}
    up = view.arrays(False)["link_up"]
    assert [int(up[where[pair]]) for pair in fixed] == [1, 1, 1]
    assert [int(up[where[i, 4]]) for i in range(4)] == [2, 2, 2, 2]  # the robot is nowhere yet
    radios(view, n1=DEAD)
    world.cut[2 * 5 + 3] = world.cut[3 * 5 + 2] = 1
    shown = view.arrays(False)
    assert shown["node_up"].tolist() == [1, 0, 1, 1, 1]
    assert [int(shown["link_up"][where[pair]]) for pair in fixed] == [0, 0, 0]


def test_who_is_yet_to_come_is_neither_on_nor_switched_off(view):
    radios(view, n0=ALIVE, n1=OFF, n2=OFF, n3=DEAD, n4=ALIVE)  # n1 starts by itself, soon
    view.plan.absent[2] = view.plan.absent[3] = view.plan.absent[4] = 1  # n3 came, and died
    shown = view.arrays(False)
    assert shown["node_up"].tolist() == [1, 1, 0, 0, 1]
    assert shown["absent"].tolist() == [0, 0, 1, 0, 0]


@pytest.mark.parametrize(("there", "back", "shown"), [(0, 0, 1), (-1, 0, 2), (0, -1, 2), (5, 5, 1)])
def test_a_robots_link_is_there_while_both_hear_each_other_well(view, there, back, shown):
    """Well: as from the 50 % point and a margin on."""
    radios(view, n3=ALIVE, n4=ALIVE)
    least = view.plan.radio.rssi50_cdb + GOOD_CDB
    view.engine.world.rssi[3 * 5 + 4] = least + there
    view.engine.world.rssi[4 * 5 + 3] = least + back
    assert view.arrays(False)["link_up"][view.field.pairs.index((3, 4))] == shown


def test_frames_on_the_air_go_to_whom_they_are_for_or_to_all_around(view):
    world = view.engine.world
    view.engine.now_us = 30_000
    for place, (node, kind, to) in enumerate([(1, c.DATA, 2), (2, c.REQUEST, c.ALL)]):
        air, frame = world.air[place], world.frames[place]
        air["state"], air["node"], air["start"], air["end"] = ON_AIR, node, 20_000, 60_000
        frame["kind"], frame["link_dst"] = kind, to
    world.air["start"][1] = 30_000
    assert view.arrays(True)["flights"] == [
        {"a": 1, "b": 2, "kind": "data", "p": 0.25},
        {"a": 2, "b": 1, "kind": "request", "p": 0.0},
        {"a": 2, "b": 3, "kind": "request", "p": 0.0},
    ]
    assert view.arrays(False)["flights"] == []


def test_the_map_has_metres_roles_and_the_fence_with_north_up(view):
    scene = view.scene()
    assert [node["label"] for node in scene["nodes"]] == list(NAMES)
    assert [(n["x"], n["y"]) for n in scene["nodes"]][:3] == [(0, 0), (20, -5), (40, -10)]
    assert [n["role"] for n in scene["nodes"]] == ["gateway", "standby", "monitor", "node", "robot"]
    assert scene["fence"] == [[[0, 30], [90, 30], [90, -50], [0, -50]],
                              [[10, -30], [20, -30], [20, -40]]]  # fmt: skip
    assert scene["metres"]
    for link in scene["links"]:
        apart = abs(link["a"] - link["b"])
        assert 0 <= link["quality"] <= 1
        assert (link["quality"] >= 0.5) == (apart == 1)


@pytest.mark.parametrize(("raised", "outside", "shown"), [(0, 0, (0, 0)), (1, 2, (1, 1)),
                                                          (0, 1, (0, 0))])  # fmt: skip
def test_a_robots_alarm_is_what_the_monitor_knows(view, raised, outside, shown):
    nodes = view.engine.world.nodes
    nodes["raised"][2][4], nodes["outside"][4] = raised, outside
    nodes["raised"][1][4], nodes["outside"][3] = 1, 2  # neither the monitor nor a robot
    found = view.arrays(False)
    assert found["alarm"].tolist() == [0, 0, 0, 0, shown[0]]
    assert found["outside"].tolist() == [0, 0, 0, 0, shown[1]]


def test_buttons_make_faults_of_what_they_are_on(view):
    radios(view, n0=ALIVE, n1=ALIVE, n2=ALIVE, n3=ALIVE, n4=ALIVE)
    link = view.field.pairs.index((1, 2))
    made = view.fault(Cut(link))
    assert (made.action, made.node, made.other, made.value) == (CUT, 1, 2, 0)
    assert view.event(made) == {"link": [1, 2]}
    made = view.fault(Kill(3))
    assert (made.action, made.node, made.other, made.value) == (KILL, 3, 0, 0)
    assert view.event(made) == {"node": 3}
    radios(view, n3=DEAD)
    assert view.fault(Revive(3)).action == REVIVE


def have_ways(view, **who):
    """From now on these nodes, and no others, are what they are called."""
    none = np.full(5, -1)
    flags = {name: np.isin(np.arange(5), list(who.get(name, ()))) for name in Ways._fields[2:]}
    view._found = view.engine.now_us, Ways(none, none, **flags)


WELL = {"leads": [0], "on": range(5)}


@pytest.mark.parametrize(
    ("now_us", "ways", "nobody", "recovered_ms", "said"),
    [
        (50_001, WELL, False, 0.0, []),  # nobody was without a way for a moment
        (50_000, WELL, False, 0.0, []),
        (50_002, WELL, False, 0.002, ["all nodes have a way to the gateway again after 0 ms"]),
        (173_400, WELL, False, 123.4, ["all nodes have a way to the gateway again after 123 ms"]),
        # As the page rounds it in its large number.
        (352_500, WELL, False, 302.5, ["all nodes have a way to the gateway again after 303 ms"]),
        (173_400, WELL | {"astray": [3]}, False, None, []),
        (173_400, WELL | {"leads": []}, False, None, []),  # who is on could be served
        (173_400, WELL | {"on": [0]}, True, None, []),  # nobody else is left
        (173_400, WELL | {"cut_off": [1, 2, 3, 4]}, True, None, []),
        (173_400, WELL | {"cut_off": [3, 4]}, False, 123.4, 1),
    ],
)
def test_a_recovery_is_over_when_all_that_can_be_served_are(
    view, now_us, ways, nobody, recovered_ms, said
):
    recovery = fault(view, KILL, 2)
    view.engine.now_us = now_us
    have_ways(view, **ways)
    before = view.history.newest
    view.check()
    assert (recovery.nobody, recovery.recovered_ms) == (nobody, recovered_ms)
    assert recovery.shown()["apart"] == len(ways.get("cut_off", ()))
    told = [item.what["text"] for item in view.history.after(LOG, before, view.history.newest, 9)]
    assert told == said if isinstance(said, list) else len(told) == said
    have_ways(view, astray=[1], cut_off=[1, 2, 3, 4])
    if recovered_ms is not None:  # what is over is not looked at again
        view.check()
        assert recovery.shown()["apart"] == len(ways.get("cut_off", ()))


def test_without_a_fault_there_is_nothing_to_get_over(view):
    have_ways(view, **WELL)
    view.check()
    assert view.memory.recovery is None
    assert MeshView.check_us == 10_000


def test_who_has_no_way_is_counted_and_ways_are_found_anew_at_another_time(view):
    view.engine.now_us = 7
    have_ways(view, astray=[1, 2], cut_off=[4])
    shown = view.arrays(False)
    assert (shown["unconnected"], shown["apart"]) == (3, 1)
    assert view.points()["unconnected"] == 3.0
    assert view._ways() is view._found[1]
    known = view._found[1]
    view.engine.now_us = 8
    assert view._ways() is not known
    have_ways(view, astray=[1])
    view.forget(view.remember())
    assert view.points()["unconnected"] != 1.0


def test_a_load_of_more_than_all_the_time_is_shown_as_all_of_it(view):
    view.memory.load = np.array([0.2, 1.0, 1.7, 0.12345, 0])
    assert view.arrays(False)["load"].tolist() == [0.2, 1, 1, 0.123, 0]


def test_what_every_gateway_knows_of_robots_is_shown_where_they_are_the_monitor(view):
    nodes = view.engine.world.nodes
    view.plan.params["monitor"] = c.MONITOR
    nodes["raised"][1][4] = 1
    for leads, raised in (([0], 0), ([0, 1], 1), ([1], 1), ([], 0)):
        have_ways(view, leads=leads)
        assert view.arrays(False)["alarm"].tolist() == [0, 0, 0, 0, raised]


def test_of_frames_on_the_air_so_many_are_shown(view, monkeypatch):
    monkeypatch.setattr(room, "FLIGHTS_MAX", 3)
    view.engine.world.air["state"][:3] = ON_AIR
    for place in range(3):
        view.engine.world.air["node"][place] = 1
        view.engine.world.frames["link_dst"][place] = c.ALL
    assert len(view.arrays(True)["flights"]) == 3


@pytest.mark.parametrize(("command", "state", "cut", "words"), [
    (Cut, ALIVE, 1, "this link is cut already"), (Heal, ALIVE, 0, "this link is not cut"),
    (Kill, DEAD, 0, "this node is not on"), (Kill, OFF, 0, "this node is not on"),
    (Revive, ALIVE, 0, "this node is on"), (Revive, OFF, 0, "this node starts by itself"),
])  # fmt: skip
def test_what_is_so_already_is_refused(view, command, state, cut, words):
    radios(view, n1=state, n2=state)
    view.engine.world.cut[1 * 5 + 2] = cut
    where = view.field.pairs.index((1, 2)) if command in (Cut, Heal) else 2
    with pytest.raises(Refused, match=words):
        view.fault(command(where))


def test_who_is_absent_by_plan_may_be_switched_on(view):
    radios(view, n2=OFF)
    view.plan.absent[2] = 1
    assert view.fault(Revive(2)).action == REVIVE
    view.engine.world.cut[1 * 5 + 2] = 1
    made = view.fault(Heal(view.field.pairs.index((1, 2))))
    assert (made.action, view.event(made)) == (RESTORE, {"link": [1, 2]})


def test_on_a_channel_there_are_no_links_to_cut(view):
    assert view.can == ("cut", "heal", "kill", "revive")
    team = scenario.plan(scenario.load("mesh-team"))
    assert MeshView(engine_of(team), History()).can == ("kill", "revive")


def test_a_fault_that_hurts_nobody_is_got_over_as_it_is_told(view):
    view.engine.given = [MeshFault(500, CUT, 1, 2, 0, 0)]
    view.engine.now_us = 501
    have_ways(view, **WELL)
    assert [text for _, text, _ in noted(view, until_us=501)] == ["link n1 - n2 cut"]
    assert view.memory.recovery.recovered_ms == 0.0


def test_what_came_later_is_forgotten_where_one_goes_back(view):
    later = {"time": 900, "end": 950, "node": 1, "kind": c.DATA, "link_dst": 2}
    early = later | {"time": 90, "end": 95}
    noted(view, (), [early, later], until_us=1000)
    view.engine.now_us = 500
    view.forget(view.remember())
    (kept,) = view.recorder._parts["sent"]
    assert kept["time"].tolist() == [90]


def test_frames_that_wait_are_not_on_the_air(view):
    view.engine.world.air["state"][:2] = (HELD, COMMITTED)
    assert view.arrays(True)["flights"] == []
