"""Networks that are folders: found, loaded anew when edited, refused with file and line."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import innervate
from boards import join
from innervate.cli import main
from innervate.network import NetworkError, networks, use
from innervate.sweeping import make_plan
from tests.own import alone, made, own

__all__ = ["alone", "own"]


def said(capsys, *words):
    """What a command that fails says, in one line."""
    assert main([str(word) for word in words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def test_it_is_found_beside_its_scenario_and_in_the_working_folder(own, capsys, alone):
    assert main(["check", str(own.scenario)]) == 0
    assert "gossip: a gossip scenario of 0.5 s" in capsys.readouterr().out
    assert innervate.check({"kind": "gossip"}).startswith("gossip: a gossip scenario")
    other = alone / "elsewhere" / "one.toml"
    other.parent.mkdir()
    other.write_text('kind = "gossip"\n')
    assert main(["check", str(other)]) == 0


def test_a_name_that_begins_with_a_vowel_has_its_article(alone, capsys):
    made(alone / "elect")
    assert innervate.check({"kind": "elect"}).startswith("elect: an elect scenario")
    capsys.readouterr()
    assert main(["new", "elect"]) == 0
    assert capsys.readouterr().out.startswith("# An elect over cables.")


def test_what_is_wrong_with_a_line_is_said_once(own, capsys):
    own.change("protocol.py", "NEWS = 1  # a kind of frame", "NEWS, OTHER = 1, 2")
    assert main(["check-protocol", str(own.folder)]) == 2
    lines = capsys.readouterr().out.splitlines()
    assert lines
    assert sorted(set(lines)) == sorted(lines)


def test_only_a_folder_of_the_kinds_name_is_loaded(own, alone):
    (own.folder / "network.py").write_text("raise SystemError")
    with pytest.raises(innervate.ScenarioError, match="kind must be"):
        innervate.check({"kind": "gossips"})
    assert "gossip" not in networks()


def test_a_folder_is_known_by_its_path_or_its_text(own):
    assert innervate.use("gossip") is innervate.use(own.folder) is networks()["gossip"]


def test_by_the_option_and_by_the_environment(own, capsys, monkeypatch, alone):
    (alone / "far").mkdir()
    monkeypatch.chdir(alone / "far")
    (alone / "far" / "one.toml").write_text('kind = "gossip"\n')
    assert "name the folder of one of your own: --network DIR" in said(capsys, "check", "one.toml")
    assert main(["check", "one.toml", "--network", str(own.folder)]) == 0
    assert main(["check", "--network=../gossip", "one.toml"]) == 0
    assert os.environ["INNERVATE_NETWORKS"] == str(own.folder)  # for processes begun from here
    assert main(["check", "one.toml"]) == 0
    assert "--network needs a folder" in said(capsys, "check", "one.toml", "--network")
    assert "no such folder" in said(capsys, "check", "one.toml", "--network", "nowhere")


def test_an_edit_to_the_same_length_within_a_second_is_read(own, monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    second = 1_700_000_000_000_000_000

    def outbox(at_ns):
        os.utime(own.folder / "protocol.py", ns=(at_ns, at_ns))
        innervate.check(own.scenario)
        return networks()["gossip"].protocol.OUTBOX

    assert outbox(second) == 8
    own.change("protocol.py", "OUTBOX = 8", "OUTBOX = 9")
    assert outbox(second + 1) == 9


def test_an_edited_protocol_is_another_sweep(own):
    """A sweep that goes on has no runs of a protocol as it was before an edit among the others."""

    def known_by():
        innervate.check(own.scenario)
        return make_plan(own.scenario).identity()

    before = known_by()
    assert known_by() == before
    own.change("protocol.py", "    node.value = item.value\n", "    node.value = item.value + 1\n")
    assert dict(known_by().items() ^ before.items()).keys() == {"the network gossip"}
    assert "the network radio" not in make_plan({"kind": "radio"}).identity()


def test_an_edited_protocol_is_read_again(own):
    def values():
        return {node.value for node in innervate.run(own.scenario, plain=True).result.world.cells}

    assert values() == {9}
    own.change("protocol.py", "    node.value = item.value\n", "    node.value = item.value + 1\n")
    assert values() == {10}


def test_of_two_folders_of_one_name_that_counts_which_was_named_last(own, alone):
    second = made(alone / "other" / "gossip")
    second.change("fields.py", '"beat_us": 10_000', '"beat_us": 20_000')
    assert "beat_us 10000" in innervate.check(own.scenario)
    text = 'kind = "gossip"\n'
    for folder, beat in ((second.folder, 20_000), (own.folder, 10_000)):
        (folder / "one.toml").write_text(text)
        assert f"beat_us {beat}" in innervate.check(folder / "one.toml")


BROKEN = {
    "out of range": ("fields.py", "0, 0, 255, \"raw\", \"what it says\"",
                     "0, 0, 1 << 40, \"raw\", \"what it says\"",
                     '("value"', "has a range beyond 2^30"),
    "turned round": ("fields.py", "0, 1000, 1_000_000", "0, 1000, 10", "beat_us", "lower first"),
    "no field": ("fields.py", ', "who we are")', ")", '"number"', "is not whole"),
    "handler missing": ("protocol.py", "def on_input(", "def on_inputs(", '"""', "has no on_input"),
    "arguments": ("protocol.py", "on_timer(node, params, now, timer, out)", "on_timer(node, out)",
                  "def on_timer", "on_timer takes 2 arguments; it is on_timer(state, params, now"),
    "no layout": ("protocol.py", "frame.kind = NEWS", "frame.kind = NEWS", "", ""),
    "ends": ("frames.py", "KIND_BITS = 4", 'ENDS = {"source": "version"}\nKIND_BITS = 4', "ENDS",
             "ENDS is (field of the sender, of the recipient, number of all)"),
    "ends of no field": ("frames.py", "KIND_BITS = 4", 'ENDS = ("version", "to", 7)\nKIND_BITS = 4',
                         "ENDS", "ENDS: to is no field of FRAME"),
    "bits": ("frames.py", '("value", 0, 8, 0)', '("value", 0, 7, 0)', "LAYOUTS",
             "value is 0 to 255 in FRAME; 7 bits hold 0 to 127"),
    "not carried": ("frames.py", ', ("value", 0, 8, 0)', ", ", "LAYOUTS", "no frame carries value"),
    "no such field": ("frames.py", '("value", 0', '("valeu", 0', "LAYOUTS", "valeu is no field"),
    "loop without bound": ("protocol.py", "    fill(out.frame[send(out, port, 0, 0)], node)\n",
                           "    while port < 4:\n        fill(out.frame[send(out, port, 0, 0)], "
                           "node)\n", "while", "a loop without bound"),
    "no such name": ("protocol.py", "    node.value = item.value", "    node.value = itme.value",
                     "itme", "itme is given no value here, and is no constant"),
    "float": ("protocol.py", "    node.value = item.value", "    node.value = item.value / 2",
              "/ 2", "divide whole numbers with //"),
    "import": ("protocol.py", "NEWS = 1", "import random\nNEWS = 1", "import random",
               "imports random"),
    "no Python": ("protocol.py", "NEWS = 1", "NEWS = = 1", "NEWS", "is no Python"),
    "no timers": ("protocol.py", "TIMERS = 1", "TIMER_COUNT = 1", '"""', "has no TIMERS"),
    "import that fails": ("fields.py", "STATE = (", "import nothing_of_that\nSTATE = (",
                          "import nothing_of_that", "ModuleNotFoundError"),
    "part": ("network.py", 'fields="fields"', 'feilds="fields"', "Network(",
             "no part 'feilds'; did you mean 'fields'?"),
    "table": ("fields.py", "STATE = (", "STAT = (", '"""What', "has no STATE; add STATE = ()"),
    "no such field to rule": ("invariants.py", "node.value == 0", "node.valeu == 0", "valeu",
                              'valeu is no field that fields.py declares; did you mean "value"?'),
    "invariant": ("invariants.py", "    return 1\n", "    return 1.0\n", "1.0", "a float"),
}  # fmt: skip
del BROKEN["no layout"]


@pytest.mark.parametrize("wrong", BROKEN)
def test_what_is_wrong_is_said_in_one_line_with_file_and_line(own, capsys, wrong):
    file, old, new, where, words = BROKEN[wrong]
    own.change(file, old, new)
    line = said(capsys, "run", own.scenario)
    assert line.startswith(f"innervate: gossip/{file}:{own.line(file, where)}: ")
    assert words in line


def test_what_users_hand_in_and_nobody_sends_needs_no_bits(own, capsys):
    own.change("fields.py", "FRAME = (\n", 'FRAME = (\n    ("more", 0, 0, 7, "raw", "to it"),\n')
    line = said(capsys, "check", own.scenario)
    assert "no frame carries more of FRAME; give it bits" in line
    own.change("fields.py", '(1, {"value": 7})', '(1, {"value": 7, "more": 3})')
    own.change("protocol.py", "    node.value = item.value\n",
               "    node.value = (item.value + item.more) % 256\n")  # fmt: skip
    text = own.scenario.read_text().replace(
        "item = { value = 7 }", "item = { value = 7, more = 2 }"
    )
    own.scenario.write_text(text.replace("value = 9", "value = 9, more = 3"))
    assert "more = 2" in text
    run = innervate.run(own.scenario, plain=True)
    assert {node.value for node in run.nodes} == {12}
    assert main(["firmware", str(own.folder), "--out", "c"]) == 0
    own.change("protocol.py", "    frame.value = node.value\n",
               "    frame.value = node.value\n    frame.more = 1\n")  # fmt: skip
    assert "no frame carries more of FRAME" in said(capsys, "check", own.scenario)


@pytest.fixture
def by_module(own):
    """A network whose protocol takes its numbers from modules, by the modules' names."""
    (own.folder / "sizes.py").write_text('"""How much."""\n\nPORTS = 4\nSTEP = 1\n')
    own.change("protocol.py", "import MASK16, MASK30, later\n", "import later\n")
    own.change("protocol.py", "from innervate.dialect.outbox",
               "from gossip import sizes\nfrom innervate.dialect import arith\n"
               "from innervate.dialect.outbox")  # fmt: skip
    own.change("protocol.py", "PORTS = 4\n", "")
    own.change("protocol.py", "node.version + 1)", "node.version + sizes.STEP)")
    path = own.folder / "protocol.py"
    text = path.read_text().replace("range(PORTS)", "range(sizes.PORTS)")
    path.write_text(text.replace("MASK", "arith.MASK"))
    return own


def test_numbers_by_their_modules_names_do_the_same_everywhere(by_module, own, capsys, tmp_path):
    assert main(["check-protocol", str(own.folder)]) == 0
    assert "at most 5 actions a call of 8" in capsys.readouterr().out
    run = innervate.run(own.scenario, plain=True)
    assert {(node.version, node.value) for node in run.result.world.cells} == {(2, 9)}
    assert main(["firmware", str(own.folder), "--out", str(tmp_path / "c")]) == 0
    text = (tmp_path / "c" / "gossip.c").read_text()
    assert "(uint16_t)((node->version + GOSSIP_STEP) & GOSSIP_MASK16)" in text
    assert "#define GOSSIP_STEP 1" in (tmp_path / "c" / "gossip.h").read_text()
    board = join.joined("gossip.protocol")
    assert "node.version = node.version + 1 & 65535" in board
    assert "sizes" not in board


def test_actions_are_counted_where_a_module_has_another_name_here(by_module, own, capsys):
    path = own.folder / "protocol.py"
    text = path.read_text().replace("import sizes", "import sizes as size")
    path.write_text(text.replace("sizes.", "size."))
    assert main(["check-protocol", "--no-tests", str(own.folder)]) == 0
    assert "at most 5 actions a call of 8" in capsys.readouterr().out


@pytest.mark.slow
def test_a_number_of_another_file_that_is_edited_is_compiled_anew(by_module, own):
    for step in (1, 3):
        own.change("sizes.py", "STEP = 1", f"STEP = {step}")
        runs = [innervate.run(own.scenario, plain=is_plain) for is_plain in (True, False)]
        plain, compiled = (run.result.world.cells for run in runs)
        assert {node.version for node in plain} == {2 * step}
        assert set(compiled["version"]) == {2 * step}
        assert runs[0].summary["frames"] == runs[1].summary["frames"]


@pytest.mark.parametrize(("old", "new", "says"), [
    ("+ sizes.STEP", "+ sizes.STEPS", "sizes.STEPS is no whole number of that module"),
    ("+ sizes.STEP", "+ sizes.step", "sizes.step of a module that is imported; only its constants"),
    ("for p in range(", "for sizes in range(",
     "sizes is a module here, and a variable; rename the variable"),
])  # fmt: skip
def test_what_is_no_number_of_a_module_is_told(by_module, own, capsys, old, new, says):
    path = own.folder / "protocol.py"
    path.write_text(path.read_text().replace(old, new, 1))
    line = own.line("protocol.py", new.partition("\n")[0])
    assert f"gossip/protocol.py:{line}: {says}" in said(capsys, "check", own.scenario)


def test_a_frame_that_has_no_layout(own, capsys):
    own.change("protocol.py", "    fill(out.frame[send(out, port, 0, 0)], node)\n",
               "    hello = out.frame[send(out, port, 0, 0)]\n    hello.kind = 2\n")  # fmt: skip
    at = own.line("protocol.py", "hello.kind")
    line = said(capsys, "run", own.scenario)
    assert f"gossip/protocol.py:{at}: a frame of kind 2 is sent, and has no layout" in line


def test_a_frame_that_has_no_layout_and_is_filled_elsewhere(own, capsys):
    own.change("protocol.py", "    frame.kind = NEWS\n", "    frame.kind = NEWS + 2\n")
    at = own.line("protocol.py", "NEWS + 2")
    line = said(capsys, "run", own.scenario)
    assert f"gossip/protocol.py:{at}: a frame of kind 3 is sent, and has no layout" in line


def test_a_name_that_is_taken(alone, own, capsys):
    for name in ("skin", "json", "numpy"):
        assert f"the name '{name}' is taken" in said(capsys, "new", "network", name)
    assert "is there already" in said(capsys, "new", "network", "gossip")
    for name in ("Mine", "my-net", "2nd"):
        assert "is no name" in said(capsys, "new", "network", name)
    assert "--on can be" in said(capsys, "new", "network", "mine", "--on", "air")
    assert [path.name for path in alone.iterdir()] == ["gossip"]


def test_a_folder_that_takes_the_name_of_ours_or_of_pythons(own, alone, capsys):
    own.folder.rename(alone / "radio")
    taken = alone / "radio" / "network.py"
    taken.write_text(taken.read_text().replace('"gossip"', '"radio"'))
    line = said(capsys, "check", "radio/gossip.toml", "--network", "radio")
    assert "radio/network.py:5: the name 'radio' is taken by innervate.networks.radio" in line
    (alone / "radio").rename(alone / "json")
    with pytest.raises(NetworkError, match=r"json/network.py:1: the name json is taken by a Py"):
        use(Path("json"))
    (alone / "json").rename(alone / "mine")
    with pytest.raises(NetworkError, match="called 'radio' and its folder 'mine'"):
        use(Path("mine"))


def test_an_installed_package_is_found_by_its_entry_point(alone, tmp_path_factory):
    """As pip leaves it: the package and its metadata lie on the path, the scenario elsewhere."""
    site = tmp_path_factory.mktemp("site")
    assert main(["new", "network", "ring"]) == 0
    (alone / "ring" / "ring.toml").rename(alone / "elsewhere.toml")
    (alone / "ring").rename(site / "ring")
    metadata = site / "ring_network-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: ring-network\nVersion: 1.0\n")
    point = "[innervate.networks]\nring = ring.network:NETWORK\n"
    (metadata / "entry_points.txt").write_text(point)
    check = [sys.executable, "-m", "innervate.cli", "check", "elsewhere.toml"]
    lacking = subprocess.run(check, capture_output=True, text=True, check=False)
    assert lacking.returncode == 2
    env = os.environ | {"PYTHONPATH": str(site)}
    done = subprocess.run(check, capture_output=True, text=True, check=False, env=env)
    assert done.returncode == 0, done.stderr
    assert "nodes" in done.stdout


def test_a_plain_run_may_print_and_others_may_not(own, capsys):
    """What is compiled prints nothing; a plain run is the same with it and without."""
    run = ["run", str(own.scenario), "--plain", "--no-report", "--out"]
    assert main([*run, "runs/one"]) == 0
    capsys.readouterr()
    old = "    node.value = item.value\n"
    own.change("protocol.py", old, old + '    print(f"{node.number} is given {item.value}", now)\n')
    assert main([*run, "runs/two"]) == 0
    assert "0 is given 7 " in capsys.readouterr().out
    at = own.line("protocol.py", "print(")
    line = said(capsys, "run", own.scenario)
    assert line == (f"innervate: gossip/protocol.py:{at}: calls print; it may stay for plain runs: "
                    "run --plain")  # fmt: skip
    assert main(["compare", "runs/one", "runs/two"]) == 0
