"""Networks drawn from one number: valid, the same again, and made smaller when one breaks."""

import pytest

from innervate import scenario
from innervate.run import wild


def test_what_is_drawn_can_nearly_always_be_run():
    refused = 0
    for seed in range(300):
        assert wild.drawn(seed) == wild.drawn(seed)
        try:
            scenario.plan(scenario.from_dict(wild.drawn(seed)))
        except scenario.ScenarioError:
            refused += 1
    assert refused == 0


@pytest.mark.parametrize("seed", [3, 5])
def test_nothing_breaks(seed):
    assert wild.attempt(seed) is None


def has_cut(tables):
    events = tables.get("event", [])
    return "there is a cut" if any(event["action"] == "cut" for event in events) else ""


def test_a_broken_network_is_made_small_and_can_be_played(tmp_path):
    seed = next(seed for seed in range(100) if has_cut(wild.drawn(seed)))
    before = wild.drawn(seed)

    def breaks(tables):
        scenario.plan(scenario.from_dict(tables))
        return has_cut(tables)

    found = wild.attempt(seed, breaks)
    assert [event["action"] for event in found.tables["event"]] == ["cut"]
    assert len(before["event"]) > 1
    assert found.tries < wild.TRIES
    path = found.save(tmp_path)
    assert path.read_text().startswith("# there is a cut\n")
    again = scenario.load(str(path))
    assert len(again.model.event) == 1
