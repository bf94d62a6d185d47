from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.skin.analysis.touch import Image, received_image
from innervate.networks.skin.sim.touch import read_sensors


def felt_image(run, time_s):
    """What the cells felt at a time, lost or not; zero without a touch."""
    result = getattr(run, "result", run)
    cells, world = result.plan.graph.cells, result.world
    sample = Of(force=[0, 0, 0], accel=[0, 0, 0])
    carrier = Of(**{name: list(t) for name, t in world.carrier._asdict().items()})
    sensors = Of(sample=[sample], carrier=carrier)
    force, proximity = np.zeros(cells, np.int64), np.zeros(cells, np.int64)
    for cell in range(cells):
        read_sensors(sensors, cell, round(1e6 * time_s))
        force[cell], proximity[cell] = sum(sample.force) // 3, sample.proximity
    return Image(force, proximity, np.zeros(cells, np.int64))


@pytest.fixture(scope="module")
def touched(go):
    return go("demo", seconds=2.3, deliveries=True)


def test_while_all_is_well_the_pc_has_what_cells_felt(touched):
    had, felt = received_image(touched, 1.9), felt_image(touched, 1.9)
    assert had.known.all()
    assert felt.force_mn.max() > 1000
    # The image is up to a sample's period and the way old; the touch moves a little in it.
    assert np.abs(had.force_mn - felt.force_mn).max() < 1500
    touched_cells = felt.force_mn > 500
    assert (had.force_mn[touched_cells] > 0).all()
    assert had.age_us.max() < 50_000


def test_loss_during_a_recovery_is_a_hole(touched):
    before = received_image(touched, 1.999, window_s=0.016)
    during = received_image(touched, 2.016, window_s=0.016)
    after = received_image(touched, 2.2, window_s=0.016)
    assert before.known.mean() > 0.95
    assert during.known.mean() < 0.6
    assert after.known.mean() > 0.95
    assert (during.force_mn[~during.known] == 0).all()
    assert (during.age_us[~during.known] == -1).all()


def test_nothing_received_yet(touched):
    assert not received_image(touched, 0.0).known.any()


def test_a_sample_is_known_from_when_it_came_until_a_window_later():
    """Cell 1 has two samples: the newer one counts. Of cell 3 nothing came."""
    made = [(100, 0, (3, 3, 4), 10), (150, 1, (6, 6, 6), 20), (160, 1, (90, 60, 0), 30),
            (200, 2, (9, 9, 10), 40)]  # fmt: skip
    kinds = [("time", np.int64), ("cell", np.int64), ("force", np.int64, 3),
             ("proximity", np.int64)]  # fmt: skip
    run = Of(plan=Of(graph=Of(cells=4)), deliveries=np.array(made, kinds))
    for now_us, ages in ((199, (99, 39, -1, -1)), (200, (-1, 40, 0, -1)), (249, (-1, 89, 49, -1)),
                         (260, (-1, -1, 60, -1)), (300, (-1, -1, -1, -1))):  # fmt: skip
        found = received_image(run, now_us / 1e6, 100e-6)
        assert found.age_us.tolist() == list(ages), now_us
        known = [age >= 0 for age in ages]
        assert found.known.tolist() == known
        assert found.force_mn.tolist() == [f * k for f, k in zip((3, 50, 9, 0), known, strict=True)]
        assert found.proximity.tolist() == [
            p * k for p, k in zip((10, 30, 40, 0), known, strict=True)
        ]


def test_what_a_cell_feels_is_the_mean_of_its_three_sensors(touched):
    carrier, at_us = touched.world.carrier, 1_900_000
    sample = Of(force=[0, 0, 0], accel=[0, 0, 0])
    sensors = Of(sample=[sample], carrier=Of(**{name: list(t) for name, t in
                                                carrier._asdict().items()}))  # fmt: skip
    found, sums = felt_image(touched, at_us / 1e6), []
    for cell in range(touched.plan.graph.cells):
        read_sensors(sensors, cell, at_us)
        sums.append(sum(sample.force))
        assert found.proximity[cell] == sample.proximity
    assert max(sums) > 3_000
    assert found.force_mn.tolist() == [force // 3 for force in sums]
    assert set(found.age_us.tolist()) == {0}


def test_a_run_will_do_as_well(touched):
    class Run:
        result = touched

    assert received_image(Run(), 1.0).known.all()
    assert felt_image(Run(), 1.0).force_mn.max() > 0


def test_no_touch(go):
    assert felt_image(go("setup-3", seconds=0.05), 0.01).force_mn.max() == 0
