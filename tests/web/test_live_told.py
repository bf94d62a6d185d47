"""What a page is told of running nodes over time: points, recoveries, who cut what; by a clock."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate.web import live
from innervate.web.errors import Refused
from innervate.web.history import LOG, SERIES
from innervate.web.live import EXPECTED_S, POLL_S, SOON_S, Live
from innervate.web.live_poll import Poller
from innervate.web.live_scene import UNKNOWN, Drawn
from innervate.web.messages import Cut, Heal, Kill, Revive

RING = [(0, 1), (1, 2), (2, 0)]


def said(received=0, dropped=0, up=(True, True), onward=(), gateway=0, number=0):
    """What a node of a ring of three says; its paths lead to the one before and the one behind."""
    near = [{"node": (number + step) % 3, "ports": [port], "suspect": False}
            for port, step in enumerate((2, 1))]  # fmt: skip
    paths = [{"port": port, "name": f"p{port}", "own": "", "up": up[port],
              "counters": {"received": received}} for port in range(2)]  # fmt: skip
    return {"kind": "mesh", "role": "node" if number else "gateway", "number": number,
            "gateway": gateway, "onward": list(onward), "paths": paths, "neighbours": near,
            "counters": {"dropped: crc": dropped, "dropped: length": 1, "frames": 99},
            }  # fmt: skip


def all_of_them(**changes):
    own = {i: {"onward": () if i == 0 else (0,)} for i in range(3)}
    for name, change in changes.items():
        own[int(name[1:])] |= change
    return {i: said(number=i, **own[i]) for i in range(3)}


class Nodes:
    """Running nodes, what they answer, and a page's source that asks them."""

    def __init__(self, monkeypatch):
        self.now, self.told, self.asked, self.deaf = 100.0, all_of_them(), [], set()
        self.refusing = set()
        clock = SimpleNamespace(monotonic=lambda: self.now)
        monkeypatch.setattr(live, "time", clock)
        monkeypatch.setattr(Poller, "ask_all", lambda _, request: dict(self.told))
        monkeypatch.setattr(Poller, "ask", lambda _, requests: self._answer(requests))
        self.source = Live([Path(name) for name in ("a", "b", "c")])

    def _answer(self, requests):
        ((node, request),) = requests.items()
        self.asked.append((node, request["do"], request["port"]))
        said = {"error": "64 are connected"} if node in self.refusing else {"ok": True}
        return {} if node in self.deaf else {node: said}

    def look(self, after_s=0.0):
        """Some time later all are asked."""
        self.now += after_s
        self.source._poll()
        self.source._look()
        return self.source.fields()

    def texts(self):
        history = self.source.history
        return [one.what["text"] for one in history.after(LOG, 0, history.newest, 99)]

    def marks(self):
        history = self.source.history
        lines = [one.what for one in history.after(LOG, 0, history.newest, 99)]
        return [line["mark"] for line in lines if "mark" in line]

    def points(self):
        history = self.source.history
        return [one.what for one in history.after(SERIES, 0, history.newest, 99)]


@pytest.fixture
def nodes(monkeypatch):
    return Nodes(monkeypatch)


def test_points_are_rates_since_the_last_look_and_never_below_0(nodes):
    nodes.look(1.0)
    assert nodes.points() == [], "of one look nobody knows a rate"
    nodes.told = all_of_them(n1={"received": 10, "dropped": 4}, n2={"received": 5})
    nodes.look(2.0)
    nodes.told = all_of_them(n1={"received": 10, "dropped": 4, "gateway": None})
    nodes.look(1.0)  # node 2 was started anew
    assert nodes.points() == [
        {"unconnected": 0.0, "frames": 15.0, "dropped": 2.0},
        {"unconnected": 1.0, "frames": 0, "dropped": 0.0},
    ]


def test_what_others_cut_is_said_and_begins_a_recovery_what_is_put_back_only_said(nodes):
    nodes.look(1.0)
    nodes.told = all_of_them(n1={"up": (False, True)})  # its cable to 0
    shown = nodes.look(1.0)
    assert shown["recovery"]["cause"] == "link a - b cut"
    assert shown["recovery"]["at_s"] == 2.0
    assert shown["link_up"].tolist() == [0, 1, 1]
    nodes.told = all_of_them()
    shown = nodes.look(1.0)
    assert shown["recovery"]["cause"] == "link a - b cut"
    nodes.told = all_of_them(n1={"up": (False, False)})
    shown = nodes.look(1.0)
    assert shown["recovery"]["cause"] == "link a - b cut, and 1 more"
    cuts = [text for text in nodes.texts() if text.startswith("link")]
    assert cuts == ["link a - b cut", "link a - b put back", "link a - b cut", "link b - c cut"]
    assert nodes.marks()[-4:] == ["loss", "return", "loss", "loss"], "as plots show clicks"


def test_those_that_end_at_once_are_told_in_a_line_and_leave_a_gap_in_plots(nodes):
    nodes.look(1.0)
    nodes.look(1.0)
    everybody, nodes.told = nodes.told, {}
    for _ in range(4):
        nodes.look(1.0)  # once they may only be slow
    assert nodes.texts()[-1] == "a, b and c do not answer any more"
    assert nodes.marks() == ["loss"]
    assert nodes.source.fields()["recovery"]["cause"] == "3 nodes do not answer any more"
    nobody = {"unconnected": None, "frames": None, "dropped": None}
    assert nodes.points()[2:] == [nobody], "once: what is silent is told seldom"
    nodes.told = everybody
    nodes.look(1.0)
    assert nodes.points()[3:] == [{"unconnected": 0.0, "frames": 0.0, "dropped": 0.0}]


@pytest.mark.parametrize(("apart_s", "told"), [(1.0, 18), (6.0, 24)])
def test_what_others_cut_is_told_again_once_it_was_calm(nodes, apart_s, told):
    """Of a flood the first eight, and that there is more."""
    nodes.look(1.0)
    for _ in range(12):
        nodes.told = all_of_them(n1={"up": (False, True)})
        nodes.look(apart_s / 2)
        nodes.told = all_of_them()
        nodes.look(apart_s / 2)
    assert sum(text.startswith(("link", "...")) for text in nodes.texts()) == told


@pytest.mark.parametrize(("after_s", "is_ours"), [(EXPECTED_S - 0.01, True),
                                                  (EXPECTED_S + 0.01, False)])  # fmt: skip
def test_what_was_cut_from_here_is_said_once(nodes, after_s, is_ours):
    nodes.look(1.0)
    nodes.source.carry_out(Cut(0))
    assert nodes.asked == [(0, "cut", 1), (1, "cut", 0)]
    nodes.told = all_of_them(n0={"up": (True, False)}, n1={"up": (False, True)})
    nodes.look(after_s)
    assert nodes.texts().count("link a - b cut") == (1 if is_ours else 2)
    nodes.asked.clear()
    with pytest.raises(Refused, match="carries nothing already"):
        nodes.source.carry_out(Cut(0))
    nodes.source.carry_out(Heal(0))
    assert nodes.asked == [(0, "restore", 1), (1, "restore", 0)]
    assert nodes.texts()[-1] == "link a - b put back"


def test_a_cable_of_which_neither_end_can_be_told(nodes):
    nodes.look(1.0)
    nodes.deaf = {0}
    nodes.source.carry_out(Cut(0))  # one end is enough
    nodes.deaf, nodes.refusing = {0}, {1}
    with pytest.raises(Refused, match="neither end could be told"):
        nodes.source.carry_out(Cut(0))
    with pytest.raises(Refused, match="this link is not cut"):
        nodes.source.carry_out(Heal(0))


def test_a_node_is_cut_off_by_all_its_paths_and_let_back(nodes):
    nodes.look(1.0)
    nodes.source.carry_out(Kill(2))
    assert nodes.asked == [(2, "cut", 0), (2, "cut", 1)]
    nodes.told = all_of_them(n2={"up": (False, False)})
    shown = nodes.look(0.5)
    assert shown["node_up"].tolist() == [1, 1, 0]
    assert shown["recovery"]["cause"] == "c cut off"
    assert [text for text in nodes.texts() if text.startswith("link")] == []
    with pytest.raises(Refused, match="c is cut off already"):
        nodes.source.carry_out(Kill(2))
    with pytest.raises(Refused, match="b is not cut off"):
        nodes.source.carry_out(Revive(1))
    for nodes.deaf, nodes.refusing in (({2}, set()), (set(), {2})):
        with pytest.raises(Refused, match="c could not be told"):
            nodes.source.carry_out(Revive(2))
    nodes.refusing = set()
    nodes.source.carry_out(Revive(2))
    assert nodes.asked[-2:] == [(2, "restore", 0), (2, "restore", 1)]
    nodes.told = all_of_them()
    assert nodes.look(0.5)["node_up"].tolist() == [1, 1, 1]
    del nodes.told[2]
    nodes.look(0.5)
    nodes.look(0.5)
    with pytest.raises(Refused, match="c does not answer; start it again where it ran"):
        nodes.source.carry_out(Kill(2))


def test_who_is_cut_off_whole_stays_so_when_it_forgets_its_neighbours(nodes):
    nodes.look(1.0)
    nodes.source.carry_out(Kill(2))
    nodes.told = all_of_them(n2={"up": (False, False)})
    assert nodes.look(0.5)["link_up"].tolist() == [1, 0, 0]
    nodes.told[2]["neighbours"] = []
    nodes.source.work()
    shown = nodes.source.fields()
    assert shown["link_up"].tolist() == [1, 0, 0]
    assert not any("put back" in text for text in nodes.texts())
    assert (shown["unconnected"], shown["apart"]) == (1, 1), "as many as the headline says"
    assert shown["headline"]["text"].startswith("1 of 3 nodes is cut off from the gateway")
    assert shown["recovery"]["apart"] == 0, "who was cut off is the cause, and not hurt by it"


def test_how_a_recovery_went_is_told_from_the_cut_on(nodes):
    nodes.look(1.0)
    nodes.source.carry_out(Cut(0))
    lost = {"n0": {"up": (True, False)}, "n1": {"up": (False, True), "gateway": None}}
    nodes.told = all_of_them(**lost)
    shown = nodes.look(0.3)
    assert (shown["recovery"]["detected_ms"], shown["recovery"]["recovered_ms"]) == (300.0, None)
    assert shown["unconnected"] == 1
    assert nodes.look(0.2)["recovery"]["detected_ms"] == 300.0
    lost["n1"] |= {"onward": (2,), "gateway": 0}
    nodes.told = all_of_them(**lost)
    assert nodes.look(0.25)["recovery"]["recovered_ms"] == 750.0
    assert nodes.texts()[-1] == "every node has a way again after 750 ms, as they say"
    shown = nodes.look(5.0)
    assert shown["recovery"]["recovered_ms"] == 750.0
    assert shown["since_cut_s"] == pytest.approx(5.8, abs=0.06)


def test_who_is_revoked_is_put_out_and_no_link_of_it_is_cut(nodes):
    def keys(*revoked):
        return {"identity": {"serial": 2, "list": 1, "revoked": [*revoked]}}

    nodes.told = all_of_them(n2={"onward": (0,)})
    nodes.told[2]["keys"] = keys()
    nodes.look(1.0)
    nodes.told = all_of_them()
    nodes.told[2]["keys"] = keys(2)
    shown = nodes.look(1.0)
    assert shown["link_up"].tolist() == [1, 0, 0]
    assert shown["recovery"]["cause"] == "c put out: revoked"
    assert shown["headline"]["text"] == "1 of 3 nodes was put out: its identity is revoked."
    texts = nodes.texts()
    assert texts == [
        "c put out: revoked", "every node but 1 that is put out kept its way, as they say",
    ]  # fmt: skip
    assert (shown["put_out"].tolist(), shown["apart"]) == ([0, 0, 1], 0)
    assert shown["recovery"]["apart"] == 0, "it was not cut off"
    assert nodes.marks() == ["loss"]
    nodes.look(1.0)
    assert nodes.texts() == texts


def test_a_cut_beside_somebody_who_is_put_out_is_told_with_it(nodes):
    nodes.told[2]["keys"] = {"identity": {"serial": 2, "list": 1, "revoked": []}}
    nodes.look(1.0)
    nodes.told = all_of_them(n1={"up": (False, True)})
    nodes.told[2]["keys"] = {"identity": {"serial": 2, "list": 1, "revoked": [2]}}
    assert nodes.look(1.0)["recovery"]["cause"] == "link a - b cut, and 1 more"
    assert [text for text in nodes.texts() if "every" not in text] == [
        "link a - b cut", "c put out: revoked",
    ]  # fmt: skip


def test_who_was_cut_off_before_is_not_counted_with_the_next_loss(nodes):
    lone = {"n2": {"up": (False, False), "onward": ()}}
    nodes.told = all_of_them(**lone)
    assert nodes.look(1.0)["recovery"]["apart"] == 1
    for _ in range(live.SLOW + 1):
        nodes.told = {i: one for i, one in all_of_them(**lone).items() if i != 1}
        shown = nodes.look(1.0)
    assert shown["recovery"]["cause"] == "b does not answer any more"
    assert shown["recovery"]["apart"] == 0
    for change in ({}, lone):
        nodes.told = {i: one for i, one in all_of_them(**change).items() if i != 1}
        shown = nodes.look(1.0)
    assert shown["recovery"]["cause"] == "link a - c cut"
    assert shown["recovery"]["apart"] == 1, "it had been joined again"


def test_several_that_go_are_one_cause(nodes):
    nodes.look(1.0)
    gone = {0: nodes.told[0]}
    nodes.told = gone
    nodes.look(0.5)
    nodes.told = gone
    shown = nodes.look(0.5)
    assert shown["recovery"]["cause"] == "2 nodes do not answer any more"
    assert nodes.texts()[-1] == "b and c do not answer any more"
    assert nodes.marks()[-1] == "loss"
    nodes.told = all_of_them()
    nodes.look(0.5)
    assert "c answers again" in nodes.texts()
    assert nodes.marks()[-2:] == ["return", "return"]


def test_nodes_are_asked_more_often_while_somebody_has_no_way(nodes):
    source = nodes.source
    assert source.work() == pytest.approx(POLL_S)
    nodes.now += POLL_S / 2
    assert source.work() == pytest.approx(POLL_S / 2)
    source.carry_out(Cut(0))
    nodes.told = all_of_them(n0={"up": (True, False)}, n1={"up": (False, True), "gateway": None})
    assert source.work() == pytest.approx(SOON_S), "it is looked at once what came of a command"
    nodes.now += SOON_S
    nodes.told = all_of_them()
    assert source.work() == pytest.approx(POLL_S)


def test_a_link_that_is_new_needs_another_scene_and_one_that_nobody_names_stays(nodes):
    source = nodes.source
    nodes.now += 1.0
    source.work()
    assert (source.scenes, len(source.scene()["links"])) == (1, 3)
    nodes.told[0]["neighbours"] = nodes.told[0]["neighbours"][1:]
    nodes.told[2]["neighbours"] = nodes.told[2]["neighbours"][:1]
    nodes.now += 1.0
    source.work()
    assert (source.scenes, len(source.scene()["links"])) == (1, 3), "neither end names it"
    nodes.told[2]["neighbours"][0] = {"node": 1, "ports": [0, 1], "suspect": False}
    nodes.now += 1.0
    source.work()
    assert (source.scenes, len(source.scene()["links"])) == (2, 3)


def test_metres_and_a_fence_are_of_nodes_that_stand_where_their_scenario_has_them(nodes):
    places, fence = {"a": (0.0, 0.0), "b": (3.0, 0.0), "c": (3.0, 4.0)}, [[[0, 0], [5, 0], [5, 5]]]
    shown = []
    for known in (places, {"a": (0.0, 0.0)}):
        nodes.source._drawn = Drawn("yard", known, fence=fence, metres=True)
        shown.append(nodes.source.scene())
    whole, part = shown
    assert [(node["x"], node["y"]) for node in whole["nodes"]] == list(places.values())
    assert (whole["name"], whole["fence"], whole["metres"]) == ("yard", fence, True)
    assert (part["name"], part["fence"], part["metres"]) == ("yard", None, False)
    nodes.source._drawn = UNKNOWN
    alone = nodes.source.scene()
    assert (alone["name"], alone["fence"], alone["metres"]) == ("live", None, False)
