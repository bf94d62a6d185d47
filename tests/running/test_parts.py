"""Where runs go, what two differ in, where code breaks, what is shown of work under way."""

import sys
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate import folders
from innervate import scenario as scenarios
from innervate.network import networks
from innervate.running import RunError, blaming, compare, fuzz, showing
from innervate.running import folder as places
from innervate.running.compare import Divergence, differences
from innervate.running.exploring import named

compares = sys.modules[compare.__module__]
runs = sys.modules[compares.Run.__module__]
RADIO = {"kind": "radio", "stations": 3, "name": "team"}


def team(**changes):
    return scenarios.from_dict({**RADIO, **changes})


def put(folder, scenario):
    folder.mkdir(parents=True)
    (folder / places.SCENARIO).write_text(scenarios.dump(scenario))


def test_a_run_goes_past_folders_of_other_runs_and_replaces_one_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    one, other = team(), team(stations=4)
    first = Path("runs/team-1")
    assert places.free_folder(one) == first
    put(first, one)
    assert places.free_folder(one) == first
    assert places.free_folder(other) == Path("runs/team-1-2")
    put(Path("runs/team-1-2"), team(stations=5))
    assert places.free_folder(other) == Path("runs/team-1-3")
    (first / places.SCENARIO).write_text("kind =")  # no run of ours
    assert places.free_folder(one) == Path("runs/team-1-3")
    Path("runs/team-1-3").mkdir()
    assert places.free_folder(one) == Path("runs/team-1-3"), "a folder without a scenario is free"


@pytest.mark.parametrize("most", [1, 3])
def test_of_too_many_the_last_is_replaced(tmp_path, monkeypatch, most):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(places, "FOLDERS_MAX", most)
    for number in range(1, most + 1):
        put(Path("runs") / ("team-1" if number == 1 else f"team-1-{number}"), team(stations=9))
    last = "team-1" if most == 1 else f"team-1-{most}"
    assert places.free_folder(team()) == Path("runs") / last


def test_names_of_folders_have_a_length():
    assert places.default_folder("x" * 80, 3).name == "x" * 80 + "-3"
    assert places.default_folder("x" * 81, 3).name == "x" * 80 + "-3"


def test_tables_are_compared_with_what_was_written(tmp_path):
    name = places.table_files()[0]
    (tmp_path / name).write_bytes(b"rows")
    written = places.digests(tmp_path)
    assert list(written) == [name]
    places.check_tables(tmp_path, written | {"strange.parquet": "x"})
    places.check_tables(tmp_path, None)
    (tmp_path / name).write_bytes(b"rowz")
    with pytest.raises(RunError, match="is damaged; run the scenario again"):
        places.check_tables(tmp_path, written)
    (tmp_path / name).unlink()
    with pytest.raises(RunError, match="is missing; run the scenario again"):
        places.check_tables(tmp_path, written)


def test_a_folder_in_which_somebody_has_put_something_meanwhile_is_left_alone(tmp_path):
    target = tmp_path / "run"

    def write():
        with places.replacing(target) as fresh:
            (fresh / "summary.json").write_text("new")
            target.mkdir()
            (target / "thesis.tex").write_text("years")

    with pytest.raises(RunError, match="not a run folder and not empty"):
        write()
    assert (target / "thesis.tex").read_text() == "years"
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@pytest.mark.parametrize(
    ("a", "b", "found"),
    [
        ([1, 2], [1, 2], []), ([1, 2], [1, 3], [("", [1, 2], [1, 3])]),
        ({"a": []}, {"a": [{"u": 1}]}, [("a.0", None, {"u": 1})]),
        ({"a": [{"u": 1}]}, {"a": []}, [("a.0", {"u": 1}, None)]),
        ({"a": {"b": 1}}, {"a": {"b": 2, "c": 3}}, [("a.b", 1, 2), ("a.c", None, 3)]),
        ({"a": 1}, {"a": {"b": 1}}, [("a", 1, {"b": 1})]),
        ({"a": [{"b": [1]}]}, {"a": [{"b": [2]}]}, [("a.0.b", [1], [2])]),
    ],
)  # fmt: skip
def test_leaves_that_differ(a, b, found):
    assert differences(a, b) == found


class Side:
    """A run as far as it is compared."""

    tables, trajectory = {}, {}

    def __init__(self, fingerprint, ended_us, **summary):
        self.fingerprint, self.ended_us, self.called = fingerprint, ended_us, "run"
        self.summary, self.provenance = {"kind": "radio", **summary}, {}

    def plan(self):
        return SimpleNamespace(kind="radio", duration_us=50, made=self.fingerprint)


@pytest.fixture
def rows(monkeypatch):
    """The first rows in which two trails differ; and how far those went."""
    found, asked = [None], []
    run = networks()["radio"].run
    monkeypatch.setattr(run, "trail", lambda plan, until_us: asked.append(until_us))
    monkeypatch.setattr(run, "call_words", lambda plan, row: row["says"])
    monkeypatch.setattr(compares, "first_difference", lambda *_: found[0])
    monkeypatch.setattr(compares, "_side", lambda side: side)
    return found, asked


def row(time, says):
    return {"time": time, "says": says}


@pytest.mark.parametrize(
    ("found", "said"),
    [
        (None, None), ((row(2_000_000, "a"), row(1_500_000, "b")),
                       Divergence(1.5, "2.000000 s, a", "1.500000 s, b", same_call=False)),
        ((row(2_000_000, "a"), None), Divergence(2.0, "2.000000 s, a", "nothing more", False)),
        ((row(7, "a"), row(7, "a")), Divergence(7e-6, "0.000007 s, a", "0.000007 s, a", True)),
    ],
)  # fmt: skip
def test_where_two_runs_part(rows, found, said):
    rows[0][0] = found
    told = compare(Side("a", 40), Side("b", 90))
    assert told.divergence == said
    assert rows[1] == [40, 50], "each as far as it came"
    assert told.same == (said is None)


@pytest.mark.parametrize(("other", "looks"), [(("a", 40), False), (("b", 40), True),
                                              (("a", 41), True)])  # fmt: skip
def test_runs_are_played_again_only_if_they_differ(rows, other, looks):
    compare(Side("a", 40), Side(*other))
    assert bool(rows[1]) == looks


def test_what_to_know_besides(rows):
    one, other = Side("a", 250_000, interrupted_at_s=0.25), Side("a", 250_000)
    one.provenance = {"innervate": "1", "packages": {"numpy": "2"}, "host": "x"}
    other.provenance = {"innervate": "1", "packages": {"numpy": "3"}, "host": "y"}
    notes = compare(one, other).notes
    assert "packages differs: {'numpy': '2'} and {'numpy': '3'}" in notes
    assert "run was interrupted at 0.25 s" in notes
    assert not [note for note in notes if note.startswith(("innervate", "host"))]


NUMBA = type("TypingError", (Exception,), {"__module__": "numba.core.errors"})


def test_a_compiler_stops_at_the_innermost_place_in_the_folder(tmp_path):
    path = tmp_path / "protocol.py"
    said = (
        "Failed in nopython mode pipeline\nNo such thing\n"
        f'File "{path}", line 3:\nFile "{path}", line 7:\nFile "/elsewhere/x.py", line 9:\n'
    )
    told = blaming._compiling(NUMBA(said), tmp_path)
    assert told == f"{folders.shown(path)}:7: cannot be compiled: No such thing"
    assert blaming._compiling(NUMBA("nothing of ours"), tmp_path) == ""
    assert blaming._compiling(ValueError(said), tmp_path) == ""


def test_the_first_action_that_found_no_room_is_blamed():
    lines = iter([("protocol.py", 4), ("protocol.py", 9)])
    watch = SimpleNamespace(overflow=None, here=lambda: next(lines))
    flag = blaming.Told([0], partial(blaming.Watched._overflow_set, watch))
    flag[0] = 0
    assert watch.overflow is None
    flag[0] = 1
    flag[0] = 1
    assert (watch.overflow, flag[0]) == (("protocol.py", 4), 1)


def test_values_of_an_array_are_within_their_range_and_places_within_it():
    noted = []
    watch = SimpleNamespace(_ranges={"x": (0, 9)}, note=lambda *one: noted.append(one))
    made = blaming._Row([1, 2, 3], partial(blaming.Watched._in_row_set, watch, 5, "x"))
    made.name = "x"
    for value in (0, 9):
        made[1] = value
    assert noted == []
    for value in (-1, 10):
        made[1] = value
    assert noted == [(5, "x")] * 2
    assert made[2] == 3
    with pytest.raises(IndexError, match=r"x\[-1\]: an index is 0 to 2"):
        made[-1]
    with pytest.raises(IndexError, match=r"x\[-1\]"):
        made[-1] = 0


@pytest.mark.parametrize(
    ("handled", "nodes", "plays"),
    [(blaming.AGAIN_EVENTS, blaming.TRIAL_NODES, True), (blaming.AGAIN_EVENTS + 1, 2, False),
     (1, blaming.TRIAL_NODES + 1, False)],
)  # fmt: skip
def test_a_run_that_broke_soon_enough_is_played_again(monkeypatch, handled, nodes, plays):
    played = []
    monkeypatch.setattr(blaming, "_play", lambda *one: played.append(one[2]))
    plan = SimpleNamespace(nodes=nodes)
    with pytest.raises(folders.NetworkError, match="broken at 1 s"):
        blaming.again("net", plan, handled, ValueError("broken at 1 s"))
    assert played == [blaming.AGAIN_EVENTS] * plays
    played.clear()
    monkeypatch.setattr(blaming, "_tried", set())
    for _ in range(2):
        blaming.try_plain("net", plan)
    assert played == [blaming.TRIAL_EVENTS] * (nodes <= blaming.TRIAL_NODES)


@pytest.mark.parametrize("count", [0, 1, 2, 3, 5])
def test_smaller_scenarios_have_half_the_events_or_one_fewer(monkeypatch, count):
    monkeypatch.setattr(networks()["radio"].random, "smaller", lambda tables: iter(["more"]))
    events = list(range(count))
    *found, more = fuzz.smaller({"kind": "radio", "event": events})
    assert more == "more"
    left = [one["event"] for one in found]
    halves = [half for half in (events[: count // 2], events[count // 2 :]) if half != events]
    assert left == [*halves, *([e for e in events if e != gone] for gone in events)]
    assert len(left) == 0 if not count else all(len(one) < count for one in left)


def test_networks_are_named_by_name_or_folder(tmp_path):
    assert named("radio") is networks()["radio"]
    with pytest.raises(folders.NetworkError, match="there is no network 'none'; name a folder or"):
        named("none")


class Cell:
    """A cell of a notebook: what it shows."""

    def __init__(self):
        self.shown = []

    def update(self, what, raw=False):
        self.shown.append(what)


def test_in_a_cell_a_bar_is_shown_now_and_then_and_gone_in_the_end(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(showing, "time", SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(showing, "_html", lambda *one: one)
    bar = showing.Bar()
    assert bar.simulated is None
    bar.show("nobody looks", 1, 2)
    bar._handle = cell = Cell()
    told = bar.simulated
    for later_s in (0.0, 0.05, 0.11, 0.15, 0.22):
        now[0] = 100.0 + later_s
        told(round(1e6 * later_s), 2_000_000)
    assert cell.shown == [
        ("simulated 0.00 of 2 s", 0, 2_000_000), ("simulated 0.11 of 2 s", 110_000, 2_000_000),
        ("simulated 0.22 of 2 s", 220_000, 2_000_000),
    ]  # fmt: skip
    now[0] = 200.0
    states = [SimpleNamespace(done=2, goal=5), SimpleNamespace(done=1, goal=5)]
    bar.swept(SimpleNamespace(states=states, lacks=""))
    assert cell.shown[-1] == ("3 of 10 runs", 3, 10)
    now[0] = 250.0
    bar.swept(SimpleNamespace(states=states, lacks="waits for workers"))
    assert cell.shown[-1] == ("waits for workers", 3, 10)
    now[0] = 300.0
    assert bar.explored("ring", 4, 0) is False
    assert cell.shown[-1] == ("ring", 4, 0)
    bar.__exit__(None, None, None)
    assert cell.shown[-1] == {"text/plain": "", "text/html": ""}


@pytest.mark.parametrize(("summary", "ended_us"), [
    ({"duration_s": 1.1}, 1_100_000), ({"duration_s": 3}, 3_000_000),
    ({"duration_s": 3, "interrupted_at_s": 1.1}, 1_100_000),
    ({"duration_s": 3, "interrupted_at_s": 0.0}, 0),
])  # fmt: skip
def test_a_run_came_to_a_whole_microsecond(summary, ended_us):
    """1e6 * 1.1 is not one."""

    def side(summary):
        return compares._Side("a run", summary, {}, {}, dict)

    assert (side(summary).ended_us, type(side(summary).ended_us)) == (ended_us, int)
    for damaged in ({}, {"duration_s": "3"}):
        with pytest.raises(RunError, match="a run: its summary is damaged"):
            _ = side(damaged).ended_us


@pytest.mark.parametrize("is_told", [True, False])
def test_who_wants_to_be_told_how_far_a_run_is_is_told_and_else_a_bar_is_shown(
    monkeypatch, is_told
):
    shown, told, given = [], [], []
    bar = SimpleNamespace(simulated=lambda *now: shown.append(now))

    def simulate(plan, *, progress, **how):
        given.append(how)
        progress(1, 2)

    room = SimpleNamespace(simulate=simulate, summarize=lambda result: {})
    monkeypatch.setattr(runs, "Bar", lambda: nullcontext(bar))
    monkeypatch.setattr(runs, "networks", lambda: {"radio": SimpleNamespace(run=room)})
    how = {"progress": lambda *now: told.append(now)} if is_told else {}
    runs.run(RADIO, checks=False, received=True, **how)
    assert (told, shown) == (([(1, 2)], []) if is_told else ([], [(1, 2)]))
    assert given == [{"plain": False, "checks": False, "received": True}]
