"""Loops without end, as far as they are seen, and those that are stopped as they go round."""

import sys
from importlib import import_module

import pytest

from innervate.dialect import bounded
from innervate.dialect.checker import broken_rules


def told_of(body):
    text = f'"""Doc."""\n\n\ndef f(cell, n):\n    """Doc."""\n    {body}\n'
    return broken_rules(text, {"g"})


@pytest.mark.parametrize("body", [
    "while n > 0:\n        n -= 1", "while cell.n > 0:\n        cell.n -= 1",
    "while cell.path[n] > 0:\n        cell.path[0] = 0", "while cell.n > 0:\n        g(cell)",
    "while g(cell) > 0:\n        cell.n = 1",
    "while cell.n:\n        cell.m -= 1\n        if cell.m < 0:\n            break",
    "while n:\n        return 1", "while cell.n > 0:\n        cell = 0",
    "while n < 4:\n        if cell.path[n] > 2:\n            cell.m += 1\n        n += 1",
    "while 1:\n        if g(cell) == 3:\n            break",
    "while n:\n        for i in range(4):\n            if i == cell.m:\n                return",
    "while n > 0:\n        if n == 3:\n            n = 1\n            continue\n        n -= 1",
])  # fmt: skip
def test_a_loop_whose_condition_changes_may_end(body):
    assert told_of(body) == []


@pytest.mark.parametrize("body", [
    "while cell.n > 0:\n        cell.m -= 1", "while n > 0:\n        g(n)",
    "while n > 0:\n        m = n", "while g(cell) > 0:\n        n = 1",
    "while cell.path[0]:\n        n = cell.path[0]",
    "while cell.n:\n        m = 1\n        if cell.m:\n            break",
    "while 1:\n        n += 1\n        if cell.m:\n            return",
    "while 1:\n        n += 1\n        for i in range(4):\n            break",
])  # fmt: skip
def test_a_loop_whose_condition_stays_does_not_end(body):
    (one,) = told_of(body)
    assert one.line == 6
    assert one.what.startswith("a loop without bound: nothing that its condition looks at")


@pytest.mark.parametrize("body", [
    "while cell.n:\n        if cell.m:\n            break", "while n > 0:\n        pass",
    "while n > 0:\n        if cell.m:\n            continue\n        n -= 1",
    "while n > 0:\n        if cell.m:\n            n -= 1\n        elif cell.n:\n            n = 0",
    "while n > 0:\n        if max(n, 3) > 3:\n            n -= 1",
    "while 1:\n        if cell.m:\n            return",
])  # fmt: skip
def test_a_way_through_a_loop_on_which_nothing_changes_is_told(body):
    (one,) = told_of(body)
    assert one.line == 6
    assert one.what.startswith("a loop without bound: there is a way through it on which nothing")


@pytest.mark.parametrize("chain", [
    "n > 5|n <= 5", "n > cell.m|cell.m > n|n == cell.m", "n > 1|n == 1", "cell.m|not cell.m",
    "0 < n < 9|n >= 9", "cell.m > 0 and n > 3|cell.m <= 0|n < 4", "n % 2 == 0|n % 2 != 0",
    "n > -3|n == -3", "n == 1|n == 2|n == 3|n > 3",
])  # fmt: skip
def test_an_if_that_covers_all_cases_needs_no_else(chain):
    sides = "\n        elif ".join(f"{test}:\n            n -= 1" for test in chain.split("|"))
    assert told_of(f"while n > 0:\n        if {sides}") == []


@pytest.mark.parametrize("chain", [
    "n > 5|n < 5", "n > cell.m|cell.m > n", "n > 1", "n == 1|n == 2|n > 3", "0 < n < 9|n > 9",
    "cell.m > 0 and n > 3|cell.m < 0|n < 4", "n % 2 == 0|n % 2 == 1", "cell.m|cell.n",
    "n >= 2 * cell.m|n < cell.m * 2",
])  # fmt: skip
def test_of_one_that_leaves_a_case_out_it_is_said_which_if_needs_an_else(chain):
    sides = "\n        elif ".join(f"{test}:\n            n -= 1" for test in chain.split("|"))
    (one,) = told_of(f"while n > 0:\n        if {sides}")
    line = 7 + 2 * chain.count("|")
    assert one.what.endswith(
        f"nothing changes; give the if in line {line} an else that changes it, or breaks"
    )


def test_of_more_cases_than_can_be_looked_at_nothing_is_taken_for_granted():
    sides = "\n        elif ".join(f"cell.path[{i}] > 0:\n            n -= 1" for i in range(9))
    all_but = " and ".join(f"cell.path[{i}] <= 0" for i in range(9))
    (one,) = told_of(
        f"while n > 0:\n        if {sides}\n        elif {all_but}:\n            n = 1"
    )
    assert "give the if in line 25 an else" in one.what


def test_of_more_ways_than_are_told_apart_any_is_possible():
    sides = "\n        if cell.m:\n            pass" * 9
    (one,) = told_of(f"while n > 0:\n        if n <= 0:\n            pass{sides}")
    assert one.what.endswith("nothing changes; change something, or break")


SOURCE = '''"""Loops."""

LIMIT = 3


def down(n):
    """Ends below 0 only."""
    count = 0
    while n != 0:
        n -= 2
        count += 1
        while count > 5 and n > 100:
            count -= 1
    return count


def many(n):
    """As many rounds as it is told."""
    for i in range(LIMIT, n):
        if i == 7:
            break
    return n


def few():
    """Three rounds."""
    for i in range(LIMIT):
        pass
    return i
'''


@pytest.fixture
def loops(tmp_path, monkeypatch):
    (tmp_path / "its_loops.py").write_text(SOURCE)
    monkeypatch.syspath_prepend(str(tmp_path))
    module = import_module("its_loops")
    yield module
    del sys.modules["its_loops"]


def test_a_loop_is_stopped_at_its_line_and_others_do_as_before(loops):
    known = loops.few.__code__
    down = loops.down
    bounded.bound(loops)
    bounded.bound(loops)  # once is enough
    assert loops.down is down
    assert loops.few.__code__ is known
    assert loops.down(6) == 3
    assert loops.many(1_000_003) == 1_000_003
    with pytest.raises(bounded.EndlessLoop, match="1,000,000 rounds in down; see that") as caught:
        loops.down(7)
    assert caught.traceback[-1].lineno + 1 == 9
    with pytest.raises(bounded.EndlessLoop, match="in many") as caught:
        loops.many(1_000_004)
    assert caught.traceback[-1].lineno + 1 == 19
