"""A tap changes nothing, and compiled and plain runs hand it the same frames."""

from importlib import import_module

import pytest

from innervate import scenario
from innervate.network import networks
from innervate.networks.radio import frames as radio
from innervate.networks.skin import frames as skin
from tests.export.test_captures import RADIO, SKIN

FIELDS = ("time", "start", "at", "sender", "out", "why")


class Tap:
    """Keeps rows and bytes of compiled and plain runs alike."""

    def __init__(self, wire, plain):
        self.wire, self.plain = wire, plain
        self.kept = []

    def __call__(self, rows, frames, now):
        for row, frame in zip(rows, frames, strict=True):
            self.kept.append((*(int(row[name]) for name in FIELDS), self.wire.encode(Frame(frame))))


class Frame:
    """A record of an array, with attributes."""

    def __init__(self, record):
        for name in record.dtype.names:
            setattr(self, name, record[name].tolist())


@pytest.mark.parametrize(
    ("keys", "wire"), [(SKIN | {"duration_s": 0.07}, skin), (RADIO, radio)], ids=["skin", "radio"]
)
def test_taps(keys, wire):
    plan = scenario.plan(scenario.from_dict(keys))
    home = networks()[plan.kind].package
    simulate = import_module(f"{home}.sim.simulate").simulate
    bare = simulate(plan)
    taps = [Tap(wire, plain) for plain in (False, True)]
    done = [simulate(plan, plain=tap.plain, tap=tap) for tap in taps]
    assert {one.fingerprint for one in done} == {bare.fingerprint}
    assert taps[0].kept == taps[1].kept
    assert len(taps[0].kept) > 50
    assert {row[4] for row in taps[0].kept} == {0, 1}
    assert len({row[5] for row in taps[0].kept}) > 1
