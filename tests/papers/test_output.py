"""What is written of a paper: tables word for word, and where on its page things stand."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

import innervate
from innervate.cli.papers import verdict_lines
from innervate.papers import output
from innervate.papers.experiment import (
    FAILS,
    HOLDS,
    OURS,
    Claim,
    Experiment,
    Sheet,
    quoted,
    reading,
)

CLAIMS = [
    Claim("3", "as many | as said", "4 of 4", HOLDS),
    Claim("3", "never *more*", "5\nof 6", FAILS, "A1: so\nit is"),
    Claim("4", "by A1", "7", reading("A1"), "A2: not here"),
]
READINGS = {"A1": "One, as A3 says.", "A2": "Two.", "A3": "Three."}
KEYS = ["slow, seed 1", "slow, seed 2", "fast, seed 1", "once"]
SHEET = Sheet("Counts", ("what", "many"), [("a|b", "1"), ("c", "*2*")])
HEADING = output.Heading(
    "toy", "A <toy>", "A. B.", quick=True, stamp="abc", redraw=False, command="papers toy",
    readings=READINGS,
)  # fmt: skip
ORIGIN = {"seeds": "1", "settings": "quick", "with": "Python 3", "time": "2 s"}
FIGURE = Experiment(
    "fig3", "Fig. 3", "How many.", lambda quick: [SimpleNamespace(key=key) for key in KEYS],
    draw=None, judge=None,
)  # fmt: skip
MADE = output.Made({"fig3": CLAIMS}, {"fig3": [SHEET]})


def test_tables_end_where_they_come_from_with_a_full_stop_and_have_all_claims():
    assert (
        output.as_tables(HEADING, FIGURE, MADE, ORIGIN)
        == """\
`innervate papers toy --quick --only fig3`;
seeds: 1;
settings: quick;
with: Python 3.

**Counts**

| what | many |
|---|---|
| a\\|b | 1 |
| c | \\*2\\* |

**What is claimed**

| claim | measured | verdict | why |
|---|---|---|---|
| as many \\| as said | 4 of 4 | holds |  |
| never \\*more\\* | 5 of 6 | does not hold | A1: so it is |
| by A1 | 7 | holds with reading A1 | A2: not here |
"""
    )


def test_the_table_for_people_says_how_to_make_it_again():
    assert (
        output.as_markdown(HEADING, CLAIMS[1:2], ORIGIN)
        == """\
# A <toy>

1 claims: 0 hold, 0 hold with a reading of ours, 1 do not hold.

| figure | claim | measurement | verdict | reason |
|---|---|---|---|---|
| 3 | never \\*more\\* | 5 of 6 | does not hold | A1: so it is |

    papers toy

- seeds: 1
- settings: quick
- with: Python 3
- time: 2 s
"""
    )
    assert output.summary(CLAIMS) == (
        "3 claims: 1 hold, 1 hold with a reading of ours, 1 do not hold."
    )


def test_the_table_for_programs_has_a_head_and_a_row_a_claim():
    assert output.as_csv(CLAIMS[:2]) == (
        "figure,claim,measurement,verdict,reason\n"
        "3,as many | as said,4 of 4,holds,\n"
        '3,never *more*,"5\nof 6",does not hold,"A1: so\nit is"\n'
    )


def test_whose_claim_it_is_stands_everywhere_in_the_same_words(tmp_path):
    rows = [
        Claim("2", "in all", "4 of 4", HOLDS, "", quoted("2", "as it is")),
        Claim("2", "in some", "0 of 4", FAILS, "so", OURS),
    ]
    assert [row.whose for row in rows] == ['the document, 2: "as it is"', "ours, 2"]
    counted = (
        "1 claims of the document: 1 hold, 0 hold with a reading of ours, 0 do not hold. "
        "1 of ours: 0 hold, 0 hold with a reading of ours, 1 do not hold."
    )
    (tmp_path / "fig3.svg").write_text("<svg/>")
    page = output.write(tmp_path, HEADING, [FIGURE], output.Made({"fig3": rows}), 2.0)
    found = page.read_text(encoding="utf-8")
    assert f"<p>{counted}</p>" in found
    assert '<p class="over">the document, 2: "as it is"</p>\nin all' in found
    assert '<a href="#fig3">ours, 2</a>: in some' in found
    assert verdict_lines(page.with_suffix(".csv")) == [
        counted, "  ours, 2: in some", "      measured: 0 of 4", "      because: so",
    ]  # fmt: skip
    assert output.columns(rows)[-1] == "source"
    tables = output.as_tables(HEADING, FIGURE, output.Made({"fig3": rows}), ORIGIN)
    assert '| the document, 2: "as it is": in all | 4 of 4 | holds |  |' in tables
    assert "| ours, 2: in some | 0 of 4 | does not hold | so |" in tables
    assert "| 2 | in some | 0 of 4 | does not hold | so | ours |" in output.as_markdown(
        HEADING, rows, ORIGIN
    )


@pytest.mark.parametrize(("made", "changed", "quick", "redraw", "said"), [
    ("f00", False, True, False, ("f00", "abc", "quick: few seeds")),
    ("f00", True, False, True, ("f00 with changes", "abc or others (redrawn)", "full")),
    (None, False, False, False, ("unknown", "abc", "full")),
])  # fmt: skip
def test_numbers_come_from_a_state_of_the_sources(monkeypatch, made, changed, quick, redraw, said):
    monkeypatch.setattr(output, "checkout", lambda: (made, changed))
    heading = output.Heading("toy", "", "", quick, "abc", redraw, "")
    found = output.provenance(heading, 61.6)
    assert (found["commit"], found["sources"], found["settings"]) == said
    assert (found["innervate"], found["time"]) == (innervate.__version__, "62 s")
    assert [word.split()[0] for word in found["with"].split(", ")] == ["Python", *output.PACKAGES]


@pytest.mark.parametrize(("width", "is_narrow"), [("399.9", True), ("400", False)])
def test_a_page_has_all_of_it(tmp_path, width, is_narrow):
    (tmp_path / "fig3.svg").write_text(f'<svg width="{width}pt"/>')
    page = output.write(tmp_path, HEADING, [FIGURE], MADE, 2.0).read_text(encoding="utf-8")
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "fig3.svg", "papers-toy.csv", "papers-toy.html", "papers-toy.md", "toy-fig3.md",
    ]  # fmt: skip
    assert ("<figure class=narrow>" in page) == is_narrow
    assert '<section id="fig3">' in page
    assert "<h1>A &lt;toy&gt;</h1>" in page
    assert page.index(output.QUICK) < page.index("<h2>Does not hold</h2>")
    whole = output.as_page(tmp_path, replace(HEADING, quick=False), [FIGURE], MADE, ORIGIN)
    assert output.QUICK not in whole
    assert '<li><a href="#fig3">3</a>: never *more*</li>' in page  # does not hold
    assert '<span class="good">2 hold</span>, <span class="bad">1 not</span>' in page
    assert page.index("Counts") < page.index("4 sets of runs, by their settings")
    assert "slow, a run a seed\nfast, seed 1\nonce</pre>" in page
    assert '<dt id="A1">A1</dt><dd>One, as A3 says.</dd><dt id="A2">' in page
    assert 'id="A3"' not in page
    verdicts = page.split('<table class="claims">')[1]
    assert verdicts.index("never") < verdicts.index("as many") < verdicts.index("by <a")


def test_labels_in_titles_and_captions_are_links_too(tmp_path):
    (tmp_path / "fig3.svg").write_text("<svg/>")
    figure = replace(FIGURE, title="A2: two", caption="As A3 <says>, not A9.")
    made = output.Made({"fig3": CLAIMS[:1]})
    page = output.write(tmp_path, HEADING, [figure], made, 2.0).read_text(encoding="utf-8")
    assert '<h2><a href="#A2">A2</a>: two</h2>' in page
    assert '<figcaption>As <a href="#A3">A3</a> &lt;says&gt;, not A9.</figcaption>' in page
    assert '<dt id="A2">A2</dt><dd>Two.</dd><dt id="A3">A3</dt>' in page


def test_without_tables_or_readings_there_are_none(tmp_path):
    (tmp_path / "fig3.svg").write_text("<svg/>")
    heading = output.Heading("toy", "", "", quick=True, stamp="", redraw=False, command="")
    made = output.Made({"fig3": CLAIMS[:1]})
    page = output.write(tmp_path, heading, [FIGURE], made, 2.0).read_text(encoding="utf-8")
    assert not (tmp_path / "toy-fig3.md").exists()
    assert '<a href="#readings">' not in page
    assert '<span class="bad">' not in page
    assert "class=narrow" not in page
    assert list(made.tables("fig3")) == []
