"""Networks of one's own over a field, by the defaults of its medium; above CSMA, too."""

import re

import pytest

import innervate
from innervate import scenario as scenarios
from innervate.cli import main
from innervate.network import NetworkError, networks
from innervate.sim.field import listening
from innervate.sim.field.declared import simulation
from innervate.web.field_view import FieldView
from tests.own import alone, at_once, bare, made, plain, refused, run_both_ways

__all__ = ["alone", "bare", "plain"]
ENDS = [{"nodes": [0, 1], "quality": 1.0}, {"nodes": [1, 2], "quality": 1.0}]


@pytest.fixture(params=["", "csma"])
def flood(alone, request):
    return made(alone / "flood", "field", request.param)


def ran(flood, **changes):
    return innervate.run(flood.scenario, plain=True, overrides=changes)


def in_line(flood, **changes):
    """Three nodes, of which those at the ends do not hear each other; node 0 has news once."""
    once = [{"at_s": 0.1, "node": 0, "item": {"value": 7}}]
    usual = {"nodes": 3, "link": ENDS, "input": once, "event": []}
    return ran(flood, **{**usual, **changes})


def test_every_frame_is_accounted_for(flood):
    for changes in ({}, {"protocol.hops": 2}, {"spacing_m": 30}, {"air.queue_frames": 1},
                    {"event": [{"at_s": 0.10001, "action": "kill", "node": 0}]}):  # fmt: skip
        frames = ran(flood, **changes).summary["frames"]
        assert frames["sent"] == frames["arrived"] + frames["lost"] > 20, changes


def test_news_go_from_hop_to_hop(flood):
    run = in_line(flood)
    assert run.summary["frames"]["lost"] == 0
    assert sorted(run.result.rows["deliveries"]["node"].tolist()) == [1, 2]
    assert (run.result.rows["deliveries"]["latency"] > 0).all()
    one_hop = in_line(flood, **{"protocol.hops": 1}).result.rows["deliveries"]
    assert one_hop["node"].tolist() == [1]


def test_news_that_many_got_do_not_stand_for_those_that_nobody_got(flood):
    given = [{"at_s": 0.1, "node": 0, "item": {"value": 7}},
             {"at_s": 0.3, "node": 2, "item": {"value": 8}}]  # fmt: skip
    event = [{"at_s": 0.2, "action": "cut", "node": 1, "other": 2}]
    run = in_line(flood, input=given, event=event)
    assert (run.result.counts.offered, run.result.counts.delivered) == (2, 2)
    assert run.summary["headline"]["text"].startswith("1 of 2 messages is not delivered, ")
    both = in_line(flood, input=given).summary["headline"]["text"]
    assert both == "2 messages are delivered 4 times, none of 8 receptions is lost."


@pytest.mark.parametrize(
    ("event", "got"),
    [
        ([{"at_s": 0.05, "action": "cut", "node": 1, "other": 2}], [1]),
        ([{"at_s": 0.05, "action": "kill", "node": 1}], []),
        ([{"at_s": 0.05, "action": "jam", "node": 2, "noise_dbm": -60}], [1]),
        ([{"at_s": 0.04, "action": "kill", "node": 1},
          {"at_s": 0.05, "action": "revive", "node": 1}], [1, 2]),
    ],
)  # fmt: skip
def test_what_happens_to_nodes_and_between_them(flood, event, got):
    run = in_line(flood, event=event)
    assert sorted(run.result.rows["deliveries"]["node"].tolist()) == got


def test_a_frame_for_one_node_is_given_to_that_one_alone(flood):
    flood.change("protocol.py", "    frame.to = ALL\n", "    frame.to = 2\n")
    links = [{"nodes": [0, 1]}, {"nodes": [0, 2]}]
    run = in_line(flood, link=links)
    assert run.result.rows["deliveries"]["node"].tolist() == [2]
    assert run.summary["frames"]["arrived"] >= 2  # the radio of the other one hears it, too


def test_quality_is_the_share_of_frames_that_is_received(flood):
    links = [{"nodes": [0, 1], "quality": 0.6}]
    often = [{"at_s": 0.01, "every_s": 0.05, "node": 0}]
    frames = ran(flood, nodes=2, link=links, input=often, event=[], duration_s=20).summary["frames"]
    assert 0.5 < frames["arrived"] / frames["sent"] < 0.7


def test_news_that_wait_stay_what_they_are_while_others_come_in(flood):
    """Both ends say something at once; whoever passes one on has heard the other meanwhile."""
    flood.change(
        "protocol.py",
        "    copy.value = frame.value\n",
        "    copy.value = frame.value\n    report(out, 2, frame.origin, frame.value)\n",
    )
    flood.change("protocol.py", "import deliver, send", "import deliver, report, send")
    given = [{"at_s": 0.1, "node": node, "item": {"value": 7 + node}} for node in (0, 2)]
    count = 0
    for seed in range(5):
        heard = innervate.run(
            flood.scenario, plain=True, seed=seed,
            overrides={"nodes": 3, "link": ENDS, "event": [], "input": given},
        ).numpy("reports")  # fmt: skip
        assert (heard["b"] == 7 + heard["a"]).all(), seed
        count += len(heard["a"])
    assert count >= 5


def test_how_loud_a_frame_came_in_is_known(flood):
    flood.change("protocol.py", "    node.value = frame.value\n    copy",
                 "    node.value = -frame.rssi\n    copy")  # fmt: skip
    often = [{"at_s": 0.1, "every_s": 0.1, "node": 0}]
    places = {"nodes": 2, "positions_m": [[0, 0], [30, 0]], "protocol.hops": 1}
    run = ran(flood, event=[], input=often, **places)
    assert run.result.world.stations[1].value == 92  # 3 dB above -95 dBm, where half are received


def test_who_sends_at_once_is_not_heard_but_waits_in_the_node(bare):
    """Without a random wait both ends answer at once: neighbours of both hear neither."""
    run = ran(bare, nodes=3, link=ENDS, event=[], input=[{"at_s": 0.1}],
              **{"protocol.wait_us": 1})  # fmt: skip
    lost = run.summary["frames"]["lost_by"]
    assert lost.get("collision", 0) + lost.get("sending", 0) >= 2, lost


@pytest.fixture
def carriers(monkeypatch):
    """Who was told of its carrier, in order: node, busy."""
    told = []
    was = listening.tell_carrier

    def noted(world, do, node, time):
        was(world, do, node, time)
        told.append((node, world.radios[node].told))

    monkeypatch.setattr(listening, "tell_carrier", noted)
    return told


def test_a_carrier_is_told_when_it_comes_and_goes(bare, carriers):
    in_line(bare, nodes=2, link=ENDS[:1])
    assert carriers == [(1, 1), (0, 0), (1, 0), (0, 1), (1, 0), (0, 0)]  # news, and passed on
    carriers.clear()
    noise = [{"at_s": 0.05, "action": "jam", "node": 1, "noise_dbm": -60},
             {"at_s": 0.06, "action": "quiet", "node": 1}]  # fmt: skip
    in_line(bare, nodes=2, link=ENDS[:1], event=noise, input=[])
    assert carriers == [(1, 1), (1, 0)]


@pytest.fixture
def blurting(bare):
    """Nodes without a medium access that send as soon as they are given something."""
    news = {"to": "ALL", "hops": 1, "origin": "node.number", "seq": "item.value"}
    bare.rewrite("on_input", at_once("NEWS", **news, value="item.value"))
    return bare


LONG = {"air.bits_per_s": 1_000, "nodes": 3, "link": ENDS}  # a frame takes more than 50 ms


@pytest.mark.parametrize(
    ("event", "told"),
    [
        ([], [(1, 1), (0, 0), (1, 0)]),
        ([("kill", 0, 20)], [(1, 1), (1, 0)]),
        ([("kill", 1, 20), ("revive", 1, 40)], [(1, 1), (1, 1), (0, 0), (1, 0)]),
        ([("restart", 1, 20)], [(1, 1), (1, 1), (0, 0), (1, 0)]),
        ([("cut", 0, 20)], [(1, 1), (1, 0), (0, 0)]),
        ([("cut", 0, 20), ("restore", 0, 40)], [(1, 1), (1, 0), (1, 1), (0, 0), (1, 0)]),
        ([("jam", 1, 20), ("quiet", 1, 400)], [(1, 1), (0, 0), (1, 0)]),
        ([("jam", 1, 20), ("quiet", 1, 40)], [(1, 1), (0, 0), (1, 0)]),
    ],
)  # fmt: skip
def test_whatever_changes_the_carrier_it_is_told(blurting, carriers, event, told):
    """Node 0 is on the air from 100 ms on; the times of events are ms after that."""
    more = {"cut": {"other": 1}, "restore": {"other": 1}, "jam": {"noise_dbm": -60}}
    events = [{"at_s": 0.1 + ms / 1000, "action": what, "node": node, **more.get(what, {})}
              for what, node, ms in event]  # fmt: skip
    in_line(blurting, event=events, **LONG)
    assert carriers == told


@pytest.mark.parametrize(
    ("event", "arrived", "lost"),
    [
        ([], 1, {}),
        ([("cut", 20)], 0, {"cut": 1}),
        ([("cut", 20), ("restore", 21)], 0, {"cut": 1}),
        ([("cut", -20), ("restore", 21)], 0, {"cut": 1}),
        ([("cut", -20), ("restore", -10)], 1, {}),
        ([("restore", 20)], 1, {}),
        ([("cut", -20), ("restore", -10), ("restore", 20)], 1, {}),
    ],
)
def test_a_frame_whose_link_was_cut_in_the_middle_is_lost(blurting, event, arrived, lost):
    events = [{"at_s": 0.1 + ms / 1000, "action": what, "node": 1, "other": 0}
              for what, ms in event]  # fmt: skip
    frames = in_line(blurting, event=events, **LONG).summary["frames"]
    assert (frames["arrived"], frames["lost_by"]) == (arrived, lost)


@pytest.mark.parametrize("times", [1, 2, 3])
def test_an_urgent_frame_that_finds_the_radio_busy_is_counted(telling, times):
    text = (telling.folder / "protocol.py").read_text()
    sent = text[text.index("    frame = out.frame[send(out, 0, 0, 0)]") :]
    sent = sent[: (sent + "\n\n\n").index("\n\n\n") + 1]
    telling.change("protocol.py", sent, sent.replace("0)]", "1)]") * times)
    frames = in_line(telling, **{"protocol.hops": 1}).summary["frames"]
    assert (frames["sent"], frames["arrived"]) == (times, 1)
    assert frames["lost_by"] == ({"busy": times - 1} if times > 1 else {})


def test_what_breaks_is_told_by_file_and_line(flood):
    flood.change("protocol.py", "    node.value = frame.value\n    copy",
                 "    node.value = frame.value + 250\n    copy")  # fmt: skip
    at = flood.line("protocol.py", "+ 250")
    says = rf"flood/protocol.py:{at}: value is 2\d\d, declared 0 to 255"
    with pytest.raises(NetworkError, match=says):
        innervate.run(flood.scenario, overrides={"protocol.hops": 1})


def test_its_own_invariants_are_looked_at(flood):
    flood.change("invariants.py", "node.hops <= params.hops", "node.seq < 2")
    with pytest.raises(NetworkError, match="a message may go further than `hops` says: node 0"):
        ran(flood)
    (case,) = innervate.explore(flood.folder, graph="pair", budget="input=2,restart=0")
    assert case.is_broken


@pytest.mark.parametrize(
    ("file", "old", "new", "says"),
    [
        ("protocol.py", "def on_carrier(", "def on_carriers(", "flood/protocol.py:1: .*on_carrier"),
        ("protocol.py", "    for i in range(PLACES):\n        node.seen[i] = -1",
         "    while node.seq == 0:\n        node.busy = 0", "flood/protocol.py:2[0-9]: "),
        ("frames.py", '"hops", 0, 4, 0', '"hops", 0, 2, 0', "flood/frames.py:[0-9]+: .*hops"),
        ("protocol.py", "    frame.kind = NEWS", "    frame.kind = 2", "no layout"),
        ("network.py", 'medium="field"', 'medium="feild"', "flood/network.py:5: .*no medium 'fei"),
        ("network.py", 'medium="field"', 'medium="field", over="tdma"', "over can be csma"),
    ],
)  # fmt: skip
def test_mistakes_of_a_protocol_are_one_line(bare, capsys, file, old, new, says):
    bare.change(file, old, new)
    line = refused(bare, capsys, "run")
    assert re.search(says, line), line


@pytest.fixture
def telling(alone):
    """A network above CSMA that reports what became of its frames."""
    network = made(alone / "flood", "field", "csma")
    network.change("protocol.py", "import deliver, send,", "import deliver, report, send,")
    path = network.folder / "protocol.py"
    path.write_text(
        path.read_text()
        + '''

def on_sent(node, params, now, ok, out):
    """A frame of ours has left, or not."""
    report(out, 7, ok, node.hops)
'''
    )
    return network


def told_of(run):
    rows = run.result.rows["rows"]
    return [(int(row["node"]), int(row["a"])) for row in rows if row["code"] == 7]


def test_a_protocol_above_csma_is_told_that_its_frames_have_left(telling):
    assert told_of(in_line(telling)) == [(0, 1), (1, 1), (2, 1)]
    jammed = {"at_s": 0.05, "action": "jam", "node": 1, "noise_dbm": -60}
    assert told_of(in_line(telling, event=[jammed])) == [(0, 1)], "1 hears nothing"
    jammed |= {"node": 0}
    assert told_of(in_line(telling, event=[jammed])) == [(0, 0)], "the channel stays busy"


def test_an_urgent_frame_waits_for_nothing_and_nobody_is_told(telling):
    telling.change("protocol.py", "send(out, 0, 0, 0)", "send(out, 0, 0, 1)")
    jammed = {"at_s": 0.05, "action": "jam", "node": 0, "noise_dbm": -60}
    run = in_line(telling, event=[jammed])
    assert told_of(run) == []
    assert sorted(run.result.rows["deliveries"]["node"].tolist()) == [1, 2]


def test_what_becomes_of_a_frame_is_explored(telling):
    telling.change("protocol.py", "report(out, 7, ok, node.hops)", "node.hops += 16 * (1 - ok)")
    (case,) = innervate.explore(telling.folder, graph="pair", budget="restart=0")
    assert case.is_broken
    assert "n0 finds the channel busy and is given up" in " ".join(case.story.sentences)
    (case,) = innervate.explore(telling.folder, graph="pair", budget="restart=0,loss=0")
    assert not case.is_broken


def test_on_sent_is_written_as_it_is_called(telling, capsys):
    telling.change(
        "protocol.py", "def on_sent(node, params, now, ok, out)", "def on_sent(node, ok)"
    )
    assert main(["run", str(telling.scenario)]) == 2
    assert "on_sent takes 2 arguments" in capsys.readouterr().err


def test_a_page_shows_it_where_it_lies_and_cuts_its_links(bare):
    plan = scenarios.plan(scenarios.load(bare.scenario))
    from innervate.web.engine import Engine
    from innervate.web.history import History

    view = FieldView(Engine(simulation(plan)), History())
    scene = view.scene()
    assert len(scene["nodes"]) == 16
    assert len(scene["links"]) == len(plan.good) == 42
    assert (scene["nodes"][5]["x"], scene["nodes"][5]["y"]) == (1.333, 1.333)
    fault = view.make(10, 0, view.cut(0, False))
    assert (fault.node, fault.other) == plan.good[0]
    arrays = view.arrays(False)
    assert (scene["ways"], arrays["unconnected"]) == (False, 0), "who is off, as nobody has a way"
    assert arrays["link_up"].tolist() == [1] * 42
    assert set(arrays["fields"]) >= {"seq", "value"}


def test_its_captures_and_its_graph(bare, plain, tmp_path):
    out = tmp_path / "flood.pcapng"
    words = ["--pcapng", str(out), "--set", "duration_s=1.05"]
    assert main(["export", str(bare.scenario), *words]) == 0
    assert out.stat().st_size > 1_000
    graph = networks()["flood"].graph(scenarios.plan(scenarios.load(bare.scenario)))
    assert len(graph.edges) == 42
    assert graph.nodes[5] == ("node 5", {"number": 5, "x_m": 20.0, "y_m": 20.0})


@pytest.mark.slow  # compiles a protocol that no other test runs
def test_compiled_runs_equal_plain_ones(flood):
    run_both_ways(flood)


def test_a_run_goes_on_from_where_it_was(bare):
    """A page's slices give what one run gives."""
    plan = scenarios.plan(scenarios.load(bare.scenario))
    whole, sliced = simulation(plan, plain=True), simulation(plan, plain=True)
    whole.finish(None, None)
    while sliced.clock_us() < plan.duration_us and sliced.next_us() is not None:
        sliced.advance(min(sliced.clock_us() + 50_000, plan.duration_us), 1_000_000)
        if sliced.next_us() >= plan.duration_us:
            break
        sliced.advance(min(sliced.next_us() + 1, plan.duration_us), 1_000_000)
    assert whole.fingerprint == sliced.fingerprint
