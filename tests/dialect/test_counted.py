"""How many actions a call can put: counted by the ways through its source."""

import ast

import pytest

from innervate.dialect.counted import Unknown, actions

CASES = {
    "send(); report()": 2,
    "if a:\n  send()\nelse:\n  send(); report()": 2,
    "if a:\n  send(); report(); return\nsend()": 2,
    "if a:\n  return\nsend(); report(); deliver()": 3,
    "if a:\n  send(); return\nelse:\n  report(); return\nsend(); send(); send()": 1,
    "report()\nif a:\n  send()\n  if b:\n    send(); send(); return\nset_timer()": 4,
    "for i in range(4):\n  send()\nreport()": 5,
    "for i in range(4):\n  if a:\n    report(); report(); return\n  send()\nreport()": 5,
    "for i in range(1, 3):\n  send(); send(); return\nreport()": 2,
    "for i in range(0):\n  send(); return\nreport()": 1,
    "while a:\n  b = b - 1\nsend()": 1,
    "return send()": 1,
    "helper(); send()": 3,
    "if helper():\n  send()": 3,
}
HELPER = "def helper():\n  if a:\n    return 0\n  send(); report()\n"


def count(body):
    text = HELPER + "def on_timer():\n" + "".join(f"  {line}\n" for line in body.split("\n"))
    functions = {one.name: one for one in ast.parse(text).body}
    return actions("on_timer", functions, {})


@pytest.mark.parametrize("body", CASES)
def test_the_longest_way_counts(body):
    assert count(body) == CASES[body]


def test_rounds_that_are_not_seen():
    for body in ("while a:\n  send()", "for i in range(a):\n  if b:\n    return send()"):
        with pytest.raises(Unknown):
            count(body)


@pytest.mark.parametrize(("rounds", "most"), [("N", 3), ("1, N", 2), ("N, 8, 2", 3), ("M", None)])
def test_rounds_may_be_named(rounds, most):
    body = ast.parse(f"def on_timer():\n  for i in range({rounds}):\n    send()").body
    functions = {one.name: one for one in body}
    if most is None:
        with pytest.raises(Unknown) as caught:
            actions("on_timer", functions, {"N": 3, "OTHER": 9})
        assert caught.value.line == 2
    else:
        assert actions("on_timer", functions, {"N": 3, "OTHER": 9}) == most
