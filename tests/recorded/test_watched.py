"""Pages are told what was recorded, message by message: of simulated and of running networks.

A change that is meant to alter what pages get records anew: python -m tests.recorded.watched
"""

import pytest

from tests.recorded import watched


@pytest.mark.parametrize("name", watched.NAMES)
def test_pages_are_told_what_was_recorded(name):
    assert not watched.changes(name)


def test_a_message_that_differs_is_named_by_its_command():
    kept = watched.by_step('"at first"\n{"a":1}\n{"do":"step"}\n{"t_s":1}\n')
    found = watched.by_step('"at first"\n{"a":1}\n{"do":"step"}\n{"t_s":2}\n')
    assert watched.differences("ring", kept, found) == ['ring.2 {"do": "step"} 1.t_s: was 1, is 2']
