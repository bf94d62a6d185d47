import signal
import subprocess
import sys
from pathlib import Path

import pytest

from innervate.cli import errors
from innervate.sim.driver import InvariantBroken, Simulation

WRONG = {
    "unknown command": (("runn", "x"), 'Did you mean "run"?'),
    "unknown option": (("run", "four.toml", "--sed", "3"), "Did you mean --seed?"),
    "no file named": (("run",), "run needs FILE"),
    "no option": (("size", "ur5.urdf"), "innervate: size needs --links; see: innervate size"),
    "size of a network": (("size", "mesh"), "size is of skins: it lays cells on a robot's body"),
    "size of a scenario": (("size", "four.toml"), "innervate sweep compares sizes: --vary"),
    "schema of no folder": (("schema", "fuor"), "fuor: no such folder; name one with a network.py"),
    "no value": (("run", "four.toml", "--seed"), "--seed needs a value"),
    "not a number": (("run", "four.toml", "--seed", "x"), '"x"'),
    "no number": (("live", "up", "four.toml", "--for", "2s"), '--for must be a number, not "2s"'),
    "no whole number": (("live", "send", "n0", "x", "hi"), 'TO must be a whole number, not "x"'),
    "negative seed": (("run", "four.toml", "--seed", "-3"), "seed must be a whole number from 0"),
    "no such file": (("run", "fuor.toml"), "fuor.toml: no such file"),
    "a folder": (("run", "."), "this is a folder"),
    "no such bundled one": (("check", "setup-11"), 'did you mean "setup-1"?'),
    "wrong key": (("run", "four.toml", "--set", "protocol.kk=3"), 'did you mean "k"?'),
    "no value to set": (("run", "four.toml", "--set", "protocol.k"), "write it as key=value"),
    "no such cell": (("check", "four.toml", "--set", "interface.0.row=9"), "there is no row 9"),
    "no such kind": (("new", "mash"), 'there is no kind "mash"; did you mean "mesh"?'),
    "an empty kind": (("new", ""), 'there is no kind ""; there is skin'),
    "a kind of one's own": (("new", "ring"), "your own: innervate new network NAME"),
    "not a run": (("compare", ".", "."), "is not a run folder"),
    "a file": (("compare", "four.toml", "."), "four.toml is not a run folder: it is a file"),
    "csv of what": (("export", "line", "--csv"), "--csv needs --tables"),
    "a scenario as a node": (("live", "node", "four.toml"), "innervate live up four.toml"),
    "nodes of a cell": (("firmware", "skin", "--nodes", "9", "--out", "x"), "leave out --nodes"),
    "out is a file": (("run", "four.toml", "--out", "four.toml"), "choose another folder"),
    "out is somebody's": (("run", "four.toml", "--out", "."), "not a run folder and not empty"),
    "too many words": (("check", "four.toml", "more"), "more"),
}


@pytest.mark.parametrize(("tokens", "says"), WRONG.values(), ids=WRONG.keys())
def test_mistakes_of_the_user_are_one_line_and_2(sh, tokens, says):
    assert sh(*tokens) == 2
    assert sh.out == ""
    assert sh.err.count("\n") == 1
    assert sh.err.startswith("innervate: ")
    assert says in sh.err
    assert sorted(path.name for path in Path().iterdir()) == ["four.toml"]


def test_a_line_number_where_there_is_one(sh):
    Path("bad.toml").write_text('kind = "skin"\n[[patch]]\ncolumns = 0\nrows = 1\n')
    assert sh("check", "bad.toml") == 2
    assert sh.err.startswith("innervate: bad.toml:3: ")


def test_a_folder_that_is_gone_is_told_as_such(sh, tmp_path, monkeypatch):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert sh("prove", "gossip") == 2
    assert sh.err.startswith("innervate: the current folder is not there any more; ")


def failing(error):
    def fail(*_, **__):
        raise error

    return fail


@pytest.mark.parametrize(
    ("error", "code", "says"),
    [
        (InvariantBroken("invariant broken at 2.000000 s (seed 1): forwarding loop through "
                         "p0 r1 c2"), 1, "seed 1): forwarding loop through p0 r1 c2; please"),
        (RuntimeError("first\nsecond"), 1, "internal error, RuntimeError: first second"),
        (MemoryError(), 1, "not enough memory"),
        (OSError(28, "No space left on device"), 1, "No space left on device"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (KeyboardInterrupt("interrupted; it is kept"), 130, "interrupted; it is kept"),
        (errors.UserError("change this"), 2, "change this"),
    ],
)  # fmt: skip
def test_exit_codes(sh, monkeypatch, error, code, says):
    monkeypatch.setattr("innervate.scenario.bundled", failing(error))
    assert sh("scenarios") == code
    assert says in sh.err
    assert sh.err.count("\n") == 1
    assert "Traceback" not in sh.err


def test_a_traceback_on_request(sh, monkeypatch):
    monkeypatch.setattr("innervate.scenario.bundled", failing(RuntimeError("x")))
    monkeypatch.setenv("INNERVATE_TRACEBACK", "1")
    assert sh("scenarios") == 1
    assert "Traceback" in sh.err
    assert sh.err.endswith("(INNERVATE_TRACEBACK=1 shows where)\n")


@pytest.mark.parametrize(
    ("module", "extra"), [("numba", "sim"), ("polars.x", "sim"), ("matplotlib", "plot")]
)
def test_a_missing_part_says_what_to_install(sh, monkeypatch, module, extra):
    error = ModuleNotFoundError(f"No module named '{module}'", name=module)
    monkeypatch.setattr("innervate.scenario.bundled", failing(error))
    assert sh("scenarios") == 2
    name = module.partition(".")[0]
    assert f"needs {name}; install it with: pip install 'innervate[{extra}]'" in sh.err


def test_a_missing_module_of_our_own_is_our_mistake(sh, monkeypatch):
    error = ModuleNotFoundError("No module named 'innervate.nowhere'", name="innervate.nowhere")
    monkeypatch.setattr("innervate.scenario.bundled", failing(error))
    assert sh("scenarios") == 1


def test_nothing_is_left_of_a_run_that_fails(sh, monkeypatch):
    from innervate.plot import report

    monkeypatch.setattr(report, "render", failing(RuntimeError("no ink")))
    assert sh("run", "four.toml") == 1
    assert list(Path("runs").rglob("*.*")) == []


def test_control_characters_do_not_reach_the_terminal(sh):
    assert sh("check", "a\x1b[31mb\nc") == 2
    assert "\x1b" not in sh.err
    assert sh.err.count("\n") == 1


def test_interrupted_runs_end_with_130(sh, monkeypatch):
    from innervate.cli import progress

    def interrupt(*_):
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(progress.Progress, "__call__", interrupt)
    monkeypatch.setattr(Simulation, "slice_events", 500)
    assert sh("run", "four.toml") == 130
    assert "Interrupted at 0." in sh.out
    assert Path("runs/four-1/summary.json").exists()


@pytest.mark.parametrize("words", [
    ("sweep", "four.toml", "--repeat", "2.5"), ("live", "command", "pc", "3.7"),
    ("live", "command", "pc", "3", "0x1.8"), ("new", "mesh", "--nodes", "20.5"),
])  # fmt: skip
def test_half_a_number_is_not_rounded(sh, words):
    assert sh(*words) == 2
    assert f'must be a whole number, not "{words[-1]}"' in sh.err


def test_numbers_may_begin_with_0_and_be_written_in_hex(sh, monkeypatch):
    monkeypatch.setenv("INNERVATE_RUN", str(Path("nobody").absolute()))
    for code in ("007", "0x1F"):
        assert sh("live", "command", "pc", code) == 2
        assert 'no node "pc" runs here' in sh.err


def test_live_means_nodes_whatever_a_folder_is_called(sh, monkeypatch):
    monkeypatch.setenv("INNERVATE_RUN", str(Path("nobody").absolute()))
    assert sh("watch", "live") == 2
    assert "no node runs here" in sh.err
    assert "./live" not in sh.err
    Path("live").mkdir()
    assert sh("watch", "live") == 2
    assert "no node runs here" in sh.err
    assert sh.err.endswith("what is called live here: innervate watch ./live\n")
    assert sh("watch", "./live") == 2
    assert "is not a run folder" in sh.err


def test_sys_exit_inside_is_kept():
    assert errors.conclude(SystemExit(3)) == 3
    assert errors.conclude(SystemExit()) == 0
    assert errors.conclude(SystemExit("why")) == 1


@pytest.mark.parametrize(("words", "close"), [(["runn"], "run"), (["live", "stauts"], "status")])
def test_a_word_that_is_no_command_needs_no_part(tmp_path, words, close):
    code = (f"import sys; sys.modules |= dict.fromkeys({list(errors.EXTRA_OF)!r})\n"
            f"from innervate.cli import main; sys.exit(main({words!r}))")  # fmt: skip
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          cwd=tmp_path, check=False)  # fmt: skip
    assert done.returncode == 2
    assert f'Did you mean "{close}"?' in done.stderr
