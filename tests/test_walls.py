"""The walls between the rooms: contracts of pyproject.toml, and what an import may load."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import networkx as nx
import pytest

from innervate.network import networks

ROOT = Path(__file__).resolve().parent.parent
HEAVY = ("numba", "numpy", "polars", "matplotlib")
# What the help may load of ours, and what takes long to load that it has no use for.
HELP_ROOMS = {"cli", "dialect", "folders", "network", "parts"}
HELP_SPARES = ("asyncio", "cryptography", "email", "importlib.metadata", "json", "markdown_it",
               "msgspec", "rich.markdown", "rich.syntax", "sqlite3")  # fmt: skip


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


@pytest.mark.parametrize("home", ["innervate", *(f"innervate.networks.{n}" for n in networks())])
def test_no_room_stands_on_one_that_stands_on_it(home):
    from docs import house

    assert list(nx.simple_cycles(house.imports(house.built(), home))) == []


# A file, an import it must not have, and the contract that says so.
ROOMS = ("__init__.py", "attic.py")  # rooms that no layer is for
BREACHES = {
    "upwards": ("trace/bad.py", "import innervate.scenario", "layers"),
    "sideways": ("topology/bad.py", "import innervate.trace", "layers"),
    "room without a layer": ("attic/__init__.py", "import ast", "layers"),
    "numba": ("analysis/bad.py", "import numba", "numba"),
    "matplotlib": ("analysis/bad.py", "from matplotlib import pyplot", "matplotlib"),
    "web server elsewhere": ("running/bad.py", "import uvicorn", "web"),
    "Dask elsewhere": ("sweeping/bad.py", "import distributed", "dask"),
    "clock in a protocol": ("networks/mesh/protocol/bad.py", "import time", "protocol"),
    "clock in sim": ("sim/bad.py", "import time", "sim"),
    "bytes in sim": ("sim/bad.py", "import innervate.wire.bits", "sim"),
    "a network in the spine": ("web/bad.py", "import innervate.networks.skin.frames", "spine"),
    "a network, indirectly": ("kernel/bad.py", "import innervate.networks.mesh", "spine"),
    "upwards in a network": (
        "networks/skin/scenario/bad.py",
        "import innervate.networks.skin.analysis.rows",
        "networks",
    ),
    "a network's room without a layer": ("networks/radio/attic.py", "import ast", "networks"),
    "a skin that knows a mesh": (
        "networks/skin/analysis/bad.py",
        "import innervate.networks.mesh.frames",
        "apart",
    ),
    "a skin that knows a radio": (
        "networks/skin/analysis/bad.py",
        "import innervate.networks.radio.frames",
        "skin-radio",
    ),
    "a mesh that knows a skin": (
        "networks/mesh/analysis/bad.py",
        "import innervate.networks.skin.frames",
        "mesh-skin",
    ),
    "numpy on the wire": ("wire/bad.py", "import numpy", "bare"),
}
NAMES = {
    "layers": "Rooms import only",
    "spine": "The spine names",
    "networks": "A network's rooms",
    "apart": "Networks do not",
    "skin-radio": "Skin, radio and",
    "mesh-skin": "A mesh does not",
    "numba": "Numba stays",
    "matplotlib": "matplotlib is",
    "dask": "Dask is one engine",
    "web": "Web servers are",
    "protocol": "Protocols know",
    "sim": "Simulated time",
    "bare": "The wire runs",
}


@pytest.fixture(scope="module")
def breached(tmp_path_factory):
    """What the contracts say of a copy with all these breaches; those of rooms in a second one."""
    said = {}
    for structural in (False, True):
        root = tmp_path_factory.mktemp("breached")
        shutil.copy(ROOT / "pyproject.toml", root)
        package, unread = root / "src/innervate", shutil.ignore_patterns("__pycache__", "page")
        shutil.copytree(ROOT / "src/innervate", package, ignore=unread)
        chosen = {name: breach for name, breach in BREACHES.items()
                  if breach[0].endswith(ROOMS) is structural}  # fmt: skip
        for number, (file, statement, _) in enumerate(chosen.values()):
            bad = package / file.replace("bad.py", f"bad_{number}.py")
            bad.parent.mkdir(exist_ok=True)
            bad.write_text(statement + "\n")
        done = lint_imports(root)
        assert done.returncode != 0
        for number, (name, (file, _, contract)) in enumerate(chosen.items()):
            module = file.replace("bad.py", f"bad_{number}.py").removesuffix(".py")
            said[name] = (done.stdout, module.removesuffix("/__init__").replace("/", "."), contract)
    return said


@pytest.mark.parametrize("breach", BREACHES)
def test_contracts_can_be_broken(breach, breached):
    said, module, contract = breached[breach]
    verdicts = [line for line in said.splitlines() if line.startswith(NAMES[contract])]
    assert any(" BROKEN" in line for line in verdicts), said
    assert module.rpartition(".")[2] in said


def loaded_after(code):
    """Which heavy packages are loaded after `code`."""
    done = python(f"{code}\nimport sys; print('loaded', *[m for m in {HEAVY} if m in sys.modules])")
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()[-1].split()[1:]


@pytest.mark.parametrize("room", ["dialect", "network", "wire", "trace", "topology", "scenario"])
def test_rooms_of_a_live_node_load_nothing_heavy(room):
    assert loaded_after(all_of(room)) == []


def all_of(room):
    """Code that imports everything in a room."""
    return (
        f"import pkgutil, importlib\nimport innervate.{room} as room\n"
        f"for m in pkgutil.walk_packages(getattr(room, '__path__', []), 'innervate.{room}.'):"
        " importlib.import_module(m.name)"
    )


@pytest.mark.parametrize("network", ["skin", "radio", "mesh"])
@pytest.mark.parametrize("room", ["protocol", "frames", "scenario", "live"])
def test_rooms_of_a_networks_live_node_load_nothing_heavy(network, room):
    assert loaded_after(all_of(f"networks.{network}.{room}")) == []


def test_help_loads_what_it_shows_and_no_more():
    # How long it takes is what it loads; a clock would tell of the machine (benchmarks do).
    done = python(
        "import sys; sys.argv = ['innervate', '--help']\nfrom innervate.cli import main\n"
        "try:\n    main()\nexcept SystemExit as done:\n    assert not done.code\n"
        "print('loaded', *sys.modules)"
    )
    assert done.returncode == 0, done.stderr
    loaded = done.stdout.splitlines()[-1].split()[1:]
    assert not {*HEAVY, *HELP_SPARES} & {*loaded}
    ours = [module.split(".") for module in loaded if module.startswith("innervate.")]
    assert {room for _, room, *_ in ours} == HELP_ROOMS


def test_running_nodes_are_watched_without_the_simulator():
    assert loaded_after("import innervate.web.live, innervate.web.serve") == ["numpy"]


def test_the_package_itself_loads_nothing_heavy():
    assert loaded_after("import innervate; assert innervate.__version__") == []
