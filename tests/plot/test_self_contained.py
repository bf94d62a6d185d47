"""A run's report is one file: readable without the internet, and it says how to get it again."""

import re
import tomllib
from html import unescape
from html.parser import HTMLParser

import pytest

from innervate import run, scenario
from innervate.plot import report
from tests.export.test_captures import MESH, RADIO, SKIN

LOADS = {"src", "href", "srcset", "data", "poster", "action", "background", "xlink:href"}


class References(HTMLParser):
    """What a page would load, and what it holds."""

    def __init__(self, page):
        super().__init__()
        self.loads, self.tags = [], []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.loads += [value for name, value in attrs if name in LOADS and value[:1] != "#"]


@pytest.mark.parametrize("keys", [SKIN, MESH, RADIO], ids=["skin", "mesh", "radio"])
def test_a_report_needs_nothing_else_and_can_be_had_again(keys, tmp_path):
    done = run(keys)
    page = report.render(done)
    found = References(page)
    assert [one for one in found.loads if not one.startswith("data:")] == []
    assert {"svg", "table", "pre"} <= set(found.tags)
    assert not {"script", "link", "iframe", "object", "embed"} & set(found.tags)
    outside = set(re.findall(r"https?://[^\"' )<]+", page))
    assert outside <= {"http://www.w3.org/2000/svg"}  # a name, not loaded
    assert not re.search(r"@import|url\((?!#|[\"']?data:)", page)
    assert "innervate run scenario.toml" in unescape(re.sub(r"<[^>]+>", "", page))
    blocks = [unescape(re.sub(r"<[^>]+>", "", block))
              for block in re.findall(r"<pre[^>]*>(.*?)</pre>", page, re.DOTALL)]  # fmt: skip
    told = next(block for block in blocks if "kind =" in block)
    assert tomllib.loads(told) == tomllib.loads(scenario.dump(done.scenario))
    assert done.summary["fingerprint"] in page
