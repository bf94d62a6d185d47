"""Live nodes answer and tell what was recorded, at the same moments.

A change that is meant to alter that records anew: python -m tests.recorded.nodes
"""

import pytest

from tests.recorded import nodes


@pytest.mark.parametrize("name", nodes.SCRIPTS)
def test_nodes_say_what_was_recorded(name):
    assert not nodes.changes(name)
