"""What may be given up to a limit: the last that is taken, and the first that is refused."""

import dataclasses

import pytest

from innervate.live import identity
from innervate.live.enrolment import Authority
from innervate.live.errors import LiveError
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.radio.slotted.drive import Setting
from innervate.networks.skin.verify import graphs
from innervate.scenario import ScenarioError, loads
from innervate.scenario.source import Source, check_plain
from innervate.sweeping import vary
from innervate.sweeping.derive import Formula
from innervate.sweeping.errors import SweepError
from innervate.sweeping.sweep import make_plan
from innervate.topology import free
from innervate.topology.errors import TopologyError
from innervate.verify.cases import budget_of
from innervate.web import messages, playback

REFUSALS = (ScenarioError, SweepError, TopologyError, LiveError, messages.Refused, ValueError)


@dataclasses.dataclass
class Budget:
    ticks: int = 0


def nested(depth):
    return {"a": nested(depth - 1)} if depth else 1


def slotted(**changes):
    Setting(**{"mac": "slotted-aloha", "stations": 2, "packet_slots": 5, "traffic": "saturated",
               **changes}).check()  # fmt: skip


def key_of(parts):
    """A key of so many parts is read, and then no key of a scenario; of more it is not read."""
    with pytest.raises(ScenarioError) as told:
        loads(f'kind = "skin"\n{".".join("a" * parts)} = 1\n')
    if "parts" in str(told.value):
        raise told.value


def revoked(count):
    data = identity.REVOKED.pack(1, count) + bytes(4 * count + identity.SIGNATURE_BYTES)
    with pytest.raises(ValueError, match="revoked nodes") as told:
        identity.read_revoked(bytes(32), data)
    if "has not signed" not in str(told.value):
        raise told.value


def chain(first, count):
    return " ".join(f"{'pc' if k == 0 else k}-{k + 1}" for k in range(first, count))


def mesh_of(nodes):
    return mesh_model.parse(" ".join(f"{k}-{k + 1}" for k in range(nodes - 1)))


BOTH_SIDES = {
    "interface ports": (lambda n: free.split_end(f"pc.{n}"), 1_048_575, 1_048_576),
    "values of a range": (lambda n: vary.values_of(f"1..{n}", "x"), 1_000_000, 1_000_001),
    "letters of a formula": (lambda n: Formula("1".ljust(n), "x"), 500, 501),
    "depth of tables": (lambda n: check_plain(Source(), nested(n)), 16, 17),
    "whole numbers": (lambda n: check_plain(Source(), n), 2**63 - 1, 2**63),
    "whole numbers below 0": (lambda n: check_plain(Source(), n), 1 - 2**63, -(2**63)),
    "parts of a key": (key_of, 101, 102),
    "repeats": (lambda n: make_plan("demo", repeat=n), 1_000_000, 1_000_001),
    "repeats at least": (lambda n: make_plan("demo", repeat=n), 1, 0),
    "a budget": (lambda n: budget_of(f"ticks={n}", Budget()), 20, 21),
    "cells explored": (lambda n: graphs.parse(chain(0, n)), 5, 6),
    "nodes of a mesh explored": (mesh_of, 6, 7),
    "nodes of a mesh explored, at least": (mesh_of, 3, 2),
    "slotted stations": (lambda n: slotted(stations=n), 10_000, 10_001),
    "slotted slots": (lambda n: slotted(packet_slots=n), 10_000, 10_001),
    "slotted slots at least": (lambda n: slotted(packet_slots=n), 1, 0),
    "slotted successes": (lambda n: slotted(packets=n), 50_000_000, 50_000_001),
    "slotted load": (lambda n: slotted(traffic="poisson", load=n), 50.0, 50.0001),
    "a backoff slot": (lambda n: slotted(backoff_slots=n), 10_000, 10_001),
    "a backoff slot at least": (lambda n: slotted(backoff_slots=n), 1, 0),
    "turnaround": (lambda n: slotted(turnaround_slots=n), 10_000, 10_000.1),
    "turnaround at least": (lambda n: slotted(turnaround_slots=n), 0, -0.1),
    "return": (lambda n: slotted(return_slots=n), 10_000, 10_000.1),
    "return at least": (lambda n: slotted(return_slots=n), 0, -0.1),
    "a probability": (lambda n: slotted(p=n), 1, 1.001),
    "a window at least": (lambda n: slotted(window=n), 0, -1),
    "certificates put out": (revoked, 64, 65),
    "speed": (playback.Playback, 1_000_000, 1_000_001),
    "speed at least": (playback.Playback, 0.001, 0.0009),
    "letters of a command": (lambda n: messages.parse('{"do":"pause"}'.ljust(n)), 4096, 4097),
}


@pytest.mark.parametrize(("take", "last", "beyond"), BOTH_SIDES.values(), ids=BOTH_SIDES)
def test_the_last_is_taken_and_the_first_beyond_is_refused(take, last, beyond):
    take(last)
    with pytest.raises(REFUSALS):
        take(beyond)


def test_numbers_that_can_be_enrolled(tmp_path):
    authority = Authority(tmp_path)
    for number in (0, 65_534):
        assert authority.enrol(number).exists()
    for number in (-1, 65_535):
        with pytest.raises(LiveError, match="0 to 65534"):
            authority.enrol(number)


def test_so_many_can_be_put_out(tmp_path):
    authority = Authority(tmp_path)
    for number in range(65):
        authority.enrol(number)
    assert len(authority.revoke(list(range(64))).serials) == 64
    with pytest.raises(LiveError, match="a list holds 64"):
        authority.revoke([64])
