"""Mesh runs as a whole: the same again, interrupted, through bytes, and what stops them."""

from types import SimpleNamespace

import numpy as np
import pytest

from innervate.dialect.outbox import deliver, report, send
from innervate.networks.mesh.protocol.frames import copy_frame
from innervate.networks.mesh.sim import simulate as simulation
from innervate.networks.mesh.sim.build import build, grow_duplicates
from innervate.networks.mesh.sim.recorder import place_of
from innervate.sim import driver
from innervate.sim.driver import InvariantBroken
from tests.networks.mesh import pinger as mesh_pinger
from tests.networks.mesh.runs import mesh_plan, run

ALL = 255
TABLES = ("rows", "sent", "delivered")


def busy_plan(**more):
    offers = [(1_000 + 9_000 * k, k % 5, ALL, 9) for k in range(40)]
    return mesh_plan(5, offers=offers, duration_s=0.5, **more)


def same(one, other):
    return one.fingerprint == other.fingerprint and all(
        np.array_equal(getattr(one, name), getattr(other, name)) for name in TABLES
    )


def test_the_same_plan_gives_the_same_run_and_another_seed_another():
    first = run(busy_plan())
    assert same(first, run(busy_plan()))
    assert not same(first, run(busy_plan(seed=2)))


def test_checks_and_trails_change_nothing():
    assert same(run(busy_plan()), run(busy_plan(), checks=False, trail=True))


def test_without_rows_the_run_is_the_same():
    result = run(busy_plan(), observe=False)
    assert result.fingerprint == run(busy_plan()).fingerprint
    assert len(result.rows) == len(result.sent) == 0
    assert result.counts["transmissions"] > 40


def test_rows_are_kept_when_their_tables_are_full(monkeypatch):
    whole = run(busy_plan())
    monkeypatch.setattr("innervate.sim.tables.PLAIN_ROWS", 40)
    seen = []
    assert same(whole, run(busy_plan(), progress=lambda now, end: seen.append((now, end))))
    assert len(seen) > 3
    assert seen == sorted(seen)


def test_an_interrupt_keeps_what_was_done(monkeypatch):
    monkeypatch.setattr(simulation, "PLAIN_SLICE_EVENTS", 20)
    stops = []

    class Asked(driver.Stop):
        def __enter__(self):
            stops.append(self)
            return self

        def __exit__(self, *_):
            pass

    monkeypatch.setattr(driver, "Stop", Asked)

    def progress(now, _):
        stops[-1].asked = now > 150_000

    whole, part = run(busy_plan()), run(busy_plan(), progress=progress)
    assert part.interrupted
    assert not whole.interrupted
    assert 150_000 < part.ended_us < 400_000
    assert np.array_equal(part.sent, whole.sent[: len(part.sent)])


def test_every_frame_can_be_sent_through_a_function():
    frames = []

    def through(frame):
        frames.append(frame)
        other = type(frame)()
        copy_frame(other, frame)
        return other

    result = run(busy_plan(), through=through)
    assert same(result, run(busy_plan()))
    assert len(frames) >= result.counts["transmissions"]


def test_a_function_that_changes_frames_is_seen_in_the_fingerprint():
    def through(frame):
        frame.ttl = 7
        return frame

    assert run(busy_plan(), through=through).fingerprint != run(busy_plan()).fingerprint


def test_compiled_frames_pass_through_nothing():
    with pytest.raises(ValueError, match="plain runs only"):
        run(busy_plan(), plain=False, through=lambda frame: frame)


def broken(**functions):
    """A run with a pinger that does something wrong."""
    names = ("on_start", "on_frame", "on_timer", "on_input")
    wrong = SimpleNamespace(**{name: getattr(mesh_pinger, name) for name in names})
    for name, function in functions.items():
        setattr(wrong, name, function)
    with pytest.raises(InvariantBroken) as error:
        simulation.simulate(busy_plan(), plain=True, entry=wrong)
    return str(error.value)


def test_a_value_out_of_range_stops_the_run():
    def on_timer(node, gate, params, now, timer, out):
        node.rssi[2] = 600

    story = broken(on_timer=on_timer)
    assert "a value of node n" in story
    assert "(seed 1)" in story


def test_an_outbox_that_overflows_stops_the_run():
    def on_frame(node, gate, params, now, port, frame, out):
        for _ in range(33):
            report(out, 20, 0, 0)

    assert "outbox of node n" in broken(on_frame=on_frame)


def test_a_packet_delivered_twice_stops_the_run():
    def on_frame(node, gate, params, now, port, frame, out):
        copy_frame(out.frame[deliver(out, 8)], frame)
        if frame.origin == 3:
            copy_frame(out.frame[deliver(out, 8)], frame)

    assert "delivered a packet twice" in broken(on_frame=on_frame)


def test_a_second_frame_while_one_is_under_way_stops_the_run():
    def on_timer(node, gate, params, now, timer, out):
        for _ in range(2):
            copy_frame(out.frame[send(out, 0, 0, 0)], out.frame[0])

    assert "while another was under way" in broken(on_timer=on_timer)


def test_a_receiver_that_changes_a_frame_stops_the_run():
    def on_frame(node, gate, params, now, port, frame, out):
        frame.seq = (frame.seq + 1) & 65535

    assert "changed the frame that node n" in broken(on_frame=on_frame)


def test_the_table_of_deliveries_grows():
    world = build(busy_plan(), True)
    keys = [1 + 2 * k for k in range(1_000)]
    for key in keys:
        at = place_of(world.duplicate_key, key)
        world.duplicate_key[at], world.duplicate_at[at] = key, 5 * key
    grown = grow_duplicates(world)
    assert len(grown.duplicate_key) == 2 * len(world.duplicate_key)
    assert [grown.duplicate_at[place_of(grown.duplicate_key, key)] for key in keys] == [
        5 * k for k in keys
    ]
