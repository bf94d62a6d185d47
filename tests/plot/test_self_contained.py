"""Reports are one file: readable without the internet, and they say how to get them again."""

import base64
import re
import tomllib
from html import unescape
from html.parser import HTMLParser

import pytest

from innervate import run, scenario
from innervate.papers import main
from innervate.plot import report
from tests.export.test_captures import MESH, RADIO, SKIN

LOADS = {"src", "href", "srcset", "data", "poster", "action", "background", "xlink:href"}
TAGS = {"script", "link", "iframe", "object", "embed", "image", "use", "base", "meta-refresh"}
SLOTTED = {"kind": "radio", "stations": 5, "seed": 3, "duration_s": 60,
           "traffic": {"kind": "disaster"}, "channel": {"level": "slotted"},
           "protocol": {"mac": "csma-cd-r", "mode": "paper"}}  # fmt: skip
KINDS = {"skin": SKIN, "mesh": MESH, "radio": RADIO, "slotted": SLOTTED}
CHEAP = {"skin": "loop", "radio": "limits", "mesh": "stretch"}
NAMES = ("www.w3.org", "purl.org", "creativecommons.org", "matplotlib.org")  # none is loaded


class References(HTMLParser):
    """What a page would load, and what it holds."""

    def __init__(self, page):
        super().__init__()
        self.loads, self.tags = [], []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.loads += [value for name, value in attrs if name in LOADS and value[:1] != "#"]


def plain(page):
    """Its text."""
    return unescape(re.sub(r"<[^>]+>", "", page))


def loads_nothing(page):
    """What a page or picture holds; nothing in it is somewhere else."""
    found = References(page)
    assert [one for one in found.loads if not one.startswith("data:image/svg+xml;base64,")] == []
    assert not re.search(r"@import|url\((?!#|[\"']?data:)|<\?xml-stylesheet|http-equiv", page)
    outside = re.findall(r"https?://([^/\"' )<]+)", page)
    assert set(outside) <= set(NAMES)
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_a_report_needs_nothing_else_and_can_be_had_again(kind):
    done = run(KINDS[kind])
    page = report.render(done)
    found = loads_nothing(page)
    assert {"svg", "table", "pre"} <= set(found.tags)
    assert not TAGS & set(found.tags)
    assert found.loads == []
    assert "innervate run scenario.toml" in plain(page)
    blocks = [plain(block) for block in re.findall(r"<pre[^>]*>(.*?)</pre>", page, re.DOTALL)]
    told = next(block for block in blocks if "kind =" in block)
    assert tomllib.loads(told) == tomllib.loads(scenario.dump(done.scenario))
    assert done.summary["fingerprint"] in page


@pytest.mark.parametrize("paper", CHEAP)
def test_a_papers_page_needs_nothing_else_and_can_be_had_again(paper, tmp_path):
    """One figure of it, by the writer of all."""
    written = main(paper, tmp_path, quick=True, only=[CHEAP[paper]])
    page = written.read_text(encoding="utf-8")
    found = loads_nothing(page)
    assert {"img", "table", "pre"} <= set(found.tags)
    assert not TAGS & set(found.tags)
    assert len(found.loads) == 1
    for picture in found.loads:
        drawn = base64.b64decode(picture.partition(",")[2]).decode()
        assert "<svg" in drawn
        loads_nothing(drawn)
    assert f"innervate papers {paper} --quick --only {CHEAP[paper]}" in plain(page)
    keys = [line.partition('"key": "')[2].partition('"')[0]
            for line in (tmp_path / "results.jsonl").read_text().splitlines()]  # fmt: skip
    assert [key for key in keys if key and key not in plain(page)] == []
