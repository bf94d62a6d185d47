"""What `check` foresees of a team: more packets than any protocol could deliver."""

import pytest

from innervate import scenario
from innervate.networks.radio.scenario.words import warnings

PACKET_S = 25 * 208e-6


def warned(**tables):
    return warnings(scenario.plan(scenario.from_dict({"kind": "radio", **tables})))


@pytest.mark.parametrize(("load", "said"), [(0.3, False), (1.0, False), (1.01, True), (3, True)])
def test_more_packets_than_the_channel_carries(load, said):
    found = warned(traffic={"kind": "poisson", "load": load})
    assert found == [f"Stations offer {load:g} times what the channel carries at most: packets "
                     "wait ever longer, or find a full queue."] * said  # fmt: skip


def test_a_run_that_ends_before_all_packets_can_have_been_sent():
    whole_s = 0.1 + 100 * PACKET_S
    assert warned(stations=100, duration_s=whole_s) == []
    assert warned(stations=100, duration_s=whole_s - 0.001) == [
        "The packets alone take 0.52 s, and the run ends 0.519 s after the start: "
        "not all can be delivered; raise duration_s."
    ]
    assert warned(stations=100, duration_s=whole_s - 0.001, traffic={"kind": "saturated"}) == []


def test_a_channel_on_which_nothing_can_be_read():
    assert warned(channel={"loss": 0.99}) == []
    assert warned(channel={"loss": 1}) == ["Nobody can read any frame: channel.loss is 1."]
