"""`innervate verify`: what it prints, writes and returns."""

import json
import re
import signal
from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate.cli import verifying
from innervate.networks.skin.plot import counterexample
from innervate.networks.skin.verify import assumptions, graphs, story
from innervate.networks.skin.verify.system import SkinModel
from innervate.verify.cases import Case, lines_of
from innervate.verify.explore import Result, Tally

SMALL = ("--plain", "--graph", "pc-1 1-2", "--updates", "periodic", "--budget", "ticks=2,faults=1")


def test_nothing_broken_is_0(sh):
    assert sh("verify", *SMALL) == 0
    first, *_, last = sh.out.splitlines()
    assert first.startswith("pc-1 1-2 ")
    assert "all states; settled in" in first
    assert last == "Nothing broken in one exploration, completely."


def test_the_command_says_what_is_proved_argued_and_trusted(sh, monkeypatch):
    words = ("verify", "--plain", "--graph", "pc-1", "--updates", "periodic", "--states", "50")
    monkeypatch.setattr(assumptions, "can_prove", lambda: False)
    assert sh(*words) == 0
    assert "taken on trust, since z3 is missing" in sh.out
    assert "proved:" not in sh.out
    assert sh(*words, "--json") == 0
    assert set(json.loads(sh.out)[0]["reductions"]) == {"trusted", "argued", "page"}
    monkeypatch.undo()
    assert sh(*words) == 0
    (line,) = [line for line in sh.out.splitlines() if "argued" in line]
    assert re.search(r"proved: the rule, .*; argued: that no more is forgotten than this", line)
    assert "trust" not in sh.out
    assert sh(*words, "--json") == 0
    assert set(json.loads(sh.out)[0]["reductions"]) == {"proved", "argued", "page"}
    assert sh(*words, "--rule", "paper", "--json") == 0
    assert set(json.loads(sh.out)[0]["reductions"]) == {"proved", "argued", "page"}
    assert sh(*words, "--no-reduce") == 0
    assert "argued" not in sh.out


def test_states_can_be_explored_unreduced(sh):
    counts = []
    for words in ((), ("--no-reduce",)):
        assert sh("verify", *SMALL, *words, "--no-liveness", "--json") == 0
        counts.append(json.loads(sh.out)[0]["states"])
    assert 50 < counts[0] < counts[1]


def test_ticks_may_be_as_many_as_it_takes(sh):
    words = ("verify", "--plain", "--graph", "pc-1", "--budget", "ticks=any,faults=1")
    assert sh(*words, "--json") == 0
    cases = json.loads(sh.out)
    assert [case["budget"]["ticks"] for case in cases] == ["any", "any"]
    assert [case["fair"]["ended"] for case in cases] == ["complete", "complete"]
    assert sh(*words, "--no-reduce") == 2
    assert "--no-reduce" in sh.err


def test_a_sample_is_called_one(sh):
    assert sh("verify", *SMALL, "--states", "50", "--no-liveness") == 0
    assert "as asked" in sh.out
    assert sh.out.splitlines()[-1] == "Nothing broken in one exploration, only in part."
    assert sh("verify", *SMALL, "--walks", "20") == 0
    assert "20 walks " in sh.out
    assert "a sample of random walks" in sh.out


def test_a_counterexample_is_told_written_and_1(sh):
    words = ("--plain", "--graph", "triangle", "--rule", "paper", "--updates", "periodic")
    assert sh("verify", *words, "--out", "found") == 1
    assert "    1. The PC sends its beacon with number 1." in sh.out
    assert "So: closed loop n1 -> " in sh.out
    assert {path.suffix for path in Path("found").iterdir()} == {".svg", ".toml", ".txt"}
    assert sh("run", "found/counterexample-1.toml", "--no-report") == 0
    assert "1 forwarding loop" in sh.out


def test_a_counterexample_that_cannot_be_written_is_one_line_and_not_there(sh, full_disk):
    words = ("--plain", "--graph", "triangle", "--rule", "paper", "--updates", "periodic")
    with full_disk():
        assert sh("verify", *words, "--no-liveness", "--out", "found") == 2
    (line,) = sh.err.splitlines()
    assert line.startswith("innervate: found/counterexample-1.toml cannot be written: ")
    assert not list(Path("found").iterdir())


@pytest.mark.parametrize("place", ["taken", "taken/below"])
def test_a_place_that_is_none_for_counterexamples_is_told_before_anything_is_explored(sh, place):
    Path("taken").write_text("mine")
    assert sh("verify", *SMALL, "--out", place) == 2
    assert (sh.out, sh.err) == (
        "", f"innervate: {place} cannot be written: taken is no folder; choose another place\n"
    )  # fmt: skip


def test_a_name_that_is_too_long_for_a_folder_is_a_mistake_in_what_was_given(sh):
    assert sh("verify", *SMALL, "--out", "x" * 300) == 2
    assert sh.err.endswith(" cannot be written: File name too long; choose another place\n")


def test_json_is_all_there_is(sh):
    assert sh("verify", *SMALL, "--rule", "all", "--json") in (0, 1)
    cases = json.loads(sh.out)
    assert [case["rule"] for case in cases] == ["feasible", "strict", "paper", "paper-lax"]
    assert cases[0]["fair"]["ended"] == "complete"
    assert all(case["states"] > 100 for case in cases)


def test_a_mesh_is_explored(sh):
    assert sh("verify", "mesh", "--graph", "line", "--rule", "graph") == 0
    assert "0-1 1-2 " in sh.out
    assert "all states; settled in" in sh.out
    assert sh.out.splitlines()[-1] == "Nothing broken in one exploration, completely."
    assert sh("verify", "mesh", "--graph", "line", "--rule", "graph", "--walks", "9", "--json") == 0
    assert [case["ended"] for case in json.loads(sh.out)] == ["walked"]


def test_a_mesh_counterexample_is_told_written_and_1(sh):
    assert sh("verify", "mesh", "--rule", "random", "--out", "found") == 1
    assert "    1. Node 1 is given message 1 for node 0." in sh.out
    assert "between nodes 1 and 2, for good" in sh.out
    assert {path.suffix for path in Path("found").iterdir()} == {".svg", ".toml", ".txt"}
    assert sh("run", "found/mesh-counterexample-1.toml", "--no-report", "--json") == 0
    assert json.loads(sh.out)["looped"] > 30


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("car",), 'verify explores skin, radio, mesh, babel, flooding or rpl, not "car"'),
        (("mesh", "--rule", "guess"), "--rule is a failover for a mesh, search"),
        (("mesh", "--graph", "0-1 2-3"), "a mesh joins the nodes 0, 1, ... by links"),
        (("mesh", "--budget", "cuts=1"), "the names are deaths, revivals, frames, acks, ticks"),
        (("--rule", "other"), "--rule is feasible, strict, paper, paper-lax or all"),
        (("--graph", "pc-1 3-4"), "all of them by cables"),
        (("--cells", "9"), "--cells must be 1 to 4"),
        (("--budget", "ticks=many"), "should be NAME=NUMBER"),
        (("--walks", "-3"), "--walks must be 0 or more"),
        (("--memory", "lots"), "--memory takes a size like 800M or 4G"),
        (("--plain", "--memory", "1M"), "give at least 64 MB"),
        (("radio", "--cells", "7"), "--cells is 2 to 4 stations"),
        (("radio", "--rule", "strict"), "--rule is practical or paper for radio"),
    ],
)
def test_mistakes_are_one_line(sh, words, line):
    assert sh("verify", *words) == 2
    assert line in sh.err
    assert sh.err.count("\n") == 1


def test_random_networks_end_after_as_many_as_asked_for(sh):
    assert sh("verify", "--random", "--seed", "3", "--count", "1") == 0
    assert sh.out == "Nothing broken in 1 network, 3.\n"


def test_who_interrupts_between_two_explorations_is_told_that_others_were_to_come(capsys):
    """The first ends by itself, with all that it was to look at, as Ctrl-C comes."""

    def first(tell):
        signal.raise_signal(signal.SIGINT)
        return Case(["the first"], {}, is_broken=False)

    def network(*explores):
        room = SimpleNamespace(explorations=lambda *_: explores, notice=lambda _: "")
        return SimpleNamespace(verify=room)

    said = "Nothing broken in one exploration, completely"
    for more, end in (((first,), "; interrupted before the others."), ((), ".")):
        code = verifying._explore(network(first, *more), None, as_json=False, out=None)
        assert code == 130
        assert capsys.readouterr().out == f"the first\n{said}{end}\n"


@pytest.mark.parametrize("count", [0, 1])
def test_who_interrupts_while_the_next_is_compiled_has_those_before_it(capsys, count):
    def first(tell):
        return Case(["the first"], {"graph": "the first"}, is_broken=False)

    def second(tell):
        raise KeyboardInterrupt

    explores = [first] * count + [second]
    room = SimpleNamespace(explorations=lambda *_: explores, notice=lambda _: "")
    network = SimpleNamespace(verify=room)
    if not count:
        with pytest.raises(KeyboardInterrupt):
            verifying._explore(network, None, as_json=True, out=None)
        assert capsys.readouterr().out == ""
        return
    assert verifying._explore(network, None, as_json=True, out=None) == 130
    assert json.loads(capsys.readouterr().out) == [{"graph": "the first"}]
    assert verifying._explore(network, None, as_json=False, out=None) == 130
    assert capsys.readouterr().out.endswith("completely; interrupted before the others.\n")


def test_a_story_in_short_is_written_without_a_picture_of_events(tmp_path, capsys):
    """There was no room for the search that its events need."""
    short = story.in_short(Result(SkinModel(graphs.parse("pair")), Tally(), 1, [b""] * 3))
    case = Case(lines_of("pair", short, str), {}, is_broken=True, story=short)
    network = SimpleNamespace(
        verify=SimpleNamespace(explorations=lambda *_: [lambda tell: case], notice=lambda _: ""),
        has=lambda part: True, counterexample=counterexample.save,
    )  # fmt: skip
    assert verifying._explore(network, None, as_json=False, out=tmp_path) == 1
    so = "So: closed loop, after 3 events or a few more"
    written = f"    Written: {tmp_path / 'counterexample-1'}.txt"
    assert capsys.readouterr().out.splitlines() == ["pair  BROKEN", f"    {so}", written,
                                                    "1 of 1 broken."]  # fmt: skip
    assert [(one.name, one.read_text("utf-8")) for one in tmp_path.iterdir()] == [
        ("counterexample-1.txt", f"{so}\n")
    ]


def test_who_asks_for_mistakes_that_are_not_listed_is_told_so(sh):
    assert sh("verify", "flooding", "--mutants") == 0
    assert sh.out == "No mistakes are listed for flooding.\n"
