"""A skin's tables out of made-up measurements whose answers are known beforehand."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate.export.errors import ExportError
from innervate.export.measure import Way
from innervate.networks.skin.export import fit
from innervate.networks.skin.export.fit import Skin


def way(got=1000, lost=0, delays=()):
    made = Way(got, lost)
    made.delays_us.extend(delays)
    return made


def skin(ways, **more):
    """Cables "a-b": what is measured of one direction, or of both."""
    found = Skin(**more)
    for name, one in ways.items():
        a, b = name.split("-")
        there, back = one if isinstance(one, tuple) else (one, one)
        found.ways[a, b], found.ways[b, a] = there, back
    return found


def timing(delays_of):
    ways = {f"pc.{i}-c{i}.0": way(delays=delays) for i, delays in enumerate(delays_of)}
    return fit.tables_of(skin(ways))["timing"]


def test_evenly_drawn_latencies_come_back_as_their_range():
    # Each of 100 .. 200 us as often; whoever had to wait for a busy computer changes nothing.
    drawn = [float(us) for us in range(100, 201) for _ in range(10)]
    found = timing([drawn, [*drawn, 5_000.0, 80_000.0]])
    assert found["latency"] == "per_frame"
    low, high = found["hop_latency_us"]
    assert low == pytest.approx(100, abs=1)
    assert high == pytest.approx(200, abs=1)


def test_a_latency_of_its_own_a_cable_gives_the_range_of_the_cables():
    found = timing([[90.4] * 7, [140.0] * 9, [60.0, 60.0, 61.0, 61.9, 61.9]])
    assert found["hop_latency_us"] == [61, 140]  # the medians, 61 to 140
    assert "latency" not in found


@pytest.mark.parametrize(("spread", "per_frame"), [(2.0, False), (2.01, True)])
def test_delays_of_a_cable_that_differ_by_more_than_two_us_are_drawn_for_every_frame(
    spread, per_frame
):
    found = timing([[50.0] * 50 + [50.0 + spread] * 50, [70.0] * 10])
    assert ("latency" in found) == per_frame


@pytest.mark.parametrize(
    ("delay", "fitted"), [(0.2, 1), (1.4, 1), (99_999.0, 99_999), (100_001.0, 100_000)]
)
def test_a_latency_is_one_that_a_scenario_can_have(delay, fitted):
    assert timing([[delay] * 5])["hop_latency_us"] == [fitted, fitted]


def test_without_delays_no_latency_is_said():
    assert timing([[]]) == {"loss": 0.0}


# Six cables of 2000 frames; five lose 2 %: four deviations of such a loss are
# 4 * sqrt(0.02 * 0.98 / 2000) = 0.0125, so that a cable is loose above 0.0325: 65 frames.
@pytest.mark.parametrize(("lost", "is_loose"), [(64, False), (66, True), (300, True)])
def test_a_cable_is_loose_that_loses_more_than_chance_has_it(lost, is_loose):
    ways = {f"c{i}.1-c{i + 1}.0": way(980, 20) for i in range(5)}
    odd = way(1000 - lost // 2, lost // 2)
    tables = fit.tables_of(skin(ways | {"pc.1-c0.2": odd}))
    whole = (5 * 40 + lost) / 12_000
    if is_loose:
        assert tables["event"] == [
            {"at_s": 0.0, "action": "loose", "loss": lost / 2000, "interface": 1}
        ]
        assert tables["timing"]["loss"] == 0.02
    else:
        assert tables["event"] == []
        assert tables["timing"]["loss"] == round(whole, 5)


@pytest.mark.parametrize(("lost", "is_loose"), [(10, False), (11, True)])
def test_where_nothing_else_is_lost_a_hundredth_is_no_loose_cable_yet(lost, is_loose):
    ways = {f"c{i}.1-c{i + 1}.0": way() for i in range(4)}
    tables = fit.tables_of(skin(ways | {"pc.0-c0.2": way(500 - lost / 2, lost / 2)}))
    assert len(tables["event"]) == is_loose


def test_both_directions_of_a_cable_count_together():
    loose = (way(1000, 0), way(600, 400))
    tables = fit.tables_of(
        skin({"pc.0-c0.2": way(), "c0.1-c1.0": way(), "c1.1-c10.0": loose, "c1.3-c2.0": way()})
    )
    assert tables["event"] == [{"at_s": 0.0, "action": "loose", "loss": 0.2, "link": ["c1", "c10"]}]


def test_cables_are_in_order_of_ports_and_numbers_the_pcs_first():
    names = ["c10.0-c9.1", "c2.3-c1.0", "c1.2-pc.1", "c2.0-c9.0", "pc.0-c10.3"]
    tables = fit.tables_of(skin({name: way() for name in names}))
    pairs = [(one["a"], one["b"]) for one in tables["link"]]
    assert pairs == [("pc.0", "c10.3"), ("pc.1", "c1.2"), ("c1.0", "c2.3"), ("c2.0", "c9.0"),
                     ("c9.1", "c10.0")]  # fmt: skip


def test_ways_on_which_nothing_went_are_no_cables():
    tables = fit.tables_of(skin({"pc.0-c0.0": way(), "c0.1-c1.0": way(0, 0),
                                 "c0.2-c2.0": (way(0, 5), way(0, 0))}))  # fmt: skip
    assert [(one["a"], one["b"]) for one in tables["link"]] == [
        ("pc.0", "c0.0"), ("c0.2", "c2.0")]  # fmt: skip


@pytest.mark.parametrize(
    ("beacon_us", "told"), [(4000.0, {"beacon_hz": 250}), (3976.0, {"beacon_hz": 252}), (0.0, None)]
)
def test_rates_are_those_measured(beacon_us, told):
    tables = fit.tables_of(skin({"pc.0-c0.0": way()}, beacon_us=beacon_us, rate_hz=99.6))
    assert tables.get("protocol") == told
    assert tables["data"] == {"rate_hz": 100}


def test_a_skin_without_its_pc_is_none():
    with pytest.raises(ExportError, match="the PC was not captured"):
        fit.tables_of(skin({"c0.1-c1.0": way()}))


@pytest.mark.parametrize(("comment", "lost"), [("simulated", 0), ("live nodes", 1)])
def test_what_came_in_nowhere_was_lost_unless_the_capture_says_what_was(comment, lost):
    reader = fit.Reader(Path("capture.pcapng"), SimpleNamespace(comment=comment))
    reader.give_up(("c0.1", "c1.0"), SimpleNamespace(data=b""))
    assert reader.found.way("c0.1", "c1.0").lost == lost
