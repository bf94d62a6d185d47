"""Counts and names in sentences."""

import pytest

from innervate.kernel.words import some


@pytest.mark.parametrize(("count", "said"), [
    (1, "n0"), (2, "n0 and n1"), (3, "n0, n1 and n2"), (4, "n0, n1, n2 and 1 more"),
    (1_203, "n0, n1, n2 and 1,200 more"),
])  # fmt: skip
def test_of_many_names_the_first_are_said_and_the_others_counted(count, said):
    assert some([f"n{i}" for i in range(count)], 3) == said
