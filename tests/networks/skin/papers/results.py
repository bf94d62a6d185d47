"""Made-up results of the skin paper's runs, so that a verdict can be asked on both sides of its
threshold: `of(figure, knob=value)` is what the runs would have left."""

from math import ceil

import numpy as np

from innervate.networks.skin.papers import (
    at_most,
    delay,
    eq3,
    eq7,
    eq9,
    fig5,
    fig6,
    fig8a,
    fig8b,
    fig10,
    fig11,
    loop,
    modes,
    startup,
    steady,
)
from innervate.networks.skin.papers.common import RULES

QUICK = True


def of(figure, **knobs):
    """Results of all points of a figure."""
    return globals()[f"_{figure}"](**knobs)


def recovered(one, count, converged, routed=None, detected=None, loops=0):
    """Recoveries of a case in periods; a list goes round over the seeds."""

    def ms(value):
        values = value if isinstance(value, list) else [value]
        return [values[i % len(values)] * one.period_ms for i in range(count)]

    routed = converged if routed is None else routed
    return {
        one.point(count).key: {
            "converged_ms": ms(converged),
            "routed_ms": ms(routed),
            "detected_ms": ms(one.k if detected is None else detected),
            "loops": [loops] * count,
            "cut_cells": [5] * count,
        }
    }


def _fig5(lock=3.0, late=3.0, free=3.0, line=3.0):
    beyond = dict(zip(fig5.CASES, (lock, late, free, line), strict=True))
    return {
        fig5.runs(name, k, QUICK).key: [[k, k + beyond[name]]] * 2
        for name in fig5.CASES
        for k in fig5.ks(QUICK)
    }


def _fig6(calm=0.0, alert=1.0, rare=0.0, off=0.0, replug=1.0):
    found = {}
    for case, share in zip(fig6.FOUND, (calm, alert, rare), strict=True):
        within = round(100 * share)
        found[fig6.watched(case, QUICK).key] = [20.0] * within + [None] * (100 - within)
    x = np.array(fig6.losses(QUICK))
    for _, r_f, r_r in fig6.SETTINGS:
        half = r_r / (r_f + r_r) + off
        shares = np.interp(x, [half - 0.25, half + 0.25], [0.0, 1.0])
        found[fig6.swept(r_f, r_r, QUICK).key] = [shares.tolist()]
    found[f"fig6 replug k={fig6.joined(fig6.REPLUG_K)}"] = {
        str(k): [k + replug] for k in fig6.REPLUG_K
    }
    return found


def _startup(beyond=1.0):
    return {
        startup.point(setup, rule, flag, QUICK).key: {"periods": [10 + beyond], "depth": [10]}
        for setup in startup.SETUPS
        for rule in RULES
        for flag in (True, False)
    }


def _eq3(printed=1.0, beta=1.0, moves=0, sizes=1.0):
    found = {}
    for setup in eq3.SETUPS:
        for rate in eq3.rates(QUICK):
            found[eq3.point(setup, rate, QUICK).key] = {"moves": [0, moves], "beta": [beta] * 2}
        unsigned = {"moves": [0, moves], "beta": [printed] * 2}
        found[eq3.point(setup, eq3.USUAL, QUICK, "paper").key] = unsigned
        for flag in (True, False):
            found[eq3.sizes(setup, flag, QUICK).key] = [[sizes * 2 * eq3.skin(setup)[0]]]
    return found


def _delay(mean=6.0):
    one = {"mean": mean, "samples": 9, "hop_us": [80, 160], "percentiles": [1.0, 2.0]}
    return {delay.point(rate, QUICK).key: one for rate in delay.RATES_HZ}


def _fig8a(off=0.0, detected=0.0):
    found = {}
    sweep = fig8a.grid(QUICK)
    for one in [one for rule in RULES for one in fig8a.cells(sweep, rule)]:
        found |= recovered(one, sweep.seeds, 7 + one.k + off, detected=one.k + detected)
    return found


def _fig8b(off=0.0, slope=0.0, scatter=0.0):
    found = {fig8b.last(QUICK).key: {"outer": [True] + [False] * 7, "middle": [8.0] * 8}}
    for rule in RULES:
        for place, (setup, h) in enumerate(fig8b.SETUPS.items()):
            for k in fig8b.KS:
                seeds = fig8b.seeds(QUICK)
                value = ceil(h / 2) + k + off + slope * h + scatter * (-1) ** place
                found |= recovered(rule.case(setup, fig8b.HZ, k), seeds, value)
    return found


def _eq7(beyond=0.0, half=0.0):
    found = {}
    for rule in RULES:
        for setup in eq7.SETUPS:
            for cut in eq7.cuts(setup):
                seeds = eq7.seeds(QUICK, cut)
                is_half = setup in eq7.HALF and cut.startswith("interface")
                middle = eq7.HALF[setup] if is_half else eq7.depth(setup)
                more = half if is_half and not beyond else beyond
                middle = eq7.depth(setup) if beyond else middle
                found |= recovered(
                    rule.case(setup, eq7.HZ, eq7.K, cut), seeds, middle + eq7.K + more
                )
    return found


def _at_most(ms=40.0):
    found = {}
    for rule in RULES:
        for setup, _ in at_most.SKINS:
            for k in at_most.KS:
                one = rule.case(setup, at_most.HZ, k)
                found |= recovered(one, at_most.seeds(QUICK), [30 / 4, ms / 4])
    return found


def _fig10(beta=1.0, over=0.0, gain=0.10, even=0.10, worst=0.30, wild=0.0, less=0.20):
    """`gain`: mean of the trees; `worst`: the greatest gain of one of setup 7's trees."""
    found = {}
    for setup in fig10.SETUPS:
        cells, ports = {"setup-5": (144, 2), "setup-6": (150, 2), "setup-7": (204, 3)}[setup]
        least = fig10.formulas.loss_bound(cells, ports, 250, 10)
        dynamic = least + over
        each = cells / ports
        largest = {fig10.DYNAMIC: each, fig10.QUEUED: each}
        for mode in (*fig10.DRAWN, fig10.QUEUED):
            count = fig10.seeds(QUICK, mode)
            for seed, point in enumerate(fig10.runs(setup, mode, QUICK), 1):
                loss = dynamic
                if mode is fig10.STATIC:
                    loss += _tree(seed, count, gain, worst if setup == "setup-7" else gain)
                elif mode is fig10.EVEN:
                    loss += even
                elif mode is fig10.DYNAMIC:
                    loss += wild * (seed - 1)
                top = largest.get(mode, each / (1 - less))
                loads = [top] + [(cells - top) / (ports - 1)] * (ports - 1)
                found[point.key] = {
                    "beta": beta, "loss": loss, "loads": loads, "cells": cells,
                }  # fmt: skip
    return found


def _tree(seed, count, gain, worst):
    """The last tree gains most; the others make up for it."""
    return worst if seed == count else gain - (worst - gain) / (count - 1)


def _eq9(off=0.0, printed=1.0, wave=0.05):
    found = {}
    for updates in eq9.UPDATES:
        for hz in eq9.hz(QUICK):
            share = fig10.formulas.beacon_share(hz)
            value = share * (1 + (wave if updates == "wave" else off))
            if printed != 1.0 and updates == "periodic" and hz in eq9.PRINTED:
                value = eq9.PRINTED[hz] * (printed - 1)
            found[eq9.point(updates, hz).key] = value
    return found


def _fig11(ms=500.0, apart=1.0, fast=1.0, down=2000.0):
    found = {}
    for name, *_ in fig11.CASES:
        off = {"dynamic": apart, "static tree": 20.0}.get(name, 0.0)
        one = {
            "angle": [[0.0, 50.0, 0.0 + off], [0.0, 40.0, 0.0]],
            "speed_max": 10 * (fast if name == "dynamic" else 1),
            "unrouted_max": 3, "converged_ms": ms, "detected_ms": 400.0, "routed_ms": 400.0 + down,
        }  # fmt: skip
        found[fig11.runs(name, QUICK).key] = {what: [value] * 3 for what, value in one.items()}
    return found


def _loop(printed=0, lax=0, slower=0, cured=0):
    found = {}
    counts = (printed, lax, slower, cured, cured)
    rules = (loop.PRINTED, loop.LAX, loop.SLOWER, *loop.CURED)
    for rule, count in zip(rules, counts, strict=True):
        one = {"episodes": count, "longest_ms": 4.0 * count, "cells": 4}
        found[loop.loops(rule, QUICK).key] = {name: [value] * 5 for name, value in one.items()}
    return found


def _modes(wave=0.5, close=0.1, triggered=8.0, often=-0.2, longer=0):
    found = {}
    for setup, _, depth, _ in modes.SKINS:
        for k in modes.KS:
            floor = modes.floor_ms(k, depth)
            above = dict(
                zip(modes.MODES, (20.0, triggered, wave, close, wave + often), strict=True)
            )
            for mode, ms in above.items():
                one = modes.case(setup, k, mode)
                found |= recovered(one, modes.seeds(QUICK), (floor + ms) / one.period_ms)
        for variant in steady.VARIANTS:
            cells = longer if variant == steady.WAVE else 3
            found[steady.point(setup, variant, QUICK).key] = [[[cells] * 3] * 2] * 3
    return found
