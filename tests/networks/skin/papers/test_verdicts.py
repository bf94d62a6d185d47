"""Every verdict of the skin paper on both sides of its threshold, with made-up results."""

from collections import Counter

import pytest

from innervate.networks.skin.papers import (
    FIGURES,
    at_most,
    eq3,
    eq7,
    experiment,
    fig8a,
    fig8b,
    loop,
)  # fmt: skip
from innervate.networks.skin.papers.common import RULES
from innervate.papers.experiment import FAILS, Measured, Span, about
from tests.networks.skin.papers.results import QUICK, of

# Figure, words of its claims, and what the runs left: with which they hold, with which they do not.
EDGES = [
    ("fig5", "after exactly (k+3) T", {"lock": 3.009}, [{"lock": 3.02}, {"lock": 2.98}], 1),
    ("fig5", "with M = min(k, 5)", {"late": 3.0}, [{"late": 4.0}, {"late": 2.0}], 1),
    ("fig5", "free-running cells", {"free": 3.0}, [{"free": 2.9}, {"free": 3.1}], 1),
    ("fig5", "line of depth 4", {"line": 3.0}, [{"line": 2.9}, {"line": 3.1}], 1),
    ("fig6", "rare misses (20 %", {"calm": 0.05}, [{"calm": 0.06}, {"calm": 0.68}], 1),
    ("fig6", "rare misses (5 %", {"rare": 0.05}, [{"rare": 0.06}], 1),
    ("fig6", "is detected", {"alert": 0.95}, [{"alert": 0.94}], 1),
    ("fig6", "allowed ratio", {"off": 0.09}, [{"off": 0.11}, {"off": -0.11}], 1),
    ("fig6", "re-plugged", {"replug": 1.0}, [{"replug": 2.0}, {"replug": 0.0}], 1),
    ("startup", "after max(H) T", {"beyond": 1.04}, [{"beyond": 1.05}], 3),
    ("eq3", "as printed", {"printed": 0.999}, [{"printed": 0.998}, {"printed": 0.67}], 1),
    ("eq3", "up to date", {"sizes": 1.0}, [{"sizes": 1.01}], 1),
    ("eq3", "stable balancing", {"beta": 0.999}, [{"beta": 0.998}, {"moves": 1}], 4),
    ("delay", "6 ms", {"mean": 7.5}, [{"mean": 7.51}, {"mean": 4.49}, {"mean": 0.7}], 1),
    ("delay", "6 ms", {"mean": 4.5}, [], 1),
    ("fig8a", "convergence of setup 1", {"off": 2.99}, [{"off": 3.01}, {"off": -3.01}], 3),
    ("fig8a", "asked for", {"off": -2.99}, [{"off": 3.01}, {"off": -3.01}], 1),
    ("fig8a", "mean k", {"detected": 0.25}, [{"detected": 0.26}, {"detected": -1.1}], 1),
    ("fig8b", "(Eq. 6)", {"off": 2.0}, [{"off": 2.01}, {"off": -2.01}], 3),
    ("fig8b", "almost linearly", {"slope": 0.09}, [{"slope": 0.11}, {"slope": -0.11}], 3),
    ("fig8b", "almost linearly", {}, [{"scatter": 1.5}], 3),
    ("eq7", "(k = 3, 250 Hz) + 3 T", {"beyond": 3.0}, [{"beyond": 3.1}], 3),
    ("eq7", "without the error bar", {"half": 0.0}, [{"beyond": 0.1}], 3),
    ("eq7", "ceil(h/2)", {"half": 0.0}, [{"half": 0.1}], 1),
    ("at_most", "at most 50 ms", {"ms": 50.0}, [{"ms": 50.1}], 3),
    ("at_most", "at most 40 ms", {"ms": 40.0}, [{"ms": 40.1}], 3),
    ("fig10", "always 1", {"beta": 0.999}, [{"beta": 0.998}], 1),
    ("fig10", "the network's capacity", {"over": 0.0199}, [{"over": 0.021}, {"over": -0.003}], 3),
    ("fig10", ": about 10 points", {"gain": 0.0751}, [{"gain": 0.0749}, {"gain": 0.22}], 3),
    ("fig10", ": about 10 points", {"gain": 0.1249}, [{"gain": 0.1251}], 3),
    ("fig10", "forward what sets", {"even": 0.0751}, [{"even": 0.03}, {"even": 0.1251}], 1),
    ("fig10", "at least 10 points", {"gain": 0.1001}, [{"gain": 0.0999}], 1),
    ("fig10", "at most about 30", {"worst": 0.42}, [{"worst": 0.2}, {"worst": 0.6}], 1),
    ("fig10", "largest subnetwork", {"less": 0.2499}, [{"less": 0.2501}, {"less": 0.1499}], 1),
    ("eq9", "240 bit", {"off": 0.0199}, [{"off": 0.021}, {"off": -0.021}], 1),
    ("eq9", "0.6 %", {"printed": 2.0}, [{}, {"printed": 1.89}, {"printed": 2.11}], 1),
    ("eq9", "wave mode", {"wave": 0.0999}, [{"wave": 0.101}], 1),
    ("fig11", "around 500 ms", {"ms": 625.0}, [{"ms": 626.0}, {"ms": 374.0}], 1),
    ("fig11", "no negative effect", {"apart": 4.9}, [{"apart": 5.1}, {"fast": 1.11}], 1),
    ("fig11", "two seconds", {"down": 2500.0}, [{"down": 2501.0}, {"down": 1499.0}], 1),
    ("loop", "loop-free convergence (printed", {}, [{"printed": 1}], 1),
    ("loop", "loop-free convergence (its laxer", {}, [{"lax": 1}], 1),
    ("loop", "strict (F1)", {}, [{"cured": 1}], 1),
    ("loop", "counting slower", {}, [{"slower": 1}], 1),
    ("modes", "on the mean (asked for)", {"wave": 4.5}, [{"wave": 6.0}], 2),
    ("modes", "of the floor", {"wave": 1.99}, [{"wave": 2.1}, {"wave": -2.1}], 2),
    ("modes", "faster than periodic", {"triggered": 0.6}, [{"triggered": 0.4}], 2),
    ("modes", "sooner than", {"often": -0.11}, [{"often": -0.09}, {"often": 0.2}], 1),
    ("modes", "no cell on a longer way", {}, [{"longer": 1}], 2),
]  # fmt: skip


def verdicts(figure, words, knobs):
    judged = list(experiment(figure).judge(Measured(of(figure, **knobs), QUICK)))
    return [claim.verdict for claim in judged if words in claim.claim]


@pytest.mark.parametrize(("figure", "words", "inside", "outside", "rows"), EDGES)
def test_a_verdict_turns_at_its_threshold(figure, words, inside, outside, rows):
    held = verdicts(figure, words, inside)
    assert len(held) == rows
    assert FAILS not in held
    for knobs in outside:
        turned = verdicts(figure, words, knobs)
        assert set(turned) == {FAILS}, knobs


def judged_with_one(figure, key, name, value, words, **knobs):
    """Verdicts where one value among all of the runs is another one."""
    made = of(figure, **knobs)
    made[key][name][-1] = value
    judged = list(experiment(figure).judge(Measured(made, QUICK)))
    return [claim.verdict != FAILS for claim in judged if words in claim.claim]


@pytest.mark.parametrize("place", range(3))
def test_a_bound_on_convergence_has_no_exception(place):
    rule, k_ms = RULES[place], 1000 / eq7.HZ
    for setup, cut in ((eq7.SETUPS[0], "random link"), (eq7.SETUPS[-1], "interface 1")):
        one = rule.case(setup, eq7.HZ, eq7.K, cut)
        key, bound = one.point(eq7.seeds(QUICK, cut)).key, eq7.depth(setup) + eq7.K + 3
        for more, holds in ((0.0, True), (0.1, False)):
            found = judged_with_one("eq7", key, "converged_ms", (bound + more) * k_ms, "+ 3 T")
            assert found == [holds or i != place for i in range(3)]


def test_nor_has_the_one_with_half_the_height():
    setup, half = next(iter(eq7.HALF.items()))
    one = RULES[0].case(setup, eq7.HZ, eq7.K)
    key = one.point(eq7.seeds(QUICK, "interface 1")).key
    for more, holds in ((0.0, True), (0.1, False)):
        ms = (half + eq7.K + more) * one.period_ms
        assert judged_with_one("eq7", key, "converged_ms", ms, "ceil(h/2)") == [holds]


@pytest.mark.parametrize("place", range(3))
@pytest.mark.parametrize("k", at_most.KS)
def test_at_most_so_many_ms_has_no_exception(place, k):
    for setup, _ in at_most.SKINS:
        key = RULES[place].case(setup, at_most.HZ, k).point(at_most.seeds(QUICK)).key
        for ms, holds in ((50.0, True), (50.1, False)):
            found = judged_with_one("at_most", key, "converged_ms", ms, "at most 50 ms", ms=40.0)
            # The paper gives no k: judged is the least that tolerates a lost beacon.
            assert found == [holds or i != place or k != at_most.K for i in range(3)]


def judged_with_some(figure, cases, seeds, more, words):
    """Verdicts where of these cases one recovery in twenty is later, and where one more is."""
    points = [one.point(seeds) for one in cases]
    few, found = len(points) * seeds // 20, []
    for count in (few, few + 1):
        made = of(figure)
        for i in range(count):
            one, place = points[i // seeds], i % seeds
            made[one.key]["converged_ms"][place] += more * cases[i // seeds].period_ms
        judged = list(experiment(figure).judge(Measured(made, QUICK)))
        found.append([claim.verdict != FAILS for claim in judged if words in claim.claim])
    return found


@pytest.mark.parametrize("place", range(3))
def test_one_recovery_in_twenty_may_lie_outside_a_band(place):
    but_one = [i != place for i in range(3)]
    sweep = fig8a.grid(QUICK)
    cases = fig8a.cells(sweep, RULES[place])
    found = judged_with_some("fig8a", cases, sweep.seeds, 3.1, "convergence of setup 1")
    assert found == [[True] * 3, but_one]
    for setup in ("setup-1", "setup-4"):  # of every setup by itself
        cases = [RULES[place].case(setup, fig8b.HZ, k) for k in fig8b.KS]
        found = judged_with_some("fig8b", cases, fig8b.seeds(QUICK), 2.1, "(Eq. 6)")
        assert found == [[True] * 3, but_one]


@pytest.mark.parametrize(
    ("rule", "words"), [(loop.PRINTED, "convergence (printed"), (loop.LAX, "convergence (its"),
                        (loop.SLOWER, "counting slower"), (loop.CURED[0], "strict (F1)"),
                        (loop.CURED[-1], "strict (F1)")],
)  # fmt: skip
def test_one_recovery_with_a_loop_is_one_too_many(rule, words):
    made = of("loop")
    made[loop.loops(rule, QUICK).key]["episodes"][-1] = 1
    failed = [claim.claim for claim in experiment("loop").judge(Measured(made, QUICK))
              if claim.verdict == FAILS]  # fmt: skip
    assert len(failed) == 1
    assert words in failed[0]


def test_every_row_is_tried_on_both_sides():
    tried = {figure: [words for name, words, *_ in EDGES if name == figure] for figure in FIGURES}
    by_graph = ("only one node", "n_bal", "more deterministic")  # below
    for figure in FIGURES:
        for claim in experiment(figure).judge(Measured(of(figure), QUICK)):
            words = (*tried[figure], *by_graph)
            assert any(word in claim.claim for word in words), claim.claim


@pytest.mark.parametrize(("most", "holds"), [(1, True), (2, False)])
def test_who_is_equally_far_from_two_roots_is_counted(monkeypatch, most, holds):
    monkeypatch.setattr(eq3, "tied_at", lambda graph: Counter({3: most, 4: 1}))
    assert (eq3._one_node().verdict != FAILS) == holds


@pytest.mark.parametrize(("tied", "holds"), [(40, True), (43, False)])
def test_who_may_balance_is_counted(monkeypatch, tied, holds):
    monkeypatch.setattr(eq3, "tied_at", lambda graph: Counter({3: tied}))
    assert (eq3._few_nodes().verdict != FAILS) == holds


def test_more_deterministic_means_a_third_of_the_spread():
    from innervate.networks.skin.papers import fig10

    got = Measured(of("fig10", worst=0.30), QUICK)
    losses = [fig10.values(got, "setup-7", fig10.STATIC, "loss")]
    spread = max(losses[0]) - min(losses[0])
    # In quick mode there is one dynamic run; its spread is given here.
    for share, holds in ((0.33, True), (0.34, False)):
        values = {fig10.STATIC: losses[0], fig10.DYNAMIC: [0.0, share * spread]}
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(fig10, "values", lambda got, s, mode, n, v=values: v[mode])
            assert (fig10._spread(got).verdict != FAILS) == holds


def test_a_span_has_its_ends_and_nothing_beyond():
    assert Span(1, 2).has(1, 2)
    assert not Span(1, 2).has(1, 2.001)
    assert not Span(1, 2).has(0.999)
    assert not Span(1, 2).has()
    assert not Span().has(float("nan"))
    assert Span(low=3).has(1e9)
    assert about(10) == Span(7.5, 12.5)
