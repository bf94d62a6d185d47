"""What watches a team's packets: delivered to nobody, to some only, or again."""

from types import SimpleNamespace

import pytest

from innervate.dialect.arith import HALF16, MASK16
from innervate.networks.radio.sim import build
from innervate.networks.radio.verify.fuzz import trouble
from innervate.running import fuzz
from innervate.sim.channel import traffic
from innervate.sim.driver import InvariantBroken
from tests.networks.radio.runs import radio_plan

COUNTS = ("silent", "partial", "again", "completed")


@pytest.fixture
def world():
    """Four stations that all hear each other; station 0 has made a packet."""
    made = build.build(radio_plan(4), True)
    for radio in made.radios:
        radio.alive = 1
    assert traffic.make(made, 0, 1_000) == 0
    return made


def hears(world, node, handle=0, count=1):
    frame = SimpleNamespace(source=0, handle=handle, count=count)
    traffic.note_received(world, node, frame, 2_000)


def counted(world):
    return {name: getattr(world.run[0], name) for name in COUNTS if getattr(world.run[0], name)}


# Which stations received it, who is off, and what is counted when its sender has it proved.
PROVED = [
    ([], (), {"silent": 1, "completed": 1}),
    ([1], (), {"partial": 1, "completed": 1}),
    ([1, 2], (), {"partial": 1, "completed": 1}),
    ([1, 2, 3], (), {"completed": 1}),
    ([1, 2], (3,), {"completed": 1}),
    ([], (1, 2, 3), {"silent": 1, "completed": 1}),
    ([1, 2, 3, 3], (), {"again": 1, "completed": 1}),
    ([1, 1], (), {"again": 1, "partial": 1, "completed": 1}),
    # Who has it and is off since makes up for nobody who lacks it.
    ([1, 2], (2,), {"partial": 1, "completed": 1}),
    ([1, 2, 3], (2,), {"completed": 1}),
]


@pytest.mark.parametrize(("who", "off", "expected"), PROVED)
def test_who_received_what_is_taken_for_delivered_is_counted(world, who, off, expected):
    for node in who:
        hears(world, node)
    for node in off:
        world.radios[node].alive = 0
    traffic.note_delivered(world, 0, 0, 3_000)
    assert counted(world) == expected
    row = world.packets[0]
    listeners = 3 - len(set(off) - set(who))
    assert (row.node, row.receivers, row.listeners) == (0, len(set(who)), listeners)


def test_who_is_off_and_hidden_is_missed_by_nobody():
    plan = radio_plan(4)
    plan.delays_us[0][3] = plan.delays_us[3][0] = -1
    made = build.build(plan, True)
    for node in range(3):
        made.radios[node].alive = 1
    assert traffic.make(made, 0, 1_000) == 0
    hears(made, 1)
    traffic.note_delivered(made, 0, 0, 3_000)
    assert counted(made) == {"partial": 1, "completed": 1}


@pytest.mark.parametrize(
    ("first", "then", "is_new"),
    [
        (5, 6, True), (5, 5, False), (5, 4, False), (MASK16, 0, True), (0, MASK16, False),
        (5, 5 + HALF16 - 1, True), (5, 5 + HALF16, False),
    ],
)  # fmt: skip
def test_a_packet_is_new_if_it_is_ahead_of_the_newest(world, first, then, is_new):
    hears(world, 1, first)
    hears(world, 1, then)
    assert world.run[0].again == (not is_new)


def test_every_count_of_packets_has_a_case():
    assert {name for *_, expected in PROVED for name in expected} == set(COUNTS)


@pytest.mark.parametrize(("lost", "said"), [(0, ""), (1, "1 packet lost silently")])
def test_packets_lost_silently_are_trouble(lost, said):
    assert trouble({"lost_silently": lost}) == said


def drawn_team(monkeypatch, run):
    monkeypatch.setattr(fuzz, "run", run)
    return fuzz.trouble({"kind": "radio", "stations": 2, "traffic": {"kind": "disaster"}})


def test_a_network_that_was_drawn_is_in_trouble_if_a_checker_or_its_summary_says_so(monkeypatch):
    def stops(_):
        raise InvariantBroken("invariant broken at 1.0 s")

    assert drawn_team(monkeypatch, stops) == "invariant broken at 1.0 s"
    for lost in (0, 2):
        done = SimpleNamespace(summary={"lost_silently": lost})
        assert bool(drawn_team(monkeypatch, lambda _, done=done: done)) == bool(lost)
