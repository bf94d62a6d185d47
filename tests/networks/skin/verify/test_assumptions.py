"""The rule itself is tried before a reduced search forgets what the rule refuses."""

from dataclasses import replace

import pytest

from innervate.networks.skin.protocol.constants import RULE_FEASIBLE
from innervate.networks.skin.prove.faults import MUTANTS
from innervate.networks.skin.prove.neighbours import ANY_RULE
from innervate.networks.skin.prove.theories import resting
from innervate.networks.skin.verify import assumptions, command, graphs, mutants
from innervate.networks.skin.verify.system import RULES, UPDATES, Budget, SkinModel
from innervate.prove.theory import prove
from innervate.verify.errors import VerifyError


def model(rule, updates):
    return SkinModel(graphs.parse("pair"), rule, updates, Budget(restart=0), lean=True)


# A process proves what is of a rule once, in a quarter of a minute; one rule's is enough here.
@pytest.mark.parametrize(
    "rule",
    [pytest.param(rule, marks=[] if rule == "feasible" else pytest.mark.slow) for rule in RULES],
)
def test_the_shipped_rule_keeps_them(rule):
    assert [assumptions.broken(model(rule, updates)) for updates in UPDATES] == ["", ""]


BACK = model("strict", "periodic").changed(budget=Budget(restart=1))
HIDING = {
    "farther is nearer": ("feasible", "periodic"),
    "the feasible distance is forgotten at once": ("feasible", "periodic"),
    "an equal number is newer": ("feasible", "triggered"),
    "an equal feasible distance is good enough": ("feasible", "triggered"),
    "any route of the same number is feasible": ("feasible", "periodic"),
    "hearing does not ask the rule": ("feasible", "triggered"),
    "strict takes an equal number": ("strict", "triggered"),
}


@pytest.mark.parametrize("name", HIDING)
def test_mistakes_that_could_hide_behind_it_are_found(name):
    mutant = next(one for one in mutants.MUTANTS if one.name == name)
    assert "is taken beside" in assumptions.broken(model(*HIDING[name]), mutants.copy_of(mutant))


# Five were planted by an independent check: a reduced search that trusts the rule ends with nothing
# broken. The others are in the paths that reductions cut, too.
@pytest.mark.parametrize("fault", MUTANTS, ids=lambda one: one.name)
def test_what_the_reductions_would_hide_is_refuted_first(fault):
    assert assumptions.refuted("feasible", (fault.old, fault.new)).startswith("refuted: "), fault


def test_there_are_the_five_and_at_least_ten_more():
    assert len({(fault.old, fault.new) for fault in MUTANTS}) >= 15


def test_under_other_rules_what_is_forgotten_decides_nothing_either():
    found = assumptions.grounds(BACK)
    assert "mirror images" in found["proved"]
    assert "the rule" not in found["proved"]
    assert "budgets" in found["argued"]
    assert "the rule" in assumptions.grounds(model("strict", "periodic"))["proved"]


@pytest.mark.slow
def test_nor_where_the_pc_restarts_under_strict():
    assert assumptions.broken(BACK) == ""


def test_a_reduced_search_does_not_start_without_them(monkeypatch):
    monkeypatch.setattr(assumptions, "broken", lambda _: "a route is taken")
    wanted = command.Wanted(live=False, states=50, plain=True)
    with pytest.raises(VerifyError, match="a route is taken; --no-reduce"):
        command.run(model("feasible", "periodic"), wanted, lambda *_: False)
    whole = model("feasible", "periodic").changed(lean=False)
    assert command.run(whole, wanted, lambda *_: False).tally.ended == "limit"


# Each lemma about what is forgotten, and a mistake that it refutes.
FORGETTING = {
    "what is only stored, news, loads": ("cell.heard[port] = 1\n", "cell.heard[port] = 1\n    "
                                         "cell.sq_own = sq\n"),
    "what the rule refuses": ("p != cell.parent and is_usable(cell, params, p) and is_allowed("
                             "cell, params, p):", "p != cell.parent and is_usable(cell, params, "
                             "p):"),
    "what broken ports said": ("cell.dist[p] < params.max_depth and cell.pf[p] < ONE and",
                               "cell.dist[p] < params.max_depth and"),
    "what is not read": ("params.updates == WAVE and cell.parent != NONE and later(",
                         "cell.parent != NONE and later("),
    "the PC": ("if frame.load > 0 and (own.sq_known == 0 or later(", "if (own.sq_known == 0 or "
               "later("),
    "ports are alike": ("elif cell.dist[p] == best:\n", "elif cell.dist[p] == best and p != 2:\n"),
    "beacons that repeat the last": ("    if parent != NONE and cell.dist[port] >= cell.dist"
                                     "[parent]:", "    if parent != NONE and cell.dist[port] > "
                                     "cell.dist[parent]:"),
}  # fmt: skip


# Steps of a lemma before those that a mistake breaks: they hold, which takes long to see.
BEFORE = {"ports are alike": 4, "beacons that repeat the last": 4}


@pytest.mark.parametrize("name", FORGETTING)
def test_a_mistake_in_what_is_forgotten_is_refuted_by_its_own_lemma(name):
    lemma = {"what broken ports said": "what dead ports said", "the PC": "what is not read"}
    of = FORGETTING[name]
    known = {one.name: one for rule in (ANY_RULE, RULE_FEASIBLE) for one in resting(rule, of)}
    whole = known[lemma.get(name, name)]
    own = replace(whole, steps=whole.steps[BEFORE.get(name, 0) :])
    assert prove(own, first_only=True).is_refuted


def test_what_is_refuted_is_told_and_what_holds_is_not_tried_again(tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    said = ["refuted: a lemma", "", "refuted: not asked for"]
    monkeypatch.setattr(assumptions, "_refuted", lambda rule, change: said.pop(0))
    tried = assumptions.refuted.__wrapped__
    assert [tried("feasible") for _ in range(3)] == ["refuted: a lemma", "", ""]
    assert len(said) == 1


def test_what_holds_is_tried_again_when_what_is_asked_was_edited(tmp_path, monkeypatch):
    """The file that says which lemmas are needed has a part in the note, too."""
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    ours = tmp_path / "networks" / "skin" / "verify" / "assumptions.py"
    ours.parent.mkdir(parents=True)
    for room in ("protocol", "prove"):
        (ours.parent.parent / room).mkdir()
    ours.write_text("asks for one lemma")
    monkeypatch.setattr(assumptions, "__file__", str(ours))
    said = ["", "refuted: another lemma"]
    monkeypatch.setattr(assumptions, "_refuted", lambda rule, change: said.pop(0))
    tried = assumptions.refuted.__wrapped__
    assert [tried("feasible"), tried("feasible")] == ["", ""]
    ours.write_text("asks for another")
    assert tried("feasible") == "refuted: another lemma"
