"""Every example runs."""

import runpy
import sys
from pathlib import Path

import pytest

import innervate

FOLDER = Path(__file__).resolve().parents[2] / "examples"


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_scenarios(path):
    done = innervate.run(path)
    assert done.summary["loops"]["episodes"] == 0
    assert len(done.summary["recoveries"]) == len(done.plan.faults)


def run_script(name, monkeypatch, capsys, *arguments):
    monkeypatch.setattr(sys, "argv", [name, *arguments])
    runpy.run_path(str(FOLDER / name), run_name="__main__")
    return capsys.readouterr().out.splitlines()


def test_recovery_times(monkeypatch, capsys):
    head, *lines = run_script("recovery_times.py", monkeypatch, capsys, "3")
    assert head.endswith("3 seeds: ms until every cell has a way again")
    means = [float(line.split("mean")[1].split()[0]) for line in lines]
    assert means == sorted(means, reverse=True)  # periodic, triggered, wave


def test_ports_needed(monkeypatch, capsys):
    lines = run_script("ports_needed.py", monkeypatch, capsys)
    lost = [float(line.split(":")[1].split("%")[0]) for line in lines]
    assert lost == sorted(lost, reverse=True)
    assert lost[0] > 50 > 10 > lost[-1]


def test_which_medium_access(monkeypatch, capsys):
    _head, *lines = run_script("which_medium_access.py", monkeypatch, capsys)
    for line in lines:
        reservation, fair, contention = (float(line.split()[i]) for i in (1, 3, 4))
        assert reservation > contention
        assert fair > 0.99


def test_every_example_is_run():
    scripts = {path.name for path in FOLDER.glob("*.py")}
    assert scripts == {"recovery_times.py", "ports_needed.py", "which_medium_access.py"}
