"""Networks drawn from one number: valid, the same again, and made smaller when one breaks."""

import random
from collections import Counter

import pytest

from innervate import scenario
from innervate.running import fuzz


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
