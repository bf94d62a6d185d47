"""The page of a paper: what fails comes first, labels lead to sentences, nothing is cut off."""

import re
from html import unescape

import pytest

from innervate.networks.mesh.papers import READINGS as MESH
from innervate.networks.radio.papers import READINGS as RADIO
from innervate.networks.skin.papers import READINGS as SKIN
from innervate.papers import output
from innervate.papers.experiment import FAILS, HOLDS, Claim, reading


@pytest.fixture(scope="module")
def page(made):
    return (made.folder / "papers-skin.html").read_text(encoding="utf-8")


def test_every_link_leads_somewhere(page):
    targets = re.findall(r'href="#([^"]+)"', page)
    assert len(targets) > 30
    assert set(targets) <= set(re.findall(r' id="([^"]+)"', page))


def labels(row):
    return re.findall(r"\b[EF]\d+\b", f"{row.verdict} {row.reason}")


def test_every_label_in_the_claims_is_a_link_to_its_sentence(made, page):
    rows = [claim for claims in made.claims.values() for claim in claims]
    used = {label for row in rows for label in labels(row)}
    assert len(used) > 8
    for label in used:
        assert f'<a href="#{label}">{label}</a>' in page
        sentence = page.split(f'<dt id="{label}">')[1].split("<dd>")[1].split("</dd>")[0]
        assert unescape(re.sub("<[^>]+>", "", sentence)) == SKIN[label]


def test_what_does_not_hold_stands_at_the_top_of_the_page_and_of_each_figure(made, page):
    top = page.index("<h2>Does not hold</h2>")
    assert top < page.index("<h2>Contents</h2>") < page.index("<img ")
    failed = [row for claims in made.claims.values() for row in claims if row.verdict == FAILS]
    assert page[top : page.index("<h2>Contents</h2>")].count("<li>") == len(failed) > 5
    for table in page.split('<table class="claims">')[1:]:
        verdicts = re.findall(r'<b class="(bad|good)">', table.split("</table>")[0])
        assert verdicts == sorted(verdicts)  # "bad" before "good"


def test_the_contents_name_every_figure_and_how_many_claims_hold(made, page):
    contents = page[page.index("<h2>Contents</h2>") :].split("</section>")[0]
    for name, rows in made.claims.items():
        entry = contents.split(f'href="#{name}"')[1].split("</li>")[0]
        assert f"{sum(row.verdict != FAILS for row in rows)} hold" in entry


def test_failing_claims_keep_their_order():
    rows = [
        Claim("f", words, "1", verdict)
        for words, verdict in (("a", HOLDS), ("b", FAILS), ("c", reading("E1")), ("d", FAILS))
    ]
    assert [row.claim for row in output.failing_first(rows)] == ["b", "d", "a", "c"]


def test_only_labels_that_are_explained_are_links():
    assert output.linked("E1 <E2> E3x", {"E1": "one", "E2": "two"}) == (
        '<a href="#E1">E1</a> &lt;<a href="#E2">E2</a>&gt; E3x'
    )
    assert output.linked("E1", {}) == "E1"


def test_all_labels_have_a_sentence():
    assert list(SKIN) == [*(f"E{i}" for i in range(1, 35)), "F1", "F2", "F3"]
    assert list(RADIO)[:17] == [f"Q{i}" for i in range(1, 18)]
    assert list(MESH) == [f"A{i}" for i in range(1, 16)]
    for sentence in (*SKIN.values(), *RADIO.values(), *MESH.values()):
        assert sentence.endswith(".")
        assert len(sentence) > 30


def test_two_claims_never_read_the_same(made):
    said = [claim.claim for claims in made.claims.values() for claim in claims]
    assert len(said) == len(set(said))
