"""What is said of one exploration of a mesh."""

import re
from types import SimpleNamespace

import pytest

from innervate.networks.mesh.verify import command
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify.command import _extent
from innervate.verify.errors import VerifyError
from innervate.verify.explore import Tally


@pytest.mark.parametrize(
    ("fair", "beats", "said"),
    [
        (0, 0, "all states"),
        (9, 0, "all states; settled in 7 events at most"),
        (8, 0, "all states; settled from 8 of them in 7 events at most"),
        (9, 5, "all states; one gateway after 0.0 s at most"),
        (8, 5, "all states; one gateway from 8 of them after 0.0 s at most"),
    ],
)
def test_how_far_it_came_and_from_where_it_settles(fair, beats, said):
    tally = Tally()
    tally.states, tally.ended = 9, "complete"
    model = SimpleNamespace(beats=beats)
    found = SimpleNamespace(fair=fair, longest=7, model=model, tally=tally, wide=[])
    assert _extent(found) == said


LINE = ((0, 1), (1, 2))


def options(**keys):
    usual = {"rule": "", "graph": "all", "budget": "", "liveness": True, "states": 0, "walks": 0,
             "seed": None, "memory": "2G"}  # fmt: skip
    return SimpleNamespace(**usual | keys)


@pytest.mark.parametrize(("rule", "failovers"), [
    ("", ("search", "graph")), ("all", mesh_model.FAILOVERS), ("random", ("random",)),
])  # fmt: skip
def test_what_is_asked_for_is_explored(rule, failovers):
    found = command.wanted_of(options(rule=rule))
    assert (found.failovers, found.links, found.seed, found.live) == (failovers, (), 1, True)
    found = command.wanted_of(options(rule=rule, graph="line", budget="deaths=2", liveness=False,
                                      states=5, walks=6, seed=7))  # fmt: skip
    assert (found.failovers, found.links, found.seed, found.live) == (failovers, LINE, 7, False)
    assert (found.budget, found.states, found.walks) == ("deaths=2", 5, 6)


@pytest.mark.parametrize("keys", [{"rule": "paper"}, {"budget": "dead=1"}, {"graph": "0-1"}])
def test_what_cannot_be_asked_is_refused_at_once(keys):
    with pytest.raises(VerifyError):
        command.wanted_of(options(**keys))


@pytest.mark.parametrize(("ended", "told", "unit", "rest"), [
    ("complete", None, "states", ["all states"]), ("walked", None, "walks ", None),
    ("broken", SimpleNamespace(sentences=["It goes."], lines=lambda: ["1. It goes."]), "states",
     ["BROKEN after 1 event", "1. It goes."]),
])  # fmt: skip
def test_an_exploration_is_told_in_a_line_and_goes_on_record(ended, told, unit, rest, monkeypatch):
    tally = Tally(states=1234, generated=5678, depth=9, wall_s=2.34, ended=ended)
    model = SimpleNamespace(beats=0, links=LINE, failover="search")
    found = SimpleNamespace(fair=0, longest=7, model=model, tally=tally, wide=[],
                            broken=told is not None)  # fmt: skip
    seen = []

    def run(model, wanted, progress):
        seen.append(progress(tally))
        return found

    monkeypatch.setattr(command, "run", run)
    monkeypatch.setattr(command, "story_of", lambda one: told)
    monkeypatch.setattr(command, "_record", lambda *_: {"it": 1})
    said = []
    made = command._explore("a message", model, None, lambda *told: said.append(told) or True)
    head, *lines = made.lines
    assert head.startswith(
        f"{'0-1 1-2':24} search    a message        1,234 {unit}      5,678 succ"
    )
    assert "successors     2.3 s" in head
    if rest is not None:
        assert head.endswith(rest[0])
        assert [line.strip() for line in lines] == rest[1:]
    assert (made.record, made.story, made.stem) == ({"it": 1}, told, "mesh-counterexample")
    assert (made.is_broken, made.is_complete) == (told is not None, ended == "complete")
    assert (made.play is None) == (told is None)
    assert seen == [True]
    rate = f"{tally.per_s / 1e3:.0f} k/s"
    assert said == [(f"0-1 1-2, search, a message: 1,234 states, 9 events deep, {rate}", 0, 0)]


ONE_VALUE = "with one value for each node's draws out of more than 8"


@pytest.mark.parametrize(("which", "budget", "drawn", "said"), [
    ("a message", {"deaths": 0, "acks": 0}, [], "all states"),
    ("an alarm", {"deaths": 0, "acks": 0}, [12_501], f"first 500 states, .*as asked, {ONE_VALUE}"),
])  # fmt: skip
def test_an_exploration_says_that_it_tried_one_value_of_wide_draws_if_there_were_any(
    which, budget, drawn, said
):
    """Those of the first round, behind which it begins, are none of its own."""
    text = ",".join(f"{name}={count}" for name, count in budget.items())
    wanted = command.wanted_of(options(graph="0-1 1-2", budget=text, states=0 if not drawn else 500,
                                       rule="search", liveness=False))  # fmt: skip
    model = dict(command.models(wanted))[which]
    case = command._explore(which, model, wanted, lambda *_: False)
    assert case.record["one_value"] == drawn
    assert re.search(f" s  {said}$", case.lines[0])
    assert case.but == (ONE_VALUE if drawn else "")


def test_columns_stand_below_each_other_whatever_the_names():
    asked = options(graph="line", walks=1)
    heads = [case(lambda *_: False).lines[0] for case in command.explorations(None, asked)]
    assert {"gateways that are asked", "a message"} <= {
        re.search(r"(?:search|graph) +(.*?) {2,}", head)[1] for head in heads
    }
    assert len({head.index(" successors") for head in heads}) == 1
