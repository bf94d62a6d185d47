import re
import signal
import xml.etree.ElementTree as ET
from html.parser import HTMLParser

import pytest

from innervate import run
from innervate.networks.skin.plot.digest import Digest
from innervate.networks.skin.show import summary_lines
from innervate.plot import report
from innervate.sim.driver import Simulation

VOID = {"meta", "link", "br", "hr", "img", "input"}
BIG = 2_000_000


class Balanced(HTMLParser):
    """Fails on tags that do not match."""

    def __init__(self):
        super().__init__()
        self.open, self.words = [], []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if not self.open or self.open[-1] not in ("style", "script"):
            self.words.append(data)


def read(page):
    """The words of a page; fails if its HTML or one of its drawings is not well formed."""
    parser = Balanced()
    parser.feed(page)
    assert parser.open == []
    drawings = re.findall(r"<svg .*?</svg>", page, re.DOTALL)
    assert drawings
    for drawing in drawings:
        ET.fromstring(drawing)
    assert not re.search(r"\bnan\b|\binf\b", page.lower())
    assert len(page) < BIG
    return " ".join("".join(parser.words).split())


def test_what_an_engineer_asks_first(cut):
    words = read(report.render(cut))
    recovery = cut.summary["recoveries"][0]
    assert "Cable to interface 1 cut at 0.300 s: noticed after" in words
    assert f"every cell had a way again after {recovery['routed_ms']:.1f} ms" in words
    since = cut.summary["broken"][0]["since_s"]
    assert f"Broken at the end: cable from interface 1 to p0 r5 c3 down, since {since:.3f}" in words
    assert "innervate run scenario.toml" in words
    assert cut.summary["fingerprint"] in words
    assert 'action = "cut"' in words


def test_nothing_is_fetched_and_nothing_runs(cut):
    page = report.render(cut)
    assert set(re.findall(r"https?://[^\"' )<]+", page)) == {"http://www.w3.org/2000/svg"}
    assert "<script" not in page
    assert "url(" not in page


def test_names_are_escaped(cut):
    page = report.render(cut)
    assert "<Arm>" not in page
    assert '<Arm> & "hand"' in read(page)


def test_every_kind_of_event(many):
    words = read(report.render(many))
    assert "cell p0 r2 c2 switched off" in words
    assert "And 6 more events, listed below." in words
    assert "the PC restarted" in words


def test_pictures_of_the_worst_event(cut):
    digest = Digest(cut.result, cut.summary)
    assert [panel.head for panel in digest.maps()] == [
        "Before", "The worst moment", "On the way back", "Afterwards",
    ]  # fmt: skip
    before, during, after = digest.images()
    assert before.text == after.text == "all samples came"
    lost = int(re.match(r"nothing from (\d+) of 30 cells", during.text)[1])
    assert 0 < lost <= cut.summary["recoveries"][0]["cut_cells"]


def test_samples_that_were_not_kept_are_told_where_they_are_missed():
    """Of very many samples there is neither a table nor a picture of touch."""
    skin = {"kind": "skin", "duration_s": 0.5, "patch": [{"rows": 2, "columns": 2}],
            "interface": [{"row": 0, "column": 0}]}  # fmt: skip
    said = "Samples were counted, not kept: no received.parquet, no pictures of touch"
    for rate_hz, kept, missed in ((20, False, True), (20, True, False), (0, None, False)):
        done = run(skin | {"data": {"rate_hz": rate_hz}}, received=kept)
        assert (said in read(report.render(done))) == missed
        assert any(line.startswith(said) for line in summary_lines(done)) == missed


def test_a_cut_cable_and_lost_cells_are_marked_by_shape(cut, parse):
    digest = Digest(cut.result, cut.summary)
    before, worst, _, after = (parse(panel.drawing) for panel in digest.maps())

    def count(tree, kind):
        return sum(node.get("class") == kind for node in tree.iter())

    assert (count(before, "cut"), count(before, "lack"), count(before, "none")) == (0, 0, 0)
    assert (count(worst, "cut"), count(worst, "lack")) == (1, 1)
    assert count(worst, "none") == cut.summary["recoveries"][0]["cut_cells"]
    assert (count(after, "cut"), count(after, "none")) == (1, 0)


@pytest.mark.parametrize(
    "changes",
    [
        {"event": []},
        {"event": [], "interface": [{"row": 0, "column": 1}]},
        {"data": {"rate_hz": 0}},
        {"touch": None},
        {"patch": [{"columns": 1, "rows": 1}], "interface": [{"row": 0, "column": 0}], "event": []},
        {"duration_s": 0.001, "event": []},
        {"duration_s": 0.301},
        {"protocol": {"rule": "static", "restart_s": 0.1}},
        {"protocol": {"rule": "paper", "updates": "periodic"}},
    ],
    ids=["quiet", "one port", "no data", "no touch", "one cell", "short", "cut off", "static",
         "paper"],
)  # fmt: skip
def test_unusual_runs(tables, changes):
    wanted = {k: v for k, v in tables(**changes).items() if v is not None}
    read(report.render(run(wanted)))


def test_captions_count_the_cells_that_are_crossed_out(tables, parse):
    both = [{"at_s": 0.3, "action": "cut", "interface": i} for i in (0, 1)]
    done = run(tables(event=both))
    text = read(report.render(done))
    assert "All 30 cells are cut off since 0.300 s: no cable joins them with the PC" in text
    assert "down" in text
    assert "kept its way" not in text
    worst = Digest(done.result, done.summary).maps()[1]
    assert worst.text.endswith("30 cells without a way, all cut off")
    assert sum(node.get("class") == "none" for node in parse(worst.drawing).iter()) == 30


def test_events_of_one_moment_are_followed_until_a_later_one_comes(tables):
    both = [{"at_s": 0.3, "action": "cut", "interface": i} for i in (0, 1)]
    done = run(tables(event=[*both, {"at_s": 0.4, "action": "restore", "interface": 1}]))
    digest = Digest(done.result, done.summary)
    *_, worst, last = digest.maps()
    assert worst.head == "The worst moment"  # and nobody is on the way back
    assert last.head == "Still so when the next event came"
    assert last.text.startswith("100.0 ms after the event: 30 cells without a way")
    assert len(digest.zooms()) == 2  # one of the cuts, one of the cable that is put back


def test_a_cell_that_is_off_is_told_in_captions(tables):
    event = [{"at_s": 0.3, "action": "kill", "cell": {"row": 5, "column": 3}}]
    done = run(tables(event=event))
    captions = [panel.text for panel in Digest(done.result, done.summary).maps()]
    assert captions[-1].endswith("no cell without a way, 1 switched off")


def test_free_graphs(tables):
    links = [{"a": "left", "b": "pc.0"}, {"a": "left", "b": "right"}, {"a": "right", "b": "pc.1"}]
    wanted = tables(link=links, event=[{"at_s": 0.3, "action": "cut", "link": ["left", "right"]}])
    del wanted["patch"], wanted["interface"]
    assert "Cable left" in read(report.render(run(wanted)))


def test_a_robots_skin():
    pytest.importorskip("icub_models")
    read(report.render(run("icub-forearm", overrides={"duration_s": 2.1})))


@pytest.mark.parametrize("count", [20, 60])
def test_large_skins_stay_readable(tables, count):
    patch = {"columns": 6, "rows": 10, "count": count, "interfaces_every": 1}
    wanted = tables(patch=[patch], interface=[], data={"rate_hz": 20})
    page = report.render(run(wanted))
    assert "Cable to interface 1 cut" in read(page)
    assert len(page) < BIG / 2


def test_an_interrupted_run_says_so(tables, monkeypatch):

    monkeypatch.setattr(Simulation, "slice_events", 10_000)
    done = run(tables(), progress=lambda now, end: signal.raise_signal(signal.SIGINT))
    assert done.interrupted
    assert "Ended early, at" in read(report.render(done))
