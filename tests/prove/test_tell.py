"""A refuted goal is told with the values that the step changes, and no others."""

import ast
from types import SimpleNamespace

import pytest

from innervate.prove.check import check
from innervate.prove.steps import Goal, Stage
from innervate.prove.tell import changes

FIELDS = (("a", 0, 5, 5, "x", "one"), ("kept", 0, 3, 3, "x", "never changed"),
          ("list", 14, 2, 2, "x", "many"))  # fmt: skip
SOURCE = """
def some(s, n):
    s.a = s.a + 2
    for i in range(n):
        s.list[i] = 7

def none(s, n):
    s.a = s.a + 0
"""


def told(name, count):
    nodes = {node.name: node for node in ast.parse(SOURCE).body}
    function = SimpleNamespace(name=name, node=nodes[name], module="m", path="m.py",
                               constants={}, calls={})  # fmt: skip
    stage = Stage({name: function}, FIELDS, 4)
    step = stage.play("a step", name, [stage.record("s", FIELDS), count], [])
    step.goals = [Goal("it holds", stage.terms.false)]
    (refuted,) = check(step, changes, reach=False).refuted
    return refuted.sentences


def values(numbers):
    return ", ".join(f"s.{name} {value}" for name, value in numbers)


@pytest.mark.parametrize("count", [0, 1, 11])
def test_what_changes_is_told_before_and_after(count):
    names = ["a", *(f"list[{i}]" for i in range(count))]
    assert told("some", count) == [
        f"Before: {values(zip(names, [5] + [2] * count, strict=True))}.",
        "Then: a step.",
        f"Afterwards: {values(zip(names, [7] + [7] * count, strict=True))}.",
        "This breaks: it holds.",
    ]


@pytest.mark.parametrize(("count", "more"), [(12, "1 more"), (14, "3 more")])
def test_of_many_changes_twelve_are_told(count, more):
    before, _, after, _ = told("some", count)
    assert before.count("s.") == after.count("s.") == 12
    assert before.endswith(f"s.list[10] 2, {more}.")
    assert after.endswith(f"s.list[10] 7, {more}.")


def test_that_nothing_changes_is_told():
    before, _, after, _ = told("none", 0)
    assert (before, after) == ("Before: nothing changes.", "Afterwards: nothing changes.")
