"""What is made of the words of running cells and of their PC, and commands that it is given."""

import pytest

from innervate.networks.skin.view.live import LOAD_FULL, SkinLiveView, SkinMap, SkinState
from innervate.web.errors import Refused
from innervate.web.messages import Give
from tests.web.test_live_state import cell, skin_of_three, udp


def state_of(told, left=None):
    return SkinState(SkinMap(told), told if left is None else left)


def three(**changes):
    """PC - c0 - c1; changes by node: c0, c1, pc."""
    told = skin_of_three()
    for number, name in enumerate(("c0", "c1", "pc")):
        told[number] |= changes.get(name, {})
    return told


def without(told, *nodes):
    return {at: one for at, one in told.items() if at not in nodes}


def facts(state):
    found = state._facts
    return list(found.silent), list(found.cut_off), list(found.seeking), found.pc_off


CASES = [  # changes, who is silent: (none, astray, could have one), then the facts
    ({}, (), (0, 0, 2), ([], [], [], False)),
    ({"c1": {"parent": None}}, (), (1, 1, 2), ([], [], [1], False)),
    ({"c0": {"parent": None}}, (), (2, 2, 2), ([], [], [0, 1], False)),
    ({}, (1,), (0, 0, 1), ([1], [], [], False)),
    ({}, (0,), (1, 0, 0), ([0], [1], [], False)),
    ({}, (2,), (2, 0, 0), ([], [0, 1], [], True)),
]


@pytest.mark.parametrize(("changes", "silent", "counted", "found"), CASES)
def test_who_has_no_way_and_who_could_have_one(changes, silent, counted, found):
    told = three(**changes)
    state = state_of(told, without(told, *silent))
    assert state.look() == counted
    assert facts(state) == found


def test_whoever_is_cut_off_by_hand_seeks_nothing():
    state = state_of(three(c1={"parent": None}))
    state.cut_off = [False, True, False]
    state.look()
    assert facts(state) == ([], [1], [], False)


def test_where_no_cable_is_known_cells_are_believed():
    told = {0: cell(0, 0, udp((1, 2))), 1: cell(1, None, udp((3, 4)))}
    state = state_of(told)
    assert state.map.links == []
    assert state.look() == (1, 1, 2)
    assert facts(state) == ([], [], [1], False)  # no PC is known: it is not said to be off


def test_a_cell_sends_over_the_path_of_its_parents_port_from_either_end():
    state = state_of(three())
    assert state.hop.tolist() == [2, 0, -1]
    shown = state.more()
    assert (shown["port"].tolist(), shown["depth"].tolist()) == ([0, 0, 0], [1, 2, 0])
    other = state_of(three(c0={"parent": 1}))  # each to the other
    assert other.hop.tolist() == [1, 0, -1]
    assert other.more()["port"].tolist() == [-1, -1, 0]
    assert state_of(three(c1={"parent": 9})).hop.tolist() == [2, -1, -1]  # no such port


def test_load_is_a_share_of_what_fills_a_link():
    assert LOAD_FULL == 66
    shown = state_of(three(c0={"load": 33}, c1={"load": 200})).more()
    assert shown["load"].tolist()[:2] == [0.5, 1.0]
    assert shown["told"] == [-1] * 3
    assert state_of(three(c0={"command": 0})).more()["told"][0] == 0


def roles(told, *names):
    return [one.get("role") for one in SkinLiveView().unknown(told, [*names])]


def test_of_those_who_do_not_answer_one_is_the_pc_where_no_other_is():
    cells = [cell(0, None, udp((1, 2), (3, 4))), cell(1, None, udp((4, 3)))]
    assert roles(cells, "a", "b") == ["sink", "cell"]
    assert roles(cells, "a", "pc") == ["cell", "sink"]
    assert roles(list(three().values()), "a", "pc") == ["cell", "cell"]
    assert roles(cells) == []


def test_who_died_beside_cells_whose_pc_runs_elsewhere_is_not_the_pc():
    cells = [cell(0, None, udp((1, 2), (3, 4))), cell(1, None, udp((4, 3), (5, 6)))]
    cells[1]["paths"][1]["heard_s"] = 0.01  # another cell, on another machine
    assert roles(cells, "c2") == ["cell"]
    away = [cell(0, 0, udp((1, 2)))]  # its way leads there, too
    assert roles(away, "c2") == ["cell"]
    assert roles(away, "pc") == ["sink"]


class Asked:
    """A PC that answers; what it was asked."""

    def __init__(self, answer):
        self.answer, self.requests = answer, []

    def __call__(self, node, request):
        self.requests.append((node, request))
        return self.answer


def given(view, ask, node=None):
    told = three()
    command = Give(code=3, value=4, node=node)
    return view.give(command, SkinMap(told), told, lambda place: f"cell {place.node}", ask)


def test_a_command_is_sent_by_the_pc_and_told_when_all_have_it():
    view, ask = SkinLiveView(), Asked({"number": 7, "ports": [0]})
    assert given(view, ask) == "command 7 sent to all cells"
    assert ask.requests == [(2, {"do": "command", "code": 3, "value": 4, "cell": None})]
    told = three(c0={"command": 7})
    assert view.news(told, lambda i: f"c{i}") == []
    assert view.news(without(three(), 0, 1), lambda i: f"c{i}") == []  # no cell answers
    told[1]["command"] = 7
    assert view.news(told, lambda i: f"c{i}") == [("command 7 came to both cells", "good")]
    assert view.news(told, lambda i: f"c{i}") == []  # once


def test_a_command_for_a_cell_is_told_when_that_has_it():
    view, ask = SkinLiveView(), Asked({"number": 8, "ports": [0]})
    assert given(view, ask, node=1) == "command 8 sent to cell 1"
    assert ask.requests[0][1]["cell"] == 1
    assert view.news(three(c0={"command": 8}), lambda i: f"c{i}") == []
    assert view.news(three(c1={"command": 8}), lambda i: f"c{i}") == [
        ("command 8 came to c1", "good")]  # fmt: skip


@pytest.mark.parametrize(("answer", "node", "words"), [
    (None, None, "did not take it: no answer"), ({"error": "too fast"}, None, "too fast"),
    ({"number": 1, "ports": []}, None, "no cell has the PC as its parent"),
    ({"number": 1, "ports": [0]}, 2, "this is a port of the PC"),
    ({"number": 1, "ports": [0]}, 3, "node"),
])  # fmt: skip
def test_a_command_that_cannot_be_is_refused_and_not_waited_for(answer, node, words):
    view = SkinLiveView()
    with pytest.raises(Refused, match=words):
        given(view, Asked(answer), node)
    assert view._under_way == {}
    assert view.can(three()) == ("command",)
    assert view.can(without(three(), 2)) == ()


def heard(told, *at):
    """Somebody is heard by these paths, (node, path)."""
    for node, path in at:
        told[node]["paths"][path]["heard_s"] = 0.01
    return told


def test_cells_whose_pc_runs_elsewhere_have_their_way():
    """Of the line PC - c0 - c1 - c2 the first two run on another machine."""
    told = {0: cell(1, 0, udp((4, 3), (5, 6))), 1: cell(2, 0, udp((6, 5)))}
    state = state_of(heard(told, (0, 0), (0, 1), (1, 0)))
    assert state.look() == (0, 0, 2)
    found = state.headline()
    assert (found.level, found.text) == (
        "ok",
        "Every cell has a way to the PC; both cells have it by nodes that do not run here, and "
        "what is said of that is believed.",
    )
    shown = state.more()
    assert (shown["beyond"].tolist(), shown["port"].tolist()) == ([1, 1], [-1, -1])
    told[0]["parent"] = None
    state = state_of(told)
    assert facts(state) == ([], [], [0, 1], False)
    assert state.headline().text == (
        "Both cells have no way to the PC, nor do nodes that do not run here give one."
    )
    told[0]["paths"][0]["broken"] = True
    assert facts(state_of(told)) == ([], [0, 1], [], False)


def test_a_cell_that_hears_its_parent_elsewhere_alone_has_a_way():
    state = state_of(heard({0: cell(1, 0, udp((4, 3)))}, (0, 0)))
    assert state.headline().level == "ok"
    assert state.more()["beyond"].tolist() == [1]
    state = state_of(heard({0: cell(1, None, udp((4, 3)))}, (0, 0)))
    assert state.headline()[:2] == (
        "down", "The only cell has no way to the PC, nor do nodes that do not run here give one.",
    )  # fmt: skip


def test_a_dead_cell_that_is_known_is_not_elsewhere():
    told = heard(three(), (1, 0))
    assert facts(state_of(told, without(told, 0))) == ([0], [1], [], False)


@pytest.mark.parametrize(("ports", "level", "text"), [
    ([3, 1], "ok", "4 cells have a way to the PC, as it says; none of them runs here."),
    ([0, 1], "ok", "1 cell has a way to the PC, as it says; none of them runs here."),
    ([0], "no data", "No cell runs here, and none has a way to the PC."),
])  # fmt: skip
def test_a_pc_whose_cells_run_elsewhere(ports, level, text):
    told = {0: skin_of_three()[2] | {"cells": ports}}
    found = state_of(told).headline()
    assert (found.level, found.text) == (level, text)


def test_a_pc_that_knows_how_many_cells_there_are_misses_those_that_died_elsewhere():
    told = {0: skin_of_three()[2] | {"cells": [3, 0], "of_cells": 4}}
    assert state_of(told).headline()[:2] == (
        "degraded", "3 of 4 cells have a way to the PC, as it says; none of them runs here.",
    )  # fmt: skip
    told[0]["cells"] = [3, 1]
    assert state_of(told).headline().level == "ok"
