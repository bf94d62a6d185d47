"""Counterexamples keep to values that are easy to read, as long as nothing else is asked of them.

Here nothing is: so every value is that which the wish names, or the nearest in its range.
"""

import ast
from types import SimpleNamespace

import pytest

from innervate.networks.skin.protocol.constants import INFINITY
from innervate.networks.skin.prove import theories
from innervate.networks.skin.prove.neighbours import number
from innervate.prove.check import check
from innervate.prove.steps import Goal, Stage

# (name, length, low, high, unit, meaning)
CELL = (("dist", 2, 1, 65535, "hops", ""), ("count", 0, 3, 9, "x", ""),
        ("debt", 0, -9, -2, "x", ""), ("left", 0, -5, 5, "x", ""),
        ("sq", 0, 0, 65535, "number", ""))  # fmt: skip
FRAME = (("dist", 0, 1, 300, "hops", ""), ("kind", 0, 0, 7, "kind", ""))


def kept():
    """A step that keeps all as it is, and is to be refuted."""
    node = ast.parse("def idle(cell):\n    cell.count = cell.count\n").body[0]
    function = SimpleNamespace(name="idle", node=node, module="m", path="m.py", constants={},
                               calls={})  # fmt: skip
    stage = Stage({"idle": function}, FRAME, 4)
    cell = stage.record("cell", CELL)
    stage.record("frame", FRAME)
    stage.store[cell, "sq", None] = number(stage.terms, "cell.sq")
    step = stage.play("idle", "idle", [cell], [])
    step.goals = [Goal("nothing holds", stage.terms.false)]
    return step


def refuted():
    """The values that break what cannot hold."""
    step = kept()
    (found,) = check(step, simple=theories.simple(step), reach=False).refuted
    return found.values


@pytest.mark.parametrize(("name", "value"), [
    ("cell.dist[0]", INFINITY), ("cell.dist[1]", INFINITY), ("cell.count", 3), ("cell.debt", -2),
    ("cell.left", 0), ("frame.dist", 1), ("frame.kind", 0), ("base", 1),
])  # fmt: skip
def test_a_value_that_does_not_matter_is_the_plainest_that_it_can_be(name, value):
    assert refuted()[name] == value


def test_numbers_that_wrap_are_less_than_eight_ahead_of_the_oldest():
    step = kept()
    (ahead,) = [value.args[1] for value in step.before.values() if value.op == "wrap"]
    assert any(wish is step.terms.less(ahead, step.terms.number(8))
               for wish in theories.simple(step))  # fmt: skip
    assert refuted()["cell.sq.ahead"] < 8
