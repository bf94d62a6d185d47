"""Records and plain twins of one declaration hold the same words in the same order."""

import numpy as np
import pytest

from innervate.dialect import plain
from innervate.kernel import records

FIELDS = (
    ("mode", 0, 2, 9, "", ""),
    ("dist", 3, 0, 31, "", ""),
    ("one", 1, -7, -4, "", ""),
    ("last", 0, 0, 1, "", ""),
)
FIRST = [2, 0, 0, 0, -4, 0]  # the value in range that is nearest 0


@pytest.mark.parametrize(("word", "size"), [(np.int32, 4), (np.int64, 8)])
def test_fields_lie_one_behind_the_other_in_as_much_room_as_asked_for(word, size):
    kind = records.dtype(FIELDS, word=word)
    offsets = [kind.fields[name][1] // size for name, *_ in FIELDS]
    assert (offsets, kind.itemsize) == ([0, 1, 4, 5], 6 * size)
    assert records.dtype(FIELDS, 64, word).itemsize == 64
    assert kind["dist"].shape == (3,)
    assert kind["mode"].shape == ()


def test_one_record_is_for_all_that_ask():
    """Each of its own had its hash taken anew before every run, by what knows loops by it."""
    assert records.dtype(FIELDS) is records.dtype(FIELDS)
    assert records.zeros(FIELDS, 3).dtype is records.zeros(FIELDS, 2).dtype
    assert records.dtype(FIELDS) != records.dtype(FIELDS, 64)


def test_records_begin_on_a_cache_line_with_values_in_range():
    kept = [records.zeros(FIELDS, count) for count in range(1, 40)]
    assert {one.ctypes.data % records.CACHE_LINE for one in kept} == {0}
    made = kept[2]
    assert made.view(np.int32).reshape(3, 6).tolist() == [FIRST] * 3


def test_every_word_has_its_bounds():
    low, high = records.bounds(FIELDS)
    assert low.tolist() == [2, 0, 0, 0, -7, 0]
    assert high.tolist() == [9, 31, 31, 31, -4, 1]


def field(length, low, high):
    return ("any", length, low, high, "", "")


@pytest.mark.parametrize(("fields", "spans"), [
    ((), []),
    (FIELDS, [(6, 1, 0)]),
    ((field(64, 0, 7),), [(64, 0, 7)]),
    ((field(63, 0, 7),), [(63, 1, 0)]),
    ((field(63, 0, 7), field(0, 0, 7)), [(64, 0, 7)]),
    ((field(0, 0, 1), field(2, 0, 2), field(64, -3, 7), field(64, -3, 8), field(0, 0, 1)),
     [(3, 1, 0), (67, -3, 7), (131, -3, 8), (132, 1, 0)]),
])  # fmt: skip
def test_long_rows_of_words_with_one_range_are_spans_of_their_own(fields, spans):
    assert records.spans(fields) == spans


def test_a_plain_twin_is_read_and_written_as_one_row_of_words():
    twin = plain.make("Twin", FIELDS)()
    words = records.Words(twin, FIELDS)
    assert [words[i] for i in range(6)] == FIRST
    for i in range(6):
        words[i] = 20 + i
    assert (twin.mode, list(twin.dist), list(twin.one), twin.last) == (20, [21, 22, 23], [24], 25)
    assert [words[i] for i in range(6)] == list(range(20, 26))


def test_a_record_without_fields_has_a_word_that_nobody_reads():
    """A network without parameters ran plain only."""
    made = records.zeros((), 3)
    assert (made.shape, made.dtype.itemsize) == ((3,), 4)
    assert [len(limits) for limits in records.bounds(())] == [0, 0]
    assert records.dtype((), word=np.int64).itemsize == 8
