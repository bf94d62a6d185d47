"""`innervate doctor`: what is missing is named, with what to do."""

import json
import os
import tomllib
from importlib import util
from pathlib import Path

import pytest

from innervate.cli import doctor, errors, main

ROOT = Path(__file__).resolve().parents[2]
find_spec = util.find_spec


@pytest.fixture
def without(monkeypatch):
    """An environment that lacks some packages."""

    def hide(*names):
        monkeypatch.setattr(
            doctor.util, "find_spec", lambda name: None if name in names else find_spec(name)
        )

    return hide


def test_all_is_well_here(capsys):
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    assert "missing  sim" not in said
    assert "ok       sim      simulate" in said


def test_what_is_missing_is_named_with_what_to_do(without, capsys):
    without("z3", "collada")
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    assert "needs z3: pip install 'innervate[prove]'" in said
    assert "needs collada: pip install 'innervate[body]'" in said


def test_every_extra_that_errors_name_is_looked_at_and_can_be_installed():
    known = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = set(known["optional-dependencies"]) - {"all", "dev", "docs"}
    assert set(doctor.EXTRAS) == set(errors.EXTRA_OF.values()) == extras


def test_without_the_simulator_it_ends_with_1(without, capsys):
    without("numba")
    assert main(["doctor", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["extras"]["sim"]["missing"] == ["numba"]
    assert found["extras"]["web"]["missing"] == []
    assert found["cache"] is None


def test_programs_are_looked_for(monkeypatch, capsys):
    monkeypatch.setenv("PATH", "")
    main(["doctor", "--json"])
    assert set(json.loads(capsys.readouterr().out)["programs"].values()) == {None}


def test_what_is_not_compiled_will_be_slow(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path / "new"))
    main(["doctor"])
    assert f"nothing is compiled in {tmp_path / 'new'} yet" in capsys.readouterr().out


@pytest.mark.parametrize(("cache", "says"), [
    ({"writable": False}, "slow     here cannot be written"),
    ({"free_bytes": doctor.SMALL_BYTES - 1}, "slow     here has little room left"),
    ({"ready": ["skin"]}, "ok       the loops of bundled networks came with the toolkit"),
    ({"compiled": ["ring"]}, "ok       compiled loops in here: ring"),
])  # fmt: skip
def test_a_cache_that_cannot_be_used_is_said(capsys, cache, says):
    usual = {"folder": "here", "writable": True, "free_bytes": doctor.SMALL_BYTES,
             "compiled": [], "ready": []}  # fmt: skip
    doctor._tell_cache(usual)
    assert says not in capsys.readouterr().out
    doctor._tell_cache(usual | cache)
    assert says in capsys.readouterr().out


def test_a_read_only_cache_is_found(monkeypatch):
    monkeypatch.setattr(doctor.os, "access", lambda path, mode: mode != os.W_OK)
    assert not doctor.look()["cache"]["writable"]
