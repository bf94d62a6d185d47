"""What tips a verdict on the radio paper: the rules by themselves, on both sides."""

import pytest

from innervate.networks.radio.papers import capture, delay, fig12, members
from innervate.networks.radio.papers.common import RESERVED, SIZES
from innervate.networks.radio.papers.members import ALLOWED, is_harmless
from innervate.papers.experiment import FAILS, HOLDS, Measured

PLAIN_S, PLAIN_T = [0.4, 0.5, 0.6], [100, 130, 160]


@pytest.mark.parametrize(
    ("found", "longer", "passed"),
    [
        ([0.3, 0.4, 0.5], [110, 140, 170], True),
        ([0.3, 0.4, 0.6], [110, 140, 170], False),  # at the last n nothing is poorer
        ([0.3, 0.4, 0.5999], [110, 140, 170], True),
        ([0.3, 0.4, 0.5], [100, 140, 170], False),  # T_D is no longer
        ([0.3, 0.4, 0.5], [100.1, 140, 170], True),
        ([0.2, 0.4, 0.5], [110, 140, 170], False),  # half of it is not above half
        ([0.2001, 0.4, 0.5], [110, 140, 170], True),
        ([0.4, 0.4, 0.5], [110, 140, 170], False),
        ([0.35, 0.35, 0.5], [110, 140, 170], False),  # it does not rise
        ([0.35, 0.3501, 0.5], [110, 140, 170], True),
        ([0.3, 0.4, 0.5], [110, 140, 320], False),  # twice
        ([0.3, 0.4, 0.5], [110, 140, 319.9], True),
    ],
)
def test_similar_but_poorer(found, longer, passed):
    assert fig12.is_similar_but_poorer(found, PLAIN_S, longer, PLAIN_T) is passed


def test_in_x2_only_the_reports_switch():
    _, x2, _ = fig12.READINGS
    assert fig12.curve(RESERVED, x2, "saturated", True).options == (("window", 45),)
    assert fig12.curve("csma-cd-d2", x2, "saturated", True).options == ()
    plain = fig12.curve(RESERVED, fig12.SIMULATED, "disaster", True).measure()["duration"]
    longer = fig12.curve(RESERVED, x2, "disaster", True).measure()["duration"]
    assert [round(a[0] - b[0]) for a, b in zip(longer, plain, strict=True)] == [20] * 4
    assert longer[-1][0] / plain[-1][0] == pytest.approx(1.11, abs=0.002)


def small(values, size=5):
    """The row on the fixed time, of S by protocol at every n."""
    made = {}
    for mac, of_n in values.items():
        for one in SIZES:
            key = capture.curve(mac, one, True).key
            made[key] = {"throughput": [[of_n] for _ in capture.NS],
                         "jain_round": [[0.2] for _ in capture.NS]}  # fmt: skip
    return capture._small(Measured(made, True), size)


def test_the_fixed_time_explains_what_is_left_without_capture():
    # S of CSMA/CD-R at T = 5 is 0.417 to 0.694 for n = 2 to 10.
    assert small({"csma-cd-d2": 0.9, "csma-cd-d2p": 0.70}).verdict == HOLDS
    most = small({"csma-cd-d2": 0.9, "csma-cd-d2p": 0.69})
    assert most.verdict == FAILS
    assert "without capture at n = 2, 3, 4, 5, 7 only" in most.reason
    few = small({"csma-cd-d2": 0.9, "csma-cd-d2p": 0.51})
    assert "without capture at n = 2, 3 only" in few.reason
    # Where D2 does not lead there is nothing to explain.
    assert "D2 leads at n = 2, 3," in small({"csma-cd-d2": 0.51, "csma-cd-d2p": 0.505}).reason
    assert small({"csma-cd-d2": 0.51, "csma-cd-d2p": 0.505}).verdict == HOLDS
    assert small({"csma-cd-d2": 0.1, "csma-cd-d2p": 0.2}).verdict == FAILS
    assert (
        "at n = 2, 3, 4, 5, 7, 10, and without capture at none"
        in small({"csma-cd-d2": 0.9, "csma-cd-d2p": 0.4}).reason
    )


@pytest.mark.parametrize(
    ("lost", "left", "extra", "passed"),
    [
        (0, 0, ALLOWED, True), (0, 0, ALLOWED + 0.1, False), (1, 0, 0, False), (0, 1, 0, False),
        (0, 0, -50, True), (-1, 0, 0, True),
    ],
)  # fmt: skip
def test_what_harms_others(lost, left, extra, passed):
    assert is_harmless(lost, left, extra) is passed


def test_the_moment_between_collision_and_report_is_looked_at():
    for quick in (True, False):
        found = members.moments(quick)
        assert found == sorted(set(found))
        assert {5200, 6240, 6448, 6656} & set(found) or set(members.CLOSE_US) <= set(found)
    # Robot 2 of Fig. 1 (station 1) ends second to last; it dies before it could report.
    plan = members.moved(members.APART, "removed", 6344, 1, 1)
    lost, left, _ = members.others(members.simulate.simulate(plan), 1)
    assert (lost, left) == (1, 0)
    late = members.moved(members.APART, "removed", 6864, 1, 1)
    assert members.others(members.simulate.simulate(late), 1)[:2] == (0, 0)


def test_numbers_are_no_part_of_the_protocols():
    for mode in members.MODES:
        found = members.renumbered(mode, True).work()
        assert found == [True] * 10


@pytest.mark.parametrize(
    ("load", "dcf", "here", "passed", "beside"),
    [
        (0.1, 100.0, 100.0, True, "1.30 times the 100 of a DCF that sends until all have it"),
        (0.1, 99.9, 100.0, False, "(beside that one it holds)"),
        (0.1, 100.0, 99.9, True, "(beside that one it does not hold)"),
        (0.3, 130.1, 30_000.0, True, "30,000 of a DCF that sends until all have it"),
        (0.3, 130.0, 130.1, False, "(beside that one it holds)"),
        (0.3, 130.1, 130.0, True, "(beside that one it does not hold)"),
    ],
)
def test_a_bar_is_judged_by_what_anybody_received_and_told_of_the_other(
    load, dcf, here, passed, beside
):
    means = {("practical", 1): 130.0, (delay.DCF, 1): dcf, (delay.DCF_HERE, 1): here}
    made = {}
    for who in delay.LOOKS:
        for one in SIZES:
            left = {name: [1.0] for name in delay.PARTS}
            point = delay.point(who, one, 5, load, True)
            made[point.key] = {"mean": [means.get(who, 1000.0)] * 2, **left}
    got = Measured(made, True)
    claim = delay._light(got, 5) if load == 0.1 else delay._below(got, 5, load, ("dcf", "tdma"), 1)
    assert (claim.verdict == HOLDS) is passed
    assert claim.measurement.count(beside) == len(SIZES)
