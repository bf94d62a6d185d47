"""What a page has to be: one file that loads nothing, and says how it can be had again."""

import base64
import re
from html import unescape
from html.parser import HTMLParser

LOADS = {"src", "href", "srcset", "data", "poster", "action", "background", "xlink:href"}
TAGS = {"script", "link", "iframe", "object", "embed", "image", "use", "base"}
NAMES = {"www.w3.org", "purl.org", "creativecommons.org", "matplotlib.org"}  # none is loaded
PICTURE = "data:image/svg+xml;base64,"


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
    """What a page or picture holds, once it is sure that nothing of it is somewhere else.

    And that no table has a column without a head, for who listens to it.
    """
    found = References(page)
    assert [one for one in found.loads if not one.startswith(PICTURE)] == []
    assert not re.search(r"@import|url\((?!#|[\"']?data:)|<\?xml-stylesheet|http-equiv", page)
    assert all(plain(head).strip() for head in re.findall(r"<th[^>]*>(.*?)</th>", page, re.DOTALL))
    assert set(re.findall(r"https?://([^/\"' )<]+)", page)) <= NAMES
    return found


def check_paper(made, system, command):
    """Hold the page of a paper against all that was run for it."""
    page = (made.folder / f"papers-{system}.html").read_text(encoding="utf-8")
    found = loads_nothing(page)
    assert {"img", "table", "pre"} <= set(found.tags)
    assert not TAGS & set(found.tags)
    assert len(found.loads) == len(made.experiments)
    for picture in found.loads:
        drawn = base64.b64decode(picture.removeprefix(PICTURE)).decode()
        assert "<svg" in drawn
        loads_nothing(drawn)
    said = plain(page)
    assert command in said.splitlines()
    keys = {point.key for one in made.experiments.values() for point in one.points(made.quick)}
    lines = set(said.splitlines())
    for key in keys:  # runs that differ by their seeds alone have a line together
        assert key in lines or re.sub(r"seed \d+$", "a run a seed", key) in lines, key
    assert keys <= set(made.values)
