import pytest

from innervate.networks.skin.analysis import formulas


def test_eq_4_and_5():
    assert formulas.convergence_s(250, 3) == pytest.approx(0.040)
    assert formulas.convergence_error_s(250) == pytest.approx(0.012)
    assert formulas.convergence_s(20, 8) == pytest.approx(0.750)  # E30


def test_eq_7_agrees_with_4_on_setup_1():
    assert formulas.convergence_by_depth_s(7, 5, 100) == formulas.convergence_s(100, 5)


@pytest.mark.parametrize(("hz", "share"), [(10, 0.0006), (100, 0.006), (250, 0.015)])
def test_eq_9_without_its_factor_of_ten(hz, share):
    assert formulas.beacon_share(hz) == pytest.approx(share)


def test_loss_bound():
    # 66.67 cells a port at 250 Hz are what a link carries (E34).
    assert formulas.loss_bound(132, 2, 250, 10) == 0.0
    room = 4e6 / 240 * (1 - 0.0006)
    assert formulas.loss_bound(204, 3, 250, 10) == pytest.approx((17000 - room) / 17000)
    uneven = max(0, 67 * 250 - room) + max(0, 68 * 250 - room)
    assert formulas.loss_bound(135, 2, 250, 10) == pytest.approx(uneven / (135 * 250))
