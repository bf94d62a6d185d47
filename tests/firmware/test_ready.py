"""What a wheel brings of nodes as C: taken without a compiler, and only for what it was made of."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from innervate.firmware import compiled, readying
from innervate.live.build import build
from innervate.live.errors import LiveError
from innervate.live.nodefile import C, Loaded, parse
from innervate.network import networks

ROOT = Path(__file__).parents[2]
CELL = readying.BEGUN | {"kind": "skin", "role": "cell"}


def node(**more):
    return build(Loaded(parse(CELL | more), Path("cell.toml")), C)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The library of a cell, as a wheel brings it."""
    if shutil.which(compiled.COMPILER) is None:
        pytest.skip("there is no C compiler")
    folder = tmp_path_factory.mktemp("wheel") / "nodes"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(readying, "networks", lambda: {"skin": networks()["skin"]})
        patch.setenv("INNERVATE_CACHE", "")
        patch.setenv("INNERVATE_READY", "")
        readying.write(folder)
    return folder


@pytest.fixture
def installed(made, tmp_path, monkeypatch):
    """A machine with that wheel, an empty cache and no compiler."""
    folder = tmp_path / "nodes"
    shutil.copytree(made, folder)
    monkeypatch.setattr(compiled, "READY", folder)
    monkeypatch.setattr(compiled, "COMPILER", "a-compiler-that-is-not-there")
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("INNERVATE_READY", raising=False)
    return folder


def test_a_usual_node_needs_no_compiler(installed):
    assert len(list(installed.iterdir())) == 1
    assert node().not_in_c == ""
    assert not list((installed.parent / "cache").rglob("*.so"))


def test_who_may_write_the_sources_may_write_it(installed):
    (library,) = installed.iterdir()
    library.chmod(0o664)  # as files are where a user's group is the user's own
    assert node().not_in_c == ""


def test_one_can_go_without(installed, monkeypatch):
    monkeypatch.setenv("INNERVATE_READY", "0")
    with pytest.raises(LiveError, match="a-compiler-that-is-not-there"):
        node()


def test_what_to_install_where_it_is_missing(installed, monkeypatch):
    monkeypatch.setattr(compiled, "COMPILER", "cc")
    monkeypatch.setenv("INNERVATE_READY", "0")
    monkeypatch.setenv("PATH", str(installed))
    with pytest.raises(LiveError, match=r"cc is missing; .*apt install gcc libc6-dev\)"):
        node()


def test_of_other_sources_none_is_taken(installed, monkeypatch):
    key = compiled.key_of
    monkeypatch.setattr(compiled, "key_of", lambda *of: key(*of)[::-1])
    with pytest.raises(LiveError, match="a-compiler-that-is-not-there"):
        node()


def test_nor_one_that_says_of_itself_that_it_is_another(installed):
    (library,) = installed.iterdir()
    library.write_bytes(library.read_bytes().replace(library.stem.encode(), b"x" * 20))
    with pytest.raises(LiveError, match="a-compiler-that-is-not-there"):
        node()


def test_every_network_whose_nodes_run_as_c_says_which_are_usual():
    usual = {name: readying.usual_of(network) for name, network in networks().items()}
    assert not usual.pop("radio")  # stations of a live channel stay in Python
    assert {(t["nodes"], t["protocol"]["mtu"]) for t in usual["mesh"]} >= {(32, 127), (254, 1200)}
    assert all(usual.values())


@pytest.mark.slow
def test_a_wheel_brings_it(made, tmp_path):
    env = os.environ | {"INNERVATE_NODES": str(made)}
    build = [sys.executable, "-m", "build", "--no-isolation", "--wheel", "--outdir", tmp_path]
    subprocess.run(build, cwd=ROOT, env=env, check=True)
    (wheel,) = tmp_path.glob("*.whl")
    assert not wheel.stem.endswith("-any")
    (library,) = made.iterdir()
    with zipfile.ZipFile(wheel) as packed:
        place = f"innervate/firmware/nodes/{library.name}"
        assert packed.read(place) == library.read_bytes()
