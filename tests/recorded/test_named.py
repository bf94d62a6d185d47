"""Numbers that have a name are as they were kept: constants of modules, and defaults.

A change that is meant to alter one keeps it anew: python -m tests.recorded.kept --only named
"""

import pytest

from tests.recorded import kept, named


@pytest.mark.parametrize("folder", kept.measures("named"))
def test_numbers_of_modules_are_as_kept(folder):
    assert kept.compared("named", folder) == []


def test_numbers_are_those_of_constants_and_of_what_may_be_left_out():
    found = kept.measures("named")["innervate/analysis"]()
    assert found["intervals.EXACT_UP_TO"] == 200
    assert found["intervals.mean_interval(level)"] == 0.95
    assert named.unsaid({"a": ["b", "c d"], "e f": 1}) == {"a": ["b", "..."]}
    assert [named.has_number(one) for one in ("1", ("a", {"b": (2,)}), {"c"}, {3: "d"})] == [
        False, True, False, True,
    ]  # fmt: skip


def test_what_is_new_or_gone_is_no_difference(monkeypatch):
    monkeypatch.setattr(kept, "kept", lambda subject: {"a": {"x": 1, "gone": 2, "z": 3}})
    monkeypatch.setattr(kept, "measures", lambda subject: {"a": lambda: {"x": 1, "new": 2, "z": 4}})
    assert kept.compared("named", "a") == ["a.z: was 3, is 4"]
