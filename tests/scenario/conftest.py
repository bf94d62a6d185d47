"""A small valid scenario to change."""

from __future__ import annotations

import pytest

SMALL = """\
kind = "skin"
duration_s = 4.0

[[patch]]
columns = 4
rows = 3

[[interface]]
row = 0
column = 1

[[interface]]
row = 2
column = 2

[protocol]
k = 3

[[event]]
at_s = 2.0
action = "cut"
interface = 1
"""


@pytest.fixture
def small() -> str:
    """The text of a scenario with 12 cells, 2 interface ports and a cut."""
    return SMALL
