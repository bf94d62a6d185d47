"""The checker of the dialect: at which line a rule is broken, and what to write instead."""

import pytest

from innervate.dialect.checker import broken_rules

CHECKED = {
    "n = 1\n    return n / 2": (7, "Div is not in the dialect; divide whole numbers with //"),
    "if n:\n        return n\n    return [n]": (8, "List is not in the dialect; declare a field"),
    "n = n + (\n        2 ** 3)": (7, "Pow is not in the dialect; multiply"),
    "return cell.far(n)": (6, "calls cell.far; only functions of the protocol"),
    "n = later(n, 1)": (6, "calls later; only functions of the protocol, of the dialect, "),
    "return min(n, 1 << 30, 1073741824)": (6, "a number of 2^30 or more"),
    "while n:\n        cell.x = 1": (
        6,
        "a loop without bound: nothing that its condition looks at",
    ),
    "return cell.x[-2]": (6, "[-2]: an index is 0 or more; count from the beginning"),
    "if n:\n        return m\n    return n": (7, "m is given no value here, and is no constant"),
    "return f(cell, n - 1)": (4, "a loop without bound: f calls itself"),
}


@pytest.mark.parametrize("body", CHECKED)
def test_a_rule_is_told_with_its_line(body):
    (one,) = broken_rules(f'"""Doc."""\n\n\ndef f(cell, n):\n    """Doc."""\n    {body}\n')
    line, says = CHECKED[body]
    assert one.line == line
    assert one.what.startswith(says)
    assert str(one) == f"{line}: {one.what}"


def test_functions_that_call_each_other_in_a_ring_are_told_each():
    calls = {"a": "b", "b": "c", "c": "a", "d": "a"}
    text = '"""Doc."""\n'
    for name, called in calls.items():
        text += f'def {name}(n):\n    """Doc."""\n    return {called}(n)\n'
    assert [one.line for one in broken_rules(text)] == [2, 5, 8]


@pytest.mark.parametrize(("line", "home", "fits"), [
    ("import innervate.networks.skin.protocol.cell", "", True),
    ("from innervate.networks.skin import run", "", False),
    ("from gossip.parts import near", "gossip", True),
    ("from gossips import near", "gossip", False),
    ("from . import parts", "gossip", True), ("import innervate.sim", "", False),
    ("from innervate.dialect import arith", "", True),
])  # fmt: skip
def test_what_a_protocol_may_import(line, home, fits):
    found = broken_rules(f'"""Doc."""\n{line}\n', home=home)
    assert [one.line for one in found] == ([] if fits else [2])


def test_calls_that_debug_are_for_plain_runs_unless_they_are_ones_own():
    text = '"""Doc."""\ndef f(n):\n    """Doc."""\n    print(n / 2)\n    breakpoint()\n'
    found = broken_rules(text)
    assert [(one.line, one.in_plain) for one in found] == [(4, True), (5, True)]
    own = text.replace("/ 2", "+ 2") + 'def print(n):\n    """Doc."""\n    return n\n'
    assert [one.line for one in broken_rules(own)] == [5]
