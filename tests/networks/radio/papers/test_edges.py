"""Every verdict of the radio's tables on both sides of its threshold, with made-up results."""

import pytest

from innervate.networks.radio.papers import (
    FIGURES,
    capture,
    common,
    delay,
    experiment,
    fairness,
    fig4_5,
    fig12,
    limits,
    members,
    practical,
    silent,
    ties,
    turnaround,
)
from innervate.networks.radio.papers.common import RESERVED, SIZES
from innervate.papers.experiment import FAILS, Measured
from tests.networks.radio.papers.results import (
    AS_N,
    CONTEND,
    DOUBLING,
    DOWN,
    OURS,
    QUICK,
    RUN,
    UP,
    ahead,
    all_reach,
    below,
    beside,
    captured,
    chained,
    changed,
    complete,
    each_alone,
    every,
    fair,
    grows,
    helped,
    just_as_ours,
    levels,
    linear,
    lost,
    moved,
    near,
    once_a_round,
    over_slotted,
    put_in_order,
    quick_few,
    results,
    run_with,
    s_of,
    scaled,
    served,
    settled,
    similar,
    t_of,
    tails,
    turned,
    waiting,
    wavy,
)

NEVER_BROKEN, TWO_MS, FOUR = practical.SETTING, turnaround.SETTING, turnaround.FOUR

# Figure, words of one claim (^ at its start, $ at its end), edits with which it holds, and with
# which it does not.
EDGES = [
    ("fig1", "^the example of Fig. 1", [], [
        run_with(packets=[*RUN["packets"][:-1], [0, 27768, 32969]]),
        run_with(packets=[[3, 1, 5200], *RUN["packets"][1:]]),
        run_with(reports=[*RUN["reports"], [0, 9000, 9208]])]),
    ("fig1", "^rule (5)", [], [run_with(counts=[3, 2, 2, 0]),
                               run_with(turns=RUN["turns"] | {"2": 3})]),
    ("fig1", "^the second latest", [], [
        run_with(reports=[[1, 6551, 6760], *RUN["reports"][1:]]),
        run_with(reports=[[1, 6553, 6760], *RUN["reports"][1:]]), run_with(roles=[0, 0, 0, 0])]),
    ("fig1", "^each node can retransmit", chained(7, 7, 1), [chained(7, 8, 1), chained(7, 7, 0)]),
    ("fig4_5", "^When a small number", every(s_of, UP, 2), each_alone(s_of, UP, 2, but=1)),
    *[("fig4_5", f"^T = {size}: CSMA/CD-R shows", every(s_of, DOWN, 100, sizes=(size,)),
       each_alone(s_of, DOWN, 100, but=1, sizes=(size,))) for size in SIZES],
    ("fig4_5", "^CSMA/CD-R is superior", every(s_of, DOWN, 100),
     each_alone(s_of, DOWN, 100, but=1)),
    ("fig4_5", "^S increases with n", [], [
        [changed(s_of(RESERVED, size), lambda v: 0.0, 100)] for size in SIZES]),
    ("fig4_5", "^S = n T /", [changed(s_of(RESERVED, 5), lambda v: v + 9e-10, 30)], [
        [changed(s_of(mac, size), lambda v, by=by: v + by, 30)]
        for mac in (RESERVED, common.READING_B) for size in SIZES for by in (2e-9, -2e-9)]),
    ("fig4_5", "^the protocols beside it",
     [scaled(s_of(mac, size), 1 - 0.99 * off)
      for mac, off in fig4_5.ALLOWED.items() if mac != "tdma" for size in SIZES],
     [[scaled(s_of(mac, size), 1 + 1.01 * off) for size in SIZES]
      for mac, off in fig4_5.ALLOWED.items()]),
    # Rises of T + 1 slots a station, n = 2..100: 1 - R^2 = off^2 / ((T + 1)^2 816.7).
    *[("fig6_7", f"^T = {size}: T_D in", wavy(t_of(RESERVED, size), 0.02 * (size + 1)),
       [wavy(t_of(RESERVED, size), 0.04 * (size + 1))]) for size in SIZES],
    ("fig6_7", "^When a small number", every(t_of, DOWN, 2, 3, macs=("csma-cd-d1",)), [
        [*every(t_of, DOWN, 2, 3, macs=("csma-cd-d1",)),
         changed(t_of("csma-cd-d1", size), lambda v: v * DOWN, n)]
        for size in SIZES for n in (2, 3)]),
    *[("fig6_7", f"^T = {size}: CSMA/CD-R is superior", every(t_of, UP, 100, sizes=(size,)),
       each_alone(t_of, UP, 100, but=1, sizes=(size,))) for size in SIZES],
    ("fig6_7", "^CSMA/CD's duration", every(t_of, UP, 100), each_alone(t_of, UP, 100, but=1)),
    *[("fig12", f"^{one.name} (", similar(one, 0.51, 1.99), [
        similar(one, 0.5, 1.5), similar(one, 1.0, 1.5), similar(one, 0.7, 2.0),
        similar(one, 0.7, 1.0)]) for one in fig12.READINGS],
    ("fig12", "CSMA/CD-R is ahead of", ahead(), [ahead(one.name) for one in fig12.READINGS]),
    ("fig12", "loses nothing in any reading$", [], [
        [(fig12.event(one, 5, QUICK), {"silent": [0, 1]})] for one in fig12.READINGS]),
    ("ties", "rules to the letter$", [], [[put_in_order(ties.WORDED, n, 39)] for n in ties.NS]),
    ("ties", "^the same for up to four", [put_in_order(ties.BOTH, n, 38) for n in (2, 3, 4)],
     [[put_in_order(ties.BOTH, n, 37)] for n in (2, 3, 4)]),
    ("ties", "^the same for five", [put_in_order(ties.BOTH, n, 39) for n in range(5, 13)],
     [[put_in_order(ties.BOTH, n, 38)] for n in range(5, 13)]),
    ("ties", "^the same for any number", [], [[(ties.apart(n), {"ordered": [0]})]
                                              for n in range(2, 21)]),
    ("ties", "^two small changes", helped(0.5, 0.501, 0.5, 0.501), [
        helped(0.5, 0.5, 0.5, 0.6), helped(0.5, 0.6, 0.5, 0.5)]),
    ("silent", "^CSMA/CD-R works with", [lost("paper", 2, 2000, 3), lost("paper", 5, 2000, 9)], [
        [lost("paper", 2, 2000, 4)], [lost("paper", 5, 2000, 10)]]),
    ("silent", "^with no turnaround", [], [[lost("paper", n, 0, 1)] for n in silent.NS]),
    ("silent", "^the practical mode loses", [], [
        [lost("practical", n, ta, 1)] for n in silent.NS for ta in silent.TURNAROUNDS]),
    *[("members", f"^{members.NAMES[mode]}: a robot can be {move}",
       moved((mode, move), lost=0.0, left=-1.0, extra=26.0),
       [moved((mode, move), extra=26.1), moved((mode, move), lost=1.0),
        moved((mode, move), left=1.0)]) for mode, move in members.CASES],
    ("members", "^a specific number", [], [
        [(members.renumbered(mode, QUICK), [True, False])] for mode in members.MODES]),
    *[(("limits", f"^settling value of CSMA/CD-R: {value}", settled(size, value + 0.0049, value),
        [settled(size, value + 0.0051, value), settled(size, value, value + 0.0051),
         settled(size, value - 0.0051, value), settled(size, value, value - 0.0051)]))
      for size, value in ((5, 0.83), (25, 0.96))],
    ("limits", "^S is independent", [*levels(5, 0.8, 0.8399), *levels(25, 0.8, 0.8399)], [
        levels(size, 0.8, 0.8401) for size in SIZES]),
    ("limits", "^the curves have settled", all_reach(), [
        all_reach((letter, size)) for letter in "AB" for size in SIZES]),
    ("limits", "^an asynchronous", [], [
        [(limits.points(QUICK)[-1], {name: value})]
        for name, value in (("low_us", 103.0), ("high_us", 105.0))]),
    ("quadratic", "^T_D in a CSMA/CD", [*AS_N, *grows(1.86, DOUBLING[0], size=5)], [
        AS_N, [*AS_N, *grows(1.84, *DOUBLING)], [*AS_N, *grows(2.0, "D2, k+1")]]),
    ("quadratic", "^some CSMA/CD has", grows(1.86, "D2, k+1"), [
        grows(1.84, "D2, k+1"), grows(2.16, "D2, k+1")]),
    ("quadratic", "^some CSMA/CD has", grows(2.14, "D2, k+1"), [
        [*grows(1.84, "D2, k+1"), *grows(2.0, "D2, k+1", size=5)]]),
    *[("capture", f"^T = {size}: CSMA/CD is", captured(size, 1.1, UP), [
        captured(size, 1.1, 1), captured(size, 1, UP),
        *[captured(size, 1.1, UP, just_as_ours(size, n)) for n in capture.SMALL]])
      for size in SIZES],
    ("capture", "^CSMA/CD-R serves everybody", [], [once_a_round(size, 0.999) for size in SIZES]),
    ("fairness", "^CSMA/CD cannot", [(one, {"longest": 0.899}) for one in CONTEND.values()], [
        [*((one, {"longest": 0.8}) for one in CONTEND.values()), (late, {"longest": 0.9})]
        for late in CONTEND.values()]),
    ("fairness", "^CSMA/CD-R guarantees",
     [served(mode, 0.3, fifo=0.991) for mode in fairness.EVENT],
     [[served(mode, 0.3, fifo=0.99)] for mode in fairness.EVENT]),
    ("fairness", "^over one round", [served("practical", 0, jain_round=0.991)], [
        [served("practical", 0, jain_round=0.99)], [(OURS, {"jain_round": 0.999})]]),
    ("fairness", "^in saturation nobody", tails(9.9, 9.9, (10, 10, 10)), [
        tails(10, 9, (10, 11, 11)), tails(9, 10, (11, 10, 11)), tails(9, 10, (11, 11, 10))]),
    ("practical", "^the practical mode resolves", *complete(NEVER_BROKEN)),
    ("practical", "^its T_D grows", *linear(NEVER_BROKEN)),
    ("practical", "^its S is at least 97 %", *near(NEVER_BROKEN, 0.97)),
    ("practical", "^its S is above", [*over_slotted(NEVER_BROKEN, 5, UP),
                                      *over_slotted(NEVER_BROKEN, 25, UP)],
     [[*over_slotted(NEVER_BROKEN, 5, five), *over_slotted(NEVER_BROKEN, 25, long)]
      for five, long in ((1, UP), (UP, 1))]),
    ("practical", "^its S beats D2'", beside(NEVER_BROKEN), [
        beside(NEVER_BROKEN, five=6), beside(NEVER_BROKEN, long=3), beside(NEVER_BROKEN, drawn=3)]),
    ("practical", "^it is fair", *fair(NEVER_BROKEN)),
    ("practical", "^its T_D is shorter", [*quick_few(NEVER_BROKEN, 5, lambda n: 100 * n + 1),
                                          *quick_few(NEVER_BROKEN, 25, lambda n: 100 * n + 1)],
     [[*quick_few(NEVER_BROKEN, 30 - size, lambda n: 100 * n + 1),
       *quick_few(NEVER_BROKEN, size, lambda n, at=at: 100 * n + (n != at))]
      for size in SIZES for at in (2, 3)]),
    ("turnaround", "^the practical mode resolves", *complete(TWO_MS)),
    ("turnaround", "^its T_D grows", *linear(TWO_MS)),
    ("turnaround", "2..100$", *near(TWO_MS, 0.92)),
    ("turnaround", "(4 T for T)$", *near(FOUR, 0.92)),
    *[("turnaround", words, beside(TWO_MS, five=2, back=back), [
        beside(TWO_MS, five=3, back=back), beside(TWO_MS, five=2, long=3, back=back),
        beside(TWO_MS, five=2, drawn=3, back=back)])
      for back, words in enumerate(("both ways$", "on the way back$"))],
    ("turnaround", "^it is fair", *fair(FOUR)),
    # n T / (n (T + 1) + 2 T + 2) at n = 10: 50 / 72 and 250 / 312.
    ("turnaround", "^with 2 ms the S of", [*turned(TWO_MS, 5, value=50 / 72 * UP),
                                           *turned(TWO_MS, 25, value=250 / 312 * UP)],
     [[*turned(TWO_MS, 5, value=50 / 72 * DOWN), *turned(TWO_MS, 25, value=1.0)],
      [*turned(TWO_MS, 5, value=1.0), *turned(TWO_MS, 25, value=250 / 312 * DOWN)]]),
    ("delay", "^with 2 ms the practical mode", [], [
        [(delay.point(("practical", turns), 5, 20, 0.9, QUICK), {name: [0, 1]})]
        for turns in (1, 4) for name in ("silent", "open")]),
    *[("delay", f"^at 10 % load and {n} stations", waiting(13.0, n, 0.1, ("dcf",), 1), [
        waiting(13.01, n, 0.1, ("dcf",), 1, size) for size in SIZES]) for n in delay.STATIONS],
    *[below(f"^at {load:.0%} load and {n} stations the".replace("%", " %"), n, load, rivals, 1)
      for load, rivals in ((0.3, ("dcf", "tdma")), (0.6, ("tdma", "token-ring")),
                           (0.9, ("tdma", "token-ring"))) for n in delay.STATIONS],
    *[below(f"^at {load:.0%} load and {n} stations, up".replace("%", " %"), n, load,
            ("tdma", "token-ring"), 4) for load in (0.6, 0.9) for n in delay.STATIONS],
]  # fmt: skip
BY_TURNAROUND = "^2 ms to change a mode"  # below


def is_of(claim, words):
    if words.startswith("^"):
        return claim.claim.startswith(words[1:])
    return claim.claim.endswith(words[:-1]) if words.endswith("$") else words in claim.claim


def verdict(figure, words, edits):
    judged = list(experiment(figure).judge(Measured(results(figure, *edits), QUICK)))
    (found,) = (claim for claim in judged if is_of(claim, words))
    return found.verdict


@pytest.mark.parametrize(
    ("figure", "words", "inside", "outside"), EDGES, ids=[f"{row[0]} {row[1]}" for row in EDGES]
)
def test_a_verdict_turns_at_its_threshold(figure, words, inside, outside):
    assert verdict(figure, words, inside) != FAILS
    assert outside
    for number, edits in enumerate(outside):
        assert verdict(figure, words, edits) == FAILS, number


# Both ways in slots of 208 us: 18.5 to 20.5 are rounded to 19 or 20.
@pytest.mark.parametrize(
    ("us", "holds"), [(1923, False), (1925, True), (2000, True), (2131, True), (2133, False)]
)
def test_both_transitions_are_nineteen_or_twenty_slots(monkeypatch, us, holds):
    monkeypatch.setattr(fig12, "TURNAROUND_US", us)
    made = results("fig12")
    judged = list(experiment("fig12").judge(Measured(made, QUICK))) if us == 2000 else None
    found = next(iter(judged or [next(fig12.judge(fig12.Measured(made, QUICK)))]))
    assert is_of(found, BY_TURNAROUND)
    assert (found.verdict != FAILS) == holds


@pytest.mark.parametrize("figure", FIGURES)
def test_every_row_is_tried_on_both_sides(figure):
    tried = {words for name, words, *_ in EDGES if name == figure} | {BY_TURNAROUND}
    for claim in experiment(figure).judge(Measured(results(figure), QUICK)):
        assert sum(is_of(claim, words) for words in tried) == 1, claim.claim
