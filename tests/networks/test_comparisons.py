"""What Babel, RPL and flooding are given of a case of another network's job, and what they say."""

from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.network import networks
from innervate.networks.babel import comparison as babel
from innervate.networks.babel.measures import measures
from innervate.networks.babel.protocol.constants import REPORT_DROP, REPORT_LINK, REPORT_ROUTE
from innervate.networks.babel.protocol.fields import DEFAULTS
from innervate.networks.flooding import comparison as flooding
from innervate.networks.rpl import comparison as rpl
from innervate.networks.rpl.protocol.constants import INFINITE
from innervate.networks.rpl.shows import depth
from innervate.papers import cabled
from innervate.web.declared_view import shown_by

# A cable that has the PC at its far end, one that has it at its near end, and two without it.
CASE = {"cables": [["c0.1", "c1.0"], ["c2.2", "pc.0"], ["pc.1", "c0.3"], ["c1.1", "c2.0"]],
        "beacon_us": 20_000, "k": 4, "loss": 0.125, "harm": "cut", "settle": 30,
        "watch": 25}  # fmt: skip


def test_babel_has_the_cases_cables_with_the_pc_first():
    made = babel.tables(CASE, 3, margin=7)
    assert made["cables"] == ["hub.0-c2.2", "hub.1-c0.3", "c0.1-c1.0", "c1.1-c2.0"]
    assert (made["kind"], made["seed"], made["drift_ppm"]) == ("babel", 3, 1000)
    assert (made["start_us"], made["links"]) == (20_000, {"loss": 0.125})


def test_babels_times_are_in_proportion_to_its_hellos():
    made = babel.tables(CASE, 3, margin=7)["protocol"]
    times = {name for name in DEFAULTS if name.endswith("_us")}
    assert set(made) == {*times, "margin"}
    assert (made["hello_us"], made["margin"]) == (20_000, 7)
    for name in times:
        assert made[name] == DEFAULTS[name] * 20_000 // DEFAULTS["hello_us"]
    assert babel.tables(CASE, 3, hello_us=9)["protocol"]["hello_us"] == 9


@pytest.mark.parametrize("seed", range(1, 7))
def test_a_cut_of_babel_is_of_a_cable_of_the_pc_at_the_moment_that_all_have(seed):
    harm, made = cabled.drawn(CASE, seed), babel.tables(CASE, seed)
    (event,) = made["event"]
    assert event["at_s"] == harm.at_us / 1e6
    names = {1: "c2-hub", 2: "hub-c0"}
    assert (event["action"], event["link"]) == ("cut", names[harm.cables[0]])
    assert made["duration_s"] == (harm.at_us + 25 * 20_000) / 1e6


def test_who_dies_in_babel_is_whom_the_case_says():
    given = CASE | {"harm": "death"}
    (who,) = cabled.drawn(given, 2).nodes
    (event,) = babel.tables(given, 2)["event"]
    assert cabled.wiring(given).names[who] == "c1"  # the only one two hops from the PC
    order = ["hub", "c2", "c0", "c1"]  # as its cables name them
    assert (event["action"], order[event["node"]]) == ("kill", "c1")
    assert babel.tables(CASE | {"harm": "none"}, 2)["event"] == []


class Ran:
    """A run that left these rows; nodes are numbered as its own cables name them."""

    def __init__(self, rows):
        kinds = [(name, int) for name in ("time", "node", "code", "a", "b")]
        self.rows = {"rows": np.array(rows, kinds)}
        self.counts = Of(sent=77)


def test_what_babel_reports_is_told_of_the_cases_nodes(monkeypatch):
    rows = [(5, 1, REPORT_ROUTE, 2, 0), (6, 3, REPORT_ROUTE, -1, 0), (7, 2, REPORT_DROP, 0, 0),
            (8, 1, REPORT_LINK, 2, 1), (9, 2, REPORT_LINK, 1, 0)]  # fmt: skip
    monkeypatch.setattr(babel, "simulate", lambda plan, checks: Ran(rows))
    monkeypatch.setattr(babel.cabled, "measured", lambda *given: given)
    given, harm, changes, downs, sent = babel.measure(CASE, 4)
    number = cabled.wiring(CASE).number
    assert changes == [(5, number["c2"], 2), (6, number["c1"], -1)]
    assert (given, harm, downs, sent) == (CASE, cabled.drawn(CASE, 4), [9], 77)


def test_babel_does_the_job_in_three_settings(monkeypatch):
    monkeypatch.setattr(babel, "measure", lambda given, seed, **protocol: (seed, protocol))
    assert babel.with_k(CASE, 5) == (5, {"up_least": 1, "up_of": 4})
    etx = {"etx": 1, "up_least": 1, "up_of": 6, "nominal": 256, "margin": 256}
    assert babel.etx(CASE, 6) == (6, etx)
    assert [one.name for one in babel.ENTRIES] == ["Babel, 2 of 3", "Babel, 1 of k", "Babel, ETX"]
    assert [one.measure.__name__ for one in babel.ENTRIES] == ["measure", "with_k", "etx"]
    assert {one.job for one in babel.ENTRIES} == {"skin"}


@pytest.mark.parametrize(
    ("room", "settings", "alarm"),
    [
        (rpl, {"RPL, storing": {"storing": 1, "root": 9}, "RPL, non-storing":
               {"storing": 0, "root": 9}}, (2, {})),
        (flooding, {"flooding, 7 hops": {"hops": 7}, "flooding, 3 hops": {"hops": 3}},
         (1, {"dest": 255})),
    ],
)  # fmt: skip
def test_what_networks_over_a_field_are_run_with(monkeypatch, room, settings, alarm):
    kind, world = room.__package__.rpartition(".")[2], Of(gateway=9)
    monkeypatch.setattr(room, "world_of", lambda given, seed: (given, seed) == ({}, 4) and world)
    monkeypatch.setattr(room, "run_declared", lambda *given: given)
    found = {one.name: one.measure({}, 4) for one in room.ENTRIES}
    inputs = {False: (1, {}), True: alarm}
    assert found == {name: (kind, given, inputs, world) for name, given in settings.items()}
    assert {one.job for one in room.ENTRIES} == {"mesh"}


def test_what_a_run_of_babel_measures():
    nodes = [Of(parent=-1), Of(parent=0), Of(parent=2)]
    rows = [{"code": code, "b": b} for code, b in
            ((REPORT_ROUTE, 0), (REPORT_ROUTE, 3), (REPORT_ROUTE, 1), (REPORT_DROP, 0),
             (REPORT_LINK, 1), (REPORT_LINK, 0), (REPORT_LINK, 0))]  # fmt: skip
    assert measures(nodes, rows, [], None) == {
        "routed_nodes": 2, "route_changes": 3, "lost_links": 2, "dropped_data": 1,
    }  # fmt: skip


@pytest.mark.parametrize(("rank", "far"), [(256, 0.0), (384, 0.5), (768, 2.0), (INFINITE, -1.0)])
def test_how_far_a_node_of_rpl_is_from_the_root(rank, far):
    assert depth(Of(rank=rank), Of(step=256)) == far


@pytest.mark.parametrize("mark", ["key_kind", "link_type"])
def test_no_two_networks_have_the_same_mark(mark):
    marks = [getattr(one, mark) for one in networks().values() if getattr(one, mark)]
    assert len(marks) >= 5
    assert len(set(marks)) == len(marks)


def test_rpl_and_flooding_lie_over_a_channel_that_is_sensed_and_rpl_shows_how_far_a_node_is():
    nets = networks()
    assert [nets[name].over for name in ("rpl", "flooding", "babel")] == ["csma", "csma", ""]
    assert [nets[name].medium for name in ("rpl", "flooding", "babel")] == [
        "field", "field", "cables"]  # fmt: skip
    assert list(nets["rpl"].shows) == ["distance to the root"]
    assert shown_by(nets["rpl"])[0][0]["name"] == "distance to the root", "pages open with it"
