"""Every frame is accounted for: sent = arrived + lost by reason + under way."""

import numpy as np
import pytest

from innervate.networks.skin.sim import counters as words
from innervate.sim import wheel
from innervate.sim.cables import wires
from tests.networks.skin.runs import busy, patch, run, setup_1

LOST = (wires.LOST_CUT, wires.LOST_NOISE, wires.LOST_OFF, wires.LOST_QUEUE, wires.LOST_BROKEN)


def column(table, name, first, behind):
    """A field of some records, compiled or plain."""
    if isinstance(table, list):
        return np.array([getattr(record, name) for record in table[first:behind]])
    return np.array(table[name][first:behind])


def under_way(result):
    """(urgent, other) frames on a wire or in a queue at the end."""
    world = result.world
    run_record = world.run[0]
    plain = isinstance(world.cells, list)
    first = int(run_record.pool_slots if plain else run_record["pool_slots"])
    behind = int(world.wheel.pool[wheel.FRESH])
    flying = column(world.wheel.events, "bucket", first, behind) != wheel.NIL
    kinds = column(world.wheel.events, "kind", first, behind)[flying]
    queued = int(column(world.buffers, "queued", 0, len(world.buffers)).sum())
    urgent = int((kinds == wires.URGENT_BLOCK).sum())
    return urgent, int((kinds == 0).sum()) + queued


def assert_conserved(result, what):
    counts = result.counters
    for block, flying in zip((wires.URGENT_BLOCK, 0), under_way(result), strict=True):
        lost = sum(counts[block + reason] for reason in LOST)
        sent, arrived = counts[block + wires.SENT], counts[block + wires.ARRIVED]
        assert sent == arrived + lost + flying, (
            f"{what}, block {block}: {sent} sent, {arrived} arrived, {lost} lost, {flying} flying"
        )
    # What a cell's sensors said went out, or in at another cell, or to the PC, or was dropped.
    came = counts[wires.OFFERED] + counts[wires.ARRIVED] - counts[wires.DELIVERED]
    went = counts[wires.SENT] + counts[words.NO_ROUTE] + counts[words.LOOPED]
    assert came == went, f"{what}: {came} samples came in, {went} went out or were dropped"
    assert min(counts) >= 0


@pytest.mark.parametrize("rule", ["feasible", "strict", "paper", "static"])
def test_no_frame_vanishes(rule):
    for seed in range(6):
        result = run(busy(seed, rule), checks=False)
        assert_conserved(result, f"seed {seed}")
        assert result.counters[wires.DELIVERED] > 100


def test_no_frame_vanishes_at_any_moment():
    for steps in range(1, 40):
        keys = busy(4) | {"duration_s": 0.05 + steps * 0.000_977}
        keys["event"] = [event for event in keys["event"] if event["at_s"] < keys["duration_s"]]
        assert_conserved(run(keys, checks=False), f"after {keys['duration_s']} s")


@pytest.mark.slow
def test_no_frame_vanishes_over_many_seeds():
    for seed in range(1000):
        rule = ("feasible", "strict", "paper", "static")[seed % 4]
        latency = ("per_link", "per_frame")[seed % 2]
        keys = busy(seed, rule, latency=latency)
        assert_conserved(run(keys, checks=False), f"seed {seed}, {rule}, {latency}")


def test_a_quiet_skin_loses_nothing():
    result = run(setup_1(duration_s=1.5, data={"rate_hz": 50}), deliveries=True)
    counts = result.counters
    late = result.deliveries[result.deliveries["time"] > 300_000]
    assert counts[words.LOOPED] == 0
    assert sum(counts[reason] for reason in LOST) == 0
    # Every cell's samples arrive, counted without a gap.
    for cell in range(99):
        seqs = late["seq"][late["cell"] == cell].astype(int)
        assert len(seqs) > 50
        assert set((np.diff(seqs) % 256).tolist()) == {1}, f"cell {cell}"


def test_hops_and_time_are_those_of_the_route():
    result = run(setup_1(duration_s=1.0, data={"rate_hz": 20}), deliveries=True)
    late = result.deliveries[result.deliveries["time"] > 300_000]
    depths = np.array(result.plan.depths)
    # `hops` counts the cells that forwarded it: one less than the cables.
    assert (late["hops"] + 1 == depths[late["cell"]]).all()


def test_an_overloaded_port_loses_in_its_queue_only():
    result = run(patch(9, 11, (0, 3), duration_s=0.6, data={"rate_hz": 250, "queue": 4}))
    counts = result.counters
    assert counts[wires.LOST_QUEUE] > 0
    assert sum(counts[r] for r in LOST) == counts[wires.LOST_QUEUE]
    # [skin 2] one frame per 60 us is what the PC's side takes
    assert counts[wires.DELIVERED] <= 0.6e6 / 60
    assert_conserved(result, "overload")
