"""The radio paper's figures and claims, in quick mode."""

import re

import numpy as np
import pytest

from innervate.networks.radio.papers.common import first_from, slope
from innervate.networks.radio.papers.fairness import longest
from innervate.papers import main
from innervate.papers.experiment import FAILS, HOLDS, Measured
from innervate.papers.words import spans
from tests.fixtures.papers import made_of_rows, must, wrong
from tests.plot.self_contained import check_paper

# Figure and words of its claims: those that have to hold, and those that must not.
MUST_HOLD = (
    ("fig1", ""),
    ("fig4_5", ""),
    ("limits", "settling value"),
    ("limits", "(within 5 %)"),
    ("limits", "asynchronous"),
    ("fig6_7", ""),
    ("quadratic", "some CSMA/CD"),
    ("fig12", "X1"),
    ("fig12", "X2"),
    ("members", "identification"),
    ("members", "as published: a robot can be added"),
    ("fig12", "loses nothing"),
    ("ties", "up to four"),
    ("ties", "more than a slot apart"),
    ("silent", "practical"),
    ("fairness", "over one round"),
    ("practical", "loses nothing silently"),
    ("practical", "linearly"),
    ("practical", "beats D2'"),
    ("practical", "hand-over bound"),
    ("practical", "slotted S"),
    ("turnaround", "loses nothing silently"),
    ("turnaround", "both ways"),
    ("turnaround", "hand-over bound"),
    ("turnaround", "fair"),
)
MUST_FAIL = (
    ("limits", "have settled"),
    ("quadratic", "proportional to a square of n"),
    ("fig12", "X3"),
    ("members", "Fig. 1's starts: a robot can be removed"),
    ("ties", "to the letter"),
    ("ties", "unlimited scalability"),
    ("silent", "modules that take 2 ms"),
    ("capture", "due to"),
    ("turnaround", "Figs. 4 and 5"),
)


@must(MUST_HOLD, MUST_FAIL)
def test_what_holds_and_what_does_not(radio_made, begins, name, words):
    assert wrong(radio_made, begins, name, words) == []


def double(values):
    return values * np.arange(1, len(values) + 1).reshape(-1, *[1] * (values.ndim - 1))


def half(values):
    return values / 2


def times(factor):
    return lambda values: values * factor


# Figure, words of the claim, of the results' keys, which number, what becomes of it; it then fails,
# or, of what fails as measured, holds.
TIPS = (
    ("fig4_5", "small number", "csma-cd-d2p T=5 saturated", "throughput", half),
    ("fig4_5", "T = 5: CSMA/CD-R shows", "csma-cd-d1 T=5 saturated", "throughput", times(3)),
    ("fig4_5", "T = 25: CSMA/CD-R shows", "csma-cd-d2 T=25 saturated", "throughput", times(30)),
    ("fig4_5", "superior in scalability", "csma-cd-d1 T=5 saturated", "throughput", times(1.3)),
    ("fig4_5", "S increases", "csma-cd-r T=5 saturated", "throughput", np.flip),
    ("fig4_5", "S = n T", "csma-cd-r T=25 saturated", "throughput", times(1 + 1e-8)),
    ("fig4_5", "closed forms", "tree T=5", "throughput", times(1.05)),
    ("fig6_7", "T = 5: T_D in CSMA/CD-R", "csma-cd-r T=5 disaster n=", "duration", double),
    ("fig6_7", "relatively small", "csma-cd-d1 T=5 disaster", "duration", times(2)),
    ("fig6_7", "T = 5: CSMA/CD-R is superior", "csma-cd-d1 T=5 disaster", "duration", times(0.1)),
    ("fig6_7", "abruptly", "csma-cd-d1 T=25 disaster", "duration", half),
    ("quadratic", "to a square", "csma-cd-d2 T=25 disaster backoff=binary", "duration",
     lambda v: double(double(v))),
    ("quadratic", "some CSMA/CD", "csma-cd-d2 T=25 disaster backoff=linear", "duration", double),
    ("fig12", "X1", "csma-cd-r T=25 saturated turnaround", "throughput", half),
    ("fig12", "X2", "csma-cd-r T=25 disaster window", "duration", times(0.8)),
    ("fig12", "loses nothing", "event practical n=5 T=5 ta=2000", "silent", lambda v: v + 1),
    ("silent", "2 ms to change", "event paper n=", "silent", times(0.05)),
    ("capture", "once a round", "csma-cd-r T=5 saturated", "jain_round", times(0.99)),
    ("fairness", "cannot guarantee", "delays csma-cd-d1 n=10 T=25 sat", "longest",
     lambda v: 0 * v + 1),
)  # fmt: skip


def bent(value, name, change):
    """A result in which one number is another."""
    if isinstance(value, dict):
        return {k: change(np.array(v, float)).tolist() if k == name else bent(v, name, change)
                for k, v in value.items()}  # fmt: skip
    return value


@pytest.mark.parametrize(("figure", "words", "keys", "name", "change"), TIPS)
def test_another_result_gives_another_verdict(radio_made, figure, words, keys, name, change):
    def holds(values):
        claims = list(radio_made.experiments[figure].judge(Measured(values, True)))
        (claim,) = [claim for claim in claims if words in claim.claim]
        return claim.verdict != FAILS

    touched = {key: bent(value, name, change) if keys in key else value
               for key, value in radio_made.values.items()}  # fmt: skip
    assert any(touched[key] != radio_made.values[key] for key in touched)
    assert holds(touched) != holds(radio_made.values)


def measurement(made, name, words):
    (claim,) = [claim for claim in made.claims[name] if words in claim.claim]
    return claim.measurement


def test_measured_numbers_are_those_of_the_findings(radio_made):
    assert "22 of 22" in measurement(radio_made, "fig1", "example of Fig. 1")
    assert "0.781 to 0.817" in measurement(radio_made, "limits", "(within 5 %)")
    assert "0.901 to 0.943" in measurement(radio_made, "limits", "(within 5 %)")
    reached = measurement(radio_made, "limits", "have settled")
    assert re.findall(r"n = (\d+) \(A\), (\d+) \(B\)", reached) == [("198", "149"), ("293", "276")]
    ordered = measurement(radio_made, "ties", "up to four")
    assert "n = 2: 40, n = 3: 40, n = 4: 40, n = 5: 0" in ordered
    lost = measurement(radio_made, "silent", "2 ms to change")
    assert "78 of 80" in lost
    assert "196 of 200" in lost


def test_the_three_readings_of_fig_12_are_all_there(radio_made):
    claims = [claim.claim[:2] for claim in radio_made.claims["fig12"]]
    assert [claim for claim in claims if claim in ("X1", "X2", "X3")] == ["X1", "X2", "X3"]
    reasons = [claim.reason for claim in radio_made.claims["fig12"]][1:4]
    assert all("image is not available" in reason for reason in reasons)


def test_a_figure_alone_has_the_same_bytes(radio_made, tmp_path):
    made_of_rows(tmp_path, "radio", only=["limits"])
    assert (tmp_path / "papers-radio.html").exists()
    assert not (tmp_path / "fig12.png").exists()
    for name in ("limits.png", "limits.svg"):
        assert (tmp_path / name).read_bytes() == (radio_made.folder / name).read_bytes()


@pytest.mark.parametrize(
    ("numbers", "words"),
    [((2, 3, 4, 7), "2-4,7"), ((5,), "5"), ((), ""), ((1, 3, 5), "1,3,5"), ((1, 2), "1-2")],
)
def test_numbers_in_words(numbers, words):
    assert spans(numbers) == words


@pytest.mark.parametrize(
    ("holds", "found"),
    [((True, True, True), 2), ((False, True, True), 3), ((True, False, True), 4),
     ((True, True, False), None)],
)  # fmt: skip
def test_from_which_on_it_holds(holds, found):
    assert first_from((2, 3, 4), holds) == found


def test_a_straight_line_fits():
    rise, start, fit = slope([1, 2, 3], [5, 7, 9])
    assert (rise, start, fit) == pytest.approx((2, 3, 1))
    assert slope([1, 2, 3], [5, 9, 7])[2] == pytest.approx(0.25)


@pytest.mark.parametrize(
    ("order", "share"),
    [([0, 1, 2] * 9, 1.0), ([0, 1] + [0] * 9, 1 / 9), ([], 0.0), ([0, 0, 0], 0.0)],
)
def test_who_waited_longest(order, share):
    assert longest(order) == pytest.approx(share)


@pytest.mark.slow
def test_what_holds_and_what_does_not_in_full(tmp_path):
    from innervate.networks.radio import papers as radio
    from tests.fixtures.papers import read

    main("radio", tmp_path)
    whole = read(tmp_path, False, radio.FIGURES, radio)
    for begins, rows in ((HOLDS, MUST_HOLD), (FAILS, MUST_FAIL)):
        for name, words in rows:
            assert wrong(whole, begins, name, words) == [], words


def test_the_page_needs_nothing_else_and_can_be_had_again(radio_made):
    check_paper(radio_made, "radio", "innervate papers radio --quick")
