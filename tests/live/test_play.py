"""What is done to nodes and cables for each thing that a scenario says happens."""

import asyncio
from types import SimpleNamespace

import pytest

from innervate import scenario as scenarios
from innervate.live import play
from innervate.live.errors import LiveError
from innervate.live.play import Event, Player
from innervate.network import networks
from tests.live import time_by_hand

NODE = ("n2", -1)
CABLE = ("", 4)
DONE = {
    "cut": [("change", 4, "cut", 0.0)],
    "restore": [("change", 4, "restore", 0.0)],
    "loose": [("change", 4, "loose", 0.25)],
    "kill": [("end", "n2", False)],
    "leave": [("end", "n2", True)],
    "revive": [("begin", "n2")],
    "join": [("begin", "n2")],
    "restart": [("end", "n2", False), ("begin", "n2")],
    # What real channels and cables do by themselves.
    "begin": [], "garble": [], "fade": [], "jam": [], "quiet": [], "lose": [],
}  # fmt: skip


class Stage:
    """Notes what is asked for, and when."""

    def __init__(self, others=()):
        self.asked = []
        self.deployment = SimpleNamespace(others=lambda stage: list(others))

    def _note(self, *what):
        self.asked.append((round(asyncio.get_running_loop().time() - 1000, 3), *what))

    async def change(self, cable, what, loss=0.0):
        self._note("change", cable, what, loss)

    async def end_node(self, name, gently):
        self._note("end", name, gently)

    async def begin_node(self, name):
        self._note("begin", name)


def event(what, at_s=0.0):
    name, cable = CABLE if what in ("cut", "restore", "loose", "lose") else NODE
    return Event(at_s, what, cable, name, 0.25 if what == "loose" else 0.0, what)


def played(*events, others=()):
    stage, told = Stage(others), []
    time_by_hand.run(Player(stage, list(events), told.append).play())
    return stage.asked, told


@pytest.mark.parametrize("what", DONE)
def test_what_is_done_for_each_action(what):
    asked, told = played(event(what))
    assert [call[1:] for call in asked] == DONE[what]
    assert told == ([event(what)] if DONE[what] else [])


def test_every_action_of_every_network_is_played_or_left_to_the_cables():
    words = {word for network in networks().values() for word in network.actions}
    assert words <= DONE.keys()


def test_events_happen_at_their_times_and_none_is_early_because_one_is_late():
    asked, _ = played(event("cut", 0.5), event("jam", 0.7), event("restart", 2.0),
                      event("restore", 2.0), event("kill", 2.25))  # fmt: skip
    assert [call[:2] for call in asked] == [
        (0.5, "change"), (2.0, "end"), (2.0, "begin"), (2.0, "change"), (2.25, "end")]  # fmt: skip


def test_what_else_a_scenario_has_goes_on_beside_its_events():
    done = []

    async def other():
        await asyncio.sleep(1.0)
        done.append(asyncio.get_running_loop().time() - 1000)

    async def bad():
        await asyncio.sleep(1.5)
        raise LiveError("n2 ended: no message")

    played(event("cut", 3.0), others=[other()])
    assert done == [pytest.approx(1.0)]
    with pytest.raises(LiveError, match=r"^n2 ended: no message$"):
        played(event("cut", 3.0), others=[bad()])


def test_the_events_of_a_skin_name_their_cables_cells_and_shares():
    plan = scenarios.plan(scenarios.from_dict({
        "kind": "skin", "duration_s": 5.0, "patch": [{"columns": 2, "rows": 1}],
        "interface": [{"row": 0, "column": 0, "port": "W"}],
        "event": [
            {"at_s": 2.5, "action": "kill", "cell": {"row": 0, "column": 1}},
            {"at_s": 0.5, "action": "loose", "loss": 0.25, "interface": 0},
            {"at_s": 1.0, "action": "restart", "pc": True},
            {"at_s": 1.5, "action": "cut", "cell": {"row": 0, "column": 0, "port": "E"}},
        ],
    }))  # fmt: skip
    deployment = networks()["skin"].deployment(plan)
    found = play.events(deployment)
    names = deployment.names
    cables = [frozenset(names[node] for node in pair) for pair in deployment.links]
    assert [(one.at_s, one.what, one.loss) for one in found] == [
        (0.5, "loose", 0.25),
        (1.0, "restart", 0.0),
        (1.5, "cut", 0.0),
        (2.5, "kill", 0.0),
    ]
    assert [one.node for one in found] == ["", names[2], "", names[1]]
    assert [one.cable for one in found] == [
        cables.index({names[0], names[2]}),
        -1,
        cables.index({names[0], names[1]}),
        -1,
    ]
    assert [one.text for one in found][3] == f"kill {names[1]}"


@pytest.mark.parametrize(
    ("cells", "names"),
    [
        (("left", "hip.2"), ["left", "hip.2", "pc"]),
        (("left", "../hip"), ["c0", "c1", "pc"]),
        (("scenario", "hip"), ["c0", "c1", "pc"]),
    ],
)
def test_cells_of_a_free_graph_have_their_names_where_these_can_name_files(cells, names):
    a, b = cells
    plan = scenarios.plan(scenarios.from_dict({
        "kind": "skin", "duration_s": 5.0,
        "link": [{"a": "pc.0", "b": f"{a}.0"}, {"a": f"{a}.1", "b": f"{b}.0"}],
    }))  # fmt: skip
    assert networks()["skin"].deployment(plan).names == names
