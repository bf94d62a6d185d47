"""The walls between the rooms: contracts of pyproject.toml, and what an import may load."""

import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
HEAVY = ("numba", "numpy", "polars", "matplotlib")
HELP_CPU_S_MAX = 0.3


def python(code, *, root=ROOT):
    """Run code in a fresh interpreter, with the sources below `root`."""
    env = {**os.environ, "PYTHONPATH": str(root / "src")}
    return subprocess.run(
        [sys.executable, "-c", code],
        cwd=root,
        env=env,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def lint_imports(root):
    return python(
        "import sys; from importlinter.cli import lint_imports\n"
        "sys.exit(lint_imports('pyproject.toml', no_cache=True))",
        root=root,
    )


def test_contracts_are_kept():
    done = lint_imports(ROOT)
    assert done.returncode == 0, done.stdout + done.stderr


# A file, an import it must not have, and the contract that says so.
BREACHES = {
    "upwards": ("trace/bad.py", "import innervate.scenario", "layers"),
    "sideways": ("topology/bad.py", "import innervate.trace", "layers"),
    "room without a layer": ("attic/__init__.py", "import ast", "layers"),
    "numba": ("analysis/bad.py", "import numba", "numba"),
    "matplotlib": ("analysis/bad.py", "from matplotlib import pyplot", "matplotlib"),
    "web server elsewhere": ("running/bad.py", "import uvicorn", "web"),
    "Dask elsewhere": ("sweeping/bad.py", "import distributed", "dask"),
    "clock in a protocol": ("protocol/bad.py", "import time", "protocol"),
    "clock in sim": ("sim/bad.py", "import time", "sim"),
    "bytes in sim": ("sim/bad.py", "import innervate.wire.skin", "sim"),
    "numpy on the wire": ("wire/bad.py", "import numpy", "bare"),
}
NAMES = {
    "layers": "Rooms import only",
    "numba": "Numba stays",
    "matplotlib": "matplotlib is",
    "dask": "Dask is one engine",
    "web": "Web servers are",
    "protocol": "Protocols know",
    "sim": "Simulated time",
    "bare": "The wire runs",
}


@pytest.mark.parametrize("breach", BREACHES.values(), ids=BREACHES.keys())
def test_contracts_can_be_broken(breach, tmp_path):
    file, statement, contract = breach
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    package = tmp_path / "src/innervate"
    shutil.copytree(ROOT / "src/innervate", package, ignore=shutil.ignore_patterns("__pycache__"))
    bad = package / file
    bad.parent.mkdir(exist_ok=True)
    bad.write_text(statement + "\n")
    done = lint_imports(tmp_path)
    assert done.returncode != 0
    verdicts = [line for line in done.stdout.splitlines() if line.startswith(NAMES[contract])]
    assert any(" BROKEN" in line for line in verdicts), done.stdout


def loaded_after(code):
    """Which heavy packages are loaded after `code`."""
    done = python(f"{code}\nimport sys; print('loaded', *[m for m in {HEAVY} if m in sys.modules])")
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()[-1].split()[1:]


@pytest.mark.parametrize("room", ["protocol", "wire", "trace", "topology", "scenario"])
def test_rooms_of_a_live_node_load_nothing_heavy(room):
    walk = "import pkgutil, importlib"
    each = (
        f"for m in pkgutil.walk_packages(room.__path__, 'innervate.{room}.'):"
        " importlib.import_module(m.name)"
    )
    code = f"{walk}\nimport innervate.{room} as room\n{each}"
    assert loaded_after(code) == []


def test_help_loads_nothing_heavy():
    code = (
        "import sys; sys.argv = ['innervate', '--help']\nfrom innervate.cli import main\n"
        "try:\n    main()\nexcept SystemExit as done:\n    assert not done.code"
    )
    assert loaded_after(code) == []


def test_running_nodes_are_watched_without_the_simulator():
    assert loaded_after("import innervate.web.live, innervate.web.serve") == ["numpy"]


def test_help_is_quick():
    # Processor time, not wall time: other tests run beside this one.
    seconds = []
    for _ in range(5):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = python("import sys; sys.argv[1:] = ['--help']; import innervate.cli as c; c.main()")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        assert done.returncode == 0, done.stderr
        seconds.append(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)
    assert min(seconds) < HELP_CPU_S_MAX


def test_the_package_itself_loads_nothing_heavy():
    assert loaded_after("import innervate; assert innervate.__version__") == []
