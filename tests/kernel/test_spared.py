"""What is left out of compiling changes nothing that is compiled, and is back afterwards."""

import re
import runpy
import sys

import numba
import numpy as np
import pytest

from innervate.kernel import linking, spared


def stepped(rows, counts):
    for place in range(len(rows)):
        row = rows[place]
        if row.heard > 3 and counts[0] < row.heard:
            row.sent = row.heard - counts[1]
        else:
            row.sent += 1
    return rows[0].sent


def rows_of_four():
    fields = [("heard", np.int32), ("sent", np.int64), ("padding", np.uint8, (3,))]
    return np.zeros(4, np.dtype(fields)).view(np.recarray)


def code():
    """The text of a function's instructions, without the number of its turn to be compiled."""
    made = numba.njit(stepped)
    assert made(rows_of_four(), (1, 2)) == 1
    (text,) = made.inspect_llvm().values()
    return re.sub(r"B\d+v\d+", "", text)


def test_the_code_is_the_same():
    whole = code()
    with spared.spared():
        assert code() == whole


@pytest.mark.parametrize("place", range(len(spared._instead())))
def test_numba_has_what_is_left_out_and_gets_it_back(place):
    """Where a new Numba has it elsewhere, loops take a quarter longer, and nobody would know."""
    owner, name, instead = spared._instead()[place]
    before = getattr(owner, name)
    with spared.spared():
        assert getattr(owner, name) is not before
    assert getattr(owner, name) == before
    assert instead != before


def test_a_newer_numba_is_left_as_it_is(monkeypatch):
    """Its insides may be others: what takes their place is not even loaded."""
    monkeypatch.setattr(numba, "version_info", numba.version_info._replace(short=(0, 69)))
    monkeypatch.setitem(sys.modules, "innervate.kernel.spared", None)
    as_one = runpy.run_path(linking.__file__)["as_one"]
    with as_one("stepped"):
        assert numba.njit(stepped)(rows_of_four(), (1, 2)) == 1
