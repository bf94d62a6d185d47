"""What of users' messages was delivered: by the moment at which each was given."""

import pytest

import innervate
from innervate.sim.came import Came, note_came
from tests.own import alone, made

__all__ = ["alone"]


@pytest.mark.parametrize(("since", "counts"), [
    (0, [0, 0, 0]), (10, [1, 0, 0]), (19, [1, 0, 0]), (20, [0, 1, 0]), (29, [0, 1, 0]),
    (30, [0, 0, 1]), (99, [0, 0, 1]), (101, [0, 0, 0]),
])  # fmt: skip
def test_a_delivery_is_counted_where_what_it_brought_was_given(since, counts):
    came = Came([10, 20, 30], [0, 0, 0])
    note_came(came, 100, 100 - since)
    assert came.counts == counts


def test_over_cables_news_that_many_got_do_not_stand_for_those_that_nobody_got(alone):
    """The first come to both others; then node 2 is cut off, and has the second for itself."""
    given = [
        {"at_s": at_s, "node": node, "item": {"value": 7}} for at_s, node in ((0.1, 0), (0.3, 2))
    ]
    cut = [{"at_s": 0.2, "action": "cut", "link": "n1-n2"}]
    said = {"nodes": 3, "shape": "line", "input": given, "event": cut}
    run = innervate.run(made(alone / "gossip").scenario, plain=True, overrides=said)
    assert (run.result.counts.offered, run.result.counts.delivered) == (2, 2)
    assert run.summary["headline"]["text"].startswith("1 of 2 messages is not delivered, ")
