"""A network of one's own on a channel, by the defaults of its medium."""

import pytest

import innervate
from innervate.network import NetworkError
from innervate.plot.lines import summary_lines
from tests.own import alone, at_once, run_both_ways, talk

__all__ = ["alone", "talk"]


def ran(talk, **changes):
    return innervate.run(talk.scenario, plain=True, overrides=changes)


def test_every_frame_is_accounted_for(talk):
    for changes in ({}, {"protocol.wait_us": 100}, {"air.loss": 0.2}, {"hidden": [[0, 1], [2, 5]]}):
        frames = ran(talk, **changes).summary["frames"]
        assert frames["sent"] == frames["arrived"] + frames["lost"] > 100, changes
    lossy = ran(talk, **{"air.loss": 0.2})
    frames = lossy.summary["frames"]
    assert frames["lost_by"]["noise"] > 20
    said = f"Receptions: {frames['sent']} due, {frames['arrived']} arrived, {frames['lost']} lost: "
    assert summary_lines(lossy)[2].startswith(said)
    assert said in lossy.report()


def test_who_does_not_hear_the_other_speaks_over_it(talk):
    hidden = {"hidden": [[a, b] for a in range(1, 6) for b in range(1, a)], "input.0.every_s": 0.02}
    assert ran(talk, **hidden).summary["frames"]["lost_by"]["collision"] > 20


def test_inputs_come_to_whom_and_when_they_are_given(talk):
    run = ran(talk, input=[{"at_s": 0.1, "node": 2, "item": {"value": 41}}], event=[])
    assert run.summary["messages"]["sent"] == 1
    assert [node.value for node in run.result.world.stations] == [0, 0, 41, 0, 0, 0]
    rows = run.result.rows["deliveries"]
    assert sorted(rows["node"].tolist()) == [0, 1, 3, 4, 5]
    assert (rows["latency"] == rows["time"] - 100_000).all()


def test_news_that_many_got_do_not_stand_for_those_that_nobody_got(talk):
    given = [
        {"at_s": at_s, "node": node, "item": {"value": 7}} for at_s, node in ((0.1, 0), (0.3, 3))
    ]
    run = ran(talk, nodes=4, input=given, event=[], hidden=[[0, 3], [1, 3], [2, 3]])
    assert (run.result.counts.offered, run.result.counts.delivered) == (2, 2)
    assert run.summary["headline"]["text"] == "1 of 2 messages is not delivered."


def test_what_breaks_is_told_by_file_and_line(talk):
    talk.change("protocol.py", "    node.busy = cd\n", "    node.busy = cd + 1\n")
    at = talk.line("protocol.py", "cd + 1")
    with pytest.raises(NetworkError, match=rf"talk/protocol.py:{at}: busy is 2, declared 0 to 1"):
        innervate.run(talk.scenario)


def test_who_sends_while_it_sends_is_told(talk):
    talk.change("protocol.py", "    if node.waiting and not node.busy and not node.sending:\n",
                "    if node.waiting:\n")  # fmt: skip
    talk.change("protocol.py", "        node.waiting = 0\n        node.sending = 1\n", "")
    with pytest.raises(NetworkError, match="sent while it was sending"):
        ran(talk, **{"protocol.wait_us": 50})


@pytest.fixture
def blurting(talk):
    """Nodes that send 15 slots as soon as they are given something."""
    talk.rewrite("on_input", at_once("SAID", slots="params.length_slots", value="item.value"))
    return talk


def test_who_dies_before_its_frame_is_on_the_air_disturbs_nobody(blurting):
    """Node 0 is on the air from 10.02 to 11.52 ms; node 1 turns its radio round from 10.5 on."""
    given = [{"at_s": 0.01, "node": 0}, {"at_s": 0.0105, "node": 1}]
    usual = {"nodes": 3, "input": given, "protocol.length_slots": 15}
    for at_s, lost in (
        (0.01051, {"off": 1, "sending": 1, "broken_off": 1}),
        (0.01052, {"off": 1, "sending": 1, "broken_off": 1}),  # as it would have begun
        (0.01053, {"off": 1, "sending": 1, "collision": 2}),
    ):
        dies = [{"at_s": at_s, "action": "kill", "node": 1}]
        frames = ran(blurting, event=dies, **usual).summary["frames"]
        assert {name: many for name, many in frames["lost_by"].items() if many} == lost, at_s
        assert (frames["sent"], frames["arrived"]) == (4, 4 - sum(lost.values())), at_s


def test_a_frame_that_was_never_sent_is_no_carrier(blurting):
    blurting.change("protocol.py", "    node.busy = cd\n", "    node.value += cd\n")
    usual = {"nodes": 3, "input": [{"at_s": 0.01, "node": 1}], "protocol.length_slots": 15}
    for at_s, told in ((0.01001, 0), (0.011, 1)):
        dies = [{"at_s": at_s, "action": "kill", "node": 1}]
        world = ran(blurting, event=dies, **usual).result.world
        assert [world.stations[node].value for node in (0, 2)] == [told, told], at_s


def test_a_frame_of_no_slots_is_told(blurting):
    blurting.change("protocol.py", "    frame.slots = params.length_slots\n    frame.value = item",
                   "    frame.slots = 0\n    frame.value = item")  # fmt: skip
    with pytest.raises(NetworkError, match="node 0 sent a frame of no slots"):
        ran(blurting, input=[{"at_s": 0.01, "node": 0}], event=[])


def test_an_explored_collision_is_heard_as_one(talk):
    talk.change("protocol.py", "    node.busy = cd\n", "    node.busy = cd + (cd - voc)\n")
    (case,) = innervate.explore(talk.folder, graph="pair", budget="restart=0")
    assert case.story.title == "busy is out of its declared range"
    assert case.story.sentences[-1] == "n1 does not hear a frame of n0: busy 0 to 2."


@pytest.mark.slow  # compiles a protocol that no other test runs
def test_compiled_runs_equal_plain_ones(talk):
    run_both_ways(talk)
