import json
import os
import tomllib
from pathlib import Path

import pytest

import innervate
from innervate import scenario
from innervate.cli import demo as demo_command


def test_version(sh):
    assert sh("--version") == 0
    assert sh.out == f"innervate {innervate.__version__}\n"


@pytest.mark.parametrize("tokens", [(), ("--help",), ("-h",)])
def test_help_names_every_command(sh, tokens):
    assert sh(*tokens) == 0
    for command in (
        "demo",
        "run",
        "sweep",
        "size",
        "papers",
        "scenarios",
        "new",
        "check",
        "compare",
    ):
        assert f" {command} " in sh.out
    assert sh.err == ""


def test_run_says_what_happened_and_writes_a_folder(sh):
    assert sh("run", "four.toml") == 0
    first, headline, event, broken, *_, last = sh.out.splitlines()
    assert first.startswith("four: 4 cells, 2 interface ports, at most 2 hops deep; 0.4 s")
    assert (
        headline == "degraded: 4 of 152 samples were lost (2.63 %); every cell has a way to the PC."
    )
    assert event.startswith("Cable to interface 1 cut at 0.300 s: noticed after")
    assert broken.startswith("Broken at the end: cable from interface 1 to p0 r0 c3 E, since 0.3")
    assert last == f"Written: {Path('runs/four-1/report.html')}"
    found = {path.name for path in Path("runs/four-1").iterdir()}
    assert {"scenario.toml", "summary.json", "provenance.json", "report.html"} <= found


def test_json_prints_the_summary_alone(sh):
    assert sh("run", "four.toml", "--json", "--out", "there") == 0
    assert json.loads(sh.out) == json.loads(Path("there/summary.json").read_text())
    assert sh.err == ""


def test_set_and_seed(sh):
    changes = ("--set", "protocol.k=3", "--set", "name=other", "--seed", "7")
    assert sh("run", "four.toml", *changes, "--json", "--no-report") == 0
    assert not Path("runs/other-7/report.html").exists()
    tables = tomllib.loads(Path("runs/other-7/scenario.toml").read_text())
    assert (tables["protocol"]["k"], tables["seed"]) == (3, 7)


def test_a_run_is_repeated_from_its_folder(sh):
    sh("run", "four.toml", "--json", "--out", "first")
    first = json.loads(sh.out)
    sh("run", Path("first/scenario.toml"), "--json", "--out", "second")
    assert json.loads(sh.out)["fingerprint"] == first["fingerprint"]
    assert sh("compare", "first", "second") == 0
    assert "same, event by event" in sh.out


def test_compare_names_what_differs(sh):
    sh("run", "four.toml", "--out", "one")
    sh("run", "four.toml", "--out", "two", "--set", "protocol.k=3")
    assert sh("compare", "one", "two") == 1  # as diff does, for scripts
    for name in ("one", "two"):
        headline = json.loads(Path(name, "summary.json").read_text())["headline"]
        assert f"{name}: {headline['level']}: {headline['text']}\n" in sh.out
    assert "protocol.k  not set -> 3" in sh.out
    assert "recoveries.0.detected_ms" in sh.out
    assert "First event that differs:" in sh.out


def test_scenarios_lists_all_with_a_line_each(sh):
    assert sh("scenarios") == 0
    lines = sh.out.splitlines()
    assert [line.split()[0] for line in lines] == list(scenario.bundled())
    assert all(len(line.split(maxsplit=1)[1]) > 20 for line in lines)


def test_new_prints_or_writes_what_check_accepts(sh):
    assert sh("new", "skin") == 0
    assert sh.out == scenario.template("skin")
    assert sh("new", "skin", "mine.toml") == 0
    assert Path("mine.toml").read_text() == scenario.template("skin")
    assert sh("check", "mine.toml") == 0
    assert sh.out.startswith("my-skin: a skin scenario of 4 s, seed 1\n")


def test_new_keeps_what_is_there(sh):
    assert sh("new", "skin", "four.toml") == 2
    assert "four.toml is there already" in sh.err
    assert 'name = "four"' in Path("four.toml").read_text()


@pytest.mark.parametrize("words", [("new", "mesh", "far.toml"), ("schema", "--out", "far.toml")])
def test_what_cannot_be_written_whole_is_not_there(sh, full_disk, words):
    with full_disk():
        assert sh(*words) == 2
    assert sh.err.startswith("innervate: far.toml cannot be written: ")
    assert not Path("far.toml").exists()
    assert sh(*words) == 0


def test_new_takes_a_measured_network(sh):
    Path("sub").mkdir()
    Path("links.txt").write_text("A B 0.9 0.8\nB C 0.7 0.9\nC D 0.2\n")
    assert sh("new", "mesh", "sub/mine.toml", "--network", "links.txt", "--min-tq", "0.5") == 0
    assert "nodes      3, gateway B" in sh.out
    assert "Taken: 3 of 4 nodes; links of 0.5 and better hold them together." in sh.out
    text = Path("sub/mine.toml").read_text()
    assert 'file = "../links.txt"' in text
    assert "min_tq = 0.5" in text
    assert sh("check", "sub/mine.toml") == 0
    assert sh("new", "mesh", "--network", "freifunk/leipzig", "--types", "wifi", "other") == 0
    assert 'types = ["wifi", "other"]' in sh.out


def chain(count, good):
    return "".join(f"n{i} n{i + 1} {0.9 if i < good else 0.4}\n" for i in range(count - 1))


@pytest.mark.parametrize(("count", "good", "chosen", "taken"), [
    (254, 100, "min_tq = 0.3 ", "254 of 254 nodes; links of 0.3 and better hold them together."),
    (255, 100, "min_tq = 0.41 ",
     "101 of 255 nodes; links of 0.41 and better hold them together; those of 0.3 hold 255, too"),
    (300, 299, 'around = "n1" ', "254 of 300 nodes; links of 0.3 and better hold them together; "
     "about the best connected one of 300, too many for a mesh: --gateways makes several."),
])  # fmt: skip
def test_new_takes_of_a_measured_network_what_a_mesh_can_have(sh, count, good, chosen, taken):
    Path("links.txt").write_text(chain(count, good))
    assert sh("new", "mesh", "mine.toml", "--network", "links.txt") == 0
    assert f"Taken: {taken}" in sh.out
    assert f"\n{chosen}" in Path("mine.toml").read_text()


def test_new_takes_the_part_about_a_node(sh):
    Path("links.txt").write_text(chain(300, 299))
    part = ("--around", "n200", "--nodes", "7")
    assert sh("new", "mesh", "mine.toml", "--network", "links.txt", *part) == 0
    assert "Taken: 7 of 300 nodes" in sh.out
    assert sh("check", "mine.toml", "--set", 'gateway="n203"') == 0
    assert "at most 6 hops from the gateway" in sh.out
    assert sh("check", "mine.toml", "--set", 'gateway="n204"') == 2


@pytest.mark.parametrize(("words", "what"), [
    (("skin", "n.toml", "--network", "freifunk/ulm"), "--network is for a mesh"),
    (("mesh", "n.toml", "--network", "none.json"), "none.json: cannot be read"),
    (("mesh", "n.toml", "--network", "freifunk/ulm", "--min-tq", "2"), "must be at most 1"),
    (("mesh", "n.toml", "--min-tq", "0.5"), "are of a --network; name one"),
    (("mesh", "n.toml", "--around", "x"), "are of a --network; name one"),
    (("mesh", "n.toml", "--network", "freifunk/ulm", "--around", "0", "--nodes", "1"), "2 to 2000"),
    (("mesh", "n.toml", "--network", "freifunk/ulm", "--around", "0", "--nodes", "255"),
     "255 nodes are too many"),
    (("mesh", "n.toml", "--network", "freifunk/ulm", "--around", "1000"), 'did you mean "100"'),
    (("mesh", "n.toml", "--network", "freifunk/ulm", "--around", "me"), "there are 0 to "),
    (("mesh", "n.toml", "--network", "freifunk/ulm", "--around", "5"),
     'import.around: "5" is left out: it has no link of type wifi'),
    (("mesh", "n.toml", "--network", "freifunk/ulm", "--around", "2"),
     'no link of "2" has a quality of 0.3 or better both ways, the best has 0.01; import.min_tq'),
    (("mesh", "n.toml", "--network", "topohub:nowhere"), "nowhere"),
    (("mesh", "n.toml", "--network", ""), "--network needs a file"),
    (("mesh", "n.toml", "--network", "n" * 300), "cannot be read: File name too long"),
    (("mesh", "n" * 300), "cannot be written: File name too long"),
    (("mesh", "n.toml", "--network", "pipe"), "pipe: is no plain file, and every run reads it"),
    (("mesh", "n.toml", "--network", "faint"), "faint: no link has a quality of 0.3 or better both "
     "ways: the best has 0.2; lower min_tq"),
    (("mesh", "n.toml", "--network", "none"), "none: holds no links"),
    (("mesh", "n.toml", "--network", "words"), 'words: a node is called "all", which means someth'),
    (("mesh", "n.toml", "--over", "csma"), "--over is for a network of your own"),
    (("network", "n", "--network", "faint"), "--network is for a measured network"),
    (("network", "n", "--min-tq", "0"), "--min-tq is for a measured network"),
])  # fmt: skip
def test_new_writes_nothing_of_a_network_that_is_none(sh, words, what):
    os.mkfifo("pipe")
    Path("faint").write_text("a b 0.2 0.9\nb c 0.1")
    Path("none").write_text('{"nodes": [{"id": 1}], "links": []}')
    Path("words").write_text("all b")
    before = set(Path().iterdir())
    assert sh("new", *words) == 2
    assert what in sh.err
    assert set(Path().iterdir()) == before


def test_new_finds_a_measured_network_from_a_folder_that_is_a_link(sh):
    Path("far/away").mkdir(parents=True)
    Path("near").symlink_to("far/away", target_is_directory=True)
    Path("links.txt").write_text("a b\nb c")
    assert sh("new", "mesh", "near/mine.toml", "--network", "links.txt") == 0
    assert 'file = "../../links.txt"' in Path("far/away/mine.toml").read_text()
    assert sh("check", "near/mine.toml") == 0


def test_check_takes_changes(sh):
    assert sh("check", "setup-1", "--set", "protocol.k=8", "--seed", "12") == 0
    assert "k = 8" in sh.out
    assert "seed 12" in sh.out
    assert not Path("runs").exists()


def test_demo_tells_the_story(sh, monkeypatch):
    opened = []
    monkeypatch.setattr(demo_command.webbrowser, "open", opened.append)
    assert sh("demo", "--out", "there", "--open") == 0
    for words in (
        "204 cells", "cable to interface 1 cut", "102 of 204 cells have lost their way",
        "every cell has a way again", "cable to interface 1 put back", "No forwarding loop",
        str(Path("there/skin/report.html")), "all ten packets have arrived",
        "0 packets lost without their sender knowing", str(Path("there/radio/report.html")),
        "30 nodes", "8 nodes switched off; nobody is told", "the robot is outside the fence",
        "the monitor has it, over 3 hops", "every one was delivered",
        str(Path("there/mesh/report.html")),
    ):  # fmt: skip
        assert words in sh.out
    there = [
        Path(f"there/{part}/report.html").resolve().as_uri() for part in ("skin", "radio", "mesh")
    ]
    assert opened == there
    assert sh("demo", "--out", "there") == 0  # runs are replaced


CLAIMS = """figure,claim,measurement,verdict,reason
Fig. 5,k + 3 periods,8 periods,holds,
Fig. 8a,Eq. 4,19 of 20,holds with reading E21,a mean
Fig. 9,never,always,does not hold,because
"""


def test_papers_runs_and_counts_verdicts(sh, monkeypatch):
    seen = []

    def main(system, out, **options):
        options.pop("progress")
        seen.append((system, out, options))
        out.mkdir()
        (out / "papers-skin.csv").write_text(CLAIMS)
        return out / "papers-skin.html"

    room = type("Room", (), {"main": staticmethod(main)})
    monkeypatch.setattr("innervate.cli.papers.import_module", lambda name: room)
    assert sh("papers", "--quick", "--out", "figures", "--only", "fig5", "--only", "loop") == 0
    options = {"quick": True, "only": ["fig5", "loop"], "redraw": False}
    assert seen == [("skin", Path("figures"), options)]
    first, *rest, last = sh.out.splitlines()
    assert first == "3 claims: 1 hold, 1 hold with a reading of ours, 1 do not hold."
    assert [line.split(":")[0].strip() for line in rest] == ["Fig. 9", "measured", "because"]
    assert last == f"Look at them in a browser: {Path('figures/papers-skin.html')}"


def test_interrupted_papers_can_be_taken_up_again(sh, monkeypatch):
    def main(*_, **__):
        raise KeyboardInterrupt

    room = type("Room", (), {"main": staticmethod(main)})
    monkeypatch.setattr("innervate.cli.papers.import_module", lambda name: room)
    assert sh("papers") == 130
    assert "goes on from there" in sh.err


@pytest.mark.parametrize("tokens", [("kitchen",), ("--only", "fig99")])
def test_papers_and_figures_that_are_not_there(sh, tokens):
    assert sh("papers", *tokens, "--out", "figures") == 2
    assert "choose from:" in sh.err
    assert "figures and table into" not in sh.err
    assert not Path("figures").exists()


@pytest.mark.parametrize(("text", "words"), [
    (None, "page.md: No such file or directory; name another page"),
    ("nothing", "page.md has no place for radio-fig1; add <!-- radio-fig1: made by"),
])  # fmt: skip
def test_a_page_without_a_place_for_tables_is_refused_before_the_work(sh, text, words):
    if text is not None:
        Path("page.md").write_text(text)
    tokens = ("radio", "--quick", "--only", "fig1", "--page", "page.md")
    assert sh("papers", *tokens, "--out", "figures") == 2
    assert words in sh.err
    assert not Path("figures").exists()
