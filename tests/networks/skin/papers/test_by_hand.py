"""What figures of the skin work out, of cables and times that are written here."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.skin.papers import fig5, fig6, fig8a, loop


@pytest.mark.parametrize(("changes", "share"), [
    ([], 0.0), ([(3.0, 0, 1)], 0.5), ([(3.0, 0, 1), (3.5, 0, 0)], 0.25), ([(0.5, 0, 1)], 1.0),
    ([(0.5, 0, 1), (0.9, 0, 0)], 0.0), ([(0.5, 0, 1), (2.5, 0, 0)], 0.25), ([(2.5, 0, 0)], 0.0),
    ([(2.5, 0, 1), (3.0, 0, 0), (3.5, 0, 1)], 0.5), ([(2.5, 1, 1), (3.0, 0, 1)], 0.5),
])  # fmt: skip
def test_for_which_share_of_a_sweep_its_cable_is_held_broken(monkeypatch, changes, share):
    """From 2 to 4 s; what an end of another cable holds does not count."""
    times, ends, broken = zip(*changes, strict=True) if changes else ((), (), ())
    found = Of(time_us=[at * 1e6 for at in times], end=ends, broken=broken)
    monkeypatch.setattr(fig6, "broken_changes", lambda _: found)
    assert fig6._broken_share(None, 2.0, 4.0) == pytest.approx(share)


@pytest.mark.parametrize(("quick", "count", "step"), [(True, 6, 0.2), (False, 26, 0.04)])
def test_losses_of_a_sweep_go_from_none_to_all(quick, count, step):
    losses = fig6.losses(quick)
    assert losses == pytest.approx([step * i for i in range(count)])
    assert losses[-1] == 1.0


@pytest.mark.parametrize("quick", [True, False])
def test_the_bar_is_asked_for_at_the_highest_rate(monkeypatch, quick):
    asked = []
    monkeypatch.setattr(fig8a, "_band", lambda *_: "a band")
    monkeypatch.setattr(fig8a, "off_band", lambda got, rule, hz, k: asked.append((hz, k)) or [0.0])
    monkeypatch.setattr(fig8a.IN_BAND.__class__, "share", lambda *_: 1.0)
    *bands, bar = [next(claims) for claims in [fig8a.judge(Of(quick=quick))]
                   for _ in range(len(fig8a.RULES) + 1)]  # fmt: skip
    assert bands == ["a band"] * len(fig8a.RULES)
    assert asked == [(250, k) for k in fig8a.BAR_K]
    assert bar.claim.startswith("feasible at 250 Hz")


@pytest.mark.parametrize(("rows", "counted"), [
    ([], (0, 0.0, 0)), ([(1_000, 3_500, 3)], (1, 2.5, 3)),
    ([(1_000, 3_500, 3), (2_000, -1, 2)], (2, 7.0, 3)),
    ([(1_000, 3_500, 2), (2_000, 3_000, 5)], (2, 2.5, 5)),
])  # fmt: skip
def test_a_loop_that_nobody_broke_stood_until_the_end(monkeypatch, rows, counted):
    columns = np.array(rows, np.int64).reshape(-1, 3).T
    found = Of(**dict(zip(("opened_us", "closed_us", "length"), columns, strict=True)))
    monkeypatch.setattr(loop, "loop_episodes", lambda result: found)
    monkeypatch.setattr(loop, "simulate", lambda plan: Of(ended_us=9_000))
    told = loop.count(Of(plan=lambda seed: None), 1)
    assert tuple(told[name] for name in ("episodes", "longest_ms", "cells")) == counted


def test_a_timeline_says_who_took_whom_as_parent_in_periods_from_the_cut(monkeypatch):
    """The PC by its port; what came before the cut as at it."""
    graph = Of(sink=9, peer={4: 36, 5: 21, 8: 17}, node_of=lambda end: end // 4,
               port_of=lambda end: end % 4, label=lambda node: f"n{node}")  # fmt: skip
    found = Of(time_us=[1_900_000.0, 2_004_000.0, 2_012_345.6], cell=[1, 1, 2], old=[-1, 0, 0],
               new=[0, 1, -1])  # fmt: skip
    asked = []
    monkeypatch.setattr(
        fig5,
        "simulated",
        lambda tables, seed: asked.append((tables, seed)) or Of(plan=Of(graph=graph)),
    )
    monkeypatch.setattr(fig5, "parent_changes", lambda result: found)
    assert fig5.parents_after_cut() == {"events": [
        [0.0, "n1", "", "PC 0"], [1.0, "n1", "PC 0", "n5"], [3.086, "n2", "n4", ""]]}  # fmt: skip
    assert asked == [(fig5.tables(5, 1, True), 1)]
