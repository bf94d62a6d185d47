"""A node of the ring as C: nothing but its folder is named."""

import shutil
from pathlib import Path

import pytest

from boards.firmware import __main__ as parity
from boards.roles import roles
from innervate.cli import main
from innervate.firmware.library import role_of
from innervate.network import networks


def test_its_c_does_call_by_call_what_its_python_does():
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    replayed, drawn = parity.compare(roles()["tokenring"], 4000, 1, sanitized=True)
    assert replayed >= 2000
    assert replayed + drawn == 4000


def test_its_folder_is_enough(tmp_path, monkeypatch, capsys):
    monkeypatch.delenv("INNERVATE_NETWORKS")
    networks.cache_clear()
    folder = str(Path(__file__).parent)
    assert main(["firmware", folder, "hold_us=2000", "--out", str(tmp_path)]) == 0
    assert "2000, /* hold_us */" in (tmp_path / "tokenring.c").read_text()
    assert "tokenring.c" in capsys.readouterr().out
    _, role = role_of(folder)
    assert role.name == "tokenring"
    assert main(["firmware", folder, "hold=2", "--out", str(tmp_path)]) == 2
    assert "hold is unknown" in capsys.readouterr().err
