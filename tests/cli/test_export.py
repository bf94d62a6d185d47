"""`innervate export`: what it writes, and what it says of what it cannot."""

import json
import re

import networkx
import pytest

from innervate import run
from innervate.cli.app import main
from innervate.export.reading import Capture
from tests.export.test_captures import SKIN
from tests.own import Own, alone, made, own

__all__ = ["alone", "own"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return run(SKIN | {"name": "small"}).write(tmp_path_factory.mktemp("runs") / "r", report=False)


def test_everything_at_once_of_a_run_folder(folder, tmp_path, capsys):
    files = {name: tmp_path / name for name in ("a.pcapng", "a.mcap", "a.graphml")}
    arguments = ["--pcapng", "a.pcapng", "--mcap", "a.mcap", "--graph", "a.graphml"]
    given = [str(files.get(word, word)) for word in arguments]
    assert main(["export", str(folder), *given, "--tables", str(tmp_path / "t"), "--csv"]) == 0
    said = capsys.readouterr().out
    count = sum(1 for _ in Capture(files["a.pcapng"]).packets())
    assert f"{count} packets" in said
    assert "dropped: queue full" in said
    assert networkx.read_graphml(files["a.graphml"]).number_of_nodes() == 13
    assert (tmp_path / "t" / "routes.csv").read_text().startswith("time_us,cell,old,new")
    assert files["a.mcap"].read_bytes()[1:5] == b"MCAP"


def test_a_window_of_a_scenario(tmp_path, capsys):
    out = tmp_path / "w.pcapng"
    words = ["export", "setup-1", "--set", "event.0.at_s=0.5", "--pcapng", str(out)]
    assert main([*words, "--from", "0.02", "--to", "0.03"]) == 0
    times = [packet.time_ns for packet in Capture(out).packets()]
    assert times
    assert min(times) >= 20_000_000
    assert max(times) < 30_000_000


def test_the_dissector_goes_where_it_is_told_or_to_wireshark(tmp_path, monkeypatch, capsys):
    assert main(["export", "--dissector", str(tmp_path / "own")]) == 0
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert main(["export", "--dissector"]) == 0
    both = [tmp_path / "own", tmp_path / "home/.local/lib/wireshark/plugins"]
    texts = {(folder / "innervate.lua").read_text() for folder in both}
    assert len(texts) == 1
    assert "DissectorTable" in texts.pop()


def test_a_file_is_no_folder_for_the_dissector(tmp_path, capsys):
    (tmp_path / "one.toml").write_text("")
    assert main(["export", "--dissector", str(tmp_path / "one.toml")]) == 2
    assert "one.toml is a file; --dissector alone takes a folder" in capsys.readouterr().err


def test_the_dissector_knows_the_network_beside_the_scenario(own, monkeypatch):
    monkeypatch.setenv("HOME", str(own.folder))
    assert main(["export", str(own.scenario), "--graph", "g.json", "--dissector"]) == 0
    text = (own.folder / ".local/lib/wireshark/plugins/innervate.lua").read_text()
    assert 'define("gossip"' in text


def test_two_networks_with_one_link_type_have_no_dissector(alone, capsys):
    for name in ("gossip", "talk"):
        made(alone / name)
        given = re.search(r"link_type=\d+", (alone / name / "network.py").read_text())[0]
        Own(alone / name).change("network.py", given, "link_type=162")
    both = ["--network", "gossip", "--network", "talk"]
    assert main(["export", "--dissector", "here", *both]) == 2
    assert (
        "gossip and talk both have link_type 162; give one of them another in its network.py: "
        "150, 152, 153," in capsys.readouterr().err
    )
    Own(alone / "talk").change("network.py", "link_type=162", "link_type=150")
    assert main(["export", "--dissector", "here", *both]) == 0
    text = (alone / "here/innervate.lua").read_text()
    assert 'define("talk", encaps.USER3' in text
    assert 'define("gossip", encaps.USER15' in text


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["{run}"], "nothing to export"),
        (["--pcapng", "{out}"], "of what?"),
        (["{run}", "--graph", "{out}"], "graphml"),
        (["{run}", "--pcapng", "{out}", "--seed", "3"], "was run as it is"),
        (["{run}", "--pcapng", "{out}", "--from", "5"], "the run ends at"),
        (["{run}", "--pcapng", "{out}", "--from", "0.02", "--to", "0.01"], "nothing lies"),
        (["{run}", "--graph", "{out}.json", "--from", "0.01"], "--from and --to are of --pcapng"),
        (["{run}", "--tables", "{out}", "--to", "0.01"], "--from and --to are of --pcapng"),
        (["{run}", "--pcapng", "{out}/no/such/folder"], "cannot be written"),
        (["{run}", "--mcap", "{out}", "--csv"], "--csv is for tables"),
        (["setup-0", "--pcapng", "{out}"], "setup-0"),
        (["loop-three", "--pcapng", "{out}"], "script"),
    ],
)
def test_mistakes_are_told_in_one_line(words, why, folder, tmp_path, capsys):
    out = tmp_path / "out"
    given = [word.format(run=folder, out=out) for word in words]
    assert main(["export", *given]) == 2
    said = capsys.readouterr().err.splitlines()
    assert why in said[-1]
    assert said[-1].startswith("innervate: ")
    assert list(tmp_path.iterdir()) == []


def test_a_run_of_another_version_is_not_exported_as_if_it_were_this_one(folder, tmp_path, capsys):
    import shutil

    other = tmp_path / "r"
    shutil.copytree(folder, other)
    summary = json.loads((other / "summary.json").read_text())
    summary["fingerprint"] = "0" * 16
    (other / "summary.json").write_text(json.dumps(summary))
    assert main(["export", str(other), "--pcapng", str(tmp_path / "a.pcapng")]) == 2
    assert "run it again" in capsys.readouterr().err
    assert not (tmp_path / "a.pcapng").exists()
