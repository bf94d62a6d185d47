"""A fourth network: the toolkit is told of it in one folder, and all of this can be done with it.

`network.py` of this folder names model, check, plan, protocol, fields and frames, and no file of
the toolkit names the ring. It is held to

| what                                                   | where                                |
|--------------------------------------------------------|--------------------------------------|
| checked; a template; one line for a mistake            | here                                 |
| run from the shell: summary, tables, provenance        | here                                 |
| reported: graph, what happened over time, nodes' states| here                                 |
| two runs compared, down to the first event that differs| here                                 |
| swept                                                  | here                                 |
| compiled = plain, row for row; mended; ranges checked  | test_runs.py                         |
| watched: coloured by a field, cut and killed by clicks | test_watch.py                        |
| captured, and read back by a dissector of its own      | test_export.py                       |
| its graph, its tables, a recording                     | test_export.py                       |
| brought up over UDP, sealed, watched, cut, played      | test_live.py, tests/browser/test_live|
| explored, and what is wrong with it found              | test_verify.py                       |
| played on MicroPython; a folder for a maker's board    | test_boards.py                       |
"""

import json
from pathlib import Path

import polars
import pytest

import innervate
from innervate.cli import main
from innervate.network import networks
from innervate.parts import DEFAULTS, PARTS
from innervate.sim.counts import Counts

HERE = Path(__file__).parent
TOLD = {"model", "check", "plan", "protocol", "fields", "frames"}
# What is a network's own affair: a demo, papers, its images, scenarios out of measurements ...
OWN = {
    "received_image", "demo", "sizing", "measured_template", "capture", "dissector",
    "fit", "log", "recovery", "counterexample", "random", "papers",
    "comparison",
    "boards", "foreseen", "invariants", "measures", "shows", "happenings",
    "packets",
}  # fmt: skip
CUT = """
[[event]]
at_s = 0.1
action = "cut"
node = 2
[[event]]
at_s = 0.15
action = "restore"
node = 2
"""


def called(*words):
    """A command's exit code."""
    return main([str(word) for word in words])


@pytest.fixture
def file(tmp_path):
    made = tmp_path / "ring.toml"
    made.write_text(f'kind = "tokenring"\nnodes = 5\nduration_s = 0.3\n{CUT}')
    return made


def test_no_more_is_said_of_it_than_has_to_be():
    ring = networks()["tokenring"]
    assert {part for part in PARTS if ring.parts.get(part) != DEFAULTS.get(part)} == TOLD
    assert set(PARTS) - set(DEFAULTS) - TOLD == OWN


def test_no_file_of_the_toolkit_knows_it():
    home = Path(innervate.__file__).parent
    texts = (path for path in home.rglob("*") if path.suffix in {".py", ".js", ".lua", ".toml"})
    assert not [path for path in texts if "tokenring" in path.read_text(encoding="utf-8")]


def test_it_is_checked(file, capsys):
    assert called("check", file) == 0
    assert "5, 5 cables" in (said := capsys.readouterr().out)
    assert "at 0.1 s cut n2 E - n3 W" in said
    file.write_text('kind = "tokenring"\nnodes = 5\nhold = 3\n')
    assert called("check", file) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "hold" in line


def test_there_is_a_scenario_to_start_from(tmp_path, capsys):
    made = tmp_path / "new.toml"
    assert called("new", "tokenring", made) == 0
    assert "hold_us = 1000" in made.read_text()
    assert called("check", made) == 0


def test_it_is_run_and_reported_and_two_runs_are_compared(file, tmp_path, capsys):
    one, other = tmp_path / "one", tmp_path / "other"
    assert called("run", file, "--out", one) == 0
    assert called("run", file, "--out", other, "--set", "event=[]") == 0
    summary = json.loads((one / "summary.json").read_text())
    assert summary["frames"]["lost_by"]["cut"] > 0
    assert summary["headline"]["level"] == "degraded"
    assert polars.read_parquet(one / "deliveries.parquet").height == summary["frames"]["arrived"]
    report = (one / "report.html").read_text()
    for word in ("n4", "5 nodes, 5 links", "messages delivered", "reports made",
                 "Nodes at the end", "passed</span>, tokens", "cable n2 E - n3 W cut"):  # fmt: skip
        assert word in report, word
    capsys.readouterr()
    called("compare", one, other)
    said = capsys.readouterr().out
    assert "frames.lost_by.cut" in said
    assert "First event that differs: 0.1" in said


def test_it_is_swept(file, tmp_path, capsys):
    out = tmp_path / "sweep"
    words = ("--vary", "hold_us=1000,2000", "--repeat", "2", "--engine", "here",
             "--show", "frames.sent")  # fmt: skip
    assert called("sweep", file, *words, "--out", out) == 0
    assert "4 of 4 runs" in capsys.readouterr().out
    found = polars.read_parquet(out / "results.parquet").group_by("hold_us")
    sent = dict(found.agg(polars.mean("frames.sent")).iter_rows())
    assert sent[1000] > 1.5 * sent[2000] > 100


@pytest.mark.parametrize(("sent", "unheard", "nodes", "said"), [
    (0, 0, 2, "3 delivered"), (5, 2, 2, "5 sent, 3 delivered"),
    (2, 0, 2, "2 sent, delivered 3 times"),  # one of them was for several
    (5, 3, 2, "5 sent, 2 of them delivered 3 times"), (5, 5, 2, "5 sent, 3 delivered"),
    (1, 0, 2, "1 sent, delivered 3 times, more often than once at each of 2 nodes"),
    (5, 4, 2, "5 sent, 1 of them delivered 3 times, more often than once at each of 2 nodes"),
    (1, 0, 3, "1 sent, delivered 3 times"),
])  # fmt: skip
def test_messages_that_were_sent_and_how_often_they_came(sent, unheard, nodes, said):
    from innervate.plot.lines import traffic_lines

    latency = {"p50": None}
    messages = {"sent": sent, "delivered": 3, "dropped_by": {}, "latency_ms": latency}
    frames = {"sent": 4, "arrived": 3, "lost": 1, "lost_by": {"cut": 1}}
    counts = Counts(nodes=nodes, offered=sent, delivered=3, unheard=unheard)
    assert traffic_lines({"frames": frames, "messages": messages}, counts) == [
        "Frames: 4 sent, 3 arrived, 1 lost: 1 cut", f"Messages: {said}",
    ]  # fmt: skip
