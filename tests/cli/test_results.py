"""What is said of sweeps, proofs and windows of runs, in words, and how failures end a command."""

from types import SimpleNamespace

import polars
import pytest

from innervate.cli import errors, exporting, proving, sweeping
from innervate.prove.theory import Outcome, Theory
from innervate.sweeping import make_plan
from innervate.sweeping import words as sentences
from innervate.sweeping.result import Sweep


@pytest.mark.parametrize(
    ("runs", "count", "low", "high", "words"),
    [(0, 9, None, None, "-"), (1, 1, 17.2, 17.2, "17.2"), (2, 2, 16.6, 17.8, "17.2 +- 0.6"),
     (9, 9, 17.1999, 17.2001, "17.2 +- 0.0001"), (2, 9, 16.6, 17.8, "17.2 +- 0.6 of 2"),
     (1, 9, 17.2, 17.2, "17.2 of 1")],
)  # fmt: skip
def test_a_mean_in_words_and_of_how_many_runs_if_not_of_all(runs, count, low, high, words):
    row = {"runs": runs, "mean": 17.2, "low": low, "high": high}
    assert sentences.mean_words(row, count) == words


def test_settings_stand_in_the_table_as_in_a_file_and_long_ones_without_their_middle():
    cells = [sweeping._cell(value) for value in (True, 2, 0.5, "a" * 40, "a" * 30 + "b" * 30)]
    assert cells == ["true", "2", "0.5", "a" * 40, f"{'a' * 18}...{'b' * 19}"]


def swept(points, *rows):
    plan = make_plan({"kind": "radio"}, vary={"stations": list(range(2, 2 + points))}, repeat=1)
    base = {"repeat": 0, "status": "done", "reason": ""}
    return Sweep(plan, polars.DataFrame([base | row for row in rows]), polars.DataFrame())


def test_a_line_for_each_point_and_how_many_more_there_are():
    most = sweeping.POINTS_MAX
    for count in (most, most + 2):
        rows = [{"point": i, "stations": 2 + i, "a.ms": float(i)} for i in range(count)]
        lines = sweeping.result_lines(swept(count, *rows))
        assert lines[0].split() == ["stations", "runs", "a.ms"]
        assert lines[1].split() == ["2", "1", "0"]
        assert lines[most].split() == [str(most + 1), "1", str(most - 1)]
        assert lines[most + 1 :] == (["... and 2 more points"] if count > most else [])
        assert len({len(line) for line in lines[: most + 1]}) == 1


def test_what_somebody_asked_for_is_shown_where_it_never_happened_and_beyond_three():
    asked = ("a", "b.ms", "c", "broken.since_s", "d")
    made = swept(1, {"point": 0, "stations": 2, "a": 1.0, "b.ms": None, "c": 3.0, "d": 4.0})
    heads, row = (line.split() for line in sweeping.result_lines(made, asked))
    assert heads == ["stations", "runs", *asked]
    assert row == ["2", "1", "1", "-", "3", "-", "4"]


def test_runs_that_are_not_well_are_counted_with_the_first_of_each_kind():
    levels = ["ok", "degraded", "down", "degraded", "ok"]
    rows = [{"point": 0, "stations": 2, "seed": 40 + i, "headline.level": level, "x": 1.0,
             "headline.text": f"{level} {i}"} for i, level in enumerate(levels)]  # fmt: skip
    made = swept(1, *rows)
    assert sentences.headline_lines(made) == [
        "2 of 5 runs: degraded; the first, point 0 with seed 41: degraded 1",
        "1 of 5 runs: down; the first, point 0 with seed 42: down 2",
    ]
    assert sentences.headline_lines(swept(1, {"point": 0, "x": 1.0})) == []


def checked(name, goals=1, refuted=(), reached=(), wall_s=0.25):
    bad = [SimpleNamespace(goal=goal, sentences=["Before: x."], values={}) for goal in refuted]
    return SimpleNamespace(name=name, goals=["g"] * goals, refuted=bad, reached=list(reached),
                           wall_s=wall_s)  # fmt: skip


WAY, OTHER = ("on_frame", 12, True), ("on_frame", 14, False)


def outcome(*steps, by="", unreached=(), named=(), ended="complete"):
    theory = Theory("loops", "no loops", ("frames arrive",), (), refuted_by=by)
    return Outcome(theory, list(steps), list(unreached), list(named), ended)


@pytest.mark.parametrize(
    ("came", "summary", "is_so"),
    [
        (outcome(checked("a", 2)), "Holds: 2 lemmas.", True),
        (
            outcome(checked("a", 2, reached=[WAY]), checked("b", 1, reached=[WAY, OTHER])),
            "Holds: 3 lemmas; 2 ways of branches reached.",
            True,
        ),
        (
            outcome(checked("a", reached=[WAY]), named=[OTHER]),
            "Holds: 1 lemma; 1 way of branches reached, 1 cannot be, as said.",
            True,
        ),
        (outcome(checked("a"), unreached=[OTHER]), "Holds: 1 lemma; some are not.", False),
        (outcome(checked("a", refuted=["g"])), "Does NOT hold.", False),
        (outcome(checked("a"), ended="stopped"), "Stopped.", False),
        (outcome(checked("a", refuted=["g"]), by="a"), "Refuted, as it must be.", True),
        (outcome(checked("a", refuted=["g"]), by="b"), "NOT REFUTED.", False),
        (outcome(checked("a"), by="a"), "NOT REFUTED.", False),
    ],
)
def test_what_came_of_a_theory(came, summary, is_so):
    assert proving._summary(came) == summary
    assert came.is_as_expected == is_so
    assert came.as_dict()["expected"] == is_so
    assert proving.lines(came)[-1] == f"  {summary}"
    said = proving._verdict([came, outcome(checked("x", 4))], 2)
    lemmas = came.lemmas + 4
    wall_s = 0.25 * (len(came.checked) + 1)
    much = f"{lemmas} lemmas in {wall_s:.1f} s"
    if came.ended == "stopped":
        cut = "interrupted after 1 of 2 theories"
        assert said == f"As it should be so far: {much}; {cut}."
    else:
        assert said == (f"All as it should be: {much}." if is_so
                        else f"NOT as it should be: loops ({much}).")  # fmt: skip


def test_of_theories_that_were_not_tried_nothing_is_claimed():
    fine, bad = outcome(checked("a", 2)), outcome(checked("a", refuted=["g"]))
    stopped = outcome(checked("a"), ended="stopped")
    cut = "interrupted after 1 of 3 theories"
    assert proving._verdict([fine], 3) == f"As it should be so far: 2 lemmas in 0.2 s; {cut}."
    assert proving._verdict([bad, stopped], 3) == (
        f"NOT as it should be: loops (2 lemmas in 0.5 s); {cut}."
    )
    assert proving._verdict([], 3).startswith("As it should be so far: 0 lemmas")


def test_a_theory_line_by_line():
    step = checked("a step", 2, refuted=["it stays"], wall_s=1.5)
    lines = proving.lines(outcome(step, checked("another"), unreached=[WAY, OTHER]))
    assert lines[:2] == ["loops: no loops", "  assumed: frames arrive"]
    assert lines[2].split() == ["a", "step", "2", "lemmas", "1", "REFUTED", "1.50", "s"]
    assert lines[3:5] == ["    it stays", "      Before: x."]
    assert lines[5].split() == ["another", "1", "lemma", "hold", "0.25", "s"]
    assert lines[6:8] == [
        "  NOT REACHED: on_frame, line 12, taken", "  NOT REACHED: on_frame, line 14, not taken",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("from_s", "to_s", "window"),
    [(0.0, None, (0, 2_000_000)), (0.5, 1.0, (500_000, 1_000_000)), (0.0, 9.0, (0, 9_000_000)),
     (1.999_999, None, (1_999_999, 2_000_000))],
)  # fmt: skip
def test_a_window_of_a_run(from_s, to_s, window):
    source = SimpleNamespace(plan=SimpleNamespace(duration_us=2_000_000))
    wanted = SimpleNamespace(from_s=from_s, to_s=to_s)
    assert exporting._Source._window(source, wanted) == window


@pytest.mark.parametrize(
    ("from_s", "to_s", "says"),
    [(2.0, None, "the run ends at 2 s"), (1.0, 1.0, "nothing lies in that window"),
     (-0.1, 1.0, "nothing lies in that window"), (1.0, 0.5, "let --from be less than --to")],
)  # fmt: skip
def test_windows_in_which_nothing_lies(from_s, to_s, says):
    source = SimpleNamespace(plan=SimpleNamespace(duration_us=2_000_000))
    with pytest.raises(errors.UserError, match=says):
        exporting._Source._window(source, SimpleNamespace(from_s=from_s, to_s=to_s))


@pytest.mark.parametrize("value", [-1e-9, float("inf"), float("nan")])
def test_what_is_no_time_to_wait(value):
    with pytest.raises(errors.UserError, match="--for must be a number of seconds from 0"):
        errors.check_seconds("--for", value)
    errors.check_seconds("--for", 0.0)
    errors.check_seconds("--for", 1e9)


@pytest.mark.parametrize(
    ("error", "said", "code"),
    [
        (errors.UserError("write it so"), "write it so", errors.USERS),
        (MemoryError(), "not enough memory; make the scenario smaller or shorter", errors.OURS),
        (OSError(28, "No space left", "/a/b"), "/a/b: No space left", errors.OURS),
        (OSError(28, "No space left"), "No space left", errors.OURS),
        (ModuleNotFoundError("x", name="polars.io"),
         "this needs polars; install it with: pip install 'innervate[sim]'", errors.USERS),
        (KeyError("x"), "internal error, KeyError: 'x' (INNERVATE_TRACEBACK=1 shows where)",
         errors.OURS),
        (ModuleNotFoundError("no x", name="x"),
         "internal error, ModuleNotFoundError: no x (INNERVATE_TRACEBACK=1 shows where)",
         errors.OURS),
    ],
)  # fmt: skip
def test_an_error_in_one_line(error, said, code):
    assert errors.explain(error) == (said, code)


@pytest.mark.parametrize(
    ("code", "found"), [(None, 0), (0, 0), (3, 3), ("words", errors.OURS), ("", 0)]
)
def test_who_ends_by_himself_keeps_his_code(code, found):
    assert errors.conclude(SystemExit(code)) == found
