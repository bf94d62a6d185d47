import pytest

from innervate.analysis.intervals import mean_interval, quantile, t_quantile, wilson


@pytest.mark.parametrize(
    ("freedom", "value"),
    [(1, 12.7062), (2, 4.3027), (5, 2.5706), (10, 2.2281), (19, 2.0930), (100, 1.9840)],
)
def test_students_t_as_in_the_books(freedom, value):
    assert t_quantile(0.975, freedom) == pytest.approx(value, abs=1e-4)


def test_series_joins_the_exact_values():
    assert t_quantile(0.975, 201) == pytest.approx(t_quantile(0.975, 200), abs=1e-4)
    assert t_quantile(0.975, 10**9) == pytest.approx(1.959964, abs=1e-6)
    assert t_quantile(0.5, 3) == pytest.approx(0.0, abs=1e-9)


def test_mean_interval():
    found = mean_interval([1.0, 2.0, 3.0, 4.0, 5.0])
    assert found.value == 3.0
    assert found.high - found.value == pytest.approx(1.9632, abs=1e-3)
    assert mean_interval([7.0]) == (7.0, 7.0, 7.0)


def test_quantile():
    assert quantile([3, 1, 2], 0.5) == 2
    assert quantile([0, 10], 0.25) == 2.5
    assert quantile([4], 0.9) == 4
    assert quantile(list(range(101)), 0.95) == pytest.approx(95)


def test_wilson():
    assert wilson(19, 20) == pytest.approx((0.95, 0.76387, 0.99112), abs=1e-5)
    assert wilson(0, 1000).low == 0.0
    assert wilson(0, 1000).high == pytest.approx(0.00383, abs=1e-5)
    assert wilson(5, 5).high == 1.0


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: mean_interval([]),
        lambda: quantile([], 0.5),
        lambda: quantile([1], 1.5),
        lambda: wilson(1, 0),
        lambda: wilson(3, 2),
        lambda: t_quantile(1.0, 3),
        lambda: t_quantile(0.9, 0),
    ],
)
def test_nonsense_is_refused(wrong):
    with pytest.raises(ValueError, match="need"):
        wrong()
