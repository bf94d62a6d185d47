"""Tests of ALOHA."""

from pathlib import Path

import innervate

SCENARIO = Path(__file__).parent / "aloha.toml"


def messages(**changes):
    """Messages of a plain run: how many nodes were given, and handed up."""
    run = innervate.run(SCENARIO, plain=True, overrides={"duration_s": 1.2, **changes})
    return run.summary["messages"]["delivered"], run.summary["messages"]["sent"]


def test_messages_are_acknowledged_though_frames_are_lost():
    delivered, sent = messages()
    assert 0.75 * sent < delivered < sent  # of eight nodes one speaks to itself


def test_without_tries_in_different_slots_hardly_any_comes():
    few, _sent = messages(**{"protocol.window_slots": 1})
    most, _sent = messages(**{"protocol.window_slots": 16})
    assert few < most / 3


def test_nothing_breaks_in_whatever_order_things_happen():
    for case in innervate.explore(SCENARIO.parent, states=1_000):
        assert not case.is_broken, case.lines
