"""Networks drawn from one number: valid, the same again, and made smaller when one breaks."""

import random
from collections import Counter
from itertools import product

import pytest

from innervate import scenario
from innervate.networks.mesh.verify import fuzz as mesh_fuzz
from innervate.networks.radio.verify import fuzz as radio_fuzz
from innervate.networks.skin.verify import fuzz as skin_fuzz
from innervate.running import fuzz
from innervate.scenario.errors import ScenarioError

EVERYTHING = [
    (skin_fuzz, lambda tables: tables["protocol"]["k"], range(1, 9)),
    (skin_fuzz, lambda tables: tables["patch"][0]["columns"], range(1, 9)),
    (skin_fuzz, lambda tables: tables["patch"][0]["rows"], range(1, 9)),
    (radio_fuzz, lambda tables: tables["packet_slots"], (3, 5, 25)),
    (radio_fuzz, lambda tables: tables["stations"], range(2, 21)),
    (mesh_fuzz, lambda tables: tables["nodes"], range(3, 25)),
    (mesh_fuzz, lambda tables: tables["protocol"]["tables"], (False, True)),
    (mesh_fuzz, lambda tables: tables["protocol"]["mtu"], (64, 127)),
    (mesh_fuzz, lambda tables: "fence" in tables, (False, True)),
]


@pytest.mark.parametrize(("of", "value", "values"), EVERYTHING)
def test_whatever_can_be_drawn_is_drawn_and_nothing_else(of, value, values):
    draw = random.Random(1)
    assert {value(of.drawn(draw, seed)) for seed in range(300)} == set(values)


def test_what_is_drawn_happens_where_it_can():
    draw = random.Random(1)
    events = [event for seed in range(50) for event in mesh_fuzz.drawn(draw, seed)["event"]]
    for event in events:
        assert ("link" in event) == (event["action"] in ("cut", "restore"))
        assert ("node" in event) != ("link" in event)


@pytest.mark.parametrize(("columns", "rows"), [(1, 2), (1, 4), (2, 1), (3, 1), (3, 3)])
def test_a_cell_beside_another_is_on_the_patch(columns, rows):
    for row, column in product(range(rows), range(columns)):
        cell = {"row": row, "column": column}
        other = skin_fuzz._beside(random.Random(1), cell, columns, rows)
        assert abs(other["row"] - row) + abs(other["column"] - column) == 1
        assert 0 <= other["row"] < rows
        assert 0 <= other["column"] < columns


def test_a_share_that_no_network_has_is_said(monkeypatch):
    monkeypatch.setattr(fuzz, "networks", dict)
    with pytest.raises(LookupError, match="no network has this share"):
        fuzz.drawn(1)


def test_what_is_drawn_can_nearly_always_be_run():
    drawn = [fuzz.drawn(seed) for seed in range(300)]
    for tables in drawn:
        scenario.plan(scenario.from_dict(tables))
    random.seed(1)  # nothing else draws along
    assert drawn == [fuzz.drawn(seed) for seed in range(300)]
    assert len({repr(tables | {"seed": 0, "name": ""}) for tables in drawn}) == 300
    kinds = Counter(tables["kind"] for tables in drawn)
    # A quarter, a half and a quarter, within three deviations of 300 draws.
    assert abs(kinds["radio"] - 75) < 23
    assert abs(kinds["skin"] - 150) < 26
    assert abs(kinds["mesh"] - 75) < 23


@pytest.mark.parametrize("seed", [3, 5, 7, 12])  # two skins, two meshes
def test_nothing_breaks(seed):
    assert fuzz.attempt(seed) is None


def has_cut(tables):
    events = tables.get("event", [])
    return "there is a cut" if any(event["action"] == "cut" for event in events) else ""


def test_a_broken_network_is_made_small_and_can_be_played(tmp_path):
    seed = next(seed for seed in range(100) if has_cut(fuzz.drawn(seed)))
    before = fuzz.drawn(seed)

    def breaks(tables):
        scenario.plan(scenario.from_dict(tables))
        return has_cut(tables)

    found = fuzz.attempt(seed, breaks)
    assert [event["action"] for event in found.tables["event"]] == ["cut"]
    assert len(before["event"]) > 1
    assert found.tries < fuzz.TRIES
    path = found.save(tmp_path)
    assert path.read_text().startswith("# there is a cut\n")
    again = scenario.load(str(path))
    assert len(again.model.event) == 1


def test_what_cannot_be_planned_any_more_is_passed_over_while_a_network_is_made_small():
    """Of four events each alone cannot be; two of them break it."""
    tried = []

    def breaks(tables):
        at = [event["at_s"] for event in tables["event"]]
        tried.append(at)
        if len(tried) in (1, 3) or len(at) < 2:
            raise ScenarioError("there is no such cable")
        return "both" if {0.2, 0.3} <= set(at) else ""

    events = [{"at_s": at, "action": "cut", "interface": 0} for at in (0.1, 0.2, 0.3, 0.4)]
    begun = {"kind": "skin", "duration_s": 1.0, "patch": [{"rows": 2, "columns": 2}]}
    small, tries = fuzz.shrink(begun | {"event": events}, breaks)
    assert [event["at_s"] for event in small["event"]] == [0.2, 0.3]
    assert tries == len(tried) > 4


def test_a_broken_mesh_is_made_small():
    def breaks(tables):
        scenario.plan(scenario.from_dict(tables))
        dies = any(e["action"] == "kill" and e["node"] < 5 for e in tables["event"])
        return "somebody dies" if dies and "robot" not in tables else ""

    def is_wanted(tables):
        return tables["kind"] == "mesh" and tables["nodes"] > 15 and breaks(tables)

    seed = next(seed for seed in range(400) if is_wanted(fuzz.drawn(seed)))
    found = fuzz.attempt(seed, breaks)
    assert [event["action"] for event in found.tables["event"]] == ["kill"]
    assert found.tables["nodes"] < 15
    assert [flow["count"] for flow in found.tables["flow"]] == [1]
    assert found.tables["duration_s"] < 2 * found.tables["event"][0]["at_s"] + 2


def test_an_event_of_a_drawn_skin_is_of_a_cable_only_where_there_are_some():
    drawn = [skin_fuzz._skin_event(random.Random(seed), 2.0, *size) for seed in range(300)
             for size in ((1, 1, False), (3, 2, True))]  # fmt: skip
    alone, several = drawn[::2], drawn[1::2]
    assert {"cell", "interface"} <= {key for event in alone for key in event}
    assert not [event for event in alone if "link" in event]
    links = [event["link"] for event in several if "link" in event]
    assert len(links) > 50
    for a, b in links:
        assert abs(a["row"] - b["row"]) + abs(a["column"] - b["column"]) == 1
    assert all(0.1 <= event["at_s"] <= 1.8 for event in drawn)
