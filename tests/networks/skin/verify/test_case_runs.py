"""How a skin is explored: which searches follow which, and which of their stories is told."""

import signal
from types import SimpleNamespace as Of

import pytest

from innervate.kernel.stop import Stop
from innervate.networks.skin.verify import command, graphs
from innervate.networks.skin.verify.command import Wanted
from innervate.networks.skin.verify.system import ANY, Budget, SkinModel
from innervate.verify.cases import budget_of
from innervate.verify.errors import VerifyError

PAIR = graphs.parse("pair")


def found(ended="complete", path=(), broken=0, lean=True, left_out=0, depth=3, **keys):
    model = SkinModel(PAIR, lean=lean, **keys)
    return Of(model=model, tally=Of(ended=ended, depth=depth, left_out=left_out), path=path,
              broken=broken)  # fmt: skip


def fair(ended="complete", starts=2, of=2, left_out=0, name="first"):
    return Of(ended=ended, starts=starts, of=of, left_out=left_out, name=name)


@pytest.fixture
def played(monkeypatch):
    """Explorations and schedules by hand, one after the other; which models were explored."""
    made = Of(searches=[], schedules=[], models=[], retraced=None, broken="")

    def explore(model, **_):
        made.models.append(model)
        one = made.searches.pop(0)
        one.model = model if one.model is None else one.model
        return one

    monkeypatch.setattr(command.explore, "explore", explore)
    monkeypatch.setattr(command.explore, "wander", lambda model, walks, **_: explore(model))
    monkeypatch.setattr(command.fair, "check", lambda *_, **__: made.schedules.pop(0))
    monkeypatch.setattr(command.retrace, "retrace", lambda _: made.retraced)
    monkeypatch.setattr(command.story, "tell", lambda whole: f"story of {len(whole.path)}")
    monkeypatch.setattr(command.story, "in_short", lambda one: "in short")
    monkeypatch.setattr(command.assumptions, "broken", lambda model: made.broken)
    return made


def run(model=None, **wanted):
    return command.run(model or SkinModel(PAIR, lean=True), Wanted(**wanted), lambda *_: False)


@pytest.mark.parametrize(("ended", "is_played"), [
    ("complete", True), ("memory", True), ("limit", True), ("broken", False),
    ("interrupted", False),
])  # fmt: skip
def test_a_fair_schedule_goes_on_from_what_a_search_found(played, ended, is_played):
    played.searches, played.schedules = [found(ended)], [fair()]
    case = run()
    assert (case.fair is not None, case.story) == (is_played, None)
    assert len(played.models) == 1


@pytest.mark.parametrize(("model", "wanted"), [
    (SkinModel(PAIR, "paper"), {}), (SkinModel(PAIR), {"live": False}),
])  # fmt: skip
def test_nothing_is_promised_of_other_rules_and_nothing_played_that_is_not_asked(
    played, model, wanted
):
    played.searches = [found()]
    assert run(model, **wanted).fair is None


def test_who_interrupts_while_reductions_are_proved_does_not_wait_for_a_search(played, monkeypatch):
    monkeypatch.setattr(command.assumptions, "broken", lambda _: signal.raise_signal(signal.SIGINT))
    with Stop(), pytest.raises(KeyboardInterrupt):
        run()
    assert played.models == []


def test_walks_have_a_story_and_no_schedule(played):
    played.searches, played.retraced = [found(broken=1, path=(1, 2))], found(path=(1,) * 9)
    case = run(walks=5)
    assert (case.fair, case.story, len(played.models)) == (None, "story of 9", 1)


def test_what_reductions_rest_on_is_looked_at_first_where_there_are_any(played):
    played.broken, played.searches, played.schedules = "it is taken", [found()], [fair()]
    with pytest.raises(VerifyError, match=r"^it is taken; --no-reduce explores it without"):
        run()
    assert run(SkinModel(PAIR, lean=False)).story is None


@pytest.mark.parametrize(("retraced", "shorter", "told", "searches"), [
    (found(path=(1, 2)), None, "story of 2", 1), (found(path=(1,)), None, "story of 1", 1),
    (found(path=(1, 2, 3)), found(path=(1,), broken=1), "story of 1", 2),
    (found(path=(1, 2, 3)), found(path=(1,)), "story of 3", 2),
    (None, found(path=(1,), broken=1), "story of 1", 2), (None, found(path=(1,)), "in short", 2),
])  # fmt: skip
def test_the_shortest_story_of_whole_states_is_told(played, retraced, shorter, told, searches):
    played.retraced = retraced
    played.searches = [found("broken", path=(1, 2), broken=1), *([shorter] if shorter else [])]
    assert run().story == told
    assert len(played.models) == searches
    if searches == 2:
        assert played.models[1] == SkinModel(PAIR, lean=False, budget=played.models[1].budget)


def test_what_a_search_of_whole_states_found_is_told_as_it_is(played):
    played.searches = [found("broken", path=(1, 2), broken=1, lean=False)]
    assert run(SkinModel(PAIR, lean=False)).story == "story of 2"


def test_of_whole_states_there_are_no_more_ticks_than_it_took():
    budget = Budget(ticks=ANY, faults=2)
    whole = command._whole(found(depth=3, budget=budget))
    assert (whole.lean, whole.budget) == (False, Budget(ticks=4, faults=2))
    few = command._whole(found(depth=9, budget=Budget(ticks=2)))
    assert few.budget.ticks == 2


@pytest.mark.parametrize(("again", "whole", "name"), [
    (fair("broken", name="again"), {}, "again"), (fair(name="again"), {}, "again"),
    (fair("memory", name="again"), {}, "first"), (fair(starts=1, name="again"), {}, "first"),
    (fair(left_out=1, name="again"), {}, "first"), (fair(name="again"), {"left_out": 1}, "first"),
    (fair(left_out=1, name="again"), {"left_out": 1}, "first"),
    (fair(name="again"), {"ended": "memory"}, "first"),
    (fair(name="again"), {"budget": Budget(ticks=1)}, "first"),
    (fair("broken", starts=1, name="again"), {"ended": "memory"}, "again"),
])  # fmt: skip
def test_a_schedule_that_ends_badly_stands_unless_whole_states_say_all(played, again, whole, name):
    played.searches = [found(), found(lean=False, **whole)]
    played.schedules = [fair("broken"), again]
    assert run().fair.name == name
    assert len(played.models) == 2


def test_without_reductions_a_schedule_that_ends_badly_stands(played):
    played.searches, played.schedules = [found(lean=False)], [fair("broken")]
    assert run(SkinModel(PAIR, lean=False)).fair.name == "first"


def test_everything_that_is_asked_for_is_explored_in_order():
    one, other = PAIR, graphs.parse("pc-1")
    wanted = Wanted(("feasible", "paper"), ("periodic", "triggered"), (one, other),
                    prompt=True, budget=Budget(ticks=1))  # fmt: skip
    made = list(command.models(wanted))
    assert [(m.graph, m.rule, m.updates, m.keep) for m in made] == [
        (graph, rule, updates, rule == "feasible") for graph in (one, other)
        for rule in ("feasible", "paper") for updates in ("periodic", "triggered")]  # fmt: skip
    assert {(m.prompt, m.lean, m.budget) for m in made} == {(True, True, Budget(ticks=1))}
    (quiet,) = command.models(Wanted(updates=("periodic",), graphs=(one,), live=False))
    assert not quiet.keep


@pytest.mark.parametrize(("keys", "fits"), [({}, True), ({"prompt": True}, False),
                                            ({"lean": False}, False)])  # fmt: skip
def test_any_number_of_ticks_goes_with_reductions_alone(keys, fits):
    wanted = Wanted(graphs=(PAIR,), budget=Budget(ticks=ANY), **keys)
    if fits:
        assert len(list(command.models(wanted))) == 2
    else:
        with pytest.raises(VerifyError, match="ticks=any goes neither"):
            list(command.models(wanted))


def test_budgets_from_text_keep_what_is_left_out():
    usual = Budget()
    assert budget_of("", usual, command.TICKS) == usual
    assert budget_of("ticks=any,loss=3", usual, command.TICKS) == Budget(
        **{name: getattr(usual, name) for name in Budget.__dataclass_fields__}
        | {"ticks": ANY, "loss": 3})  # fmt: skip
