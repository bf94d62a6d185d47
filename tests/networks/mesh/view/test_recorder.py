"""Which rows of a running mesh are kept to count its messages by, and how often that is done."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.mesh.protocol import constants as c
from innervate.networks.mesh.scenario.plan import MeshFault
from innervate.networks.mesh.view import recorder as room
from innervate.networks.mesh.view.recorder import TrafficRecorder
from innervate.scenario.actions.field import KILL
from innervate.web.engine import engine_of
from tests.networks.mesh.view.test_mesh_view import CHAIN
from tests.web.runs import plan_of


@pytest.fixture
def engine():
    return engine_of(plan_of(CHAIN))


@pytest.fixture
def recorder(engine, monkeypatch):
    """A recorder that tells how often it counts, and of what."""
    made = TrafficRecorder(engine)
    made.counted = []
    for name in ("duplicates", "looped"):
        monkeypatch.setattr(room, name, lambda result: 0)
    monkeypatch.setattr(room, "judged", lambda result: ([], []))
    monkeypatch.setattr(room, "messages", lambda result: made.counted.append(result))
    monkeypatch.setattr(room, "traffic", lambda *given: len(made.counted))
    return made


def add(engine, recorder, **tables):
    rows = {}
    for name in ("rows", "sent", "delivered"):
        given = tables.get(name, ())
        rows[name] = np.zeros(len(given), getattr(engine.world, name).dtype)
        for i, values in enumerate(given):
            for key, value in values.items():
                rows[name][key][i] = value
    recorder.add(rows)


CODES = (c.REPORT_ACCEPTED, c.REPORT_FULL, c.REPORT_EXPIRED, c.REPORT_ALARM, c.REPORT_SUSPECT,
         c.REPORT_TABLE)  # fmt: skip
FRAMES = ((c.DATA, 2), (c.ALARM, 2), (c.DATA, c.ALL), (c.ALARM, c.ALL), (c.REQUEST, 2), (c.ACK, 2))


def test_what_is_kept_is_what_messages_are_counted_by(engine, recorder):
    add(engine, recorder, rows=[{"code": code} for code in CODES],
        sent=[{"kind": kind, "link_dst": to} for kind, to in FRAMES],
        delivered=[{"kind": c.DATA}, {"kind": c.ALARM}])  # fmt: skip
    add(engine, recorder, delivered=[{"kind": c.E2E_ACK}])
    recorder.traffic(True)
    (result,) = recorder.counted
    assert result.rows["code"].tolist() == list(CODES[:4])
    found = zip(result.sent["kind"].tolist(), result.sent["link_dst"].tolist(), strict=True)
    assert list(found) == list(FRAMES[:2])
    assert result.delivered["kind"].tolist() == [c.DATA, c.ALARM, c.E2E_ACK]
    engine.now_us += 1
    add(engine, recorder, delivered=[{"kind": c.DATA}])
    recorder.traffic(True)
    assert len(recorder.counted[-1].delivered) == 4  # nothing twice


def test_going_back_forgets_what_ended_later(engine, recorder):
    add(engine, recorder, rows=[{"code": c.REPORT_ALARM, "time": at} for at in (99, 100, 101)],
        sent=[{"kind": c.DATA, "time": 50, "end": end} for end in (99, 100)],
        delivered=[{"time": at} for at in (99, 100)])  # fmt: skip
    engine.now_us = 100
    recorder.traffic(True)
    recorder.forget()
    recorder.traffic(True)
    result = recorder.counted[1]  # though the moment is the same
    assert [len(table) for table in (result.rows, result.sent, result.delivered)] == [1, 1, 1]


def test_faults_that_have_happened_count_whoever_gave_them(engine, recorder):
    def fault(at_us):
        return MeshFault(at_us, KILL, 1, 0, 0, 0)

    engine.plan.faults[:] = [fault(300), fault(900)]
    engine.given = [fault(100), fault(500)]
    engine.now_us = 500
    recorder.traffic(True)
    (result,) = recorder.counted
    assert [one.at_us for one in result.plan.faults] == [100, 300]
    assert result.ended_us == 500


def test_all_is_counted_anew_for_a_twentieth_of_the_time(engine, recorder, monkeypatch):
    clock = iter((10.0, 10.5, 11.0, 19.9, 20.0, 20.0, 20.7, 21.7, 22.0, 22.1, 22.2))
    monkeypatch.setattr(room, "time", Of(monotonic=lambda: next(clock)))

    def at(now_us, exact=False):
        engine.now_us = now_us
        return recorder.traffic(exact)

    assert at(1) == 1  # took half a second: not again for ten
    assert [at(2), at(3)] == [1, 1]
    assert at(4) == 2  # at 20 s; took nothing
    assert at(5) == 3  # took a second
    assert at(5) == 3  # of the same moment
    assert at(2) == 4  # what is known is of later
