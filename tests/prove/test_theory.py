"""How a theory comes out: what counts as expected, what is told, where it ends."""

from types import SimpleNamespace as Of

import pytest

from innervate.prove import faults
from innervate.prove.check import Checked, Refuted, unreached
from innervate.prove.errors import ProveError
from innervate.prove.mutants import Mutant
from innervate.prove.records import Record
from innervate.prove.steps import Goal
from innervate.prove.theory import Outcome, Source, Theory, is_touched, prove
from tests.prove.test_goals import KNOWN, SOURCE, played


@pytest.fixture(autouse=True)
def file_of_functions(tmp_path, monkeypatch):
    (tmp_path / "m.py").write_text(SOURCE)
    monkeypatch.chdir(tmp_path)


WAY = ("never", 3, True)
BAD = [Refuted("G", {"n": 1}, ["told"])]


def theory(*steps, **more):
    return Theory("name", "claim", ("assumed",), steps, **more)


def outcome(*checked, missing=(), ended="complete", **more):
    return Outcome(theory(**more), list(checked), list(missing), [], ended)


def checked(name="step", goals=("F", "G"), refuted=()):
    return Checked(name, list(goals), list(refuted), wall_s=1.23456)


@pytest.mark.parametrize(
    ("made", "holds", "expected"),
    [
        (outcome(checked()), True, True), (outcome(checked(refuted=BAD)), False, False),
        (outcome(checked(), missing=[WAY]), False, False),
        (outcome(checked(), ended="stopped"), False, False),
        (outcome(checked(refuted=BAD), refuted_by="step"), False, True),
        (outcome(checked(refuted=BAD), refuted_by="other"), False, False),
        (outcome(checked("other"), checked(refuted=BAD), refuted_by="other"), False, False),
        (outcome(checked(), refuted_by="step"), True, False),
    ],
)  # fmt: skip
def test_what_is_as_expected(made, holds, expected):
    assert (made.is_as_expected, made.as_dict()["expected"]) == (expected, expected)
    assert made.as_dict()["holds"] == holds


def test_what_programs_are_told():
    made = outcome(checked(refuted=BAD), checked("other"), missing=[WAY]).as_dict()
    assert (made["theory"], made["claim"], made["assumed"]) == ("name", "claim", ["assumed"])
    assert (made["lemmas"], made["unreached"], made["ended"]) == (4, [list(WAY)], "complete")
    step = made["steps"][0]
    assert (step["name"], step["wall_s"], step["branches"]) == ("step", 1.235, 0)
    assert step["lemmas"] == [{"name": "F", "answer": "unsat"}, {"name": "G", "answer": "sat"}]
    assert step["refuted"] == [{"lemma": "G", "story": ["told"], "values": {"n": 1}}]


def test_ways_that_no_step_takes_are_those_that_some_come_to():
    one, other = checked(), checked()
    one.missed, one.reached = {("b", 1, True), ("a", 1, True)}, {("c", 1, True)}
    other.missed, other.reached = {("c", 1, True), ("d", 1, False)}, {("b", 1, True)}
    assert list(unreached([one, other])) == [("a", 1, True), ("d", 1, False)]
    assert list(unreached([other, one])) == [("a", 1, True), ("d", 1, False)]


def step(name="in_an_if", holds=True, made=None):
    """A step that is counted when it is made."""

    def make():
        if made is not None:
            made.append(name)
        found = played(name, (0, 9), m=(0, 4))
        found.goals = [Goal("it holds", found.terms.truth_of(holds))]
        return found

    return make


def test_a_theory_is_told_how_far_it_is_and_may_be_stopped():
    told = []
    claim = theory(step(), step(), is_example=True)
    assert prove(claim, lambda *one: told.append(one)).ended == "complete"
    assert told == [("name: in_an_if", 0, 2), ("name: in_an_if", 1, 2)]
    stopped = prove(claim, lambda what, number, of: number == 1)
    assert (stopped.ended, len(stopped.checked), stopped.is_as_expected) == ("stopped", 1, False)
    early = prove(theory(never, step()), lambda what, number, of: number == 1)
    assert (early.unreached, early.named) == ([], [])  # what comes later may take it


def test_the_first_that_is_refuted_ends_it_where_one_is_enough():
    made = []
    claim = theory(step(made=made), step(holds=False, made=made), step(made=made), is_example=True)
    first = prove(claim, first_only=True)
    assert (len(made), first.ended, first.is_refuted) == (2, "stopped", True)
    whole = prove(claim)
    assert (len(whole.checked), whole.ended, whole.unreached) == (3, "complete", [])


def never():
    """A step in which `n < m` never holds."""
    found = played("in_an_if", (5, 9), m=(0, 5))
    found.facts.append(found.terms.less(found.terms.unknown("m", 0, 5), found.terms.number(5)))
    found.goals = [Goal("it holds", found.terms.true)]
    return found


@pytest.mark.parametrize(
    ("function", "part", "taken", "named"),
    [("in_an_if", "if n < m", True, 1), ("in_an_if", "n > m", True, 0),
     ("in_an_if", "if n < m", False, 0), ("another", "if n < m", True, 0)],
)  # fmt: skip
def test_branches_that_nothing_takes_are_named_by_function_line_and_way(
    function, part, taken, named
):
    found = prove(theory(never, unreachable={(function, part, taken): "why"}))
    assert (len(found.named), len(found.unreached)) == (named, 1 - named)
    example = prove(theory(never, is_example=True))
    assert (example.named, example.unreached) == ([], [])
    assert example.checked[0].reached == set()  # nobody asks


def test_a_step_is_touched_by_a_mistake_whose_function_was_asked_for_since():
    made = Of(machine=Of(functions=Source({"f": 1, "g": 2}, frozenset({"g"}))))
    known = made.machine.functions
    assert known["f"] == 1
    assert not is_touched(made)
    assert known["g"] == 2
    assert is_touched(made)
    assert not is_touched(made)  # not since
    assert is_touched(Of(machine=Of(functions=Source({}, frozenset()))))
    assert is_touched(Of(machine=Of(functions=KNOWN)))


def network(*theories, explorers=False):
    mutants = (Mutant("own", "a", "b"),)
    others = (Mutant("its", "c", "d"),)
    return Of(prove=Of(MUTANTS=mutants, EXPLORERS=explorers, theories=lambda *_: theories),
              verify=Of(MUTANTS=others))  # fmt: skip


def test_mistakes_are_hunted_in_what_is_claimed_to_hold():
    false = theory(step(holds=False), refuted_by="in_an_if")
    holds, broken = theory(step()), theory(step("in_a_call", holds=False))
    fault = Mutant("x", "a", "b")
    assert faults.hunt(network(false, holds, broken), fault) == ("in_a_call", "it holds")
    assert faults.hunt(network(false, holds), fault) == ("", "")


def test_the_explorers_mistakes_are_tried_where_a_proof_is_about_them():
    assert [one.name for one in faults.faults_of(network())] == ["own"]
    found = faults.faults_of(network(explorers=True))
    assert found == [Mutant("own", "a", "b"), Mutant("its", "c", "d")]


@pytest.mark.parametrize(("length", "count"), [(0, 1), (3, 3), ("ports", 5)])
def test_an_array_may_be_as_long_as_a_node_has_ports(length, count):
    record = Record("pc", (("x", length, 0, 9, "", ""),), ports=5)
    inner = Record("own", (("y", 0, 0, 1, "", ""),))
    record.parts["own"] = (inner, inner)
    places = list(record.places())
    assert [low for (_, name, _), low, _ in places if name == "x"] == [0] * count
    assert sum(key[1] == "y" for key, _, _ in places) == 2


def test_nothing_can_be_proved_where_no_state_is_as_assumed():
    def impossible():
        found = step()()
        found.facts.append(found.terms.false)
        return found

    with pytest.raises(ProveError, match="no state is as assumed"):
        prove(theory(impossible))
