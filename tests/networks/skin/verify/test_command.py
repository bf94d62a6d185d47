"""What `innervate verify skin` looks at, what it takes for found, and what it says of that."""

from types import SimpleNamespace

import pytest

from innervate.networks.skin.verify import command, graphs, story
from innervate.networks.skin.verify.command import SkinCase, Wanted
from innervate.networks.skin.verify.fair import Fair
from innervate.networks.skin.verify.system import ANY, Budget, SkinModel
from innervate.verify.errors import VerifyError
from innervate.verify.tally import Tally

PAIR = graphs.parse("pair")


def tally(ended="complete", **more):
    return Tally(ended=ended, **{"states": 7, "expanded": 7, "generated": 9, **more})


def fair(ended="complete", starts=4, of=4, **more):
    return Fair(5, starts, of, **{"ended": ended, "rounds": 3, "calm": 2, "played": 6, **more})


def case(tallied=None, fairly=None, told=None, ticks=2):
    model = SkinModel(PAIR, "feasible", "wave", Budget(ticks=ticks))
    return SkinCase(model, "the cables", tallied or tally(), fairly, told)


BROKEN = SimpleNamespace(title="closed loop", sentences=["The PC ticks."],
                         lines=lambda: ["1. The PC ticks.", "So: closed loop"])  # fmt: skip


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (case(), "all states"),
        (
            case(tally(left_out=1200)),
            "all states but 1,200 successors with too many frames in flight",
        ),
        (case(fairly=fair()), "all states; settled in 3 of 5 rounds"),
        (
            case(tally(left_out=1200), fair(left_out=34)),
            "all states but 1,234 successors with too many frames in flight; "
            "settled in 3 of 5 rounds",
        ),
        (case(fairly=fair(starts=1)), "all states; settled from 1 of them in 3 of 5 rounds"),
        (
            case(fairly=fair("limit", starts=1)),
            "all states; fair schedule from 1 of them: limit after 3 rounds",
        ),
    ],
)
def test_how_far_it_came(made, said):
    assert command._extent(made) == said
    (line,) = command._lines(made)
    assert line.endswith(f"  {said}")
    assert "7 states            9 successors" in line


def test_what_broke_is_told_event_by_event_or_by_its_rounds():
    lines = command._lines(case(tally("broken"), told=BROKEN))
    assert lines[0].endswith("BROKEN after 1 event")
    assert lines[1:] == ["    1. The PC ticks.", "    So: closed loop"]
    lines = command._lines(case(fairly=fair("broken")))
    assert lines[1:] == ["    BROKEN: routes are not shortest after 5 fair rounds"]
    assert "walks " in command._lines(case(tally("walked")))[0]


def test_graphs_by_name_and_all_of_up_to_so_many_cells():
    (one,) = command.graphs_of("pair", 99)
    assert graphs.cables(one) == graphs.cables(PAIR)
    for text in ("pc-1", "pc-1 1-2", "pc-1 pc-2 1-2 2-3"):
        assert graphs.cables(graphs.parse(text)) == text
    assert [graph.cells for graph in command.graphs_of("all", 2)] == sorted(
        graph.cells for graph in command.graphs_of("all", 2)
    )
    assert {graph.cells for graph in command.graphs_of("all", 2)} == {1, 2}
    assert {graph.cells for graph in command.graphs_of("all", 1)} == {1}


@pytest.mark.parametrize(("more", "fits"), [
    ({}, True), ({"prompt": True}, False), ({"lean": False}, False),
])  # fmt: skip
def test_ticks_without_end_need_what_is_forgotten(more, fits):
    wanted = Wanted(graphs=(PAIR,), budget=Budget(ticks=ANY), **more)
    if fits:
        assert len(list(command.models(wanted))) == len(command.system.UPDATES)
    else:
        with pytest.raises(VerifyError, match="ticks=any goes neither with"):
            list(command.models(wanted))


def test_models_are_all_that_is_asked_for_and_keep_what_the_fair_schedule_needs():
    wanted = Wanted(("paper", "feasible"), ("wave",), (PAIR,), prompt=True, lean=False)
    paper, feasible = command.models(wanted)
    assert [(one.rule, one.updates, one.keep) for one in (paper, feasible)] == [
        ("paper", "wave", False), ("feasible", "wave", True),
    ]  # fmt: skip
    (calm,) = command.models(Wanted(updates=("wave",), graphs=(PAIR,), live=False))
    assert not calm.keep


def found(broken=0, path=3, lean=True, ended="complete", left_out=0, depth=9, ticks=2):
    model = SkinModel(PAIR, "feasible", "wave", Budget(ticks=ticks), lean=lean)
    return SimpleNamespace(broken=broken, path=[b""] * path, model=model,
                           tally=tally(ended, left_out=left_out, depth=depth))  # fmt: skip


@pytest.mark.parametrize(
    ("reduced", "whole", "unreduced", "told"),
    [
        (found(), None, None, None),
        (found(1, 3, lean=False), None, None, "reduced"),
        (found(1, 3), found(1, 3), None, "whole"),
        (found(1, 3), found(1, 5), found(1, 4), "unreduced"),
        (found(1, 3), found(1, 5), found(0), "whole"),
        (found(1, 3), None, found(1, 4), "unreduced"), (found(1, 3), None, found(0), "in short"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("walks", [0, 5])
def test_the_shortest_story_is_told_of_states_with_all_that_is_in_them(
    monkeypatch, reduced, whole, unreduced, told, walks
):
    """Of walks nothing is searched anew."""
    monkeypatch.setattr(command.retrace, "retrace", lambda _: whole)
    monkeypatch.setattr(command, "_explore", lambda *_: unreduced)
    monkeypatch.setattr(story, "tell", lambda result: result)
    monkeypatch.setattr(story, "in_short", lambda _: "in short")
    if walks and told == "unreduced":
        told = "whole" if whole is not None else "in short"
    wanted = {"reduced": reduced, "whole": whole, "unreduced": unreduced}.get(told, told)
    assert command._tell(reduced, Wanted(walks=walks), "name", None) is wanted


@pytest.mark.parametrize(
    ("whole", "again", "stands"),
    [
        (found(), fair(left_out=0), False), (found(), fair("broken", left_out=0), False),
        (found(ended="limit"), fair(left_out=0), True), (found(), fair("limit", left_out=0), True),
        (found(), fair(starts=3, left_out=0), True), (found(left_out=1), fair(left_out=0), True),
        (found(), fair(left_out=1), True), (found(ticks=1), fair(left_out=0), True),
        (found(ended="limit"), fair("broken", left_out=0), False),
    ],
)  # fmt: skip
def test_a_schedule_that_ends_badly_stands_unless_all_was_looked_at_unreduced(
    monkeypatch, whole, again, stands
):
    monkeypatch.setattr(command, "_explore", lambda *_: whole)
    monkeypatch.setattr(command, "_settle", lambda *_: again)
    broken = fair("broken")
    taken = command._settle_whole(broken, found(), Wanted(), "name", None)
    assert taken is (broken if stands else again)


@pytest.mark.parametrize(("ticks", "depth", "wanted"), [(2, 9, 2), (200, 9, 10), (ANY, 3, 4)])
def test_unreduced_nothing_is_forgotten_and_no_more_ticks_are_had_than_it_took(
    ticks, depth, wanted
):
    model = command._whole(found(ticks=ticks, depth=depth))
    assert (model.lean, model.budget.ticks) == (False, wanted)


def asked(**keys):
    usual = {"rule": "", "updates": "all", "graph": "all", "cells": None, "budget": "",
             "prompt": False, "liveness": True, "starts": 0, "walks": 0, "seed": None,
             "states": 0, "memory": "2G", "plain": False, "reduce": True}  # fmt: skip
    return [one.args for one in command.explorations(None, SimpleNamespace(**usual | keys))]


def test_skins_of_up_to_two_cells_are_explored_under_the_rule_that_keeps_its_promise():
    found = asked()
    assert {model.rule for model, *_ in found} == {"feasible"}
    assert {model.graph.cells for model, *_ in found} == {1, 2}
    assert {model.updates for model, *_ in found} == set(command.system.UPDATES)
    assert [first for *_, first in found] == [True] + [False] * (len(found) - 1)
    assert {wanted.seed for _, wanted, _ in found} == {1}
    found = asked(rule="paper", graph="pair", seed=7, cells=1)
    assert {(model.rule, wanted.seed) for model, wanted, _ in found} == {("paper", 7)}
    assert {model.graph.cells for model, *_ in asked(cells=1)} == {1}


@pytest.mark.parametrize(("plain", "is_compiled", "is_told"), [
    (False, False, True), (True, False, False), (False, True, False), (True, True, False),
])  # fmt: skip
def test_who_has_to_wait_for_the_compiler_is_told_so(plain, is_compiled, is_told, monkeypatch):
    monkeypatch.setattr(command.compilation, "is_compiled", lambda name: is_compiled)
    assert bool(command.notice(SimpleNamespace(plain=plain))) == is_told


@pytest.mark.parametrize("plain", [True, False])
@pytest.mark.parametrize(("first", "words", "is_told"), [
    (True, "what is left out", True), (False, "what is left out", False), (True, "", False),
])  # fmt: skip
def test_what_is_left_out_is_told_once(plain, first, words, is_told, monkeypatch):
    marked, made, said = [], case(), []

    def run(model, wanted, progress):
        assert progress("pair", tally(depth=3))
        return made

    monkeypatch.setattr(command, "run", run)
    monkeypatch.setattr(command.compilation, "mark_compiled", marked.append)
    monkeypatch.setattr(command.assumptions, "told", lambda model: words)
    monkeypatch.setattr(command.assumptions, "grounds", lambda model: {"page": "it"})
    found = command._case(made.model, Wanted(plain=plain), first,
                             lambda *told: said.append(told) or True)  # fmt: skip
    assert found.lines == [*command._lines(made), *([words] if is_told else [])]
    assert found.record == made.as_dict() | {"reductions": {"page": "it"}}
    assert (found.is_broken, found.is_complete, found.story) == (False, True, None)
    assert marked == ([] if plain else [command.COMPILED])
    ((text, *rest),) = said
    assert text.startswith("pair: 7 states, 3 events deep, ")
    assert rest == [0, 0]
