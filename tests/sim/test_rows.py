"""Rows that every run keeps, and frames for a capture: each field, and none without room."""

from types import SimpleNamespace as Of

from innervate.sim import rows, taps

STALE = 99  # tables are not cleared before they are used


def world_of(**run):
    given = {"rows": 1, "row_limit": 9, "trail": 2, "trail_limit": 9, "fingerprint": -5,
             "taps": 1, "tap_limit": 9, "queue_frames": 3,
             "deliveries": 1, "delivery_limit": 9}  # fmt: skip
    return Of(
        run=[Of(**given | run)], rows=[Of() for _ in range(4)], trail=[Of() for _ in range(4)],
        deliveries=[Of() for _ in range(4)],
        taps=[Of(start=STALE, sender=STALE) for _ in range(6)],
        tapped=[Of(seq=STALE) for _ in range(6)],
        queue=[Of(seq=seq) for seq in (0, 0, 0, 0, 0, 0, 72, 70, 71)],
        buffers=[None, None, Of(first=1, queued=3)],
    )  # fmt: skip


def test_a_report_has_a_row_behind_those_before():
    world = world_of()
    rows.record_row(world, 70, 3, 12, -4, 5)
    assert vars(world.rows[1]) == {"time": 70, "node": 3, "code": 12, "a": -4, "b": 5}
    assert (world.run[0].rows, vars(world.rows[0])) == (2, {})


def test_a_call_has_a_row_with_what_had_happened_by_then():
    world = world_of()
    rows.record_step(world, 3, 70, 2, 1)
    row = {"time": 70, "node": 3, "handler": 2, "port": 1, "fingerprint": -5}
    assert (vars(world.trail[2]), world.run[0].trail) == (row, 3)


def test_a_delivery_has_a_row_with_how_long_it_took():
    world = world_of()
    rows.record_delivery(world, 900, 2, 1, 5, 70)
    row = {"time": 900, "node": 2, "port": 1, "kind": 5, "latency": 70}
    assert (vars(world.deliveries[1]), world.run[0].deliveries) == (row, 2)


def test_without_room_for_rows_there_are_none():
    world = world_of(row_limit=0, trail_limit=0, tap_limit=0, delivery_limit=0)
    rows.record_delivery(world, 70, 3, 2, 1, 5)
    rows.record_row(world, 70, 3, 12, -4, 5)
    rows.record_step(world, 3, 70, 2, 1)
    taps.record_queue(world, 2, 70, taps.OFF, copy)
    assert (world.run[0].rows, world.run[0].trail, world.run[0].taps) == (1, 2, 1)
    assert not any(vars(row) for row in (*world.rows, *world.trail, *world.deliveries))


def copy(to, frame):
    to.seq = frame.seq


def test_a_frame_has_a_row_whose_sender_and_start_are_its_own_until_said():
    world = world_of()
    row = taps.record_frame(world, 70, 4, 1, taps.NOISE)
    assert row is world.taps[1]
    assert vars(row) == {
        "time": 70, "start": 70, "at": 4, "sender": 0, "out": 1, "why": taps.NOISE,
    }  # fmt: skip
    assert world.run[0].taps == 2


def test_what_waits_and_is_lost_is_kept_in_its_order_round_the_ring():
    world = world_of()
    taps.record_queue(world, 2, 70, taps.OFF, copy)
    assert [one.seq for one in world.tapped] == [STALE, 70, 71, 72, STALE, STALE]
    assert [(one.time, one.at, one.out, one.why) for one in world.taps[1:4]] == [
        (70, 2, 1, taps.OFF)] * 3  # fmt: skip
    assert world.run[0].taps == 4
