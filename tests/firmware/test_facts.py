"""What is known of numbers: no more than is so, and no less than C needs to compute as Python."""

import ast
import itertools
from types import SimpleNamespace as Of

import pytest

from innervate.firmware.facts import ALL, NATURAL, NONE, Fact, Facts
from innervate.firmware.program import Type

VALUES = {NONE: range(-3, 4), NATURAL: range(4), ALL: (0, 1)}
# What comes out is never negative, and is 0 or 1, where this is so of the operands.
KEPT = {
    "&": ("either", "either"), "|": ("both", "both"), "^": ("both", "both"), "+": ("both", ""),
    "-": ("", ""), "*": ("both", "both"), "//": ("both", ""), "%": ("right", ""),
    "<<": ("both", ""), ">>": ("left", "left"),
}  # fmt: skip


class Made:
    """A function with numbers `a` and `b`, which calls `inner`."""

    def __init__(self, calls):
        self.calls = calls
        self.types = {"a": Type("int"), "b": Type("int")}
        self.function = Of(constants={"FIVE": 5, "ONE": 1, "LESS": -1})


def known(text, a=NONE, b=NONE, returned=NONE):
    """What is known of an expression."""
    node = ast.parse(text, mode="eval").body
    inner = Made({})
    made = Made({one: inner for one in ast.walk(node)
                 if isinstance(one, ast.Call) and one.func.id == "inner"})  # fmt: skip
    facts = Facts(Of(handlers=[], functions=list, records={}))
    facts.variables = {(made, "a"): a, (made, "b"): b}
    facts.returned = {inner: returned}
    return facts.of(made, node)


def is_sound(found, values):
    """Nothing is said that is not so."""
    return (not found.natural or min(values) >= 0) and (not found.flag or set(values) <= {0, 1})


@pytest.mark.parametrize("op", KEPT)
def test_what_is_known_of_two_numbers_is_so_and_is_what_can_be_told_of_them(op):
    for a, b in itertools.product(VALUES, VALUES):
        found = known(f"a {op} b", a, b)
        kept = [{"both": x and y, "either": x or y, "left": x, "right": y, "": False}[word]
                for word, x, y in zip(KEPT[op], a, b, strict=True)]  # fmt: skip
        assert found == Fact(*kept), (a, b)
        pairs = [
            (x, y)
            for x, y in itertools.product(VALUES[a], VALUES[b])
            if (op not in ("//", "%") or y > 0) and (op not in ("<<", ">>") or y >= 0)
        ]
        assert is_sound(found, [eval(f"x {op} y", {"x": x, "y": y}) for x, y in pairs]), (a, b)


@pytest.mark.parametrize(("text", "a", "b", "fact"), [
    ("0", NONE, NONE, ALL), ("1", NONE, NONE, ALL), ("2", NONE, NONE, NATURAL),
    ("FIVE", NONE, NONE, NATURAL), ("ONE", NONE, NONE, ALL), ("LESS", NONE, NONE, NONE),
    ("a < b", NONE, NONE, ALL), ("not a", NONE, NONE, ALL), ("-a", ALL, ALL, NONE),
    ("~a", ALL, ALL, NONE), ("abs(a)", NONE, NONE, NATURAL),
    ("a and b", ALL, NATURAL, NATURAL), ("a or b", NONE, ALL, NONE), ("a or b", ALL, ALL, ALL),
    ("a if b else 1", ALL, NONE, ALL), ("1 if b else a", NATURAL, NONE, NATURAL),
    ("max(a, b)", NONE, NATURAL, NATURAL), ("max(a, b)", NATURAL, NONE, NATURAL),
    ("max(a, b)", NONE, NONE, NONE), ("max(a, b)", ALL, ALL, ALL),
    ("max(a, b)", NATURAL, ALL, NATURAL), ("min(a, b)", NONE, NATURAL, NONE),
    ("min(a, b)", ALL, NATURAL, NATURAL), ("min(a, b)", ALL, ALL, ALL),
])  # fmt: skip
def test_what_is_known_of_an_expression(text, a, b, fact):
    assert known(text, a, b) == fact


@pytest.mark.parametrize("fact", VALUES)
def test_of_a_call_is_known_what_the_function_returns(fact):
    assert known("inner(a, b)", returned=fact) == fact


@pytest.mark.parametrize(("text", "fact"), [
    ("range(b)", NATURAL), ("range(a)", NATURAL), ("range(a, b)", NONE), ("range(b, a)", NATURAL),
    ("range(2, a)", NATURAL), ("range(LESS, b)", NONE),
])  # fmt: skip
def test_what_counts_is_negative_only_where_it_begins_so(text, fact):
    made, facts = Made({}), Facts(Of(handlers=[], functions=list, records={}))
    facts._nodes = {made: ast.parse(f"for i in {text}: pass").body}
    facts.variables = {(made, "a"): NONE, (made, "b"): NATURAL}
    facts._look(made)
    assert facts.variables[made, "i"] == fact
