"""What other programs take: `--json`, the schema of scenario files, completion of shells."""

import contextlib
import io
import json
import os
import subprocess
import sys
import tomllib

import jsonschema
import pytest

from innervate import scenario
from innervate.cli import main
from tests.own import alone, made

__all__ = ["alone"]


def said(capsys, *words, code=0):
    assert main(list(words)) == code
    return json.loads(capsys.readouterr().out)


def test_scenarios(capsys):
    listed = said(capsys, "scenarios", "--json")
    assert {one["name"] for one in listed} == set(scenario.bundled())
    assert all(one["shows"].endswith(".") and os.path.isfile(one["path"]) for one in listed)


def test_check_says_line_by_line_what_it_says_to_people(capsys):
    found = said(capsys, "check", "line", "--json", "--seed", "7", "--set", "protocol.k=4")
    assert (found["name"], found["kind"], found["seed"]) == ("line", "skin", 7)
    main(["check", "line", "--seed", "7", "--set", "protocol.k=4"])
    lines = capsys.readouterr().out.splitlines()[1:]
    assert [f"{one['what']} {one['says']}".split() for one in found["holds"]] == [
        line.split() for line in lines
    ]
    assert len(lines) >= 4


def test_check_says_of_each_line_what_it_is_about(capsys):
    kills = 'event=[{at_s=0.1, action="kill", node=3}, {at_s=0.2, action="revive", node=3}]'
    found = said(capsys, "check", "babel-patch", "--json", "--set", kills)
    events = [one["says"] for one in found["holds"] if one["what"] == "event"]
    assert events == ["at 0.1 s kill n3", "at 0.2 s revive n3"]


def test_compare(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for seed in ("1", "2"):
        assert main(["run", "line", "--seed", seed, "--out", seed, "--no-report"]) == 0
    capsys.readouterr()
    assert said(capsys, "compare", "1", "1", "--json")["same"]
    found = said(capsys, "compare", "1", "2", "--json", code=1)
    assert not found["same"]
    assert found["scenario"] == [{"key": "seed", "a": 1, "b": 2}]
    assert found["first_event_that_differs"]
    assert found["headlines"][0]["text"] == "Every cell has a way to the PC."


def test_sweep(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ("sweep", "line", "--vary", "protocol.k=3,5,99", "--repeat", "2", "--workers", "1",
             "--show", "recoveries.routed_ms,cut_off.most", "--out", "out")  # fmt: skip
    found = said(capsys, *words, "--json")
    assert (found["folder"], found["runs"], found["complete"]) == ("out", 6, True)
    assert [one["settings"]["protocol.k"] for one in found["points"]] == [3, 5, 99]
    assert sum(found["failed"].values()) == 2
    assert found["headlines"]["ok"] == 4
    assert main(list(words)) == 0
    table = capsys.readouterr().out.splitlines()[1:3]
    for line, one in zip(table, found["points"], strict=False):
        shown = one["figures"]["recoveries.routed_ms"]
        assert line.split()[:3] == [str(one["settings"]["protocol.k"]), "2", f"{shown['mean']:.4g}"]
        assert shown["low"] <= shown["mean"] <= shown["high"]
        assert shown["runs"] == one["runs"]
    assert found["points"][2]["figures"]["cut_off.most"]["mean"] is None
    every = said(capsys, *words[:-4], "--out", "out", "--json")["points"][0]["figures"]
    assert {"recoveries.routed_ms", "balance_factor"} <= every.keys()


def test_the_schema_has_the_keys_of_an_own_networks_medium(alone, capsys):
    made(alone / "talk", "channel")
    assert "ChannelScenario" not in said(capsys, "schema")["$defs"]
    assert "ChannelScenario" in said(capsys, "schema", "talk")["$defs"]


@pytest.fixture(scope="module")
def schema():
    """What holds a scenario against the schema that is printed; made once."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        assert main(["schema"]) == 0
    made = json.loads(printed.getvalue())
    jsonschema.Draft202012Validator.check_schema(made)
    return jsonschema.Draft202012Validator(made)


@pytest.mark.parametrize("name", scenario.bundled())
def test_bundled_scenarios_are_as_the_schema_says(schema, name):
    schema.validate(tomllib.loads(scenario.bundled()[name].read_text(encoding="utf-8")))


def test_the_schema_refuses_an_unknown_value(capsys, tmp_path):
    out = tmp_path / "scenario.schema.json"
    assert main(["schema", "--out", str(out)]) == 0
    assert "#:schema scenario.schema.json" in capsys.readouterr().out
    made = json.loads(out.read_text())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"kind": "skin", "duration_s": "long"}, made)


def test_a_schema_that_cannot_be_written_is_one_line(capsys, tmp_path):
    assert main(["schema", "--out", str(tmp_path)]) == 2
    assert str(tmp_path) in capsys.readouterr().err


def test_a_shell_completes_commands(tmp_path):
    """As a user would: install it, then let bash itself ask for what begins with `sce`."""
    env = os.environ | {"HOME": str(tmp_path), "SHELL": "/bin/bash"}
    done = subprocess.run([sys.executable, "-m", "innervate.cli", "--install-completion"],
                          env=env, capture_output=True, text=True, check=True)  # fmt: skip
    (script,) = (tmp_path / ".local").rglob("innervate")
    assert str(script) in done.stdout
    asked = f"""source {script}
COMP_WORDS=(innervate sce) COMP_CWORD=1
read -ra words <<< "$(complete -p innervate)"
for i in "${{!words[@]}}"; do
  [ "${{words[i]}}" = -F ] && "${{words[i+1]}}" innervate sce innervate
done
echo "${{COMPREPLY[@]}}"
"""
    answer = subprocess.run(
        ["bash", "-c", asked], env=env, capture_output=True, text=True, check=True
    )
    assert answer.stdout.split() == ["scenarios"]
