"""Comparisons: cells and claims of known numbers, the same harm for all, tables in a page."""

from collections import Counter
from math import inf
from types import SimpleNamespace

import pytest

from innervate.analysis.intervals import median_interval, quantile_interval
from innervate.analysis.parents import Ways
from innervate.papers import PapersError, book, cabled, compare, jobs
from innervate.papers.experiment import FAILS, HOLDS, Measured
from innervate.papers.jobs import Case, Column, Compared, Entry, Job, Words

LINE = [["pc.0", "a.0"], ["a.1", "b.0"], ["b.1", "c.0"], ["c.1", "pc.1"], ["a.2", "d.0"]]
GIVEN = {"cables": LINE, "beacon_us": 1000, "k": 3, "loss": 0.0, "settle": 100, "watch": 50}


# Intervals between order statistics.


def test_a_quantiles_interval():
    assert median_interval([5.0]) == (5.0, 5.0, 5.0)
    assert median_interval(list(range(1, 41))) == (20.5, 14, 27)  # tables of the sign test
    assert quantile_interval(list(range(1, 101)), 0.9)[1:] == (84, 96)
    assert quantile_interval([1.0, 2.0, inf, inf], 0.9).value == inf


# Jobs.


@pytest.fixture
def compared(monkeypatch):
    """A job of one case that two entries do, and what their ten runs gave."""
    columns = (Column("time (ms)", "ms"), Column("loops", "loops", jobs.TOTAL, 0))
    case = Case("one", "The case", {"harm": "cut"}, range(1, 11), columns)
    quick = Entry("toy", "quick", "is quick", measured, lambda: None)
    slow = Entry("toy", "slow", "is slow", measured, lambda: None)
    job = Job("toy", "T", "C", lambda quick: [case], lambda all_: iter(()), ("ms", "ms"))
    monkeypatch.setattr(jobs, "entries", lambda name: [quick, slow])
    ms = {quick: [1.0 * n for n in range(10)], slow: [3.0 + n for n in range(9)] + [None]}
    values = {run.key: {"ms": late, "loops": 2 * (late == ms[one][-1])} for one in (quick, slow)
              for run, late in zip(jobs.runs(case, one), ms[one], strict=True)}  # fmt: skip
    return Compared(job, Measured(values, True))


def measured(given, seed):
    return {"ms": 1.0 * seed}


def test_tables_have_a_row_an_entry(compared):
    (sheet,) = compared.sheets()
    assert sheet.title == "The case; 10 runs each"
    assert sheet.head == ("who", "time (ms)", "loops")
    assert sheet.rows == [
        ("quick", "4.5 (1.0 to 8.0)", "2"),
        ("slow", "7.5 (4.0 to 11.0), never in 1", "2"),
    ]


def test_a_claim_holds_where_every_seed_says_so(compared):
    (case,) = compared.cases()
    words = Words("quick is quicker", "as it was slower")
    claim = compared.less({"cut": case}, "ms", ("quick", "slow"), words)
    assert (claim.verdict, claim.reason) == (HOLDS, "")
    assert "cut: -3.0 (-3.0 to -3.0), less in 10 and more in 0 of 10" in claim.measurement
    claim = compared.less({"cut": case}, "ms", ("slow", "quick"), words)
    assert (claim.verdict, claim.reason) == (FAILS, "as it was slower")
    assert compared.less({"": case}, "ms", ("slow", "slow"), words).verdict == FAILS


@pytest.mark.parametrize(
    ("show", "values", "said"),
    [(jobs.MEAN, [1, 3], "2.0 (-10.7 to 14.7)"), (jobs.PERCENT, [1, 3], "2.0 (0.0 to 14.7)"),
     (jobs.PERCENT, [97, 99], "98.0 (85.3 to 100.0)"),
     (jobs.MOST, [1, 3], "3.0"),
     (jobs.SHARE, [0, 1, 2, 0], "2 (0.15 to 0.85)"), (jobs.MEDIAN, [], "-"),
     (jobs.MEDIAN, [inf, inf], "never"), (jobs.MEDIAN, [1, inf, inf], "never in 2 of 3"),
     (jobs.MEAN, [inf, inf], "never"),
     (jobs.TOTAL, [1, 3, 2], "6.0"), (jobs.MEAN, [1, 3, inf], "2.0 (-10.7 to 14.7), never in 1"),
     (jobs.SHARE, [0, inf, inf, 0], "2 (0.15 to 0.85)"), (jobs.SHARE, [1, 1], "2 (0.34 to 1.00)"),
     (jobs.MEDIAN, [1, 2, inf], "2.0 (1.0 to never), never in 1"),
     (jobs.TAIL, list(range(51)), "45.0 (40.0 to 50.0)")],
)  # fmt: skip
def test_cells(show, values, said):
    assert jobs.cell(values, Column("x", "x", show)) == said


def test_a_claim_holds_only_if_it_does_in_all_cases(monkeypatch):
    """The last case alone decides nothing; what never happens with either is no difference."""
    given = {"a": ([inf, *range(11)], [inf, *range(1, 12)]), "b": ([1] * 12, [1] * 12),
             "c": ([1] * 12, [2] * 12)}  # fmt: skip
    by_seed = {case: [dict(enumerate(one)) for one in pair] for case, pair in given.items()}
    monkeypatch.setattr(
        jobs.Compared, "_by_seed", lambda self, case, side, name: by_seed[case][side.name]
    )
    monkeypatch.setattr(jobs, "entries", lambda name: [SimpleNamespace(name=i) for i in range(2)])
    made = jobs.Compared(SimpleNamespace(name="toy"), None)

    def verdict(*cases):
        return made.less(dict(zip(cases, cases, strict=True)), "ms", (0, 1), Words("less"))

    assert [verdict(case).verdict for case in "abc"] == [HOLDS, FAILS, HOLDS]
    assert (verdict("b", "c").verdict, verdict("a", "c").verdict) == (FAILS, HOLDS)
    assert verdict("a").measurement == (
        "median difference a: -1.0 (-1.0 to -1.0), less in 11 and more in 0 of 12"
    )


def test_all_networks_bring_what_they_have():
    assert "skin" in compare.FIGURES
    names = [entry.name for entry in jobs.entries("skin")]
    assert [names[0].split(",")[0], names[-1].split(",")[0]] == ["skin", "Babel"]
    assert len(set(names)) == len(names)
    with pytest.raises(PapersError, match='no paper "toy"; choose from: skin, '):
        book.book_of("toy")


# What happens to cables.


def harms(what):
    return [cabled.drawn({**GIVEN, "harm": what}, seed) for seed in range(40)]


def test_harm_comes_within_five_beacons_of_when_all_has_settled(monkeypatch):
    asked = []
    draw = SimpleNamespace(draw=lambda most: asked.append(most) or most - 1)
    monkeypatch.setattr(cabled, "stream", lambda seed, what: draw)
    given = {**GIVEN, "harm": "none", "beacon_us": 1_000, "settle": 7}
    assert cabled.drawn(given, 3) == cabled.Harm(7_000 + 4_999)
    assert asked == [5_000]


def test_harm_is_the_seeds_and_leaves_the_others_joined():
    assert harms("cut") == harms("cut")
    own = Counter(harm.cables for harm in harms("cut"))
    assert set(own) == {(0,), (3,)}  # both of the PC's
    assert {harm.nodes for harm in harms("death")} == {(2,), (4,)}  # b and d are two hops away
    for harm in (*harms("cut"), *harms("death")):
        assert 100_000 <= harm.at_us < 105_000
        made = cabled.wiring(GIVEN)
        ways = Ways(5, 0, made.cables).play((), [harm])
        assert ways.steps[-1][1] == 4 - len(harm.nodes)
    assert all(harm.cables == harm.nodes == () for harm in harms("none"))
    with pytest.raises(PapersError, match="no four cuts leaves all others joined"):
        harms("four cuts")


def test_what_is_measured():
    given = {**GIVEN, "harm": "cut"}
    harm = next(h for h in harms("cut") if h.cables == (0,))
    up = [(3_000, 1, 0), (4_000, 2, 0), (5_000, 3, 1), (6_000, 4, 0)]
    mended = [(harm.at_us + 2_000, 1, 1), (harm.at_us + 2_500, 2, 1)]
    found = cabled.measured(given, harm, [*up, *mended], [harm.at_us + 1_500, 9], 1000)
    assert found == {
        "start_ms": 6.0, "detected_ms": 1.5, "routed_ms": 2.5, "without": 3, "without_s": 0.0075,
        "loops": 1, "largest_share": 0.75,
        "bits_per_s": 1000 * 240 / 5 / (cabled.end_us(given, harm) / 1e6),
    }  # fmt: skip


def test_what_happens_at_the_moment_of_the_harm_comes_after_it():
    given = {**GIVEN, "harm": "cut"}
    harm = next(h for h in harms("cut") if h.cables == (0,))
    up = [(3_000, 1, 0), (4_000, 2, 0), (5_000, 3, 1), (6_000, 4, 0)]
    at_once = [(harm.at_us, 1, 1), (harm.at_us, 2, 1)]

    def found(changes, downs=()):
        return cabled.measured(given, harm, [*up, *changes], downs, 0)

    # No one downstream is without a way for a moment; the largest share is of before it.
    mended = found(at_once)
    assert (mended["routed_ms"], mended["without_s"], mended["largest_share"]) == (0.0, 0.0, 0.75)
    assert found([])["routed_ms"] is None
    assert found([])["without"] == 3
    seen = found(at_once, [harm.at_us, harm.at_us + 900, harm.at_us + 400, 50])
    assert seen["detected_ms"] == 0.4
    assert found(at_once, [harm.at_us])["detected_ms"] is None
    late = cabled.measured(given, harm, [(harm.at_us - 1, *rest) for _, *rest in up], [], 0)
    assert late["start_ms"] == (harm.at_us - 1) / 1e3  # up to the end less calm will do
    never = cabled.measured(given, harm, up[:3], [], 0)
    assert (never["start_ms"], never["largest_share"]) == (None, pytest.approx(2 / 3))


# Pages.


def test_tables_go_between_the_marks_of_a_page(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(
        "a\n<!-- compare-toy: made by innervate papers -->\nold\n<!-- end of compare-toy -->\nb\n"
    )
    book.output.insert(page, "compare-toy", "new")
    book.output.insert(page, "compare-toy", "newer")
    assert page.read_text().splitlines()[::2] == ["a", "newer", "b"]
    with pytest.raises(PapersError, match="has no place for compare-other; add <!--"):
        book.output.insert(page, "compare-other", "new")
    with pytest.raises(PapersError, match="No such file"):
        book.output.insert(tmp_path / "none.md", "compare-toy", "new")
    with pytest.raises(PapersError, match="leave out --page"):
        book.into_page(page, "mesh", tmp_path)


def test_a_job_compiles_what_its_own_entries_run_each_once(monkeypatch):
    said = []
    one, other = (lambda: said.append("one")), (lambda: said.append("other"))
    doing = {"skin": [("a", one), ("b", one), ("c", other)], "mesh": [("d", pytest.fail)]}
    made = {name: [Entry(name, who, "", measured, up) for who, up in found]
            for name, found in doing.items()}  # fmt: skip
    monkeypatch.setattr(compare, "entries", made.__getitem__)
    compare.experiment("skin").warm_up()
    compare.warm_up()
    assert said == ["one", "other"]
