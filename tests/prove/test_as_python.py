"""What a protocol says means in its formula what it means in Python, and nobody proves else.

Each function is run both ways on all of its inputs; programs that are drawn, on some.
"""

import ast
from itertools import product
from types import SimpleNamespace as Of

import pytest

from innervate.dialect.plain import make
from innervate.prove.check import check
from innervate.prove.errors import ProveError
from innervate.prove.records import Partly
from innervate.prove.solve import Formulas
from innervate.prove.steps import Stage, own_goals
from tests.prove.parity import compiled
from tests.prove.programs import HELPERS, drawn

STATE = (("a", 0, -5, 20, "x", "one"), ("b", 0, 0, 3, "x", "one"), ("list", 4, -3, 9, "x", "four"))
SAID = {
    "or gives what is not 0": "return s.a or n",
    "and gives the last": "return n and s.a and m",
    "either of numbers and truths": "return n > 1 or s.a and m == 2",
    "a plus changes nothing": "return +n - +s.a",
    "a chain ends with what does not hold": "s.a = 7\n    return n < 2 < bump(s, n) <= m",
    "what a chain asks, it asks once": "return 0 <= bump(s, n) <= 2",
    "which place is asked once": "s.list[bump(s, n)] += 2",
    "what stood there is read first": "s.b += bump(s, n)",
    "steps of two": "for i in range(n, 6, 2):\n        s.a += i\n    return s.a",
    "steps downwards": "for i in range(m, -2, -1):\n        s.a = s.a * 2 + i\n    return s.a",
    "a range that ends before it begins": "for i in range(4, n, -3):\n        s.a += i",
    "nothing returned where nobody asks": "part(s, n)\n    return s.a",
}
KNOWN = [
    (a, b, *rest) for a, b, rest in product((-5, 0, 4), range(4), ((0, 1, 2, 3), (9, 0, 9, 5)))
]
GIVEN = list(product(range(-2, 5), range(4)))


def sources(body):
    text = f"{HELPERS}\ndef f(s, n, m):\n    {body}\n"
    nodes = {node.name: node for node in ast.parse(text).body}
    usual = {"module": "m", "path": "m.py", "constants": {}, "calls": {one: one for one in nodes}}
    return text, {name: Of(name=name, node=node, **usual) for name, node in nodes.items()}


def played(body):
    """A step of a function f(s, n, m) with such a body."""
    stage = Stage(sources(body)[1], (), 0)
    numbers = [stage.terms.unknown("n", -2, 4), stage.terms.unknown("m", 0, 3)]
    step = stage.play("f", "f", [stage.record("s", STATE), *numbers], [])
    step.goals = own_goals(step, (), 0, 0)
    return step


def formula(body):
    """What the function returns and leaves by its formula; None where a demand is broken."""
    step = played(body)
    t, result = step.terms, step.result
    if isinstance(result, Partly):
        result = t.pick(result.where, t.as_number(result.value), t.number(99))
    result = t.number(99) if result is None else t.as_number(result)
    sound = t.all(*(t.implies(one.guard, one.holds) for one in step.machine.demands))
    formulas = Formulas()
    left = [step.after[key] for key, *_ in step.records["s"].places()]
    made = [formulas.of(one) for one in (sound, result, *left)]
    run = compiled(made, {})

    def asked(state, given):
        values = dict(zip(("s.a", "s.b", *(f"s.list[{i}]" for i in range(4))), state, strict=True))
        is_sound, *found = run(values | dict(zip("nm", given, strict=True)), 0)
        signed = [one - (1 << form.size()) if one >> (form.size() - 1) else one
                  for one, form in zip(found, made[1:], strict=True)]  # fmt: skip
        return signed if is_sound else None

    return asked


def python(body):
    """The same as Python has it."""
    known = {}
    exec(sources(body)[0], known)

    def asked(state, given):
        node = make("S", STATE)()
        node.a, node.b, node.list = *state[:2], list(state[2:])
        result = known["f"](node, *given)
        return [99 if result is None else int(result), *map(int, (node.a, node.b, *node.list))]

    return asked


@pytest.mark.parametrize("body", SAID.values(), ids=SAID)
def test_it_means_what_it_means_in_python(body):
    proved, run = formula(body), python(body)
    for state, given in product(KNOWN, GIVEN):
        assert proved(state, given) in (run(state, given), None), (state, given)
    assert any(proved(*one) for one in product(KNOWN, GIVEN))


@pytest.mark.parametrize("seed", [*range(8), *range(9, 13)])  # of 8 a name is never set: refused
def test_a_program_that_is_drawn_does_in_its_formula_what_it_does_in_python(seed):
    """Python runs to its end wherever what is demanded holds: no index, no name is wrong."""
    body = drawn(seed)
    proved, run = formula(body), python(body)
    for state, given in product(KNOWN[::5], GIVEN[::2]):
        found = proved(state, given)
        assert found is None or found == run(state, given), (body, state, given)


@pytest.mark.parametrize(("body", "line"), [
    ("if n > 3:\n        x = 1\n    s.a = x", 24),
    ("for i in range(m):\n        s.a = 1\n    s.a = i", 24),
    ("while m > 0:\n        m -= 1\n        x = 2\n    return x", 25),
    ("if n > 3:\n        x = n\n    x += 1", 24),
    ("s.a = part(s, n)", 22),
    ("return part(s, n) + 1", 22),
    ("if part(s, n):\n        s.a = 1", 22),
    ("x = s.list if n > 2 else s.list\n    if n < 4:\n        y = s\n    return y.a", 25),
])  # fmt: skip
def test_what_may_have_no_value_where_it_is_used_is_refuted(body, line):
    (bad,) = check(played(body), reach=False).refuted
    assert bad.goal == f"what is used has a value: f (m.py:{line})"


@pytest.mark.parametrize("body", [
    "if n > 3:\n        x = 1\n    else:\n        x = 2\n    s.a = x",
    "if n > 3:\n        x = 1\n    if n == 4:\n        s.a = x",
    "for i in range(m + 1):\n        x = i\n    s.a = x + i",
    "if n > 3:\n        return 0\n    x = 1\n    return x",
    "if n > 2:\n        s.a = part(s, n)",
    "part(s, n)",
    "return part(s, n)",
])  # fmt: skip
def test_what_has_a_value_wherever_it_is_used_holds(body):
    assert check(played(body), reach=False).refuted == []


@pytest.mark.parametrize("body", ["return -x", "return abs(x)"])
def test_the_opposite_of_the_least_number_does_not_fit(body):
    least = "x = s.a * 536870912 + 536870912\n    "
    goals = [bad.goal for bad in check(played(least + body), reach=False).refuted]
    assert "every number fits 32 bits: f (m.py:23)" in goals
    assert check(played(f"x = s.list[0]\n    {body}"), reach=False).refuted == []


@pytest.mark.parametrize(("body", "why"), [
    ("for i in range(0, 4, n):\n        s.a = i", "by how much a loop goes on is not known"),
    ("for i in range(0, 4, 0):\n        s.a = i", "by how much a loop goes on is not known"),
    ("x = bare(s, n)", r"bare\(s, n\) has no value"),
    ("return s + 1", "s is no number"),
    ("s.a = s", "s.a is set to what is no number"),
    ("s.list += 1", "s.list is no field that is declared"),
    ("s.c = 1", "s.c is no field that is declared"),
])  # fmt: skip
def test_what_cannot_be_told_is_an_error_of_one_line(body, why):
    with pytest.raises(ProveError, match=rf"^f \(m.py:\d+\): {why}$"):
        played(body)
