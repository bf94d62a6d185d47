"""What `check` foresees of a mesh: nobody leads, parts, too many messages, robots out of reach."""

import pytest

from innervate import scenario
from innervate.networks.mesh.scenario.foreseen import foreseen

LINE = [{"a": f"n{i}", "b": f"n{i + 1}"} for i in range(4)]


def line(*events, **more):
    """Five nodes in a row, the first leads."""
    happens = [dict(zip(("at_s", "action"), event[:2], strict=True)) | event[2] for event in events]
    tables = {"kind": "mesh", "link": LINE, "gateway": "n0", "event": happens, **more}
    return foreseen(scenario.plan(scenario.from_dict(tables)))


def kill(node, at_s=10):
    return at_s, "kill", {"node": node}


HEADLESS = "nobody leads at the end: the gateway is off, and "


@pytest.mark.parametrize(("events", "standby", "said"), [
    ([], [], []),
    ([kill("n0")], [], [HEADLESS + "there is no standby"]),
    ([kill("n0"), (20, "revive", {"node": "n0"})], [], []),
    ([kill("n0"), (20, "restart", {"node": "n0"})], [], []),
    ([kill("n0")], ["n1"], []),
    ([kill("n0"), kill("n1")], ["n1"], [HEADLESS + "so is every standby"]),
    ([kill("n0"), kill("n1")], ["n1", "n2"], []),
    ([kill("n4")], [], []),
    ([kill("n3")], [], ["at the end no links lead to n0, the gateway, from n4"]),
    ([kill("n0"), kill("n2")], ["n1"],
     ["at the end no links lead to n1, the gateway, from n3, n4"]),
    ([(10, "cut", {"link": ["n3", "n2"]})], [],
     ["at the end no links lead to n0, the gateway, from n3, n4"]),
    ([(10, "cut", {"link": ["n3", "n2"]}), (11, "restore", {"link": ["n2", "n3"]})], [], []),
])  # fmt: skip
def test_what_is_left_when_all_has_happened(events, standby, said):
    assert line(*events, standby=standby) == said


@pytest.mark.parametrize(("noise_dbm", "quiet", "said"), [
    (-40, False, ["at the end no links lead to n0, the gateway, from n1, n2, n3, n4"]),
    (-40, True, []), (-150, False, []),
])  # fmt: skip
def test_who_is_jammed_at_the_end_is_cut_off(noise_dbm, quiet, said):
    events = [(10, "jam", {"node": "n0", "noise_dbm": noise_dbm})]
    assert line(*events, *[(20, "quiet", {"node": "n0"})] * quiet) == said
    assert line(*events, radio={"profile": "ideal"}) == []


def test_faint_links_lead_too_as_long_as_most_messages_come_over_them():
    events = kill("n1"), kill("n2")
    for quality, said in (
        (0.4, []),
        (0.1, ["at the end no links lead to n0, the gateway, from n3"]),
    ):
        around = [{"a": "n0", "b": "n3", "quality": quality}]
        assert line(*events, kill("n4"), link=[*LINE, *around]) == said


BAD = (
    ": every way to n0, the gateway, has a link on which less than 25 % of transmissions are "
    "acknowledged; retries do not make up for that, and many messages will not come; the worst is "
)


@pytest.mark.parametrize(("qualities", "said"), [
    ((1, 0.5, 0.5, 1), []),
    ((1, 0.9, 0.22, 1), ["n3, n4" + BAD + "n3 - n2: there 22 % arrive, back 22 %, so 4.8 % are "
                         "acknowledged"]),
    ((0.05, 1, 1, 0.4), ["n1, n2, n3, n4" + BAD + "n1 - n0: there 5 % arrive, back 5 %, so 0.25 % "
                         "are acknowledged"]),
    ((1, 1, 1, (1, 0.2)), ["n4" + BAD + "n4 - n3: there 20 % arrive, back 100 %, so 20 % are "
                           "acknowledged"]),
])  # fmt: skip
def test_who_is_reached_over_bad_links_alone_is_told_with_their_numbers(qualities, said):
    links = [one | {"quality": share} for one, share in zip(LINE, qualities, strict=True)]
    assert line(link=links) == said


def test_a_bad_link_is_nothing_where_a_good_way_leads_round_it():
    assert line(link=[*LINE, {"a": "n0", "b": "n4", "quality": 0.05}]) == []
    assert line(link=[{**one, "quality": 0.1} for one in LINE]) != []
    star = [{"a": "n0", "b": f"n{i}", "quality": 0.6} for i in (2, 3, 4)]
    assert line(link=[{**one, "quality": 0.1} for one in LINE] + star) == [
        "n1" + BAD + "n1 - n0: there 10 % arrive, back 10 %, so 1 % are acknowledged"
    ]


def test_who_was_never_reached_is_told_once_and_who_loses_a_bad_link_twice():
    links = [{**one, "quality": 0.1 if i == 3 else 1} for i, one in enumerate(LINE)]
    (said,) = line(kill("n1"), link=[*links, {"a": "n0", "b": "n2"}])
    assert said.startswith("n4" + BAD)
    links = [{**one, "quality": 0.4 if i == 3 else 1} for i, one in enumerate(LINE)]
    assert len(line((10, "cut", {"link": ["n3", "n4"]}), link=links)) == 2


def test_a_monitor_that_is_off_learns_of_nothing():
    assert line(kill("n4"), monitor="n4") == ["the monitor n4 is off at the end"]
    assert line(kill("n4"), (20, "revive", {"node": "n4"}), monitor="n4") == []


def test_messages_that_take_longer_than_there_is_time():
    flow = {"from": "all", "to": "monitor", "every_s": 0.01, "bytes": 44, "start_s": 8}
    # 400 a second of 50 bytes and 32 us each: 0.64 of the time
    assert line(duration_s=12, flow=[flow]) == []
    (said,) = line(duration_s=12, flow=[flow | {"every_s": 0.005, "bytes": 90}])
    assert said == (
        "messages to n0 alone take 10 s on the air, without any header or ack, and there are 4 s: "
        "most will not come"
    )
    many = [flow | {"bytes": 90, "every_s": 0.005}]
    assert line(duration_s=12, flow=many, radio={"profile": "ideal"}) == []
    assert line(duration_s=12, flow=[many[0] | {"to": "all"}]) == []


def walk(*waypoints):
    tables = {
        "kind": "mesh", "nodes": 6, "placement": {"side_m": 40}, "duration_s": 30.0,
        "robot": [{"node": 5, "waypoints": waypoints, "speed_mps": 50.0, "start_s": 10}],
    }  # fmt: skip
    return foreseen(scenario.plan(scenario.from_dict(tables)))


def test_a_robot_that_leaves_everybody_behind():
    assert walk((20, 20), (20, 30)) == []
    (gone,) = walk((20, 20), (20, 900))
    assert gone.startswith("out of everybody's reach on the way, first after 1")
    assert gone.endswith(": n5")
    assert walk((20, 20), (20, 900), (20, 20))  # it comes back in the end


@pytest.mark.parametrize(("quality", "protocol", "said"), [
    (0.6, {}, True), (0.8, {}, False),
    (0.6, {"guard_s": 0.5}, False), (0.6, {"guard_s": 0.4}, True),
    (0.6, {"guard_s": 0}, False), (0.6, {"dead_s": 25}, False),
])  # fmt: skip
def test_a_standby_behind_lossy_links_that_waits_for_a_short_time_is_told(quality, protocol, said):
    links = [*LINE[:1], LINE[1] | {"quality": quality}, *LINE[2:]]
    found = line(link=links, standby=["n1", "n3"], protocol=protocol)
    assert [words.partition(":")[0] for words in found] == ["n3"] * said
