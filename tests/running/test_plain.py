"""`run --plain`: of every network the same run, event by event, without the compiler."""

import json
from pathlib import Path

import pytest

from innervate import scenario
from innervate.cli import main
from innervate.network import networks

SHORT = {"skin": 0.15, "radio": 0.5, "mesh": 3.0, "babel": 0.3, "flooding": 3.0, "rpl": 3.0}


def told(folder, *more):
    """What a run's folder says, but for its times."""
    assert main(["run", "one.toml", "--no-report", "--out", folder, *more]) == 0
    summary, origin = (json.loads((Path(folder) / f"{name}.json").read_text())
                       for name in ("summary", "provenance"))  # fmt: skip
    kept = {key: value for key, value in summary.items() if key not in ("wall_s", "events_per_s")}
    return kept, origin["fingerprint"], origin["tables_sha256"]


def test_every_network_is_here():
    assert list(SHORT) == list(networks())


@pytest.mark.slow
@pytest.mark.parametrize("kind", SHORT)
def test_a_plain_run_is_the_compiled_one(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = scenario.template(kind)
    (tmp_path / "one.toml").write_text(text)
    short = ["--set", f"duration_s={SHORT[kind]}", "--set", "event=[]"]
    assert told("plain", *short, "--plain") == told("compiled", *short)
