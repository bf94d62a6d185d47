"""What `check` says of scenarios of declared networks that cannot work, and that runs show it."""

import pytest

import innervate
from innervate import scenario

INPUT = {"at_s": 0.5, "every_s": 0.05, "node": 8, "item": {"dest": 0}}


def warned(kind, **keys):
    """What `check` warns of, in one text."""
    loaded = scenario.from_dict({"kind": kind, **keys})
    lines = scenario.summary(loaded).splitlines()
    return "\n".join(line for line in lines if line.startswith("  warning"))


SAID = (
    ("rpl", {"protocol": {"root": 9}}, "protocol.root = 9, but nodes are 0 to 8: nobody is it"),
    ("babel", {"protocol": {"pc": 4}}, "protocol.pc = 4, but nodes are 0 to 3: nobody is it"),
    ("rpl", {"input": [{"item": {"dest": 9}}]}, "input.0.item.dest = 9, but nodes are 0 to 8"),
    ("rpl", {"protocol": {"ack_us": 607}}, "is there after 608 us at the earliest, and "
     "protocol.ack_us is 607: every frame counts as lost"),
    ("rpl", {"protocol": {"dio_min": 11}}, "the root speaks after 1.024 s at the earliest, and "
     "duration_s is 1: nobody gets a way"),
    ("rpl", {"protocol": {"hops": 1}}, "protocol.hops is 1, and 5 of 9 nodes are farther from the "
     "root, up to 2 hops"),
    ("rpl", {"spacing_m": 40.0}, "the network falls into 9 parts: no way leads from the largest, "
     "of 1, to nodes 1, 2, 3, 4 and 4 more"),
    ("rpl", {"start_us": 1_000_001}, "switched on within 1 s, and duration_s is 1: not all ever"),
    ("flooding", {}, "nobody sends anything: there is no [[input]]; add one"),
    ("flooding", {"input": [INPUT], "protocol": {"hops": 0}}, "protocol.hops = 0 lets packets go 1 "
     "at most, and it is more over good links from 8 to 0 (2)"),
    ("babel", {"links": {"loss": 1.0}}, "nobody gets any frame: links.loss is 1"),
    ("babel", {"cables": ["a-b", "c-d"]}, "falls into 2 parts: no way leads from the largest, of "
     "2, to nodes 2, 3"),
)  # fmt: skip


@pytest.mark.parametrize(("kind", "keys", "words"), SAID)
def test_check_says_what_cannot_work(kind, keys, words):
    assert words in warned(kind, **keys)


@pytest.mark.parametrize(("kind", "keys"), [
    ("rpl", {"protocol": {"root": 8, "ack_us": 608, "dio_min": 10, "hops": 2}}),
    ("rpl", {"input": [{"item": {"dest": 8}}], "start_us": 1_000_000}),
    ("babel", {"protocol": {"pc": 3}, "links": {"loss": 0.99}}),
    ("flooding", {"input": [INPUT], "protocol": {"hops": 1}}),
    ("flooding", {"input": [{"item": {"dest": 255}}]}),
])  # fmt: skip
def test_check_says_nothing_of_what_works(kind, keys):
    assert not warned(kind, **keys)


@pytest.mark.parametrize(("kind", "keys"), [
    ("rpl", {"protocol": {"root": 9}}),
    ("rpl", {"protocol": {"dio_min": 11}}),
    ("flooding", {"protocol": {"hops": 0}, "layout": "line", "air": {"reach_m": 20.0}}),
    ("rpl", {"spacing_m": 60.0}),
])  # fmt: skip
def test_a_run_shows_what_check_says(kind, keys):
    made = scenario.from_dict({"kind": kind, "input": [INPUT], **keys})
    run = innervate.run(made, plain=True)
    assert run.summary["headline"]["level"] == "down"
