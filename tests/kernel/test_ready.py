"""Ready loops: taken only where they fit, never when stale, and then the same run."""

import json
import os
import runpy
import shutil
import subprocess
import sys
import zipfile
import zlib
from collections import namedtuple
from pathlib import Path
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.kernel import ready, readying
from innervate.kernel.sources import ROOT, content_hash

World = namedtuple("World", "run numbers")
KIND = np.dtype([("count", np.int64), ("step", np.int32)], align=True)
PACKAGE = """
import sys
from innervate.kernel import compilation, ready, readying, tables

def advance(world, until, budget):
    run = world.run[0]
    for number in range(budget):
        run.count += run.step * until
        world.numbers[number] = run.count
"""


def counting(step=3, length=4):
    run = np.zeros(1, KIND)
    run["step"] = step
    return World(run, np.zeros(length, np.int64))


@pytest.fixture(scope="module")
def code(tmp_path_factory):
    """A small loop's machine code, made in a process of its own as a wheel's is."""
    folder = tmp_path_factory.mktemp("code")
    (folder / "makes.py").write_text(PACKAGE + """
import numpy as np
from collections import namedtuple
World = namedtuple("World", "run numbers")
run = np.zeros(1, np.dtype([("count", np.int64), ("step", np.int32)], align=True))
jitted = compilation.compiled_as_one(advance)
jitted(tables.borrowed(World(run, np.zeros(4, np.int64))), 1, 0)
open(sys.argv[1], "wb").write(readying.object_code(jitted))
""")  # fmt: skip
    env = os.environ | {"INNERVATE_CACHE": str(folder)}
    subprocess.run([sys.executable, "makes.py", "code.o"], cwd=folder, env=env, check=True)
    return (folder / "code.o").read_bytes()


@pytest.fixture
def shipped(tmp_path, monkeypatch, code):
    """A folder as it comes with a wheel, with `counting`; what is said of it may differ."""
    folder = tmp_path / "loops"
    folder.mkdir()
    monkeypatch.setattr(ready, "FOLDER", folder)
    monkeypatch.delenv("INNERVATE_READY", raising=False)

    def say(**other):
        key, packed, digest = readying.packed("counting", counting(), code)
        (folder / f"{key}.o.z").write_bytes(packed)
        told = readying.about_of({key: digest}, {"counting"})
        (folder / ready.ABOUT).write_text(json.dumps({**told, **other}))
        ready.about.cache_clear()
        return folder

    yield say
    ready.about.cache_clear()


def plain(world, until, budget):
    for number in range(budget):
        world.run["count"] += world.run["step"] * until
        world.numbers[number] = world.run["count"][0]


class Compiled:
    def __init__(self):
        self.calls = 0

    def __call__(self, world, until, budget):
        self.calls += 1
        plain(world, until, budget)


def ran(world, name="counting"):
    """Was it the ready loop that ran? The result is the same anyway."""
    compiled, expected = Compiled(), type(world)(*(part.copy() for part in world))
    loop = ready.Loop(name, lambda: compiled)
    for _ in range(2):
        loop(world, 5, 3)
        plain(expected, 5, 3)
    assert all(map(np.array_equal, world, expected))
    assert compiled.calls in (0, 2)
    return not compiled.calls


def test_a_loop_that_fits_is_taken(shipped):
    shipped()
    assert ready.is_ready("counting")
    assert ran(counting())
    assert ran(counting(step=-7, length=9))  # lengths are no part of a form


def test_a_loop_of_another_name_or_for_other_tables_is_not(shipped):
    shipped()
    assert not ran(counting(), "counting down")
    assert not ran(counting(), "")
    other = counting()
    assert not ran(other._replace(numbers=other.numbers.astype(np.int32)))
    assert not ran(other._replace(run=other.run.astype([("count", "i8"), ("step", "i8")])))
    renamed = namedtuple("World", "run others")
    assert ready.form_of(renamed(*counting())) != ready.form_of(counting())


@pytest.mark.parametrize("other", [
    {"sources": "0" * 20}, {"target": "plan9-mips"}, {"form": ready.FORM + 1},
    {"features": ["telepathy"]}, {"loops": 1}, {"sources": None},
])  # fmt: skip
def test_a_foreign_or_a_stale_loop_is_never_taken(shipped, other):
    shipped(**other)
    assert not ran(counting())


@pytest.mark.parametrize("harm", [
    lambda data: data[:-1], lambda data: b"", lambda data: data + b"0",
    lambda data: data[:40] + b"?" + data[41:],
])  # fmt: skip
def test_half_a_file_is_never_taken(shipped, harm):
    (file,) = shipped().glob("*.o.z")
    file.write_bytes(harm(file.read_bytes()))
    assert not ran(counting())


def test_one_can_go_without(shipped, monkeypatch):
    shipped()
    monkeypatch.setenv("INNERVATE_READY", "0")
    ready.about.cache_clear()
    assert not ready.is_ready("counting")
    assert not ran(counting())


def test_tables_that_are_not_contiguous_are_refused(shipped):
    shipped()
    with pytest.raises(ValueError, match="contiguous"):
        ran(counting()._replace(numbers=np.zeros(8, np.int64)[::2]))


def test_an_edit_makes_ready_loops_stale_and_moving_does_not(tmp_path):
    shutil.copytree(
        ROOT, tmp_path / "innervate", ignore=shutil.ignore_patterns("page", "static", "*.pyc")
    )
    copied = tmp_path / "innervate"
    assert content_hash(copied) == content_hash()  # wherever it is installed
    os.utime(copied / "sim" / "wheel.py", (0, 0))
    assert content_hash(copied) == content_hash()
    with (copied / "sim" / "wheel.py").open("a") as file:
        file.write("# another\n")
    assert content_hash(copied) != content_hash()


class Jitted:
    """What compiles a loop keeps the function that it was made of."""

    def __init__(self, function):
        self.compiled, self.function = function, function

    def __call__(self, world, until, budget):
        self.function(world, until, budget)


class Running:
    """A run of `counting`, by whatever it is advanced with."""

    name = "usual"

    def __init__(self, function):
        self.world, self.fingerprint = counting(), ""
        self._advance = ready.Loop("counting", lambda: Jitted(function))

    def finish(self):
        self._advance(self.world, 5, 3)
        self.fingerprint = str(self.world)


@pytest.fixture
def network(monkeypatch, code):
    """A network whose compiled loop is this function, and whose code is that of `counting`."""

    def of(function, running=Running):
        found = {"own": Of(simulation=lambda _: running(function))}
        monkeypatch.setattr("innervate.network.networks", lambda: found)
        monkeypatch.setattr("innervate.scenario.load", lambda *words: words)
        monkeypatch.setattr("innervate.scenario.plan", lambda _: Of(kind="own"))
        monkeypatch.setattr(readying, "object_code", lambda _: code)

    return of


class Named(Running):
    loop_names = staticmethod(lambda: {"one", "another"})


@pytest.mark.parametrize(("running", "names"), [
    (Running, {"usual"}), (Named, {"one", "another"}),
])  # fmt: skip
def test_a_loop_is_packed_with_the_names_that_plans_have_for_it(network, code, running, names):
    network(plain, running)
    packed, known = readying.made("own", ())
    assert (packed, known) == (readying.packed("counting", counting(), code), names)
    key, data, digest = packed
    assert zlib.decompress(data) == code
    assert (key, len(digest)) == (ready.key_of("counting", counting()), 32)


def test_a_loop_that_runs_otherwise_than_the_compiled_one_is_none(network):
    network(lambda world, until, budget: plain(world, until, budget + 1))
    with pytest.raises(RuntimeError, match="own: the ready loop runs otherwise"):
        readying.made("own", ())


def test_what_is_made_ready_takes_the_place_of_what_was(tmp_path, monkeypatch, capsys):
    loops = {
        ("a", ()): (("k1", b"one", "d1"), {"x", "y"}),
        ("b", ("s",)): (("k2", b"2", "d2"), {"y"}),
    }
    monkeypatch.setattr(readying, "BUNDLED", tuple(loops))
    monkeypatch.setattr(readying, "made", lambda *asked: loops[asked])
    (tmp_path / "loops").mkdir()
    (tmp_path / "loops" / "old.o.z").write_bytes(b"")
    readying.write(tmp_path / "loops")
    found = {path.name: path.read_bytes() for path in (tmp_path / "loops").iterdir()}
    told = json.loads(found.pop(ready.ABOUT))
    assert found == {"k1.o.z": b"one", "k2.o.z": b"2"}
    assert told == {
        "form": ready.FORM, "target": ready.target(), "features": list(ready.baseline()[1]),
        "sources": content_hash(), "names": ["x", "y"], "loops": {"k1": "d1", "k2": "d2"},
    }  # fmt: skip
    assert capsys.readouterr().out == "a : 0 KiB\nb s: 0 KiB\n"
    assert len(list((tmp_path / "loops").glob("*.o.z"))) == 2


def test_of_sources_that_were_edited_meanwhile_nothing_is_said(tmp_path, monkeypatch):
    hashes = iter("ab")
    monkeypatch.setattr(readying, "BUNDLED", ())
    monkeypatch.setattr(readying, "content_hash", lambda: next(hashes))
    with pytest.raises(RuntimeError, match="edited while"):
        readying.write(tmp_path)
    assert not (tmp_path / ready.ABOUT).exists()


def test_the_command_compiles_for_the_least_processor_and_keeps_no_cache(tmp_path, monkeypatch):
    for name in ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "INNERVATE_READY", "INNERVATE_CACHE"):
        monkeypatch.setenv(name, "before")
    (tmp_path / "file").touch()
    monkeypatch.setattr(sys, "argv", ["readying", str(tmp_path / "file" / "loops")])
    monkeypatch.delitem(sys.modules, "innervate.kernel.readying")
    with pytest.raises(NotADirectoryError):
        runpy.run_module("innervate.kernel.readying", run_name="__main__")
    assert os.environ["NUMBA_CPU_NAME"] == ready.baseline()[0]
    assert (os.environ["NUMBA_CPU_FEATURES"], os.environ["INNERVATE_READY"]) == ("", "0")
    assert not Path(os.environ["INNERVATE_CACHE"]).exists()


@pytest.mark.slow
def test_from_a_wheel_the_first_figures_come_at_once_and_nothing_is_compiled(tmp_path):
    """Loops are made, a wheel built and unpacked elsewhere, and its scenarios run."""
    env = {key: value for key, value in os.environ.items() if not key.startswith("INNERVATE")}
    top = ROOT.parents[1]
    subprocess.run([sys.executable, "-m", "innervate.kernel.readying", tmp_path / "loops"],
                   env=env, check=True)  # fmt: skip
    build = [sys.executable, "-m", "build", "--no-isolation", "--wheel", "--outdir", tmp_path]
    subprocess.run(build, cwd=top, env=env | {"INNERVATE_LOOPS": str(tmp_path / "loops")},
                   check=True)  # fmt: skip
    (wheel,) = Path(tmp_path).glob("*.whl")
    assert "-py3-none-" in wheel.name
    assert not str(wheel.name).endswith("-any.whl")
    with zipfile.ZipFile(wheel) as packed:
        packed.extractall(tmp_path / "site")
    at = env | {"PYTHONPATH": str(tmp_path / "site"), "INNERVATE_CACHE": str(tmp_path / "cache")}
    asked = (
        "import sys, innervate; print(innervate.__file__); run = innervate.run(sys.argv[1]); "
        "print(run.result.fingerprint, 'numba' in sys.modules)"
    )
    for scenario in ("demo", "radio-disaster", "mesh-field", "mesh-team"):
        said = {}
        for way in ("1", "0"):
            done = subprocess.run([sys.executable, "-c", asked, scenario], cwd=tmp_path, text=True,
                                  env=at | {"INNERVATE_READY": way}, stdout=subprocess.PIPE,
                                  check=True)  # fmt: skip
            place, said[way], *_ = done.stdout.splitlines()
            assert Path(place).is_relative_to(tmp_path)
        assert said["1"].split()[0] == said["0"].split()[0]
        assert (said["1"].split()[1], said["0"].split()[1]) == ("False", "True"), scenario
