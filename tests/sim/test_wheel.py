"""The event queue against a sorted list: by time, then in order of insertion."""

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate import scenario
from innervate.networks.skin.sim import build
from innervate.sim import wheel

SLOTS = 24
FAR = [0, 0, 1, 2, 63, 64, 1023, 1024, 1025, (1 << 20) - 1, 1 << 20, (1 << 20) + 1,
       (1 << 30) - 1, 1 << 30, 3 << 30, 500 << 30]  # fmt: skip


def empty_wheel():
    keys = {"kind": "skin", "patch": [{"columns": 3, "rows": 3}]}
    keys["interface"] = [{"row": 0, "column": 0}]
    return build.build(scenario.plan(scenario.from_dict(keys)), plain=True).wheel


class Model:
    """A wheel and what should be in it."""

    def __init__(self, fresh):
        self.wheel = fresh
        self.inserted = 0
        self.queued = {}  # slot: (time, order of insertion)

    @property
    def now(self):
        return self.wheel.clock[wheel.NOW]

    def insert(self, slot, delay):
        slot %= SLOTS
        if slot not in self.queued and self.now + delay < 1 << 40:
            self.inserted += 1
            self.queued[slot] = (self.now + delay, self.inserted)
            wheel.insert(self.wheel, slot, self.now + delay)

    def remove(self, number, _):
        if self.queued:
            slot = sorted(self.queued)[number % len(self.queued)]
            del self.queued[slot]
            wheel.remove(self.wheel, slot)
            assert self.wheel.events[slot].bucket == wheel.NIL

    def pop(self, _, ahead):
        until = self.now + 1 + ahead  # never before a list that is being taken
        slot = min(self.queued, key=self.queued.get, default=wheel.NIL)
        if slot != wheel.NIL and self.queued[slot][0] >= until:
            slot = wheel.NIL
        found = wheel.pop(self.wheel, until)
        assert found == slot, f"pop({until}) gave {found}, not {slot} of {self.queued}"
        if slot != wheel.NIL:
            assert self.now == self.queued.pop(slot)[0]
            assert self.wheel.events[slot].bucket == wheel.NIL
        else:
            assert self.now <= until

    def drain(self):
        while self.queued:
            self.pop(0, 1 << 40)
        assert wheel.pop(self.wheel, 1 << 40) == wheel.NIL


def play(model, history):
    for place, (action, number, time) in enumerate(history):
        try:
            getattr(model, action)(number, time)
        except AssertionError as error:
            error.args = (f"{error}\nafter {history[: place + 1]}",)
            raise
    model.drain()


DELAY = st.one_of(st.sampled_from(FAR), st.integers(0, 3), st.integers(0, 1 << 32))
STEP = st.tuples(st.sampled_from(["insert", "insert", "remove", "pop"]), st.integers(0, 99), DELAY)


@pytest.fixture(scope="module")
def fresh():
    """An empty wheel's tables: every history ends with an empty one, at time 0 again."""
    return empty_wheel()


def rewound(fresh):
    assert all(word == 0 for word in fresh.words)
    fresh.clock[wheel.NOW] = 0
    return Model(fresh)


@given(history=st.lists(STEP, max_size=60))
@settings(max_examples=200, deadline=None)
def test_events_come_out_by_time_then_by_order_of_insertion(fresh, history):
    play(rewound(fresh), history)


def random_history(seed, steps):
    draw = random.Random(seed)
    spread = draw.choice([1, 3, 2000, 1 << 21, 1 << 31])
    return [
        (
            draw.choice(["insert", "insert", "remove", "pop", "pop"]),
            draw.randrange(1000),
            draw.choice(FAR) if draw.random() < 0.1 else draw.randrange(spread),
        )
        for _ in range(steps)
    ]


def test_so_they_do_over_long_times():
    for seed in range(25):
        try:
            play(Model(empty_wheel()), random_history(seed, 800))
        except AssertionError as error:
            error.args = (f"seed {seed}: {error}"[:4000],)
            raise


def test_a_slot_can_leave_the_list_that_is_being_taken(fresh):
    for gone in range(1, 5):
        model = rewound(fresh)
        for slot in range(5):
            model.insert(slot, 7)
        model.pop(0, 100)
        model.remove(gone - 1, 0)  # the number counts the slots that are left
        model.insert(gone, 0)  # the same moment, but behind all the others
        model.insert(9, 0)
        model.drain()


def test_an_event_at_the_limit_waits(fresh):
    model = rewound(fresh)
    model.insert(3, 1 << 20)
    model.pop(0, (1 << 20) - 1)
    assert model.queued
    model.pop(0, 1 << 20)
    assert not model.queued
    model.drain()


def test_pool_slots_are_handed_out_once_each(fresh):
    draw = random.Random(5)
    held, most, before = [], 0, fresh.pool[wheel.FRESH]
    for _ in range(500):
        if held and draw.random() < 0.5:
            wheel.give(fresh, held.pop(draw.randrange(len(held))))
        else:
            slot = wheel.take(fresh)
            assert slot not in held
            held.append(slot)
        most = max(most, len(held))
    assert fresh.pool[wheel.FRESH] - before == most  # no more are in use than ever were at once
