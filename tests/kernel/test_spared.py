"""What is left out of compiling changes nothing that is compiled, and is back afterwards."""

import re

import numba
import numpy as np
import pytest

from innervate.kernel import spared


def stepped(rows, counts):
    for place in range(len(rows)):
        row = rows[place]
        if row.heard > 3 and counts[0] < row.heard:
            row.sent = row.heard - counts[1]
        else:
            row.sent += 1
    return rows[0].sent


def code():
    """The text of a function's instructions, without the number of its turn to be compiled."""
    fields = [("heard", np.int32), ("sent", np.int64), ("padding", np.uint8, (3,))]
    rows = np.zeros(4, np.dtype(fields)).view(np.recarray)
    made = numba.njit(stepped)
    assert made(rows, (1, 2)) == 1
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
