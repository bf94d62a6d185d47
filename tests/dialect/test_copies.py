"""Copies of protocols in which a text is replaced: the copy alone has it, and all that it calls."""

import sys

import pytest

from innervate.dialect import arith
from innervate.dialect.copies import changed_copy, sources
from innervate.networks.skin.protocol import route

ARITH, ROUTE = "innervate.dialect.arith", "innervate.networks.skin.protocol.route"
INVARIANTS = "innervate.networks.skin.invariants"
OLD, NEW = "return ahead != 0 and ahead < HALF16", "return ahead == 7"


def test_sources_are_the_dialects_and_all_protocols():
    found = sources()
    for path in ("dialect/arith.py", "networks/skin/protocol/route.py"):
        assert "later" in found[path]
    assert not any(path.startswith(("sim/", "networks/skin/sim")) for path in found)


def test_a_copy_has_the_change_and_so_has_what_calls_it():
    copied, above = changed_copy([(OLD, NEW)], ARITH, ROUTE)
    assert [copied.later(7, 0), copied.later(1, 0), arith.later(1, 0)] == [True, False, True]
    assert above.later is copied.later
    assert route.later is arith.later
    assert not [name for name in sys.modules if name.startswith("innervate_copy_")]
    (other,) = changed_copy([], ARITH)
    assert other.later(1, 0)
    assert other.__name__ != copied.__name__


@pytest.mark.parametrize(("old", "count"), [("no such text", 0), ("return", None)])
def test_a_text_to_replace_stands_once(old, count):
    with pytest.raises(ValueError, match="times in the protocols' sources") as caught:
        changed_copy([(old, "x")], ARITH)
    said = int(str(caught.value).split(" stands ")[1].split()[0])
    assert said == count if count is not None else said > 1


def test_what_stands_beside_uses_the_copy():
    (one,) = changed_copy([(OLD, NEW)], INVARIANTS, beside=[INVARIANTS])
    assert [one.later(7, 0), one.later(1, 0)] == [True, False]
