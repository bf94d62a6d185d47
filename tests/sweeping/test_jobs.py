"""The job table: all of a batch or nothing, once and for good."""

import json
import sqlite3

import pytest

from innervate.sweeping import jobs
from innervate.sweeping.errors import DamagedError, SweepError
from innervate.sweeping.jobs import Jobs
from innervate.sweeping.work import Outcome

PLACE, OTHER = json.dumps({"host": "a"}), json.dumps({"host": "b"})


def done(point, repeat, value=1):
    return Outcome(point, repeat, 10 + repeat, json.dumps({"x": value}), "", 0.5, 100.0)


def failed(point, repeat):
    return Outcome(point, repeat, 10 + repeat, None, "it broke", 0.25, 200.0)


@pytest.fixture
def table(tmp_path):
    with Jobs(tmp_path) as made:
        yield made


def interrupted():
    yield done("p", 1)
    raise KeyboardInterrupt


UNFIT = done("p", 2)._replace(reason=object())


@pytest.mark.parametrize(
    ("batch", "error"),
    [(interrupted(), KeyboardInterrupt), ([done("p", 1), UNFIT], SweepError),
     ([done("p", 1), None], AttributeError)],
    ids=["interrupted", "refused by the table", "our own mistake"],
)  # fmt: skip
def test_of_a_batch_that_fails_nothing_is_kept_and_the_next_one_is(table, batch, error):
    table.add([done("p", 0)], PLACE)
    with pytest.raises(error):
        table.add(batch, OTHER)
    assert list(table.runs("p", 9)) == [0]
    assert list(table.places().values()) == [{"host": "a"}]
    table.add([done("p", 1), done("p", 2)], OTHER)
    assert list(table.runs("p", 9)) == [0, 1, 2]
    assert list(table.places().values()) == [{"host": "a"}, {"host": "b"}]


def test_what_is_kept_is_there_for_who_opens_the_table_next(tmp_path):
    with Jobs(tmp_path) as first:
        first.add([done("p", 0)], PLACE)
        with pytest.raises(KeyboardInterrupt):
            first.add(interrupted(), PLACE)
    with Jobs(tmp_path) as again:
        assert list(again.runs("p", 9)) == [0]
        again.add([done("p", 1)], PLACE)
        assert list(again.runs("p", 9)) == [0, 1]


def test_a_run_that_is_done_stays_as_it_was_first(table):
    table.add([done("p", 0, 1)], PLACE)
    table.add([done("p", 0, 2), done("p", 1, 3), failed("p", 0)], OTHER)
    assert {repeat: run.figures for repeat, run in table.runs("p", 9).items()} == {
        0: {"x": 1}, 1: {"x": 3}}  # fmt: skip


def test_runs_are_those_of_a_point_before_a_repeat_in_order(table):
    table.add([done("p", 2), done("p", 0), done("q", 1), failed("p", 1), done("p", 3)], PLACE)
    assert list(table.runs("p", 3)) == [0, 1, 2]
    assert list(table.runs("p", 0)) == []
    assert list(table.runs("r", 9)) == []
    found = table.runs("p", 9)
    assert found[0] == (10, {"x": 1}, "", 0.5, 100.0, 1)
    assert found[1] == (11, None, "it broke", 0.25, 200.0, 1)


def test_a_place_is_kept_once(table):
    for repeat, place in enumerate((PLACE, OTHER, PLACE)):
        table.add([done("p", repeat)], place)
    assert table.places() == {1: {"host": "a"}, 2: {"host": "b"}}
    assert [run.place for run in table.runs("p", 9).values()] == [1, 2, 1]


def test_only_failed_runs_are_forgotten(table):
    table.add([done("p", 0), failed("p", 1), failed("q", 0)], PLACE)
    assert table.forget_failed() == 2
    assert (list(table.runs("p", 9)), list(table.runs("q", 9))) == ([0], [])
    assert table.forget_failed() == 0
    table.add([done("q", 0)], PLACE)
    assert table.runs("q", 9)[0].figures == {"x": 1}


def test_a_folder_holds_one_sweep(tmp_path):
    with Jobs(tmp_path) as table:
        table.claim({"scenario": "abc", "plan": "def"})
        table.claim({"scenario": "abc", "plan": "def"})
    with Jobs(tmp_path) as table:
        table.claim({"scenario": "abc", "plan": "def"})
        with pytest.raises(SweepError, match=r"^scenario changed since .* give it as it was,"):
            table.claim({"scenario": "other", "plan": "def"})
        with pytest.raises(SweepError, match=r"^scenario and plan changed"):
            table.claim({"scenario": "", "plan": ""})
        table.claim({"scenario": "abc"})


def test_a_table_of_another_layout_is_not_gone_on_with(tmp_path, monkeypatch):
    with Jobs(tmp_path) as table:
        table.claim({"plan": "def"})
    monkeypatch.setattr(jobs, "SCHEMA", jobs.SCHEMA + 1)
    with Jobs(tmp_path) as table, pytest.raises(SweepError, match=r"^schema changed"):
        table.claim({"plan": "def"})


def test_one_process_is_at_work_on_a_table_and_lets_go_of_it(tmp_path):
    with Jobs(tmp_path), pytest.raises(SweepError, match="another sweep is at work in"):
        Jobs(tmp_path)
    with Jobs(tmp_path):
        pass


def test_what_is_no_table_is_said_and_let_go_of(tmp_path):
    (tmp_path / jobs.FILE).write_bytes(b"something else" * 100)
    with pytest.raises(SweepError, match="is no job table, or damaged so that nothing"):
        Jobs(tmp_path)
    with pytest.raises(SweepError, match="cannot be written; choose another folder"):
        Jobs(tmp_path / "none")


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("SQLITE_BUSY", "another sweep is at work in /a; wait for it, or choose another folder"),
        ("SQLITE_LOCKED_SHAREDCACHE", "another sweep is at work in /a"),
        ("SQLITE_READONLY_DBMOVED", "/a/b cannot be written"),
        ("SQLITE_PERM", "/a/b cannot be written"),
        ("SQLITE_FULL", "/a/b: no space left on the disk"),
        ("SQLITE_IOERR_WRITE", "/a/b: no space left on the disk, or it fails"),
        ("SQLITE_CORRUPT", "/a/b is no job table, or damaged"),
        ("SQLITE_CONSTRAINT", "/a/b: words of its own"),
        (None, "/a/b: words of its own"),
    ],
)
def test_each_trouble_of_a_table_is_one_line(code, words):
    error = sqlite3.OperationalError("words of its own")
    error.sqlite_errorname = code
    assert jobs._in_words("/a/b", error).startswith(words)


@pytest.mark.parametrize(
    "harm",
    [
        """figures = '{"x": 1'""", "figures = '5'", "figures = x'ff'", "figures = NULL",
        "figures = CAST(x'7bff' AS TEXT)", """figures = CAST(x'7b2278ff223a317d' AS TEXT)""",
        "seed = 'ten'", "wall_s = 'long'", "place = x'01'", "reason = x'00'", "state = 'failed'",
    ],
)  # fmt: skip
def test_a_torn_row_costs_that_run_alone_and_the_next_outcome_takes_its_place(table, harm):
    table.add([done("p", 0), done("p", 1), done("p", 2)], PLACE)
    table._db.execute("PRAGMA foreign_keys = OFF")
    table._db.execute(f"UPDATE runs SET {harm} WHERE repeat = 1")
    assert list(table.runs("p", 9)) == [0, 2]
    assert table.torn == {("p", 1)}
    table.add([done("p", 0, 7), done("p", 1, 7)], OTHER)
    assert [run.figures["x"] for run in table.runs("p", 9).values()] == [1, 7, 1]


def test_of_a_torn_place_nothing_is_known_and_its_runs_stay(table):
    table.add([done("p", 0)], PLACE)
    table.add([done("p", 1)], OTHER)
    table._db.execute("UPDATE places SET facts = 'torn' WHERE id = 1")
    assert table.places() == {1: {}, 2: {"host": "b"}}
    assert (table.torn_places, list(table.runs("p", 9))) == ({1}, [0, 1])


PAGE = 4096
LONG = "x" * 900  # of a run, so that few fit on a page


def filled(folder, points="pqrs", repeats=12):
    """A table of many pages; where each part begins, and how many there are."""
    with Jobs(folder) as made:
        made.claim({"plan": "abc"})
        runs = [done(point, k, LONG) for point in points for k in range(repeats)]
        made.add(runs, PLACE)
    data = (folder / jobs.FILE).read_bytes()
    with sqlite3.connect(folder / jobs.FILE) as db:
        roots = dict(db.execute("SELECT name, rootpage FROM sqlite_master"))
    db.close()
    return roots, len(data) // PAGE


def harmed(folder, page):
    """One page of a table is noise, as a bad block of a disk leaves it."""
    path = folder / jobs.FILE
    data = bytearray(path.read_bytes())
    data[PAGE * (page - 1) : PAGE * page] = b"\x7fnoise of" * (PAGE // 9) + b"!"
    assert len(data) % PAGE == 0
    path.write_bytes(data)


def test_of_a_table_with_a_damaged_page_all_other_runs_are_kept(tmp_path):
    first = tmp_path / "whole"
    first.mkdir()
    roots, pages = filled(first)
    assert pages > 12
    kept = []
    for page in range(1, pages + 1):
        folder = tmp_path / str(page)
        folder.mkdir()
        filled(folder)
        harmed(folder, page)
        if page in (1, roots["meta"]):  # whose table it is, nobody knows
            with pytest.raises(DamagedError, match="nothing of it can be kept; move it away"):
                jobs.rescue(folder, {point: 12 for point in "pqrs"})
            assert [one.name for one in folder.iterdir()] == [jobs.FILE]
            continue
        count, aside = jobs.rescue(folder, {point: 12 for point in "pqrs"})
        assert (folder / aside).name == f"{jobs.FILE}.damaged-1"
        with Jobs(folder) as again:
            again.claim({"plan": "abc"})
            found = [run for point in "pqrs" for run in again.runs(point, 12).values()]
            assert again.count() == len(found) == count
            assert all(run.figures == {"x": LONG} for run in found)
            again.add([done(point, k, LONG) for point in "pqrs" for k in range(12)], PLACE)
            assert again.count() == 48
        kept.append(count)
    assert kept.count(48) >= 2  # places, and their index
    assert kept.count(0) == 1  # the root
    rest = sorted(count for count in kept if 0 < count < 48)
    assert all(count > 20 for count in rest)  # two pages only point to others
    assert all(count >= 43 for count in rest[2:])


def test_what_was_found_damaged_twice_is_kept_twice(tmp_path):
    for k in (1, 2):
        roots, _ = filled(tmp_path)
        harmed(tmp_path, roots["places"])
        assert jobs.rescue(tmp_path, {}) == (48, f"{jobs.FILE}.damaged-{k}")
