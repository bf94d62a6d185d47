"""Whose claims the rows are: the document's in its own words, all others ours."""

import re

import pytest

from innervate.networks.mesh.papers import FIGURES, document
from innervate.papers import output
from innervate.papers.experiment import FAILS, OURS, Measured, summary
from tests.networks.mesh.papers.test_edges import QUICK, experiment, results

# What the document says where claims quote it, its sentences whole, by section.
SAID = {
    "1": "Our network supports routed messages between any two nodes. "
    "This is not scalable, but sufficient for small networks.",
    "1.1": "It broadcast a discovery request packet. Each node which receives a discovery packet "
    "1. takes note where the source node it came from: this is the next hop to the gateway "
    "2. marks itself as visited "
    "3. responds to the request by sending a response packet to the node from which the request "
    "came 4. broadcasts the same discovery request packet",
    "2.1": "Our design is optimized for low latency thanks to the routing by next hop tables, "
    "which contain the next hop calculating according to the shortest path to destination by hop "
    "count.",
    "2.2": "Reliability is important for a virtual fence because the fence crossing event delivery "
    "must happen even if some intermediate nodes malfunctioned. "
    "Our design is optimized for reliability by having the routed packets acknowledged and by "
    "having nodes update their routing tables when an acknowledgement does not arrive in time. "
    "As a result, if a node X dies, the nodes which list X as the next hop in their routing "
    "tables, will replace it automatically. "
    "On next packet, A will not forward it to B but to a different neighbor. Currently, the choice "
    "of neighbor is random (except for packet source), but in the future it could be based on last "
    "heard time and RSSI, both of which are tracked.",
}
FROM_DOCUMENT = re.compile(r'the document, ([\d.]+): "(.+)"')


def rows(figure):
    return list(experiment(figure).judge(Measured(results(figure), QUICK)))


@pytest.fixture(scope="module")
def everything():
    return [row for figure in FIGURES for row in rows(figure)]


def test_every_row_says_whose_claim_it_is_and_quotes_word_by_word(everything):
    quoting = [row for row in everything if row.source != OURS]
    for row in quoting:
        section, words = FROM_DOCUMENT.fullmatch(row.source).groups()
        assert section == row.figure
        assert words in SAID[section]
    assert len(quoting) >= len(document.SENTENCES)
    assert {row.source for row in everything} > {OURS}


def test_every_sentence_is_quoted_by_a_row(everything):
    found = {row.source for row in everything}
    for section, words in document.SENTENCES:
        assert document.quoted(section, words) in found


def test_what_stands_between_marks_is_the_documents(everything):
    for row in everything:
        for words in re.findall(r'"([^"]+)"', f"{row.claim} {row.reason}"):
            assert any(words in text for text in SAID.values()), words


def test_what_is_asked_or_beyond_is_ours(everything):
    others = [row for row in everything if not row.figure[0].isdigit()]
    assert {row.figure for row in others} == {"asked", "beyond"}
    assert {row.source for row in others} == {OURS}


def test_the_headline_counts_the_documents_apart(everything):
    quoting = [row for row in everything if row.source != OURS]
    failed = sum(row.verdict == FAILS for row in quoting)
    said = summary(everything)
    assert said.startswith(f"{len(quoting)} claims of the document: ")
    assert f" {failed} do not hold. {len(everything) - len(quoting)} of ours: " in said


def test_page_and_tables_say_it_in_the_same_words(mesh_made):
    page, table = ((mesh_made.folder / f"papers-mesh.{kind}").read_text(encoding="utf-8")
                   for kind in ("html", "csv"))  # fmt: skip
    all_rows = [row for claims in mesh_made.claims.values() for row in claims]
    for row in all_rows:
        assert f'<p class="over">{output.clean(row.whose)}</p>\n{output.clean(row.claim[:20])}' in (
            re.sub(r"<a [^>]+>([A-Z]\d+)</a>", r"\1", page)
        )
    assert output.clean(summary(all_rows)) in page
    assert table.splitlines()[0].endswith(",reason,source")
    assert table.count(",ours\n") == sum(row.source == OURS for row in all_rows)
