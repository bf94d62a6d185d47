"""Plans, declarations, bytes and files are as they were recorded, number by number.

A change that is meant to alter them records anew: python -m tests.recorded.kept
"""

import pytest

from innervate.network import networks
from tests.recorded import declared, kept
from tests.recorded.data import plain, shortened, tidy

EVERYTHING = [(subject, name) for subject in kept.SUBJECTS for name in kept.measures(subject)]


@pytest.mark.parametrize("subject", kept.SUBJECTS)
def test_everything_is_kept(subject):
    assert list(kept.kept(subject)) == list(kept.measures(subject))


@pytest.mark.parametrize(("subject", "name"), EVERYTHING, ids=lambda part: part)
def test_it_is_as_kept(subject, name):
    assert kept.compared(subject, name) == []


def test_networks_are_listed_by_rank():
    assert [name for name in networks() if name in declared.OURS] == list(declared.OURS)


def test_a_long_list_is_known_by_all_of_its_numbers():
    numbers = list(range(100))
    assert plain(numbers[:16]) == numbers[:16]
    other = plain([*numbers[:50], 0, *numbers[51:]])
    found = plain(numbers)
    assert found["count"] == other["count"] == 100
    assert found["some"] == other["some"] == [0, 1, "...", 99]
    assert found["digest"] != other["digest"]
    assert shortened([[1]] * 5) == [[1]] * 5
    assert shortened([[1]] * 6)["count"] == 6


def test_files_are_read_line_by_line():
    assert tidy({"a": [1, {"b": 2}], "c": {"d": None}}) == (
        '{\n "a": [1, {"b": 2}],\n "c": {\n  "d": null\n }\n}'
    )
