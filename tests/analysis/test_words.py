"""Figures in words on both sides of where they change their form."""

import pytest

from innervate.analysis.words import figure_words, share_words


@pytest.mark.parametrize(("ratio", "said"), [
    (0, "0 %"), (9.9e-6, "less than 0.001 %"), (1e-5, "0.001 %"), (0.00653, "0.653 %"),
    (0.5, "50 %"), (0.99949, "99.9 %"), (0.9996, "99.96 %"), (15854 / 15855, "99.99 %"),
    (0.99996, "99.996 %"), (0.99999, "99.999 %"), (0.999991, "more than 99.999 %"), (1, "100 %"),
])  # fmt: skip
def test_a_part_is_never_said_to_be_the_whole(ratio, said):
    assert share_words(ratio) == said


@pytest.mark.parametrize(("value", "digits", "said"), [
    (0.01234, 3, "0.0123"), (12.34, 3, "12.3"), (1.0, 3, "1"), (100, 2, "100"), (99.4, 2, "99"),
    (304.8, 2, "305"), (999.4, 3, "999"), (1234.5, 3, "1,234"), (100_000, 4, "100,000"),
])  # fmt: skip
def test_no_number_has_an_exponent(value, digits, said):
    assert figure_words(value, digits) == said
