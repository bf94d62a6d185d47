"""The ring's scenario on the page of `innervate watch`."""

import pytest

from innervate import scenario
from innervate.web import simulated
from innervate.web.engine import engine_of
from innervate.web.errors import Refused
from innervate.web.messages import Cut, Heal, Kill, Save
from innervate.web.simulated import Simulated
from tests.browser.conftest import browser, look
from tests.browser.servers import PHONE, beside, click, expect, serving
from tests.browser.test_design import DRAWN

__all__ = ["browser", "look"]
RING = 'kind = "tokenring"\nname = "round"\nnodes = 6\nduration_s = 60\nlost_us = 50_000\n'


@pytest.fixture
def source():
    made = Simulated(scenario.plan(scenario.from_dict({"kind": "tokenring", "nodes": 6})))
    made.prepare()
    return made


def test_its_nodes_show_what_they_declare(source):
    scene = source.scene()
    assert [field["name"] for field in scene["fields"]] == ["lap", "passed", "made_at"]
    assert {field["unit"] for field in scene["fields"]} == {"number", "tokens", "us"}
    assert [node["label"] for node in scene["nodes"]] == [f"n{i}" for i in range(6)]
    assert len({(node["x"], node["y"]) for node in scene["nodes"]}) == 6
    assert "save" not in scene["can"]
    source.run_to_end()
    state = source.fields()
    passed = state["fields"]["passed"]
    assert sum(passed) == source.engine.running.counts().sent > 100
    assert max(passed) - min(passed) <= 1
    assert state["headline"]["level"] == "ok"


def test_its_cables_are_cut_and_its_nodes_switched_off(source):
    source.do(Cut(0))
    assert source.fields()["link_up"].tolist() == [0, 1, 1, 1, 1, 1]
    assert source.fields()["unconnected"] == 0  # the other way round
    with pytest.raises(Refused, match="cut already"):
        source.do(Cut(0))
    source.do(Cut(3))
    assert source.fields()["unconnected"] > 0
    source.do(Heal(3))
    source.do(Kill(2))
    assert source.fields()["node_up"].tolist() == [1, 1, 0, 1, 1, 1]
    with pytest.raises(Refused, match="off already"):
        source.do(Kill(2))
    with pytest.raises(Refused, match="writes its events"):
        source.do(Save())
    source.run_to_end()
    assert source.fields()["headline"]["level"] == "degraded"


def test_a_cable_is_cut_however_short_a_slice_is(source, monkeypatch):
    """On a busy machine a slice of wall time was over before the cut was there."""
    monkeypatch.setattr(simulated, "SLICE_S", 0)
    monkeypatch.setattr(source, "_budget", 1)
    source.do(Cut(0))
    assert source.fields()["link_up"].tolist() == [0, 1, 1, 1, 1, 1]


def test_what_is_watched_is_what_is_run(source):
    source.run_to_end()
    plan = source.plan
    running = engine_of(plan).running
    running.finish()
    assert source.engine.running.fingerprint == running.fingerprint


@pytest.mark.flaky(reruns=1)  # as all that a browser looks at
def test_a_network_that_does_not_say_who_has_a_way(look, tmp_path):
    """Who is cut off is known from its cables; when it has recovered nobody says."""
    path = tmp_path / "round.toml"
    path.write_text('kind = "tokenring"\nnodes = 5\nduration_s = 119.7\n')
    with beside(path, 0.1) as address:
        page = look(address)
        label = page.locator("#unconnected .label")
        expect(label).to_have_text("cut off")
        expect(page.locator("#clock")).to_contain_text("/ 1:59.7 min")
        for cable in ("n0 - n1", "n0 - n4"):
            click(page, cable, "link, cut")
        expect(page.locator("#unconnected output")).to_have_text("4")
        expect(page.locator("#unconnected .more")).to_have_text("of 5 nodes")
        expect(page.locator("#recovery")).to_be_hidden()
        page.set_viewport_size(PHONE)
        page.evaluate(DRAWN)
        row, last = (page.locator(one).bounding_box() for one in ("#numbers", "#unconnected"))
        right, end = (one["x"] + one["width"] for one in (row, last))
        assert abs(end - right) < 1  # two numbers fill the row, as three do


@pytest.mark.slow
def test_a_cable_is_cut_by_a_click(look, tmp_path):
    path = tmp_path / "round.toml"
    path.write_text(RING)
    with serving(path, "--speed", 0.05) as address:
        page = look(address)
        expect(page.locator("#colour option")).to_have_text(["lap", "passed", "made_at"])
        expect(page.locator("#level")).to_have_text("✓ ok")
        click(page, "n0 - n1", has="cut")
        expect(page.locator("#log")).to_contain_text("cable n0 E - n1 W cut")
        expect(page.locator("#level")).to_have_text("! degraded")
        click(page, "n0 - n1", "link, up")
        click(page, "n3", has="switched off")
        page.locator("#colour").select_option("passed")
        expect(page.locator("#unconnected .more")).to_have_text("of 6 nodes")
